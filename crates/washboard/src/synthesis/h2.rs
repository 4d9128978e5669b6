//! The H2-optimal controller of a generalised plant, and LQG as its special case.

use super::{Filter, Regulator, SynthesisError, broken_assumptions, kalman_of_input, lqr, lqr_of_output};
use crate::linalg::{Mat, lyapunov};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, Signals, StateSpace};

/// A feedthrough below this share of the plant's largest entry is rounding.
const ROUNDING_OF_D: f64 = 1e-13;

/// An H2-optimal controller.
#[derive(Debug, Clone)]
pub struct H2Design {
    /// K: order of the plant, strictly proper for a plant without D₂₂.
    pub controller: StateSpace<Continuous>,
    /// ‖T_zw‖₂ as the two Riccati equations say it.
    pub claimed_h2: f64,
    /// The state feedback.
    pub regulator: Regulator,
    /// The observer.
    pub filter: Filter,
}

/// Weights and noises of an LQG design beside the plant's own.
#[derive(Debug, Clone, PartialEq)]
pub struct LqgWeights {
    /// Intensity of white noise on each measurement.
    pub sensor_noise: Vec<f64>,
    /// ρ of each control: ρ u² is added to the cost.
    pub input_weight: Vec<f64>,
    /// Intensity of the disturbances (1: as the plant has them).
    pub process_noise: f64,
    /// Whether the regulator's cost keeps C₁ᵀD₁₂, as it must. Without it the law is not the optimum of the cost: there to
    /// reproduce a printed design.
    pub cross_term: bool,
}

impl Default for LqgWeights {
    fn default() -> Self {
        LqgWeights {
            sensor_noise: Vec::new(),
            input_weight: Vec::new(),
            process_noise: 1.0,
            cross_term: true,
        }
    }
}

/// The controller that minimises ‖T_zw‖₂ of a generalised plant.
///
/// With R = D₁₂ᵀD₁₂, V = D₂₁D₂₁ᵀ, F the regulator of (C₁ᵀC₁, R, C₁ᵀD₁₂) and L the filter of (B₁B₁ᵀ, V, B₁D₂₁ᵀ),
///
/// x̂' = (A + B₂F + L C₂ + L D₂₂F) x̂ − L y, u = F x̂, ‖T‖₂² = tr(B₁ᵀX B₁) + tr(R F Y Fᵀ).
///
/// # Errors
/// D₁₁ that is not zero (the norm is infinite), and every assumption that the plant breaks, in words: stabilisable,
/// detectable, D₁₂ and D₂₁ of full rank, no zeros on the axis.
///
/// Source: Doyle, Glover, Khargonekar, Francis, IEEE Trans. Automat. Control 34 (1989) 831–847; Zhou, Doyle, Glover,
/// *Robust and Optimal Control*, ch. 14.
pub fn h2(plant: &GeneralizedPlant) -> Result<H2Design, SynthesisError> {
    with_cross_term(plant, true)
}

fn with_cross_term(plant: &GeneralizedPlant, cross_term: bool) -> Result<H2Design, SynthesisError> {
    let norm = plant.d11().norm_max();
    if norm > ROUNDING_OF_D * plant.b1().norm_max() * plant.c1().norm_max() {
        return Err(LtiError::NotStrictlyProper { what: "the H2 norm", norm }.into());
    }
    let (a, b1, b2) = (plant.a(), plant.b1(), plant.b2());
    let (c1, c2, d12, d21, d22) = (plant.c1(), plant.c2(), plant.d12(), plant.d21(), plant.d22());
    let r = symmetric(&(d12.transpose() * &d12));
    let both = if cross_term {
        lqr_of_output(a, &b2, &c1, &d12)
    } else {
        lqr(a, &b2, &symmetric(&(c1.transpose() * &c1)), &r, None)
    }
    .and_then(|regulator| Ok((regulator, kalman_of_input(a, &c2, &b1, &d21)?)));
    // the equations say that they can't be solved; the assumptions say what is wrong with the plant
    let (regulator, filter) = match both {
        Ok(both) => both,
        Err(e) => {
            let broken = broken_assumptions(plant)?;
            return Err(if broken.is_empty() { e } else { SynthesisError::Assumptions(broken) });
        }
    };
    let (f, l) = (&regulator.gain, &filter.gain);
    let ak = a + &b2 * f + l * &c2 + l * &d22 * f;
    let controller = StateSpace::continuous(ak, -l.clone(), f.clone(), Mat::zeros(f.nrows(), l.ncols()))?;
    let squared = if cross_term {
        let regulated = trace(&(b1.transpose() * &regulator.solution.x * &b1));
        regulated + trace(&(&r * f * &filter.solution.x * f.transpose()))
    } else {
        of_any_regulator(plant, f, &filter)?
    };
    Ok(H2Design { controller, claimed_h2: squared.max(0.0).sqrt(), regulator, filter })
}

