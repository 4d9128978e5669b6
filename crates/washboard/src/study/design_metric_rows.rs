//! Metrics as rows of a table: passive, closed and the change, by what they say of a car.

use super::{DesignMetrics, Named, ResponseGroup, RideMetrics, TravelUse};

/// Places at the end of names, longest first.
const PLACES: [&str; 6] = ["front_left", "front_right", "rear_left", "rear_right", "front", "rear"];

/// Shares of time in percent, and how often an hour or a kilometre: less of it than this is never, to any driver.
const NEVER: f64 = 1e-6;
/// In words, of what is infinite.
const INFINITE: &str = "infinite on this road";

/// What a metric says of a car.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MetricGroup {
    /// Weighted accelerations.
    Comfort,
    /// Travels and strokes.
    RattleSpace,
    /// Dynamic tire loads.
    TireLoad,
    /// Forces and powers.
    Actuator,
    /// Over the bump.
    Bump,
}

impl MetricGroup {
    /// In the order in which they are read.
    pub const ALL: [MetricGroup; 5] = [
        MetricGroup::Comfort,
        MetricGroup::RattleSpace,
        MetricGroup::TireLoad,
        MetricGroup::Actuator,
        MetricGroup::Bump,
    ];

    /// Its heading.
    #[must_use]
    pub fn heading(self) -> &'static str {
        match self {
            MetricGroup::Comfort => "comfort, ISO 2631-1",
            MetricGroup::RattleSpace => "rattle space",
            MetricGroup::TireLoad => "tire load",
            MetricGroup::Actuator => "actuators",
            MetricGroup::Bump => "over the bump",
        }
    }
}

/// One number, passive and in the loop.
#[derive(Debug, Clone, PartialEq)]
pub struct MetricRow {
    /// What it says of a car.
    pub group: MetricGroup,
    /// As a column of a table would be called: `weighted_heave_acceleration`.
    pub key: String,
    /// In words.
    pub what: String,
    /// Its unit; of pure numbers nothing.
    pub unit: String,
    /// Passive, closed.
    pub values: [Option<f64>; 2],
    /// The standard's words for them, or that they are infinite.
    pub words: [String; 2],
}

impl MetricRow {
    /// The word for a value that is missing as it is infinite on this road; nothing else.
    #[must_use]
    pub fn infinite(&self, side: usize) -> &'static str {
        if self.words.get(side).is_some_and(|w| w == INFINITE) { "infinite" } else { "" }
    }

    /// The loop's over the passive one, less 1; none of what never happens.
    #[must_use]
    pub fn change(&self) -> Option<f64> {
        let [before, after] = [self.values[0]?, self.values[1]?];
        (before > 0.0 && !self.is_never(before)).then(|| after / before - 1.0)
    }

    /// Passive and closed as they are shown: numbers by `number`, but for what never happens.
    #[must_use]
    pub fn shown(&self, number: impl Fn(f64) -> String) -> [Option<String>; 2] {
        let one = |v: f64| if self.is_never(v) { format!("never (< {NEVER:e})") } else { number(v) };
        self.values.map(|v| v.map(one))
    }

    fn is_never(&self, v: f64) -> bool {
        ["%", "1/h", "1/km"].contains(&self.unit.as_str()) && v < NEVER
    }
}

/// How places of one thing become one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Whole {
    /// The largest of them …
    Worst,
    /// … or all together.
    Sum,
}

/// One number of a ride's metrics.
struct Quantity {
    group: MetricGroup,
    /// `weighted`, …; the name of the output follows.
    key: &'static str,
    what: &'static str,
    unit: &'static str,
    whole: Whole,
    of: fn(&RideMetrics) -> Named<f64>,
}

fn pick<T>(all: &Named<T>, number: impl Fn(&T) -> Option<f64>) -> Named<f64> {
    all.iter().filter_map(|(name, v)| Some((name.to_owned(), number(v)?))).collect()
}

fn used(m: &RideMetrics, number: fn(&TravelUse) -> Option<f64>) -> Named<f64> {
    pick(&m.travel, number)
}

