//! The job `damping`: what linear dampers, and so what modes, roads of growing roughness make of dampers with curves.

use super::modes::modes_of;
use super::{DampingSpec, Input, StudyError, VehicleMode, load_road, load_vehicle};
use crate::vehicle::linearise;
use serde::{Deserialize, Serialize};

/// Where no road is named: the classes that people drive on.
const CLASSES: [&str; 5] =
    ["case:iso8608-a", "case:iso8608-b", "case:iso8608-c", "case:iso8608-d", "case:iso8608-e"];

/// Equivalent linear damping against roughness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DampingOutcome {
    /// Forward speed.
    pub speed_m_s: f64,
    /// One entry a road, in the order asked for.
    pub roads: Vec<DampingOnRoad>,
}

/// A vehicle's dampers and modes on a road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DampingOnRoad {
    /// Its file or `case:NAME`.
    pub road: String,
    /// Each damper with a curve.
    pub dampers: Vec<EquivalentDamper>,
    /// With these dampers.
    pub modes: Vec<VehicleMode>,
    /// Steps of the fixed-point iteration.
    pub steps: usize,
}

/// What a road makes of a damper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EquivalentDamper {
    /// Its wheel.
    pub name: String,
    /// rms of its velocity.
    pub velocity_m_s: f64,
    /// E\[F v\]/E\[v²\].
    pub damping_n_s_per_m: f64,
}

/// The equivalent damping of the vehicle that a spec names on its roads, and the files read.
///
/// # Errors
/// A vehicle or road that cannot be built, a vehicle without damper curves, a speed that is not positive, an iteration
/// that does not converge.
pub fn damping(spec: &DampingSpec) -> Result<(DampingOutcome, Vec<Input>), StudyError> {
    super::ride::check_speed(spec.speed_m_s)?;
    let loaded = load_vehicle(&spec.vehicle)?;
    let mut inputs = loaded.inputs.clone();
    let names: Vec<String> =
        if spec.roads.is_empty() { CLASSES.map(str::to_owned).to_vec() } else { spec.roads.clone() };
    let mut roads = Vec::with_capacity(names.len());
    for name in names {
        let road = load_road(&name)?;
        let found = linearise(&loaded.vehicle, &road.road, spec.speed_m_s)
            .map_err(|source| StudyError::Linearise { name: format!("{} on {name}", loaded.name), source })?;
        let modes = modes_of(&found.vehicle)
            .map_err(|source| StudyError::Vehicle { name: loaded.name.clone(), source })?;
        let dampers = loaded.vehicle.dampers().iter().zip(&found.velocity_m_s).zip(&found.damping_n_s_per_m);
        let dampers = dampers.map(|((damper, velocity_m_s), damping_n_s_per_m)| EquivalentDamper {
            // the only wheel of a quarter car has no corner's name
            name: if damper.name.is_empty() { "wheel".to_owned() } else { damper.name.clone() },
            velocity_m_s: *velocity_m_s,
            damping_n_s_per_m: *damping_n_s_per_m,
        });
        roads.push(DampingOnRoad { dampers: dampers.collect(), road: name, modes, steps: found.steps });
        inputs.extend(road.inputs);
    }
    Ok((DampingOutcome { speed_m_s: spec.speed_m_s, roads }, inputs))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vehicle_without_curves_is_refused_and_a_road_that_is_named_is_taken() {
        let spec = |vehicle: &str| DampingSpec {
            vehicle: vehicle.to_owned(),
            roads: vec!["case:iso8608-b".into()],
            speed_m_s: 20.0,
        };
        let e = damping(&spec("case:turkay-quarter-car")).unwrap_err();
        assert!(e.is_wrong_input());
        let text = "case:turkay-quarter-car on case:iso8608-b: damper_curve: expected a vehicle with one";
        assert!(e.to_string().starts_with(text), "{e}");
        let path = std::env::temp_dir().join(format!("washboard-damping-{}.toml", std::process::id()));
        let car = crate::cases::find("turkay-quarter-car", crate::cases::CaseKind::Vehicle).unwrap().toml;
        std::fs::write(&path, format!("{car}\ndamper_curve = [[-1.0, -700.0], [2.0, 1400.0]]\n")).unwrap();
        let (outcome, inputs) = damping(&spec(&path.display().to_string())).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!((outcome.roads.len(), inputs.len()), (1, 2));
        let found = &outcome.roads[0];
        assert_eq!((found.dampers[0].name.as_str(), found.modes.len()), ("wheel", 2));
        assert!((found.dampers[0].damping_n_s_per_m / 700.0 - 1.0).abs() < 1e-12);
    }
}
