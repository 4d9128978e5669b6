//! A controller near what no controller beats: LQG with sensor noise that vanishes, decade by decade.

use super::h2::symmetric;
use super::{Certificate, SynthesisError, full_information, kalman};
use crate::linalg::{LinalgError, Mat, solve};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};

/// The last decade of the noise: no loop in double precision has held it.
const LAST_DECADE: i32 = 30;
/// The excess over the limit counts as known where two coordinate systems agree about it to this share …
const KNOWN: f64 = 0.01;
/// … or where both are this near the limit, which is all that a norm's rounding leaves.
const ROUNDING: f64 = 1e-9;
/// Directions in which Y is below this share of its size keep that share: they may not be disturbed at all.
const UNDISTURBED: f64 = 1e-12;

/// One decade of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct NearLimitStep {
    /// ε: each measurement has noise of intensity ε times its own passive variance, s.
    pub epsilon: f64,
    /// ‖T_zw‖₂ of the plant and this K, without the noise that K was made for.
    pub h2: f64,
    /// `h2` over the limit, less 1.
    pub excess: f64,
    /// By which share the same loop's norm is another one in the filter's coordinates: what rounding does to it.
    pub rounding: f64,
    /// The fastest pole of the loop, rad/s: what the actuator would have to follow.
    pub fastest_rad_s: f64,
}

/// Why the search ended.
#[derive(Debug, Clone, PartialEq)]
pub enum NearLimitEnd {
    /// The excess is what was asked for.
    Reached,
    /// At the next ε double precision does not hold the loop: the two coordinate systems differ by this share.
    Precision(f64),
    /// At the next ε there is no filter or no stable loop, for this reason.
    NoLoop(SynthesisError),
    /// The noise is as small as it goes: the measurements do not suffice (too few of them, or zeros in the right half plane).
    NoiseVanished,
}

/// A controller, the limit, and the way between.
#[derive(Debug, Clone)]
pub struct NearLimit {
    /// K, of the plant's order and strictly proper: u = +K y.
    pub controller: StateSpace<Continuous>,
    /// The loop of K and the plant that was given, measured by itself.
    pub certificate: Certificate,
    /// What no controller is below: [`full_information`].
    pub limit: f64,
    /// ‖T_zw‖₂ over the limit, less 1.
    pub excess: f64,
    /// Every ε up to the one taken, which is the last.
    pub steps: Vec<NearLimitStep>,
    /// Why there are no more.
    pub end: NearLimitEnd,
}

/// A controller whose ‖T_zw‖₂ is above that of [`full_information`] by `share` at most, or as near as double precision
/// holds its loop.
///
/// The infimum over all controllers is ‖F − H Q₀‖₂ with the Q₀ of (5.17) and (6.11), H_o⁻¹ Π H_i~F = F_x(sI − A − B₂F_x)⁻¹B₁,
/// F_x the full-information gain. K is to have Q G₂₁ = Q₀ for Q = K(I − G₂₂K)⁻¹, but G₂₁ has no proper stable left inverse: it
/// is zero at infinity, and for travels at 0. The thesis leaves that to "simple modifications"; for one actuator
/// ([`near_optimal`](super::achievable::near_optimal)) G₂₁ is divided by, here the Kalman filter is the approximate left inverse,
///
/// u = F_x x̂, x̂' = A x̂ + B₂u + L(C₂x̂ + D₂₂u − y), Y the filter's solution for noise of intensity ε σᵢ² on measurement i,
///
/// which has Q G₂₁ → Q₀ for ε → 0 where G₂₁ has no zeros in the open right half plane and no fewer rows than columns. K has
/// the plant's order; (6.11) taken literally, with a left inverse of the two travels in polynomials, has a higher one.
///
/// Y vanishes with ε at another rate in each direction, which no scaling of states mends. So ε falls by decades, and each
/// equation is solved in the coordinates T⁻¹x in which the last Y = TTᵀ is the identity: its solution is then of size 1. The
/// loop's norm is computed twice, in the given coordinates and in those, and the search ends where the two differ.
///
/// # Errors
/// A plant that is not stable, whose D₁₁ is not zero, as [`full_information`]; a measurement that no disturbance moves; a `share` that
/// is not positive; no filter at ε = 1; a norm that is below the limit.
///
/// Source: Türkay's thesis, (5.10)–(5.18), (6.8)–(6.12); Kwakernaak and Sivan, *Linear Optimal Control Systems*, 4.4 (vanishing
/// noise).
pub fn near_limit(plant: &GeneralizedPlant, share: f64) -> Result<NearLimit, SynthesisError> {
    if !(share > 0.0 && share.is_finite()) {
        return Err(LtiError::Field { field: "share", expected: "a positive number", found: share }.into());
    }
    plant.passive().check_stable("a controller near the H2 limit")?;
    let variances = passive_variances(plant)?;
    let mut p = GeneralizedPlant::new(plant.system().balanced_scales()?.0, plant.signals().clone())?;
    let (limit, regulator) = full_information(&p)?;
    let mut f = regulator.gain;
    let mut steps: Vec<NearLimitStep> = Vec::new();
    let mut taken: Option<(StateSpace<Continuous>, Certificate)> = None;
    let mut end = NearLimitEnd::NoiseVanished;
    for decade in 0..=LAST_DECADE {
        let epsilon = 10f64.powi(-decade);
        let noise: Vec<f64> = variances.iter().map(|v| epsilon * v).collect();
        let step = filtered(&p, &f, &noise).and_then(|(controller, covariance)| {
            let in_filters_states = p.close(&controller)?.h2_norm()?;
            let (controller, _) = controller.balanced_scales()?;
            let certificate = Certificate::of(plant, &controller)?;
            let h2 = certificate.h2.unwrap_or(f64::INFINITY);
            let rounding = (in_filters_states / h2 - 1.0).abs();
            let fastest_rad_s = certificate.poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
            let excess = h2 / limit - 1.0;
            let step = NearLimitStep { epsilon, h2, excess, rounding, fastest_rad_s };
            Ok((controller, certificate, covariance, step))
        });
        let (controller, certificate, covariance, step) = match step {
            Ok(step) => step,
            Err(e) if taken.is_none() => return Err(e),
            Err(e) => {
                end = NearLimitEnd::NoLoop(e);
                break;
            }
        };
        if step.rounding > KNOWN * step.excess.abs() + ROUNDING {
            end = NearLimitEnd::Precision(step.rounding);
            break;
        }
        if step.excess < -ROUNDING {
            let what = "the H2 norm, which no controller makes less than its limit,";
            return Err(SynthesisError::Refused { what, claimed: limit, found: step.h2 });
        }
        let excess = step.excess;
        steps.push(step);
        taken = Some((controller, certificate));
        if excess <= share {
            end = NearLimitEnd::Reached;
            break;
        }
        let next = root(&covariance)
            .map_err(SynthesisError::from)
            .and_then(|t| Ok((in_coordinates(&p, &t)?, &f * &t)));
        match next {
            Ok(next) => (p, f) = next,
            Err(e) => {
                end = NearLimitEnd::NoLoop(e);
                break;
            }
        }
    }
    let (Some((controller, certificate)), Some(last)) = (taken, steps.last()) else {
        return Err(SynthesisError::NotAchievable(
            "no loop is held by double precision, even at ε = 1".into(),
        ));
    };
    let excess = last.excess;
    Ok(NearLimit { controller, certificate, limit, excess, steps, end })
}

