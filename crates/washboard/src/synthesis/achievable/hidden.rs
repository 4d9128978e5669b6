//! Modes of a closed loop that a response does not show.

use super::{AchievableError, Response, Youla};
use crate::lti::{Polynomial, RationalFunction};

/// A mode that some response hides, exactly (its factor is cancelled there).
#[derive(Debug, Clone, PartialEq)]
pub struct HiddenMode {
    /// |λ|/2π.
    pub freq_hz: f64,
    /// −Re λ/|λ|: 1 of a real pole.
    pub damping: f64,
    /// Responses that do not show it.
    pub hidden_in: Vec<Response>,
    /// Responses that do.
    pub visible_in: Vec<Response>,
}

/// Modes of the closed loop with a controller of one measurement that are poles of some responses and not of others, by
/// exact cancellation, by frequency.
///
/// The characteristic polynomial is Δ d_K − n₂₂ n_K. Modes that no response shows are hidden from all (`visible_in`
/// empty): the road does not drive them.
///
/// # Errors
/// Not one measurement; zeros that can't be found.
pub fn hidden_modes(
    youla: &Youla,
    controller: &RationalFunction,
    responses: &[RationalFunction; 3],
) -> Result<Vec<HiddenMode>, AchievableError> {
    let [measurement] = youla.measurements() else {
        let (what, found) = ("measurements", youla.measurements().len());
        return Err(AchievableError::Count { what, expected: 1, found });
    };
    let characteristic = characteristic(youla, *measurement, controller)?;
    // split into factors with the same signature: in or out of each denominator
    let mut parts = vec![(characteristic, Vec::<Response>::new())];
    for response in Response::ALL {
        let shown = responses[response as usize].denominator();
        let mut next = Vec::new();
        for (part, seen) in parts {
            let common = part.gcd(shown);
            let rest = part.exactly_over(&common)?;
            let mut with = seen.clone();
            with.push(response);
            next.extend([(common, with), (rest, seen)].into_iter().filter(|(p, _)| p.degree() > 0));
        }
        parts = next;
    }
    let mut modes = Vec::new();
    for (part, visible_in) in parts.into_iter().filter(|(_, v)| v.len() < Response::ALL.len()) {
        for root in part.roots()?.into_iter().filter(|r| r.im >= 0.0) {
            modes.push(HiddenMode {
                freq_hz: root.norm() / std::f64::consts::TAU,
                damping: -root.re / root.norm(),
                hidden_in: Response::ALL.into_iter().filter(|r| !visible_in.contains(r)).collect(),
                visible_in: visible_in.clone(),
            });
        }
    }
    modes.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    Ok(modes)
}

/// Δ d_K − n₂₂ n_K of the closed loop, poles that are hidden included.
pub(super) fn characteristic(
    youla: &Youla,
    measurement: super::Measurement,
    controller: &RationalFunction,
) -> Result<Polynomial, AchievableError> {
    let (delta, g22) = (youla.car().delta(), youla.car().force_to(measurement));
    let n22 = &g22 * &RationalFunction::polynomial(delta.clone());
    Ok(&(&delta * controller.denominator()) - &(n22.numerator() * controller.numerator()))
}
