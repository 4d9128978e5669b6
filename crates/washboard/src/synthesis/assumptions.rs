//! What H2 and H∞ designs assume of a plant, measured, and said in words where it does not hold.

use super::SynthesisError;
use crate::linalg::{C64, LinalgError, Mat};
use crate::lti::{GeneralizedPlant, LtiError, StateSpace};
use std::fmt;

/// A mode nearer to being unreachable than this (relative) can't be stabilised to any purpose.
const UNREACHABLE: f64 = 1e-10;
/// A pole less than this inside the stable region, as a share of the fastest one, has to be moved.
const ON_AXIS: f64 = 1e-12;
/// A zero whose real part is below this share of its size (or of the slowest pole's) is on the axis.
const ZERO_ON_AXIS: f64 = 1e-7;
/// Singular values of D₁₂ or D₂₁ below this share of the largest are none.
const RANK: f64 = 1e-10;

/// The assumptions, in the order in which they are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Assumption {
    /// (A, B₂) is stabilisable.
    Stabilisable,
    /// (C₂, A) is detectable.
    Detectable,
    /// D₁₂ has full column rank: every control costs something.
    ControlsWeighted,
    /// D₂₁ has full row rank: every measurement is noisy.
    MeasurementsNoisy,
    /// [A − iωI, B₂; C₁, D₁₂] keeps its column rank for all ω.
    NoControlZeroOnAxis,
    /// [A − iωI, B₁; C₂, D₂₁] keeps its row rank for all ω.
    NoFilterZeroOnAxis,
}

/// An assumption that does not hold, with the numbers that show it.
#[derive(Debug, Clone, PartialEq)]
pub struct BrokenAssumption {
    /// Which one.
    pub assumption: Assumption,
    /// How near the plant is to breaking it: 0 where it does entirely.
    pub measured: f64,
    /// What it must be above.
    pub limit: f64,
    /// Where, rad/s, where it is about a frequency.
    pub omega_rad_s: Option<f64>,
    /// The signal concerned, where there is one.
    pub signal: Option<String>,
}

impl fmt::Display for BrokenAssumption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let signal = self.signal.as_deref().unwrap_or("");
        let omega = self.omega_rad_s.unwrap_or(0.0);
        let (what, mend) = match self.assumption {
            Assumption::Stabilisable => (
                format!("the controls do not reach the mode at {omega:.4} rad/s, which is not stable"),
                "take the mode out of the plant, or damp it a little",
            ),
            Assumption::Detectable => (
                format!("the measurements do not see the mode at {omega:.4} rad/s, which is not stable"),
                "measure it, take it out of the plant, or damp it a little",
            ),
            Assumption::ControlsWeighted => (
                format!(
                    "the control `{signal}` costs nothing at high frequencies (D12 has not full column rank)"
                ),
                "weight the control (input_weight), or minimise something that it moves at once, an acceleration",
            ),
            Assumption::MeasurementsNoisy => (
                format!("the measurement `{signal}` is free of noise (D21 has not full row rank)"),
                "give it sensor noise",
            ),
            Assumption::NoControlZeroOnAxis => (
                format!("from controls to performances there is a zero at {omega:.4} rad/s on the axis"),
                "minimise something that the controls move there too, or weight the controls",
            ),
            Assumption::NoFilterZeroOnAxis => (
                format!("from disturbances to measurements there is a zero at {omega:.4} rad/s on the axis"),
                "let a disturbance be seen there too, or give the measurements noise",
            ),
        };
        write!(f, "{what} (measured {:.1e}, expected above {:.0e}): {mend}", self.measured, self.limit)
    }
}