/// ‖e_iᵀC₂(sI − A)⁻¹B₁‖₂² of each measurement: feedthrough left out.
fn passive_variances(plant: &GeneralizedPlant) -> Result<Vec<f64>, SynthesisError> {
    let without = Mat::zeros(plant.ny(), plant.nw());
    let seen = StateSpace::continuous(plant.a().clone(), plant.b1(), plant.c2(), without)?.h2_of_outputs()?;
    match seen.iter().position(|v| *v == 0.0) {
        Some(i) => Err(SynthesisError::NotAchievable(format!(
            "no disturbance moves the measurement `{}`",
            plant.signals().measurements.get(i).map_or("", String::as_str)
        ))),
        None => Ok(seen.iter().map(|v| v * v).collect()),
    }
}

/// K and Y for noise of these intensities beside the measurements.
fn filtered(
    p: &GeneralizedPlant,
    f: &Mat,
    noise: &[f64],
) -> Result<(StateSpace<Continuous>, Mat), SynthesisError> {
    let (b1, c2, d21) = (p.b1(), p.c2(), p.d21());
    let own = symmetric(&(&d21 * d21.transpose()));
    let v = Mat::from_fn(p.ny(), p.ny(), |i, j| own[(i, j)] + if i == j { noise[i] } else { 0.0 });
    let filter = kalman(p.a(), &c2, &symmetric(&(&b1 * b1.transpose())), &v, Some(&(&b1 * d21.transpose())))?;
    let l = &filter.gain;
    let a = p.a() + p.b2() * f + l * &c2 + l * p.d22() * f;
    let controller = StateSpace::continuous(a, -l.clone(), f.clone(), Mat::zeros(p.nu(), p.ny()))?;
    Ok((controller, symmetric(&filter.solution.x)))
}

/// T with TTᵀ = Y, but for what is undisturbed.
fn root(y: &Mat) -> Result<Mat, LinalgError> {
    let n = y.nrows();
    let size = (0..n).map(|i| y[(i, i)]).fold(0.0, f64::max);
    let lifted = Mat::from_fn(n, n, |i, j| y[(i, j)] + if i == j { UNDISTURBED * size } else { 0.0 });
    match lifted.llt(faer::Side::Lower) {
        Ok(root) => Ok(root.L().to_owned()),
        Err(_) => {
            let (what, why) = ("the filter's covariance", "it has a negative direction");
            Err(LinalgError::Singular { what, why, value: size })
        }
    }
}

/// The plant over the states T⁻¹x.
fn in_coordinates(p: &GeneralizedPlant, t: &Mat) -> Result<GeneralizedPlant, SynthesisError> {
    let s = p.system();
    let system = StateSpace::continuous(solve(t, &(s.a() * t))?, solve(t, s.b())?, s.c() * t, s.d().clone())?;
    Ok(GeneralizedPlant::new(system, p.signals().clone())?)
}
