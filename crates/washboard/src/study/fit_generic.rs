//! A vehicle fitted without a file: generic starts, a symmetric car, then one whose sides differ.

use super::drives::{Drive, Families, fit};
use super::identify_evidence::StartTried;
use super::{StudyError, drives};
use crate::identify::{
    ANNEALING_FAR, ANNEALING_NEAR, ANNEALING_NONE, PhysicalOutcome, PhysicalSettings, RoadStart,
};
use crate::lti::Parametric;
use crate::vehicle::{GenericStart, ParametricVehicle, Symmetry};

/// Both symmetries are polished where their rough costs differ by less than so many thresholds.
const CLEAR: f64 = 5.0;
/// A part that may be absent and is below this share of its start has all but vanished.
const VANISHED: f64 = 0.05;

/// What was found without a file.
pub(super) struct GenericFit {
    /// The families of the answer.
    pub families: Families,
    pub outcome: PhysicalOutcome,
    /// The starts, best first.
    pub starts: Vec<StartTried>,
    /// What the sides' differing gains, and what it would have to, where that was asked.
    pub sides: Option<Sides>,
}

/// Twice the cost's fall from a symmetric to an asymmetric vehicle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides {
    pub gain: f64,
    pub needed: f64,
    /// Whether the answer is asymmetric.
    pub differ: bool,
}

