//! A vehicle file with some of its numbers replaced.

use super::known::{leaves, names, unknown};
use super::{VehicleError, VehicleSpec};
use serde_json::Value;

impl VehicleSpec {
    /// The file with numbers replaced, by dotted names of its fields: `front.tire_damping_n_s_per_m`; a name without its
    /// axle means every axle, one without its side both sides. Where two names mean one number the more specific one has it, in
    /// whatever order they are given.
    ///
    /// # Errors
    /// A name that is none, with the nearest that is; a number that makes no file.
    pub fn with_overrides(&self, overrides: &[(String, f64)]) -> Result<Self, VehicleError> {
        let wrong = |found: String| VehicleError::Field {
            field: "override".into(),
            expected: "values that make a vehicle file",
            found,
        };
        let mut file = serde_json::to_value(self).map_err(|e| wrong(e.to_string()))?;
        let model = self.model.name();
        let found = leaves(&file[model]);
        let mut ordered: Vec<&(String, f64)> = overrides.iter().collect();
        ordered.sort_by_key(|(name, _)| name.matches('.').count());
        for (name, value) in ordered {
            let mut written = false;
            for (path, _) in found.iter().filter(|(path, _)| names(name, path)) {
                if let Some(slot) = file[model].pointer_mut(&format!("/{}", path.join("/"))) {
                    *slot = Value::from(*value);
                    written = true;
                }
            }
            if !written {
                return Err(unknown(name, &found));
            }
        }
        serde_json::from_value(file).map_err(|e| wrong(e.to_string()))
    }

    /// Every number of the file that is not 0, by its dotted name, as fields that are to change together: of `matrices` all
    /// entries of M, of C and C_w, of K and K_w, since a road that is lifted lifts the vehicle as it stands.
    #[must_use]
    pub fn parameters(&self) -> Vec<(String, Vec<(String, f64)>)> {
        let file = serde_json::to_value(self).unwrap_or_default();
        let all: Vec<(String, f64)> = leaves(&file[self.model.name()])
            .into_iter()
            .filter(|(_, value)| *value != 0.0)
            .map(|(path, value)| (path.join("."), value))
            .collect();
        if self.matrices.is_none() {
            return all.into_iter().map(|(name, value)| (name.clone(), vec![(name, value)])).collect();
        }
        let groups: [(&str, &[&str]); 3] = [
            ("m", &["m."]),
            ("c, wheel_damping", &["c.", "wheel_damping."]),
            ("k, wheel_stiffness", &["k.", "wheel_stiffness."]),
        ];
        let of = |heads: &[&str]| {
            let own = all.iter().filter(|(name, _)| heads.iter().any(|h| name.starts_with(h)));
            own.cloned().collect::<Vec<_>>()
        };
        let groups = groups.into_iter().map(|(name, heads)| (name.to_owned(), of(heads)));
        groups.filter(|(_, fields)| !fields.is_empty()).collect()
    }

    /// Names of the dampings that are 0.
    #[must_use]
    pub fn undamped(&self) -> Vec<String> {
        let file = serde_json::to_value(self).unwrap_or_default();
        let all = leaves(&file[self.model.name()]).into_iter().filter(|(_, value)| *value == 0.0);
        all.map(|(path, _)| path.join(".")).filter(|name| name.contains("damping")).collect()
    }

    /// Whether two names of fields mean a number in common.
    #[must_use]
    pub fn overlap(&self, one: &str, other: &str) -> bool {
        let file = serde_json::to_value(self).unwrap_or_default();
        leaves(&file[self.model.name()]).iter().any(|(path, _)| names(one, path) && names(other, path))
    }
}

#[cfg(test)]
mod tests {
    use crate::vehicle::test_cases;

    #[test]
    fn a_bare_name_means_every_axle_and_a_dotted_one_its_own() {
        let spec = test_cases::spec("chalasani-full-car");
        let damping = |o: &[(&str, f64)]| {
            let o: Vec<(String, f64)> = o.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
            let car = spec.with_overrides(&o)?.build_alone()?;
            Ok::<_, super::VehicleError>([0, 2].map(|w| car.wheel_damping()[(3 + w, w)]))
        };
        assert_eq!(damping(&[("tire_damping_n_s_per_m", 98.0)]).unwrap(), [98.0, 98.0]);
        assert_eq!(
            damping(&[("tire_damping_n_s_per_m", 98.0), ("rear.tire_damping_n_s_per_m", 50.0)]).unwrap(),
            [98.0, 50.0]
        );
        assert_eq!(
            damping(&[("rear.tire_damping_n_s_per_m", 50.0), ("tire_damping_n_s_per_m", 98.0)]).unwrap(),
            [98.0, 50.0],
            "the specific name has it in either order"
        );
        assert!(spec.overlap("rear.tire_damping_n_s_per_m", "tire_damping_n_s_per_m"));
        assert!(!spec.overlap("rear.tire_damping_n_s_per_m", "front.tire_damping_n_s_per_m"));
        let e = damping(&[("tire_dampng_n_s_per_m", 1.0)]).unwrap_err().to_string();
        assert!(e.contains("no parameter `tire_dampng_n_s_per_m`"), "{e}");
        assert!(damping(&[("tire_damping_n_s_per_m", -1.0)]).is_err());
    }
}
