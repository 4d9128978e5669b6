//! The conservation law of tire deflection: what is pressed down at some frequencies comes up at others.

use super::{AchievableError, QuarterCar};
use crate::linalg::integrate;
use crate::lti::{Polynomial, RationalFunction, to_f64};
use std::f64::consts::{FRAC_PI_2, PI};

/// Relative accuracy asked of the quadrature.
const ACCURACY: f64 = 1e-9;
const MOST_EVALUATIONS: usize = 2_000_000;

/// ∫₀^∞ ln|T_{z₃w}(jω)| dω by formula and by quadrature, rad/s.
#[derive(Debug, Clone, PartialEq)]
pub struct LogIntegral {
    /// π Σ Re z over the zeros of T in the open right half plane.
    pub zeros: f64,
    /// −(π/2) c_t/m_u: what tire damping gives, independent of the controller. The thesis has it for c_t = 0 only.
    pub tire_damping: f64,
    /// The sum of both.
    pub formula: f64,
    /// By adaptive quadrature of the response.
    pub quadrature: f64,
    /// Its estimated error.
    pub quadrature_error: f64,
    /// The zeros counted, rad/s.
    pub zeros_rad_s: Vec<crate::linalg::C64>,
}

/// Bode's integral of a tire deflection response, T = −1 + (c_t/m_u)/s + O(s⁻²):
///
/// ∫₀^∞ ln|T(jω)| dω = π Σ Re zₖ − (π/2) c_t/m_u, zₖ the zeros of T in the open right half plane.
///
/// # Errors
/// A response that is not in RH∞ or does not begin as every tire deflection does at infinity.
///
/// Source: Türkay's thesis, after proposition 4.3.13 (c_t = 0); the term for c_t > 0 is Jensen's formula with residue at
/// infinity.
pub fn log_integral(car: &QuarterCar, h3: &RationalFunction) -> Result<LogIntegral, AchievableError> {
    if !h3.is_stable() {
        return Err(AchievableError::NotStable { what: "T_z3w", found: h3.to_string() });
    }
    let first = h3.at_infinity(2)?;
    let residue = &car.ct / &car.mu;
    let minus_one = num_rational::Ratio::from_integer((-1).into());
    if first != [minus_one, residue.clone()] {
        let (field, expected) = ("T_z3w at infinity", "−1 + (c_t/m_u)/s");
        return Err(AchievableError::Number { field, expected, found: first.first().map_or(0.0, to_f64) });
    }
    let zeros_rad_s: Vec<_> = h3.numerator().roots()?.into_iter().filter(|z| z.re > 0.0).collect();
    let zeros = PI * zeros_rad_s.iter().map(|z| z.re).sum::<f64>();
    let tire_damping = -FRAC_PI_2 * to_f64(&residue);
    let (quadrature, quadrature_error) = by_quadrature(h3)?;
    Ok(LogIntegral {
        zeros,
        tire_damping,
        formula: zeros + tire_damping,
        quadrature,
        quadrature_error,
        zeros_rad_s,
    })
}

/// ω = ω₀ tan θ; ln|T| = ½ ln(1 + (|n|² − |d|²)/|d|²) with the difference exact, as it vanishes as ω⁻² at infinity.
fn by_quadrature(h: &RationalFunction) -> Result<(f64, f64), AchievableError> {
    let squared = |p: &Polynomial| {
        // |p(jω)|² in x = ω²: e(−x)² + x o(−x)²
        let (e, o) = p.even_and_odd();
        let turned = |p: &Polynomial| {
            let c: Vec<_> = p
                .coefficients()
                .into_iter()
                .enumerate()
                .map(|(k, c)| if k % 2 == 1 { -c } else { c })
                .collect();
            Polynomial::new(&c)
        };
        let (e, o) = (turned(&e), turned(&o));
        &(&e * &e) + &(&Polynomial::power_of_s(1) * &(&o * &o))
    };
    let (n, d) = (squared(h.numerator()), squared(h.denominator()));
    let degree = d.degree();
    // the geometric mean of the poles as the unit of frequency
    let mean = to_f64(&(d.coefficient(0) / d.leading())).powf(0.5 / degree as f64);
    let scale = if mean.is_normal() { mean } else { 1.0 };
    let floats = |p: &Polynomial| -> Vec<f64> {
        p.coefficients()
            .iter()
            .enumerate()
            .map(|(k, c)| to_f64(c) * scale.powi(2 * (k as i32 - degree as i32)))
            .collect()
    };
    let (difference, below, above) = (floats(&(&n - &d)), floats(&d), floats(&n));
    // x^-degree·p(x) for large x, so that nothing overflows
    let value = |c: &[f64], x: f64| {
        if x <= 1.0 {
            c.iter().rev().fold(0.0, |v, c| v * x + c)
        } else {
            let y = 1.0 / x;
            c.iter().fold(0.0, |v, c| v * y + c) * y.powi(degree as i32 + 1 - c.len() as i32)
        }
    };
    let integrand = |theta: f64, out: &mut [f64]| {
        let (sin, cos) = theta.sin_cos();
        let x = (sin / cos).powi(2);
        let ratio = value(&difference, x) / value(&below, x);
        // near a zero the quotient itself keeps its digits
        let ln = if ratio > -0.5 { ratio.ln_1p() } else { (value(&above, x) / value(&below, x)).ln() };
        out[0] = if ln.is_finite() { 0.5 * ln * scale / (cos * cos) } else { 0.0 };
    };
    let breakpoints = [0.0, 1e-6, 1e-4, 1e-2, 0.1, 0.4, 0.8, 1.2, 1.5, 1.57, FRAC_PI_2];
    let found = integrate(integrand, 1, &breakpoints, ACCURACY, &[], MOST_EVALUATIONS);
    Ok((found.values[0], found.errors[0]))
}
