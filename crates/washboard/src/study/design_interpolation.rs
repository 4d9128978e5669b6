//! `method = "interpolation"`: the hybrid design of a quarter car, and what it hides.

use super::design_outcome::DesignOutcome;
use super::design_problem::Problem;
use super::design_words::short_numbers;
use super::{Flag, StudyError};
use crate::lti::{Continuous, StateSpace};
use crate::synthesis::SynthesisError;
use crate::synthesis::achievable::{HybridSettings, Psi, QuarterCar, QuarterCarNumbers, hybrid};

/// The car measures its travel, on white road velocity, and has something to copy; that it is a quarter car is seen
/// before its outputs are.
pub(super) fn check(problem: &Problem) -> Result<(), StudyError> {
    let setting = |field, expected: &str, found: String| {
        Err(StudyError::Setting { field, expected: expected.to_owned(), found })
    };
    if problem.spec.interpolation.is_none() {
        return setting("interpolation", "a section with fictitious_tire_damping_n_s_per_m", "none".into());
    }
    let y: Vec<&str> = problem.measurements.iter().map(|o| o.name.as_str()).collect();
    if y != ["suspension_travel"] {
        return setting("measurements", "[\"suspension_travel\"] for method interpolation", y.join(", "));
    }
    if problem.ground.excitation().white_intensity(problem.spec.speed_m_s).is_none() {
        return setting("road", "white road velocity for method interpolation", problem.spec.road.clone());
    }
    Ok(())
}

/// The controller, with what it hides as warnings.
pub(super) fn by_interpolation(
    problem: &Problem,
    outcome: &mut DesignOutcome,
) -> Result<Option<StateSpace<Continuous>>, SynthesisError> {
    let spec = &problem.spec;
    let (Some(car), Some(section)) = (&problem.file.quarter_car, spec.interpolation) else { return Ok(None) };
    let stuck = |e: crate::synthesis::achievable::AchievableError| SynthesisError::Achievable(Box::new(e));
    let numbers = QuarterCarNumbers {
        ms: car.sprung_mass_kg,
        mu: car.unsprung_mass_kg,
        ks: car.suspension_stiffness_n_per_m,
        cs: car.suspension_damping_n_s_per_m,
        kt: car.tire_stiffness_n_per_m,
        ct: car.tire_damping_n_s_per_m,
    };
    let psi = match section.psi {
        Some([a, b]) => Psi::Given { a, b },
        None => Psi::ForBand { omega_rad_s: section.band_rad_s, tolerance: section.tolerance },
    };
    let settings = HybridSettings {
        fictitious_tire_damping: section.fictitious_tire_damping_n_s_per_m,
        psi,
        sensor_noise: spec.noises().sensor_noise,
        road_velocity_intensity: problem.ground.excitation().white_intensity(spec.speed_m_s).unwrap_or(1.0),
    };
    let car = QuarterCar::new(&numbers).map_err(stuck)?;
    let found = hybrid(&car, &settings)
        .map_err(stuck)?
        .map_err(|why| SynthesisError::NotAchievable(why.to_string()))?;
    outcome.claimed.insert("match_error", found.match_error);
    outcome.claimed.insert("tire_factor_at_wheel_hop", found.tire_factor_at_wheel_hop);
    for (name, value) in
        ["sprung_acceleration", "suspension_travel", "tire_deflection"].into_iter().zip(found.rms.hybrid)
    {
        outcome.claimed.insert(format!("rms_{name}"), value);
    }
    outcome
        .warnings
        .extend(found.warnings.iter().map(|text| Flag { name: "interpolation".into(), text: text.clone() }));
    if let Some(why) = &found.exact_match {
        let text = format!("the acceleration of the copied design can't be had exactly on this tire: {why}");
        outcome.notes.push(Flag { name: "no-exact-match".into(), text: short_numbers(&text) });
    }
    Ok(Some(found.system))
}
