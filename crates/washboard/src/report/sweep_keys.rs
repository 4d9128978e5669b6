//! Keys of a sweep's grid as people read them: a name and a unit, and which of them make another vehicle of a point.

use crate::study::{SweepAxis, SweepOutcome};

/// Ends of keys and their units, longer ones first.
const UNITS: [(&str, &str); 13] = [
    ("_n_m_s_per_rad", "N m s/rad"),
    ("_n_m_per_rad", "N m/rad"),
    ("_rad_per_m", "rad/m"),
    ("_n_s_per_m", "N s/m"),
    ("_n_per_m", "N/m"),
    ("_kg_m2", "kg m²"),
    ("_rad_s", "rad/s"),
    ("_m_s", "m/s"),
    ("_kg", "kg"),
    ("_hz", "Hz"),
    ("_m3", "m³"),
    ("_m", "m"),
    ("_s", "s"),
];

/// `tire damping, N s/m` of `override.tire_damping_n_s_per_m`.
pub(super) fn key_label(key: &str) -> String {
    let named = |words: &str, name: &str| format!("{words} {}", name.replace('_', " "));
    let (place, rest) = match key.split_once('.') {
        Some(("goal", rest)) => match rest.split_once('.') {
            Some((list, name)) if list.starts_with("minimize") => return named("weight of", name),
            Some((list, name)) if list.starts_with("bound") => return named("bound on", name),
            _ => ("", rest),
        },
        Some(("normalize_at", rest)) => ("norms at ", rest),
        Some((_, rest)) => ("", rest),
        None => ("", key),
    };
    let unit = UNITS.iter().find(|(end, _)| rest.ends_with(end) && rest.len() > end.len());
    let name = unit.map_or(rest, |(end, _)| &rest[..rest.len() - end.len()]);
    let unit = unit.map_or_else(String::new, |(_, unit)| format!(", {unit}"));
    format!("{place}{}{unit}", name.replace(['_', '.'], " "))
}

/// Axes of several values whose key is one of these tables or names.
fn varied<'a>(o: &'a SweepOutcome, of: &[&str]) -> Vec<&'a str> {
    let is = |a: &&SweepAxis| {
        let head = a.key.split('.').next().unwrap_or_default();
        a.values.len() > 1 && of.contains(&head)
    };
    o.grid.iter().filter(is).map(|a| a.key.as_str()).collect()
}

/// What the page's numbers are over, where the points are of different vehicles; none where they are all of one.
pub(super) fn compared(o: &SweepOutcome) -> Option<String> {
    let own = varied(o, &["vehicle", "road", "speed_m_s", "override"]);
    let norms = varied(o, &["normalize_at"]);
    let mut words = Vec::new();
    if !own.is_empty() {
        words.push(format!(
            "The points are not of one passive vehicle on one road, as {} changes it: each value is over the point's own passive one, so \
             that a smaller value is a larger gain by control and not always a smaller response.",
            own.join(", ")
        ));
    }
    if !norms.is_empty() {
        words.push(format!(
            "Goals of different {} are over different norms, and not to be compared.",
            norms.join(", ")
        ));
    }
    (!words.is_empty()).then(|| words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Named;
    use serde_json::Value;

    #[test]
    fn units_stand_behind_names() {
        for (key, label) in [
            ("override.tire_damping_n_s_per_m", "tire damping, N s/m"),
            ("override.front.tire_damping_n_s_per_m", "front tire damping, N s/m"),
            ("normalize_at.sprung_mass_kg", "norms at sprung mass, kg"),
            ("goal.minimize.suspension_travel", "weight of suspension travel"),
            ("goal.bound_h2.tire_deflection", "bound on tire deflection"),
            ("goal.max_pole_rad_s", "max pole, rad/s"),
            ("goal.order", "order"),
            ("speed_m_s", "speed, m/s"),
            ("lqg.sensor_noise", "sensor noise"),
            ("vehicle", "vehicle"),
        ] {
            assert_eq!(key_label(key), label);
        }
    }

    #[test]
    fn another_vehicle_is_said_and_another_goal_is_none() {
        let outcome = |key: &str, n: usize| SweepOutcome {
            grid: vec![SweepAxis { key: key.into(), values: (0..n).map(Value::from).collect() }],
            warm_start: false,
            goal: None,
            counts: Named::default(),
            missing: Vec::new(),
            points: Vec::new(),
        };
        let words = compared(&outcome("override.sprung_mass_kg", 2)).unwrap();
        assert!(
            words.contains("override.sprung_mass_kg changes it") && words.contains("own passive"),
            "{words}"
        );
        assert!(compared(&outcome("normalize_at.sprung_mass_kg", 2)).unwrap().contains("not to be compared"));
        assert_eq!(compared(&outcome("override.sprung_mass_kg", 1)), None);
        assert_eq!(compared(&outcome("goal.order", 3)), None);
    }
}
