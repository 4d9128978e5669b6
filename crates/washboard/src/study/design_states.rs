//! A vehicle's state as outputs that can be measured: what a state feedback is a gain of.

use super::design_problem::Problem;
use super::{DesignDisturbance, DesignMethod, StudyError};
use crate::linalg::{Mat, rank, solve};
use crate::lti::{GeneralizedPlant, LtiError, StateSpace};
use crate::vehicle::{Output, PlantError, PlantSettings, Ride, Vehicle};

/// Rows that are nearer to being dependent than this, relative, say nothing new.
const DEPENDENT: f64 = 1e-9;

/// Outputs that together are the state: travels, tire deflections and velocities, then displacements where the road's height
/// is a part of it and that makes the state whole; as many as are independent.
pub(super) fn states(vehicle: &Vehicle, settings: &PlantSettings<'_>) -> Result<Vec<Output>, PlantError> {
    const KINDS: [&str; 4] = ["travel", "tire_deflection", "velocity", "displacement"];
    let mut chosen: Vec<Output> = Vec::new();
    for kinds in [&KINDS[..3], &KINDS[..]] {
        let of_kind =
            |kind: &&str| vehicle.outputs().iter().filter(|o| o.base.contains(*kind)).collect::<Vec<_>>();
        let candidates: Vec<&Output> = kinds.iter().flat_map(of_kind).collect();
        let Ok(plant) = vehicle.plant(&[], &candidates, settings) else { continue };
        let kept = independent(&plant);
        let complete = kept.len() == plant.order();
        if complete || chosen.is_empty() {
            chosen = kept.iter().map(|i| candidates[*i].clone()).collect();
        }
        if complete {
            break;
        }
    }
    Ok(chosen)
}

/// Measurements without feedthrough that none of the earlier ones say, by Gram and Schmidt.
fn independent(plant: &GeneralizedPlant) -> Vec<usize> {
    let (c, d21, d22) = (plant.c2(), plant.d21(), plant.d22());
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut kept = Vec::new();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    for i in 0..c.nrows() {
        let direct =
            (0..d21.ncols()).any(|j| d21[(i, j)] != 0.0) || (0..d22.ncols()).any(|j| d22[(i, j)] != 0.0);
        let mut row: Vec<f64> = (0..c.ncols()).map(|j| c[(i, j)]).collect();
        let size = dot(&row, &row).sqrt();
        if direct || size == 0.0 {
            continue;
        }
        for _ in 0..2 {
            for b in &basis {
                let along = dot(&row, b);
                row.iter_mut().zip(b).for_each(|(r, b)| *r -= along * b);
            }
        }
        let left = dot(&row, &row).sqrt();
        if left > DEPENDENT * size {
            row.iter_mut().for_each(|r| *r /= left);
            basis.push(row);
            kept.push(i);
        }
    }
    kept
}

/// Refuses measurements that follow a road height without bound: in a loop with them so does every force.
///
/// # Errors
/// [`StudyError::Setting`] of `disturbance` where the states of a gain are such, else of `measurements`.
pub(super) fn check_bounded(problem: &Problem) -> Result<(), StudyError> {
    let spec = &problem.spec;
    // of a vehicle that only its controller damps the loop says it
    let Ok(ride) = Ride::new(&problem.vehicle, problem.ground.excitation(), spec.speed_m_s) else {
        return Ok(());
    };
    let all: Vec<&Output> = problem.measurements.iter().collect();
    let why =
        ride.infinite(&all).map_err(|source| StudyError::Ride { name: spec.vehicle.clone(), source })?;
    let wandering: Vec<String> =
        all.iter().zip(why).filter(|(_, why)| why.is_some()).map(|(o, _)| format!("`{}`", o.name)).collect();
    if wandering.is_empty() {
        return Ok(());
    }
    let names = wandering.join(", ");
    let why = "whose variance on this road is infinite: its height has no bound, and in a loop with them neither have forces and travels";
    let by_height = spec.method == DesignMethod::RobustStateFeedback
        && spec.disturbance == DesignDisturbance::RoadDisplacement;
    Err(if by_height {
        StudyError::Setting {
            field: "disturbance",
            expected: "road-velocity, or road-displacement on a road of kind first-order".into(),
            found: format!("road-displacement, with which the states are measured by {names}, {why}"),
        }
    } else {
        StudyError::Setting {
            field: "measurements",
            expected: "outputs with a finite variance, or a road of kind first-order".into(),
            found: format!("{names}, {why}"),
        }
    })
}

/// A problem's plant with its measurements as states: ẋ = A x + …, y = x.
///
/// # Errors
/// Measurements that are not the state: too few, dependent, or reached at once by road or force.
pub(super) fn in_states(problem: &Problem) -> Result<GeneralizedPlant, StudyError> {
    let plant = &problem.plant;
    let name = |i: usize| format!("`{}`", problem.measurements[i].name);
    let wrong =
        |expected: String, found: String| StudyError::Setting { field: "measurements", expected, found };
    let fail =
        |e: LtiError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) };
    let (c, d21, d22) = (plant.c2(), plant.d21(), plant.d22());
    let (n, ny) = (plant.order(), plant.ny());
    for i in 0..ny {
        if (0..d21.ncols()).any(|j| d21[(i, j)] != 0.0) || (0..d22.ncols()).any(|j| d22[(i, j)] != 0.0) {
            let expected = "states of the vehicle: travels, tire deflections, velocities".to_owned();
            return Err(wrong(expected, format!("{}, which road or force reach at once", name(i))));
        }
    }
    // rows of order one: their units differ
    let size = |i: usize| (0..n).map(|j| c[(i, j)].powi(2)).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    let even = Mat::from_fn(ny, n, |i, j| c[(i, j)] / size(i));
    let known = rank(&even, DEPENDENT).map_err(|e| fail(e.into()))?;
    if known < n {
        let mechanical = 2 * problem.vehicle.dofs().len();
        let rest = if n > mechanical {
            format!(
                ": {} of these are of the road's filter and of wheels that follow others, which nothing on the vehicle measures; take \
                 a road whose wheels are independent ([coherence] kind = \"independent\"), or method mixed-h2-hinf",
                n - mechanical
            )
        } else {
            String::new()
        };
        let expected = format!("outputs that show all {n} states{rest}");
        return Err(wrong(expected, format!("{ny} outputs that show {known}")));
    }
    if ny > n {
        let kept = independent(plant);
        let more: Vec<String> = (0..ny).filter(|i| !kept.contains(i)).map(name).collect();
        let expected = format!("{n} outputs, as many as there are states");
        return Err(wrong(expected, format!("{ny}: leave out {}", more.join(", "))));
    }
    // x_new = C₂ x
    let right = |m: &Mat| -> Result<Mat, StudyError> {
        let solved =
            solve(&c.transpose().to_owned(), &m.transpose().to_owned()).map_err(|e| fail(e.into()))?;
        Ok(solved.transpose().to_owned())
    };
    let s = plant.system();
    let system = StateSpace::continuous(right(&(&c * s.a()))?, &c * s.b(), right(s.c())?, s.d().clone())
        .map_err(fail)?;
    GeneralizedPlant::new(system, plant.signals().clone()).map_err(fail)
}