/// All assumptions of the two-Riccati designs that a plant breaks; empty where it breaks none.
///
/// # Errors
/// An iteration that does not converge.
pub fn broken_assumptions(plant: &GeneralizedPlant) -> Result<Vec<BrokenAssumption>, SynthesisError> {
    let mut broken = Vec::new();
    let system = |b: Mat, c: Mat, d: Mat| StateSpace::continuous(plant.a().clone(), b, c, d);
    let control = system(plant.b2(), plant.c1(), plant.d12())?;
    let filter = system(plant.b1(), plant.c2(), plant.d21())?;
    let reach = |s: &StateSpace<_>| s.controllability();
    broken.extend(unreached(&reach(&control)?, Assumption::Stabilisable));
    broken.extend(unreached(&reach(&filter.transposed())?, Assumption::Detectable));
    let signals = plant.signals();
    broken.extend(rank(&plant.d12(), &signals.controls, Assumption::ControlsWeighted)?);
    let d21 = plant.d21().transpose().to_owned();
    broken.extend(rank(&d21, &signals.measurements, Assumption::MeasurementsNoisy)?);
    if broken.is_empty() {
        // D has full rank: all zeros that count are the system's
        broken.extend(on_axis(&control, Assumption::NoControlZeroOnAxis)?);
        broken.extend(on_axis(&filter, Assumption::NoFilterZeroOnAxis)?);
    }
    Ok(broken)
}

/// Modes that are not stable and not reached.
fn unreached(reach: &[(C64, f64)], assumption: Assumption) -> Option<BrokenAssumption> {
    let fastest = reach.iter().map(|(p, _)| p.norm()).fold(0.0, f64::max);
    let worst = reach
        .iter()
        .filter(|(pole, _)| pole.re >= -ON_AXIS * fastest)
        .min_by(|x, y| x.1.total_cmp(&y.1))
        .filter(|(_, distance)| *distance < UNREACHABLE)?;
    Some(BrokenAssumption {
        assumption,
        measured: worst.1,
        limit: UNREACHABLE,
        omega_rad_s: Some(worst.0.norm()),
        signal: None,
    })
}

/// Whether D has full column rank; names the column that is nearest to costing nothing.
fn rank(d: &Mat, names: &[String], assumption: Assumption) -> Result<Option<BrokenAssumption>, LtiError> {
    let columns = d.ncols();
    if columns == 0 {
        return Ok(None);
    }
    let size = (0..columns).map(|j| d.subcols(j, 1).norm_l2()).fold(0.0, f64::max);
    let (measured, column) = if size == 0.0 {
        (0.0, 0)
    } else {
        // columns in units of their own, so that a small but weighted control counts
        let scaled = Mat::from_fn(d.nrows(), columns, |i, j| {
            let own = d.subcols(j, 1).norm_l2();
            if own > RANK * RANK * size { d[(i, j)] / own } else { 0.0 }
        });
        let svd = scaled.svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: columns })?;
        let least = if d.nrows() < columns { 0.0 } else { svd.S()[columns - 1] };
        let v = svd.V();
        let heaviest =
            (0..columns).max_by(|i, j| v[(*i, columns - 1)].abs().total_cmp(&v[(*j, columns - 1)].abs()));
        (least, heaviest.unwrap_or(0))
    };
    Ok((measured < RANK).then(|| BrokenAssumption {
        assumption,
        measured,
        limit: RANK,
        omega_rad_s: None,
        signal: names.get(column).cloned(),
    }))
}

/// The zero nearest to the axis, where it is on it.
fn on_axis(
    system: &StateSpace<crate::lti::Continuous>,
    assumption: Assumption,
) -> Result<Option<BrokenAssumption>, LtiError> {
    let slowest = system.poles()?.iter().map(|p| p.norm()).filter(|p| *p > 0.0).fold(f64::INFINITY, f64::min);
    let floor = if slowest.is_finite() { slowest } else { 1.0 };
    let nearest = system
        .zeros()?
        .into_iter()
        .map(|z| (z.re.abs() / z.norm().max(floor), z.norm()))
        .min_by(|x, y| x.0.total_cmp(&y.0));
    Ok(nearest.filter(|(share, _)| *share < ZERO_ON_AXIS).map(|(measured, omega)| BrokenAssumption {
        assumption,
        measured,
        limit: ZERO_ON_AXIS,
        omega_rad_s: Some(omega),
        signal: None,
    }))
}