/// ‖T‖₂² of any stabilising F on the optimal filter: x̂ is driven by the innovations and not correlated with the error,
/// tr((C₁ + D₁₂F) P (C₁ + D₁₂F)ᵀ) + tr(C₁YC₁ᵀ) with (A + B₂F)P + P(A + B₂F)ᵀ + L V Lᵀ = 0.
fn of_any_regulator(plant: &GeneralizedPlant, f: &Mat, filter: &Filter) -> Result<f64, SynthesisError> {
    let (c1, d21, l) = (plant.c1(), plant.d21(), &filter.gain);
    let driven = l * &d21 * d21.transpose() * l.transpose();
    let p = lyapunov(&(plant.a() + plant.b2() * f), &symmetric(&driven))?.x;
    let seen = &c1 + plant.d12() * f;
    Ok(trace(&(&seen * p * seen.transpose())) + trace(&(&c1 * &filter.solution.x * c1.transpose())))
}

/// The LQG controller: [`h2`] of the plant with white noise beside its measurements, weights on its controls and its
/// disturbances scaled.
///
/// `claimed_h2` is of that larger plant, noise and weighted controls included.
///
/// # Errors
/// Weights or intensities that are negative or of another number; else as [`h2`].
pub fn lqg(plant: &GeneralizedPlant, weights: &LqgWeights) -> Result<H2Design, SynthesisError> {
    with_cross_term(&lqg_plant(plant, weights)?, weights.cross_term)
}

/// The plant that [`lqg`] solves.
///
/// # Errors
/// As [`lqg`].
pub fn lqg_plant(plant: &GeneralizedPlant, weights: &LqgWeights) -> Result<GeneralizedPlant, SynthesisError> {
    let found = weights.process_noise;
    if !(found >= 0.0 && found.is_finite()) {
        let (field, expected) = ("process noise", "an intensity ≥ 0");
        return Err(LtiError::Field { field, expected, found }.into());
    }
    let s = plant.system();
    let (n, nw, root) = (plant.order(), plant.nw(), found.sqrt());
    let scale =
        |m: &Mat| Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] * if j < nw { root } else { 1.0 });
    let rho = &weights.input_weight;
    if rho.len() != plant.nu() {
        let (expected, found) = ((plant.nu(), 1), (rho.len(), 1));
        return Err(LtiError::Shape { name: "input weight", expected, found }.into());
    }
    if let Some(found) = rho.iter().find(|r| !(**r >= 0.0 && r.is_finite())) {
        let (field, expected) = ("input weight", "numbers ≥ 0");
        return Err(LtiError::Field { field, expected, found: *found }.into());
    }
    // weighted controls that cost something become performances, before the measurements
    let weighted: Vec<usize> = (0..rho.len()).filter(|k| rho[*k] > 0.0).collect();
    let (nz, more) = (plant.nz(), weighted.len());
    let old = |i: usize| if i < nz { Some(i) } else { i.checked_sub(nz + more).map(|k| nz + k) };
    let c = Mat::from_fn(s.outputs() + more, n, |i, j| old(i).map_or(0.0, |i| s.c()[(i, j)]));
    let d_old = scale(s.d());
    let d = Mat::from_fn(s.outputs() + more, s.inputs(), |i, j| match old(i) {
        Some(i) => d_old[(i, j)],
        None if j == nw + weighted[i - nz] => rho[weighted[i - nz]].sqrt(),
        None => 0.0,
    });
    let mut signals: Signals = plant.signals().clone();
    signals
        .performances
        .extend(weighted.iter().map(|k| format!("weighted {}", plant.signals().controls[*k])));
    let system = StateSpace::continuous(s.a().clone(), scale(s.b()), c, d)?;
    Ok(GeneralizedPlant::new(system, signals)?.with_sensor_noise(&weights.sensor_noise)?)
}

pub(super) fn symmetric(m: &Mat) -> Mat {
    Mat::from_fn(m.nrows(), m.ncols(), |i, j| 0.5 * (m[(i, j)] + m[(j, i)]))
}

pub(super) fn trace(m: &Mat) -> f64 {
    (0..m.nrows()).map(|i| m[(i, i)]).sum()
}
