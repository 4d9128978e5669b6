//! The scale between the Lyapunov matrices of two norms, where the program is not linear in it: a search.

use super::goals::LyapunovScale;
use crate::optimize::{LmiSolution, SdpError, Status};

/// Scales are searched to this share.
const SCALE_TOLERANCE: f64 = 0.02;
/// Scales are searched within these factors of 1.
const SCALES: [f64; 2] = [1e-4, 1e4];

/// A search ends where a parabola through its last three points promises less than this share of the objective, and these
/// are no further apart.
const GAIN: f64 = 3e-5;
const NARROW: f64 = 0.4;

/// Where the parabola through three points is lowest, and its value there; none where it opens downwards.
fn lowest([(a, fa), (b, fb), (c, fc)]: [(f64, f64); 3]) -> Option<(f64, f64)> {
    let (left, right) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
    let bend = (right - left) / (c - a);
    let slope = left + bend * (b - a);
    (bend > 0.0 && bend.is_finite()).then(|| (b - 0.5 * slope / bend, fb - 0.25 * slope * slope / bend))
}

/// The least objective over scales: by bracketing, then parabolas (golden section where these fail), in ln s.
pub(super) fn search<P>(
    mut solve: impl FnMut(LyapunovScale) -> Result<(P, LmiSolution), SdpError>,
) -> Result<(P, LmiSolution), SdpError> {
    let mut best: Option<(f64, P, LmiSolution)> = None;
    let mut last = None;
    let mut at = |ln_s: f64| -> Result<f64, SdpError> {
        let (p, s) = solve(LyapunovScale::Fixed(ln_s.exp()))?;
        // a search that stalled beyond a point well inside knows its least value nearly
        let near = s.outcome.status == Status::Stalled && s.outcome.interior.is_some();
        if s.outcome.status != Status::Optimal && !near {
            last = Some((p, s));
            return Ok(f64::INFINITY);
        }
        let value = s.outcome.objective;
        if best.as_ref().is_none_or(|(b, ..)| value < *b) {
            best = Some((value, p, s));
        }
        Ok(value)
    };
    const GOLDEN: f64 = 0.381_966_011_250_105;
    let step = 4f64.ln();
    let (mut low, mut middle, mut high) = (-step, 0.0, step);
    let (mut fl, mut fm, mut fh) = (at(low)?, at(middle)?, at(high)?);
    while fl < fm && low > SCALES[0].ln() {
        (high, fh, middle, fm, low) = (middle, fm, low, fl, low - step);
        fl = at(low)?;
    }
    while fh < fm && high < SCALES[1].ln() {
        (low, fl, middle, fm, high) = (middle, fm, high, fh, high + step);
        fh = at(high)?;
    }
    while fm.is_finite() && high - low > SCALE_TOLERANCE {
        let golden = if high - middle > middle - low {
            middle + GOLDEN * (high - middle)
        } else {
            middle - GOLDEN * (middle - low)
        };
        let next = match lowest([(low, fl), (middle, fm), (high, fh)]) {
            Some((x, f)) if (low..high).contains(&x) && fm - f >= GAIN * fm.abs() => x,
            Some(_) if high - low < NARROW => break,
            _ => golden,
        };
        let f = at(next)?;
        match (f < fm, next > middle) {
            (true, true) => (low, fl, middle, fm) = (middle, fm, next, f),
            (true, false) => (high, fh, middle, fm) = (middle, fm, next, f),
            (false, true) => (high, fh) = (next, f),
            (false, false) => (low, fl) = (next, f),
        }
    }
    match (best, last) {
        (Some((_, p, s)), _) => Ok((p, s)),
        (None, Some(last)) => Ok(last),
        (None, None) => Err(SdpError::Empty { variables: 0, blocks: 0 }),
    }
}
