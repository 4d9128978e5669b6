//! The matrix exponential, by scaling and squaring.

use super::dense::{LinalgError, Mat, check_finite, check_square, solve};

/// Largest 1-norm for which the [13/13] Padé approximant has a backward error below ε: Higham (2005), table 2.3.
const THETA_13: f64 = 5.371_920_351_148_152;

/// Coefficients of the [13/13] Padé numerator, exact in f64.
const PADE_13: [f64; 14] = [
    64_764_752_532_480_000.0,
    32_382_376_266_240_000.0,
    7_771_770_303_897_600.0,
    1_187_353_796_428_800.0,
    129_060_195_264_000.0,
    10_559_470_521_600.0,
    670_442_572_800.0,
    33_522_128_640.0,
    1_323_241_920.0,
    40_840_800.0,
    960_960.0,
    16_380.0,
    182.0,
    1.0,
];

/// e^A of a real n × n matrix.
///
/// e^A = (r₁₃(A/2ˢ))^{2ˢ}, r₁₃ the [13/13] Padé approximant and s the least for which ‖A/2ˢ‖₁ ≤ 5.37.
///
/// # Errors
/// A matrix that is not square or not finite, and an exponential that overflows.
///
/// Source: Higham, *The scaling and squaring method for the matrix exponential revisited*, SIAM J. Matrix Anal.
/// Appl. 26 (2005), algorithm 2.3.
///
/// ```
/// use washboard::linalg::{Mat, expm};
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let turn = expm(&Mat::from_fn(2, 2, |i, j| [[0.0, -quarter], [quarter, 0.0]][i][j]))?;
/// assert!((turn[(1, 0)] - 1.0).abs() < 1e-15 && turn[(0, 0)].abs() < 1e-15);
/// # Ok::<(), washboard::linalg::LinalgError>(())
/// ```
pub fn expm(a: &Mat) -> Result<Mat, LinalgError> {
    let n = check_square("A", a)?;
    check_finite("A", a)?;
    let norm = (0..n).map(|j| (0..n).map(|i| a[(i, j)].abs()).sum::<f64>()).fold(0.0, f64::max);
    let squarings = if norm > THETA_13 { (norm / THETA_13).log2().ceil() as i32 } else { 0 };
    let a = a * faer::Scale(0.5f64.powi(squarings));
    let b = PADE_13.map(faer::Scale);
    let one = Mat::identity(n, n);
    let a2 = &a * &a;
    let a4 = &a2 * &a2;
    let a6 = &a4 * &a2;
    // eqs. (2.11)–(2.12)
    let u = &a
        * (&a6 * (&a6 * b[13] + &a4 * b[11] + &a2 * b[9])
            + &a6 * b[7]
            + &a4 * b[5]
            + &a2 * b[3]
            + &one * b[1]);
    let v =
        &a6 * (&a6 * b[12] + &a4 * b[10] + &a2 * b[8]) + &a6 * b[6] + &a4 * b[4] + &a2 * b[2] + &one * b[0];
    let mut x = solve(&(&v - &u), &(&v + &u))?;
    for _ in 0..squarings {
        x = &x * &x;
    }
    check_finite("e^A", &x)?;
    Ok(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::test_matrices::{all, random};
    use crate::linalg::{C64, CMat, eigen, solve_complex};

    #[test]
    fn agrees_with_diagonalisation() {
        for (n, scale) in [(2, 0.1), (5, 1.0), (8, 4.0), (12, 10.0)] {
            let a = random(n, n, n as u64) * faer::Scale(scale);
            let (values, v) = eigen(&a).unwrap();
            // e^A V = V e^Λ, transposed for the solver
            let w = CMat::from_fn(n, n, |i, j| v[(j, i)]);
            let scaled = CMat::from_fn(n, n, |i, j| v[(j, i)] * values[i].exp());
            let other = solve_complex(&w, &scaled).unwrap();
            let e = expm(&a).unwrap();
            for i in 0..n {
                for j in 0..n {
                    let d = (other[(j, i)] - C64::new(e[(i, j)], 0.0)).norm();
                    assert!(d < 1e-11 * e.norm_l2(), "order {n}: {d:e}");
                }
            }
        }
    }

    #[test]
    fn a_nilpotent_matrix_has_a_finite_series() {
        let a = Mat::from_fn(4, 4, |i, j| if j == i + 1 { 30.0 } else { 0.0 });
        let a2 = &a * &a;
        let series = Mat::identity(4, 4) + &a + &a2 * faer::Scale(0.5) + &a2 * &a * faer::Scale(1.0 / 6.0);
        let e = expm(&a).unwrap();
        assert!((e - &series).norm_l2() < 1e-13 * series.norm_l2());
    }

    #[test]
    fn the_inverse_is_the_exponential_of_the_negative() {
        for (name, a) in all().into_iter().filter(|m| !m.0.starts_with("stiff")) {
            let n = a.nrows();
            let (e, inverse) = (expm(&a).unwrap(), expm(&-&a).unwrap());
            let d = (&e * &inverse - Mat::identity(n, n)).norm_l2();
            assert!(d <= 1e-13 * (1.0 + e.norm_l2() * inverse.norm_l2()), "{name}: {d:e}");
        }
    }

    #[test]
    fn a_large_rotation_stays_a_rotation() {
        let phi: f64 = 1234.5;
        let e = expm(&Mat::from_fn(2, 2, |i, j| [[0.0, -phi], [phi, 0.0]][i][j])).unwrap();
        // conditioning: an error of ε in φ turns by φ ε
        assert!((e[(0, 0)] - phi.cos()).abs() < 1e-11 && (e[(1, 0)] - phi.sin()).abs() < 1e-11);
    }

    #[test]
    fn an_overflow_is_refused() {
        assert!(expm(&Mat::from_fn(1, 1, |_, _| 800.0)).is_err());
        assert!(expm(&Mat::zeros(1, 2)).is_err());
    }
}
