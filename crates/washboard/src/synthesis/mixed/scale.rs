//! The scale between the Lyapunov matrices of two norms, where the program is not linear in it: a search.

use super::goals::LyapunovScale;
use crate::optimize::{LmiSolution, SdpError, Status};

/// Scales are searched to this share.
const SCALE_TOLERANCE: f64 = 0.02;
/// Scales are searched within these factors of 1.
const SCALES: [f64; 2] = [1e-4, 1e4];

/// The least objective over scales: by bracketing and golden section in ln s.
pub(super) fn search<P>(
    mut solve: impl FnMut(LyapunovScale) -> Result<(P, LmiSolution), SdpError>,
) -> Result<(P, LmiSolution), SdpError> {
    let mut best: Option<(f64, P, LmiSolution)> = None;
    let mut last = None;
    let mut at = |ln_s: f64| -> Result<f64, SdpError> {
        let (p, s) = solve(LyapunovScale::Fixed(ln_s.exp()))?;
        if s.outcome.status != Status::Optimal {
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
    let _ = (fl, fh);
    while fm.is_finite() && high - low > SCALE_TOLERANCE {
        let next = if high - middle > middle - low {
            middle + GOLDEN * (high - middle)
        } else {
            middle - GOLDEN * (middle - low)
        };
        let f = at(next)?;
        let above = next > middle;
        if f < fm {
            if above {
                low = middle
            } else {
                high = middle
            }
            (middle, fm) = (next, f);
        } else if above {
            high = next;
        } else {
            low = next;
        }
    }
    match (best, last) {
        (Some((_, p, s)), _) => Ok((p, s)),
        (None, Some(last)) => Ok(last),
        (None, None) => Err(SdpError::Empty { variables: 0, blocks: 0 }),
    }
}
