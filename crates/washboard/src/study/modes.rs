//! The job `modes`: frequencies, damping and shapes of a vehicle.

use super::{Input, LoadedVehicle, ModesSpec, ShapeValue, StudyError, load_vehicle};
use crate::lti::ModeKind;
use crate::vehicle::{Vehicle, VehicleError};
use serde::{Deserialize, Serialize};

/// The modes of a vehicle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModesOutcome {
    /// Ascending in |λ|: one entry a conjugate pair, one a real pole, one a rigid motion.
    pub modes: Vec<VehicleMode>,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VehicleMode {
    /// |λ|/2π.
    pub freq_hz: f64,
    /// |Im λ|/2π.
    pub damped_hz: f64,
    /// −Re λ/|λ|.
    pub damping: f64,
    /// λ as [re, im], 1/s, Im λ ≥ 0.
    pub pole: [f64; 2],
    /// Oscillatory, overdamped or rigid.
    pub kind: VehicleModeKind,
    /// The motion that it resembles.
    pub label: String,
    /// Displacements, the largest 1.
    pub shape: Vec<ShapeValue>,
}

/// What sort of motion a mode is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VehicleModeKind {
    /// A conjugate pair of poles.
    Oscillatory,
    /// A real pole.
    Overdamped,
    /// A motion without stiffness.
    Rigid,
}

impl VehicleModeKind {
    /// As it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            VehicleModeKind::Oscillatory => "oscillatory",
            VehicleModeKind::Overdamped => "overdamped",
            VehicleModeKind::Rigid => "rigid",
        }
    }
}

/// The modes of the vehicle that a spec names, and the files read.
///
/// # Errors
/// A vehicle that cannot be built, an eigenvalue iteration that does not converge.
pub fn modes(spec: &ModesSpec) -> Result<(ModesOutcome, Vec<Input>), StudyError> {
    let loaded = load_vehicle(&spec.vehicle)?;
    Ok((ModesOutcome { modes: vehicle_modes(&loaded)? }, loaded.inputs))
}

/// The modes of a loaded vehicle.
pub(super) fn vehicle_modes(loaded: &LoadedVehicle) -> Result<Vec<VehicleMode>, StudyError> {
    modes_of(&loaded.vehicle).map_err(|source| StudyError::Vehicle { name: loaded.name.clone(), source })
}

/// The modes of a vehicle.
pub(super) fn modes_of(vehicle: &Vehicle) -> Result<Vec<VehicleMode>, VehicleError> {
    let found = vehicle.modes()?;
    let shape = |mode: &crate::lti::Mode| {
        let values = vehicle.shape_places().iter().zip(&mode.shape);
        values.map(|(dof, z)| ShapeValue { dof: dof.clone(), re: z.re, im: z.im }).collect()
    };
    Ok(found
        .into_iter()
        .map(|(mode, label)| VehicleMode {
            freq_hz: mode.freq_hz,
            damped_hz: mode.damped_hz,
            damping: mode.damping,
            pole: [mode.pole.re, mode.pole.im],
            kind: match mode.kind {
                ModeKind::Oscillatory => VehicleModeKind::Oscillatory,
                ModeKind::Overdamped => VehicleModeKind::Overdamped,
                ModeKind::Rigid => VehicleModeKind::Rigid,
            },
            label,
            shape: shape(&mode),
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_published_car_has_its_modes() {
        let spec = ModesSpec { vehicle: "case:guiggiani-full-car".into() };
        let (outcome, inputs) = modes(&spec).unwrap();
        assert_eq!((outcome.modes.len(), inputs.len()), (7, 1));
        assert_eq!(inputs[0].path, "case:guiggiani-full-car");
        assert!(outcome.modes.windows(2).all(|w| w[0].freq_hz <= w[1].freq_hz));
        let first = &outcome.modes[0];
        assert_eq!(first.shape.len(), 7);
        assert!((first.pole[0].hypot(first.pole[1]) / std::f64::consts::TAU - first.freq_hz).abs() < 1e-12);
        assert!(first.shape.iter().any(|s| (s.re - 1.0).abs() < 1e-12 && s.im.abs() < 1e-12));
    }
}