/// What is infinite on the road is worse than what is not.
fn beside_infinite(m: &RideMetrics, group: ResponseGroup, finite: Named<f64>) -> Named<f64> {
    let own = m.infinite.iter().filter(|(name, _)| ResponseGroup::of(name) == group);
    let own = own.map(|(name, _)| (name.to_owned(), f64::INFINITY));
    finite.iter().map(|(name, v)| (name.to_owned(), *v)).chain(own).collect()
}

const fn quantity(
    group: MetricGroup,
    [key, what, unit]: [&'static str; 3],
    whole: Whole,
    of: fn(&RideMetrics) -> Named<f64>,
) -> Quantity {
    Quantity { group, key, what, unit, whole, of }
}

const QUANTITIES: [Quantity; 14] = [
    quantity(MetricGroup::Comfort, ["weighted", "weighted", ""], Whole::Worst, |m| {
        beside_infinite(m, ResponseGroup::Comfort, pick(&m.weighted, |w| Some(w.rms)))
    }),
    quantity(
        MetricGroup::Comfort,
        [
            "vibration_total",
            "vibration total value (z and rotations only: without x, y, seat-back and feet), seat at",
            "m/s²",
        ],
        Whole::Worst,
        |m| m.vibration_total.iter().map(|t| (t.at.clone(), t.rms)).collect(),
    ),
    quantity(MetricGroup::RattleSpace, ["three_sigma", "3σ of", "m"], Whole::Worst, |m| {
        beside_infinite(m, ResponseGroup::RattleSpace, used(m, |t| Some(t.three_sigma_m)))
    }),
    quantity(
        MetricGroup::RattleSpace,
        ["beyond_stroke", "time beyond the stroke,", "%"],
        Whole::Worst,
        |m| used(m, |t| t.beyond_stroke.map(|v| 100.0 * v)),
    ),
    quantity(MetricGroup::RattleSpace, ["bottoming_per_hour", "bottoming,", "1/h"], Whole::Worst, |m| {
        used(m, |t| t.bottoming_per_hour)
    }),
    quantity(MetricGroup::RattleSpace, ["bottoming_per_km", "bottoming,", "1/km"], Whole::Worst, |m| {
        used(m, |t| t.bottoming_per_km)
    }),
    quantity(
        MetricGroup::TireLoad,
        ["load_coefficient", "dynamic load coefficient,", ""],
        Whole::Worst,
        |m| beside_infinite(m, ResponseGroup::TireLoad, pick(&m.tire_load, |t| Some(t.coefficient))),
    ),
    quantity(MetricGroup::Actuator, ["force_rms", "rms force,", "N"], Whole::Worst, |m| {
        pick(&m.actuator, |a| Some(a.force_rms_n))
    }),
    quantity(MetricGroup::Actuator, ["force_three_sigma", "3σ of the force,", "N"], Whole::Worst, |m| {
        pick(&m.actuator, |a| Some(a.force_three_sigma_n))
    }),
    quantity(MetricGroup::Actuator, ["power_net", "mean power, given less taken,", "W"], Whole::Sum, |m| {
        pick(&m.actuator, |a| Some(a.net_w))
    }),
    quantity(MetricGroup::Actuator, ["power_absolute", "mean power, magnitude,", "W"], Whole::Sum, |m| {
        pick(&m.actuator, |a| Some(a.absolute_w))
    }),
    quantity(MetricGroup::Actuator, ["power_given", "mean power, given alone,", "W"], Whole::Sum, |m| {
        pick(&m.actuator, |a| Some(a.given_w))
    }),
    quantity(MetricGroup::Bump, ["bump_peak", "peak of", ""], Whole::Worst, |m| {
        m.bump.as_ref().map_or_else(Named::default, |b| b.peak.clone())
    }),
    quantity(MetricGroup::Bump, ["bump_settling", "settling of", "s"], Whole::Worst, |m| {
        m.bump.as_ref().map_or_else(Named::default, |b| {
            // what has not settled outlasts what has
            pick(&b.settling_s, |s| Some(s.unwrap_or(f64::INFINITY)))
        })
    }),
];

/// A name without its place.
fn base(name: &str) -> &str {
    let cut = |p: &&str| name.strip_suffix(*p).and_then(|b| b.strip_suffix('_'));
    PLACES.iter().find_map(cut).unwrap_or(name)
}

/// What a short table of a bump leaves out: others say the same of the car.
fn is_minor(name: &str) -> bool {
    ["unsprung_", "body_", "chassis_", "tire_force"].iter().any(|p| name.starts_with(p))
}

impl DesignMetrics {
    /// Every number by its output.
    #[must_use]
    pub fn rows(&self, units: &Named<String>) -> Vec<MetricRow> {
        self.rows_by(units, |_, name| Some((name.to_owned(), name.to_owned())))
    }

    /// The worst corner of each, and the power of all actuators together; over the bump not what wheels and corners of the body do.
    #[must_use]
    pub fn short_rows(&self, units: &Named<String>) -> Vec<MetricRow> {
        self.rows_by(units, |quantity, name| {
            if quantity.key == "force_rms" || (quantity.group == MetricGroup::Bump && is_minor(name)) {
                return None;
            }
            let whole = quantity.whole;
            // actuators may be nothing but places
            let actuators = whole == Whole::Sum || PLACES.contains(&name);
            let base = if actuators { "actuators" } else { base(name) };
            let many = actuators || base != name;
            let words = match (whole, many) {
                (Whole::Worst, true) => format!("{base} (worst)"),
                (Whole::Sum, _) => "all actuators".to_owned(),
                _ => base.to_owned(),
            };
            Some((base.to_owned(), words))
        })
    }

    fn rows_by(
        &self,
        units: &Named<String>,
        merged: impl Fn(&Quantity, &str) -> Option<(String, String)>,
    ) -> Vec<MetricRow> {
        let mut rows = Vec::new();
        for quantity in &QUANTITIES {
            let mut own: Vec<MetricRow> = Vec::new();
            for (side, metrics) in [&self.passive, &self.closed].into_iter().enumerate() {
                let Some(metrics) = metrics else { continue };
                for (name, value) in (quantity.of)(metrics).iter() {
                    let Some((under, words)) = merged(quantity, name) else { continue };
                    let key = format!("{}_{under}", quantity.key);
                    let at = own.iter().position(|r| r.key == key).unwrap_or_else(|| {
                        let unit = if quantity.unit.is_empty() {
                            unit(quantity, name, units)
                        } else {
                            quantity.unit.into()
                        };
                        let what = format!("{} {words}", quantity.what);
                        let (values, words) = ([None; 2], [String::new(), String::new()]);
                        own.push(MetricRow { group: quantity.group, key, what, unit, values, words });
                        own.len() - 1
                    });
                    let row = &mut own[at];
                    let before = row.values[side];
                    let whole = match quantity.whole {
                        Whole::Worst => before.map_or(*value, |b| b.max(*value)),
                        Whole::Sum => before.unwrap_or(0.0) + value,
                    };
                    row.values[side] = Some(whole);
                    if quantity.group == MetricGroup::Comfort && before.is_none_or(|b| *value > b) {
                        row.words[side] =
                            metrics.weighted.get(name).map_or_else(String::new, |w| w.reactions.join(", "));
                    }
                }
            }
            for row in &mut own {
                for (value, words) in row.values.iter_mut().zip(&mut row.words) {
                    // over a bump what has not settled is another matter
                    if *value == Some(f64::INFINITY) && row.group != MetricGroup::Bump {
                        *words = INFINITE.to_owned();
                    }
                    *value = value.filter(|v| v.is_finite());
                }
            }
            rows.extend(own);
        }
        rows
    }
}

/// Of what has its output's unit.
fn unit(quantity: &Quantity, name: &str, units: &Named<String>) -> String {
    match quantity.group {
        MetricGroup::Comfort | MetricGroup::Bump => units.get(name).cloned().unwrap_or_default(),
        _ => String::new(),
    }
}

impl super::RideOutcome {
    /// The worst corner of each, all as the first value.
    #[must_use]
    pub fn metric_rows(&self) -> Vec<MetricRow> {
        let bump = super::BumpSpec::default();
        let one = DesignMetrics { stroke_m: None, bump, passive: self.metrics.clone(), closed: None };
        one.short_rows(&self.units)
    }
}

impl super::DesignOutcome {
    /// What the metrics are of, in words.
    #[must_use]
    pub fn metrics_words(&self) -> String {
        let Some(m) = &self.metrics else { return String::new() };
        let stroke = m.stroke_m.map_or_else(
            || "No stroke is given ([metrics] stroke_m); 3σ is what 0.27 % of the time goes beyond".to_owned(),
            |s| format!("The stroke is ±{s} m about rest; bottoming is the expected number of times that it is reached (Rice)"),
        );
        let rides: Vec<&RideMetrics> = m.passive.iter().chain(&m.closed).collect();
        let weightless = rides.iter().all(|r| r.tire_load.is_empty());
        let endless = rides.iter().flat_map(|r| r.infinite.iter());
        let endless = endless.map(|(name, _)| name).any(|n| ResponseGroup::of(n) == ResponseGroup::TireLoad);
        let loads = if endless {
            "A load coefficient is the rms of a tire's dynamic force over its static load: infinite where this road makes the force so"
        } else if weightless {
            "There is no dynamic load coefficient: no tire forces, or no finite ones, over a known weight"
        } else {
            "A load coefficient is the rms of a tire's dynamic force over its static load"
        };
        let stated = self.design.metrics.is_some_and(|m| m.bump.is_some());
        let whose = if stated { "" } else { " (the default: [metrics] bump states another)" };
        format!(
            "Metrics are of the road's part alone, without the sensors' noise, at {} m/s. Weighted accelerations are rms of one axis, without the others, behind \
             W_k (vertical) and W_e (rotational) as a rigid seat on the body has them; words are ISO 2631-1 annex C's (informative, for the total value in public \
             transport), at the driver and the centre of gravity alone. {stroke}. {loads}. The bump is {} m high and {} m long, w = ½h(1 − cos 2πvt/l){whose}; \
             settling is to 5 % of the peak. Signals are taken to be Gaussian; power that an actuator gives is positive.",
            self.design.speed_m_s, m.bump.height_m, m.bump.length_m
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{ActuatorUse, RideOutcome, RideSpec, TireLoad, ride};

    fn full_car() -> RideOutcome {
        let spec = RideSpec {
            vehicle: "case:chalasani-full-car".into(),
            road: "case:iso8608-c".into(),
            speed_m_s: 20.0,
            controller: None,
            stroke_m: Some(0.1),
        };
        ride(&spec).unwrap().0
    }

    #[test]
    fn short_rows_have_the_worst_corner() {
        let outcome = full_car();
        let m = outcome.metrics.clone().unwrap();
        let rows = outcome.metric_rows();
        let find = |key: &str| rows.iter().find(|r| r.key == key).unwrap_or_else(|| panic!("{key} {rows:?}"));
        let load = find("load_coefficient_tire_force");
        let worst = m.tire_load.iter().map(|(_, t)| t.coefficient).fold(0.0, f64::max);
        assert_eq!(load.values, [Some(worst), None]);
        assert_eq!(load.what, "dynamic load coefficient, tire_force (worst)");
        assert!(find("bottoming_per_km_suspension_travel").values[0].is_some_and(|v| v > 0.0));
        let heave = find("weighted_heave_acceleration");
        assert_eq!((heave.unit.as_str(), heave.what.as_str()), ("m/s²", "weighted heave_acceleration"));
        assert_eq!(heave.words[0], m.weighted.get("heave_acceleration").unwrap().reactions.join(", "));
        assert!(!heave.words[0].is_empty());
        // nobody sits on a wheel's corner
        assert!(find("weighted_body_acceleration").words[0].is_empty());
        let of = |name: &str| m.weighted.get(name).unwrap().rms;
        let turns = (0.4 * of("pitch_acceleration")).hypot(0.63 * of("roll_acceleration"));
        let total = find("vibration_total_driver");
        assert!((total.values[0].unwrap() - of("driver_heave_acceleration").hypot(turns)).abs() < 1e-12);
        assert!(total.what.contains("without x, y, seat-back and feet") && total.unit == "m/s²");
    }

    #[test]
    fn what_happens_once_in_a_lifetime_is_never() {
        let row = |unit: &str, before: f64, after: f64| MetricRow {
            group: MetricGroup::RattleSpace,
            key: "beyond_stroke".into(),
            what: String::new(),
            unit: unit.into(),
            values: [Some(before), Some(after)],
            words: Default::default(),
        };
        let number = |v: f64| format!("{v}");
        let never = || Some("never (< 1e-6)".to_owned());
        let rare = row("%", 5.647e-46, 0.25);
        assert_eq!(rare.shown(number), [never(), Some("0.25".into())]);
        assert!(rare.change().is_none());
        assert_eq!(row("1/h", 0.5, 9.176e-80).shown(number), [Some("0.5".into()), never()]);
        assert_eq!(row("1/h", 0.5, 9.176e-80).change(), Some(-1.0));
        // a force of a micronewton is one
        assert_eq!(row("N", 1e-7, 1.0).shown(number)[0], Some(number(1e-7)));
    }

    #[test]
    fn a_worst_wheel_that_is_infinite_is_the_worst() {
        let load = |coefficient| TireLoad { static_n: 1.0, rms_n: coefficient, coefficient };
        let rows = |infinite: &[&str]| {
            let mut m = RideMetrics::default();
            m.tire_load.insert("tire_force_rear", load(0.2));
            infinite.iter().for_each(|name| m.infinite.insert(*name, "it wanders off".into()));
            let one = DesignMetrics {
                stroke_m: None,
                bump: super::super::BumpSpec::default(),
                passive: Some(m),
                closed: None,
            };
            one.short_rows(&Named::default())
        };
        let row = &rows(&["tire_force_front"])[0];
        assert_eq!(
            (row.what.as_str(), row.values[0]),
            ("dynamic load coefficient, tire_force (worst)", None)
        );
        assert_eq!(row.words[0], "infinite on this road");
        assert_eq!(rows(&["suspension_travel_front"]).len(), 2);
        let row = &rows(&[])[0];
        assert_eq!((row.values[0], row.words[0].as_str()), (Some(0.2), ""));
    }

    #[test]
    fn powers_of_all_actuators_are_summed_and_forces_are_the_worst() {
        let used = |force_rms_n: f64, net_w: f64| ActuatorUse {
            force_rms_n,
            force_three_sigma_n: 3.0 * force_rms_n,
            velocity_rms_m_s: 0.1,
            net_w,
            absolute_w: net_w.abs(),
            given_w: net_w.max(0.0),
        };
        let actuator = [("front", used(10.0, -3.0)), ("rear", used(20.0, 1.0))];
        let closed = RideMetrics {
            actuator: actuator.into_iter().map(|(n, u)| (n.to_owned(), u)).collect(),
            ..RideMetrics::default()
        };
        let metrics = DesignMetrics {
            stroke_m: None,
            bump: crate::study::BumpSpec::default(),
            passive: None,
            closed: Some(closed),
        };
        let rows = metrics.short_rows(&Named::default());
        let value = |key: &str| rows.iter().find(|r| r.key == key).and_then(|r| r.values[1]);
        assert_eq!(value("force_three_sigma_actuators"), Some(60.0));
        assert_eq!(
            (value("power_net_actuators"), value("power_absolute_actuators")),
            (Some(-2.0), Some(4.0))
        );
        assert_eq!(metrics.rows(&Named::default()).len(), 10);
    }
}
