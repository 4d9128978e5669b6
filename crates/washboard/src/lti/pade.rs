//! A pure delay as a rational all-pass.

use super::{Continuous, LtiError, StateSpace};
use crate::linalg::Mat;

/// Factorials of higher orders leave no digits in companion form: beyond it, shorter delays in series.
const HIGHEST_IN_ONE: usize = 12;
/// More states than this are no approximation any more but a delay line.
const HIGHEST: usize = 120;

/// e^{−sT} by Padé's approximation of the order given, P(−sT)/P(sT): its modulus is 1 at all frequencies, its phase right
/// up to about ωT = order.
///
/// P(x) = Σ (2n − k)! n!/((2n)! k! (n − k)!) xᵏ. Order 0 is no delay at all, a gain of 1. Orders above 12 are shorter
/// delays in series.
///
/// # Errors
/// A delay that is negative or not finite, an order above 120.
///
/// Source: Golub and Van Loan, *Matrix Computations*, 4th ed., §9.3.1.
///
/// ```
/// let delay = washboard::lti::pade_delay(0.1, 3)?;
/// let g = delay.frequency_response(&[5.0])?[0][(0, 0)];
/// assert!((g.norm() - 1.0).abs() < 1e-13 && (g.arg() + 0.5).abs() < 1e-5);
/// # Ok::<(), washboard::lti::LtiError>(())
/// ```
pub fn pade_delay(delay_s: f64, order: usize) -> Result<StateSpace<Continuous>, LtiError> {
    if !(delay_s >= 0.0 && delay_s.is_finite()) {
        return Err(LtiError::Field { field: "delay_s", expected: "a number ≥ 0", found: delay_s });
    }
    if order > HIGHEST {
        return Err(LtiError::Field { field: "order", expected: "an order up to 120", found: order as f64 });
    }
    if order == 0 || delay_s == 0.0 {
        return StateSpace::continuous_gain(Mat::identity(1, 1));
    }
    if order > HIGHEST_IN_ONE {
        let pieces = order.div_ceil(HIGHEST_IN_ONE);
        // orders that differ by one at most, each with its share of the delay
        let share = |k: usize| order / pieces + usize::from(k < order % pieces);
        let piece = |k: usize| pade_delay(delay_s * share(k) as f64 / order as f64, share(k));
        return (1..pieces).try_fold(piece(0)?, |all, k| all.series(&piece(k)?));
    }
    // c_k of P, over c_n
    let mut c = vec![1.0; order + 1];
    for k in (0..order).rev() {
        // c_k/c_{k+1} = (2n − k)(k + 1)/(n − k)
        c[k] = c[k + 1] * ((2 * order - k) * (k + 1)) as f64 / (order - k) as f64;
    }
    // in x = sT: monic denominator; numerator (−1)ᵏ c_k; D = (−1)ⁿ
    let d = if order.is_multiple_of(2) { 1.0 } else { -1.0 };
    let a = Mat::from_fn(order, order, |i, j| {
        (if i + 1 == order { -c[j] } else { f64::from(u8::from(j == i + 1)) }) / delay_s
    });
    let b = Mat::from_fn(order, 1, |i, _| f64::from(u8::from(i + 1 == order)) / delay_s);
    let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    let row = Mat::from_fn(1, order, |_, j| (sign(j) - d) * c[j]);
    let raw = StateSpace::continuous(a, b, row, Mat::from_fn(1, 1, |_, _| d))?;
    Ok(raw.balanced_scales()?.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_order_one_is_the_known_one() {
        // (x² − 6x + 12)/(x² + 6x + 12)
        let (t, s) = (0.25, crate::linalg::C64::new(0.7, 3.0));
        let x = s * t;
        let known = (x * x - x * 6.0 + 12.0) / (x * x + x * 6.0 + 12.0);
        let found = pade_delay(t, 2).unwrap().at(s).unwrap()[(0, 0)];
        assert!((found - known).norm() < 1e-14);
    }

    #[test]
    fn every_order_is_an_all_pass_of_the_right_phase() {
        for order in (1..=HIGHEST_IN_ONE).chain([13, 20, 37]) {
            let delay = pade_delay(0.3, order).unwrap();
            let wt = 0.5 * order as f64;
            let g = delay.frequency_response(&[wt / 0.3]).unwrap()[0][(0, 0)];
            assert!((g.norm() - 1.0).abs() < 1e-9, "{order}: {:e}", g.norm() - 1.0);
            let error = (g * crate::linalg::C64::new(wt.cos(), wt.sin())).arg();
            assert!(error.abs() < 0.011, "{order}: {error:e}");
            assert!(delay.is_stable().unwrap());
        }
        assert!(pade_delay(-1.0, 2).is_err() && pade_delay(1.0, 121).is_err());
        assert_eq!(pade_delay(0.0, 4).unwrap().order(), 0);
    }
}