/// Fits all drives from generic starts.
///
/// # Errors
/// Wheels or channels that no generic vehicle has; drives that cannot be fitted.
pub(super) fn fit_generic(drives: &[Drive<'_>], known: &[(String, f64)]) -> Result<GenericFit, StudyError> {
    let convention = drives.first().map(|d| d.task.convention).unwrap_or_default();
    let settings = |annealing: &[f64], roads: Option<Vec<RoadStart>>, rough: bool| PhysicalSettings {
        convention,
        annealing: annealing.to_vec(),
        roads,
        rough,
        clocks: !rough,
    };
    let mut starts = Vec::new();
    let mut best: Option<(Families, PhysicalOutcome)> = None;
    for start in GenericStart::ALL {
        let families = families(drives, &start, known)?;
        let Ok(found) = fit(drives, &families, None, &settings(&ANNEALING_FAR, None, true)) else {
            continue;
        };
        starts.push(StartTried {
            name: format!(
                "generic: body {} Hz, hop {} Hz, damping {}",
                start.body_hz, start.hop_hz, start.damping
            ),
            cost: found.cost,
            chi: found.chi,
            converged: found.decrement < 1.0,
            steps: found.work[0],
        });
        if best.as_ref().is_none_or(|(_, b)| found.cost < b.cost) {
            best = Some((families, found));
        }
    }
    starts.sort_by(|a: &StartTried, b: &StartTried| a.cost.total_cmp(&b.cost));
    let Some((symmetric, rough)) = best else {
        // none of the starts: say why the first one cannot
        let families = families(drives, &GenericStart::ALL[0], known)?;
        let failed = fit(drives, &families, None, &settings(&ANNEALING_FAR, None, true));
        return Err(match failed {
            Err(e) => drives::cannot_start(&e),
            Ok(_) => drives::cannot_start(&crate::identify::FitError::NoDrive),
        });
    };
    let fine = |families: &Families, rough: &PhysicalOutcome| -> Result<PhysicalOutcome, StudyError> {
        let polished = |start: &[f64], rough: &PhysicalOutcome| {
            fit(drives, families, Some(start), &settings(&ANNEALING_NONE, Some(roads(rough)), false))
                .map_err(|e| drives::cannot_start(&e))
        };
        let first = polished(&values(rough), rough)?;
        // the logarithm of a part that has all but vanished is flat: whether it is absent shows from a start that has it
        let Some(revived) = revived(&families[0].0, &values(&first)) else { return Ok(first) };
        let second = polished(&revived, &first)?;
        Ok(if second.cost < first.cost { second } else { first })
    };
    let asymmetric: Families = symmetric
        .iter()
        .map(|(family, derivatives)| {
            let family = family.asymmetric_at(&sane(family, &values(&rough))).map_err(|found| {
                StudyError::Setting {
                    field: "vehicle",
                    expected: "a symmetric fit that an asymmetric one can start from".into(),
                    found,
                }
            })?;
            Ok((family, derivatives.clone()))
        })
        .collect::<Result<_, StudyError>>()?;
    let more = asymmetric[0].0.names().len() - symmetric[0].0.names().len();
    let only_symmetric = |families: Families, sides| -> Result<GenericFit, StudyError> {
        Ok(GenericFit { outcome: fine(&families, &rough)?, families, starts: starts.clone(), sides })
    };
    if more == 0 {
        return only_symmetric(symmetric, None);
    }
    let from = |annealing: &[f64]| {
        fit(drives, &asymmetric, None, &settings(annealing, Some(roads(&rough)), true)).ok()
    };
    let mut rough_asymmetric = from(&ANNEALING_NEAR);
    if rough_asymmetric.as_ref().is_none_or(|found| found.cost > rough.cost) {
        // more freedom can't explain less: the annealing led astray
        rough_asymmetric = from(&ANNEALING_NONE).or(rough_asymmetric);
    }
    let Some(rough_asymmetric) = rough_asymmetric else { return only_symmetric(symmetric, None) };
    let needed = threshold(more);
    let rough_gain = 2.0 * (rough.cost - rough_asymmetric.cost);
    if rough_gain > CLEAR * needed {
        let sides = Some(Sides { gain: rough_gain, needed, differ: true });
        let outcome = fine(&asymmetric, &rough_asymmetric)?;
        return Ok(GenericFit { outcome, families: asymmetric, starts, sides });
    }
    let one = fine(&symmetric, &rough)?;
    let other = fine(&asymmetric, &rough_asymmetric)?;
    let gain = 2.0 * (one.cost - other.cost);
    let differ = gain > needed;
    let (families, outcome) = if differ { (asymmetric, other) } else { (symmetric, one) };
    Ok(GenericFit { families, outcome, starts, sides: Some(Sides { gain, needed, differ }) })
}

fn families(
    drives: &[Drive<'_>],
    start: &GenericStart,
    known: &[(String, f64)],
) -> Result<Families, StudyError> {
    drives
        .iter()
        .map(|d| {
            let recording = d.task.recording;
            ParametricVehicle::generic(
                start,
                Symmetry::Symmetric,
                recording.channels(),
                recording.wheels(),
                known,
            )
            .map_err(|source| StudyError::Vehicle { name: "a generic vehicle".into(), source })
        })
        .collect()
}

/// Values to start from: parts that may be absent and ran to a limit go back to where they began.
fn sane(family: &ParametricVehicle, values: &[f64]) -> Vec<f64> {
    let (start, limits, may_vanish) = (family.start(), family.limits(), family.may_vanish());
    (0..values.len())
        .map(|i| {
            let [low, high] = limits[i];
            let inside = values[i] > 1.01 * low && values[i] < 0.99 * high;
            if may_vanish[i] && !inside { start[i] } else { values[i] }
        })
        .collect()
}

/// Values with the parts that have all but vanished back at where they began; None where none has.
fn revived(family: &ParametricVehicle, values: &[f64]) -> Option<Vec<f64>> {
    let (start, may_vanish) = (family.start(), family.may_vanish());
    let gone = |i: usize| may_vanish[i] && values[i] < VANISHED * start[i];
    (0..values.len())
        .any(gone)
        .then(|| (0..values.len()).map(|i| if gone(i) { start[i] } else { values[i] }).collect())
}

pub(super) fn values(found: &PhysicalOutcome) -> Vec<f64> {
    found.parameters.iter().map(|(_, _, e)| e.value).collect()
}

pub(super) fn roads(found: &PhysicalOutcome) -> Vec<RoadStart> {
    let road = |d: &crate::identify::DriveOutcome| RoadStart {
        exponent: d.exponent.value,
        mu: d.mu.map(|m| m.value),
    };
    found.drives.iter().map(road).collect()
}

/// The 99.9 % point of χ² with k degrees of freedom (Wilson and Hilferty): what k parameters more gain by chance.
fn threshold(k: usize) -> f64 {
    let k = k as f64;
    let share = 2.0 / (9.0 * k);
    k * (1.0 - share + 3.09 * share.sqrt()).powi(3)
}
