//! Lyapunov equations solved for a factor of X: covariances that are nearly singular keep their small directions.

use super::dense::{C64, CMat, LinalgError, Mat, check_finite, check_square};
use super::quasi_triangular::Equation;
use super::schur::RealSchur;

/// L with X = L Lᵀ and A X + X Aᵀ + B Bᵀ = 0, B Bᵀ never formed.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `a` | n × n | eigenvalues in the open left half plane |
/// | `b` | n × m | any number of columns |
/// | result | n × n | lower triangular, diagonal of either sign |
///
/// Singular values of L are known to ε‖L‖, those of X therefore to ε²‖X‖, where X itself would lose all below ε‖X‖.
///
/// # Errors
/// Shapes, entries that are not finite, and [`LinalgError::Singular`] with the largest real part where A is unstable.
///
/// Source: Hammarling, *Numerical solution of the stable, non-negative definite Lyapunov equation*, IMA J. Numer.
/// Anal. 2 (1982), on a complex Schur form.
///
/// ```
/// use washboard::linalg::{Mat, lyapunov_factor};
/// let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
/// let l = lyapunov_factor(&one(-2.0), &one(6.0))?;
/// assert!((l[(0, 0)].abs() - 3.0).abs() < 1e-14);
/// # Ok::<(), washboard::linalg::LinalgError>(())
/// ```
pub fn lyapunov_factor(a: &Mat, b: &Mat) -> Result<Mat, LinalgError> {
    factor(Equation::Continuous, a, b)
}

/// L with X = L Lᵀ and A X Aᵀ − X + B Bᵀ = 0, B Bᵀ never formed; |λ(A)| < 1. Shapes as in [`lyapunov_factor`].
///
/// # Errors
/// As [`lyapunov_factor`], with the largest |λ| where A is unstable.
///
/// Source: Hammarling (1982), §6.
pub fn discrete_lyapunov_factor(a: &Mat, b: &Mat) -> Result<Mat, LinalgError> {
    factor(Equation::Discrete, a, b)
}

fn factor(equation: Equation, a: &Mat, b: &Mat) -> Result<Mat, LinalgError> {
    let n = check_square("A", a)?;
    check_finite("A", a)?;
    check_finite("B", b)?;
    if b.nrows() != n {
        return Err(LinalgError::Shape {
            name: "B",
            expected: (n, b.ncols()),
            found: (b.nrows(), b.ncols()),
        });
    }
    let (z, t) = complex_schur(&RealSchur::new(a)?);
    let values = (0..n).map(|k| t[(k, k)]);
    match equation {
        Equation::Continuous => {
            let value = values.map(|v| v.re).fold(f64::NEG_INFINITY, f64::max);
            if value >= 0.0 {
                let (what, why) = ("A X + X Aᵀ + B Bᵀ = 0", "A is not stable: largest real part");
                return Err(LinalgError::Singular { what, why, value });
            }
        }
        Equation::Discrete => {
            let value = values.map(|v| v.norm()).fold(0.0, f64::max);
            if value >= 1.0 {
                let (what, why) = ("A X Aᵀ − X + B Bᵀ = 0", "A is not stable: largest magnitude");
                return Err(LinalgError::Singular { what, why, value });
            }
        }
    }
    let b = z.adjoint() * CMat::from_fn(n, b.ncols(), |i, j| C64::new(b[(i, j)], 0.0));
    let u = z * triangular(equation, &t, upper_factor(&b));
    // X = Re(U Uᴴ) = [Re U, Im U][Re U, Im U]ᵀ
    let both = Mat::from_fn(2 * n, n, |i, j| if i < n { u[(j, i)].re } else { u[(j, i - n)].im });
    let l = both.qr().thin_R().transpose().to_owned();
    check_finite("L", &l)?;
    Ok(l)
}

/// U of T U Uᴴ + U Uᴴ Tᴴ + R Rᴴ = 0 (or T U Uᴴ Tᴴ − U Uᴴ + R Rᴴ = 0), all upper triangular.
///
/// From the last column: with T = [T₁ t; 0 λ], R = [R₁ r; 0 ρ], U = [U₁ u; 0 τ] the last row gives τ, the last column
/// u, and what remains is the same equation for T₁ with R₁R₁ᴴ + y yᴴ.
fn triangular(equation: Equation, t: &CMat, mut r: CMat) -> CMat {
    let n = t.nrows();
    let mut u = CMat::zeros(n, n);
    for k in (0..n).rev() {
        let lambda = t[(k, k)];
        let rho = r[(k, k)];
        // α τ = ρ
        let alpha = match equation {
            Equation::Continuous => (-2.0 * lambda.re).sqrt(),
            Equation::Discrete => {
                let size = lambda.norm();
                ((1.0 - size) * (1.0 + size)).sqrt()
            }
        };
        let tau = rho / alpha;
        // (T₁ + λ̄ I) u = −α r − τ t, or (λ̄ T₁ − I) u = −α r − λ̄ τ t
        let (scale, shift) = match equation {
            Equation::Continuous => (C64::new(1.0, 0.0), lambda.conj()),
            Equation::Discrete => (lambda.conj(), C64::new(-1.0, 0.0)),
        };
        let mut column: Vec<C64> = (0..k).map(|i| -r[(i, k)] * alpha - scale * tau * t[(i, k)]).collect();
        for i in (0..k).rev() {
            let x = column[i] / (scale * t[(i, i)] + shift);
            column[i] = x;
            for (l, c) in column.iter_mut().enumerate().take(i) {
                *c -= scale * t[(l, i)] * x;
            }
        }
        let y: Vec<C64> = match equation {
            Equation::Continuous => (0..k).map(|i| r[(i, k)] - column[i] * alpha).collect(),
            Equation::Discrete => {
                let moved = |i: usize| (i..k).map(|l| t[(i, l)] * column[l]).sum::<C64>() + t[(i, k)] * tau;
                (0..k).map(|i| moved(i) * alpha - r[(i, k)] * lambda).collect()
            }
        };
        u[(k, k)] = tau;
        for (i, x) in column.into_iter().enumerate() {
            u[(i, k)] = x;
        }
        append(&mut r, y, k);
    }
    u
}

/// R of order k such that R Rᴴ grows by y yᴴ: rotations of columns from the last row up.
fn append(r: &mut CMat, mut y: Vec<C64>, k: usize) {
    for j in (0..k).rev() {
        let (p, q) = (r[(j, j)], y[j]);
        let size = p.norm().hypot(q.norm());
        if size == 0.0 {
            continue;
        }
        let (c, s) = (p / size, q / size);
        for i in 0..=j {
            let (x, v) = (r[(i, j)], y[i]);
            r[(i, j)] = x * c.conj() + v * s.conj();
            y[i] = v * c - x * s;
        }
    }
}

/// Upper triangular n × n R with R Rᴴ = B Bᴴ, by a QR factorisation of the reversed Bᴴ.
fn upper_factor(b: &CMat) -> CMat {
    let (n, m) = (b.nrows(), b.ncols());
    let reversed = CMat::from_fn(m, n, |i, j| b[(n - 1 - j, i)].conj());
    let qr = reversed.qr();
    let r = qr.thin_R();
    // B = P Rᴴ Qᴴ, and P Rᴴ is upper triangular with its columns reversed
    let rows = r.nrows();
    CMat::from_fn(n, n, |i, j| {
        let (row, col) = (n - 1 - j, n - 1 - i);
        if row < rows && row <= col { r[(row, col)].conj() } else { C64::new(0.0, 0.0) }
    })
}

/// A = Z T Zᴴ with an upper triangular T: each 2 × 2 block of the real form turned by one complex rotation.
fn complex_schur(real: &RealSchur) -> (CMat, CMat) {
    let n = real.order();
    let complex = |m: &Mat| CMat::from_fn(n, n, |i, j| C64::new(m[(i, j)], 0.0));
    let (mut z, mut t) = (complex(&real.q), complex(&real.t));
    for (k, size) in real.blocks() {
        if size == 1 {
            continue;
        }
        // [a b; c a], bc < 0: the eigenvector of a + i√(−bc) is [b; i√(−bc)]
        let (b, c) = (real.t[(k, k + 1)], real.t[(k + 1, k)]);
        let root = b.abs().sqrt() * c.abs().sqrt();
        let size = b.hypot(root);
        let (x, y) = (C64::new(b / size, 0.0), C64::new(0.0, root / size));
        // columns [x y; y x]: unitary, as y is imaginary and x real
        for j in 0..n {
            let (p, q) = (t[(k, j)], t[(k + 1, j)]);
            t[(k, j)] = x * p - y * q;
            t[(k + 1, j)] = x * q - y * p;
        }
        for m in [&mut t, &mut z] {
            for i in 0..n {
                let (p, q) = (m[(i, k)], m[(i, k + 1)]);
                m[(i, k)] = p * x + q * y;
                m[(i, k + 1)] = p * y + q * x;
            }
        }
        let a = real.t[(k, k)];
        t[(k + 1, k)] = C64::new(0.0, 0.0);
        t[(k, k)] = C64::new(a, root);
        t[(k + 1, k + 1)] = C64::new(a, -root);
    }
    (z, t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::test_matrices::{random, stable};
    use crate::linalg::{discrete_lyapunov, lyapunov, symmetric_eigenvalues};

    #[test]
    fn the_complex_form_is_triangular_and_the_matrix() {
        for n in [1, 2, 5, 12] {
            let a = random(n, n, 3);
            let (z, t) = complex_schur(&RealSchur::new(&a).unwrap());
            let back = &z * &t * z.adjoint();
            let error = Mat::from_fn(n, n, |i, j| (back[(i, j)] - a[(i, j)]).norm()).norm_l2();
            assert!(error < 1e-13 * n as f64, "{n}: {error:e}");
            let below = (0..n).flat_map(|j| (j + 1..n).map(move |i| (i, j)));
            assert!(below.into_iter().all(|at| t[at].norm() < 1e-13));
        }
    }

    #[test]
    fn the_factor_squares_to_the_solution() {
        for (n, m) in [(1, 1), (2, 1), (3, 5), (8, 2), (20, 3), (6, 0)] {
            let (a, b) = (stable(n, 5), random(n, m, 6));
            let q = &b * b.transpose();
            let (l, x) = (lyapunov_factor(&a, &b).unwrap(), lyapunov(&a, &q).unwrap().x);
            let error = (&l * l.transpose() - &x).norm_l2();
            assert!(error <= 1e-13 * n as f64 * x.norm_l2(), "{n}, {m}: {error:e}");
            let a = random(n, n, 8) * faer::Scale(0.9 / (n as f64).sqrt());
            let (l, x) = (discrete_lyapunov_factor(&a, &b).unwrap(), discrete_lyapunov(&a, &q).unwrap().x);
            let error = (&l * l.transpose() - &x).norm_l2();
            assert!(error <= 1e-12 * n as f64 * x.norm_l2(), "discrete {n}, {m}: {error:e}");
        }
    }

    /// diag(A₁, A₂) with inputs of sizes 1 and 1e-12, turned: the small singular value is b/√(2a) exactly, 1e-24 in X.
    #[test]
    fn a_direction_that_x_loses_is_kept() {
        let small = 1e-12;
        let turn = random(4, 4, 2).qr().compute_Q();
        let rates = [1.0, 2.0, 3.0, 4.0];
        let a = &turn * Mat::from_fn(4, 4, |i, j| if i == j { -rates[i] } else { 0.0 }) * turn.transpose();
        let b = &turn
            * Mat::from_fn(4, 4, |i, j| {
                if i != j {
                    0.0
                } else if i == 3 {
                    small
                } else {
                    1.0
                }
            });
        let expected = small / (2.0 * rates[3]).sqrt();
        let l = lyapunov_factor(&a, &b).unwrap();
        let least = *l.singular_values().unwrap().last().unwrap();
        assert!((least / expected - 1.0).abs() < 1e-2, "{least:e}");
        // the route over X: rounding of order ε, its square root ten thousand times too large (or negative)
        let x = lyapunov(&a, &(&b * b.transpose())).unwrap().x;
        let lost = symmetric_eigenvalues(&x).unwrap()[0];
        assert!((lost / expected / expected - 1.0).abs() > 10.0, "{lost:e}");
    }

    #[test]
    fn an_unstable_matrix_is_refused() {
        let refused = lyapunov_factor(&Mat::identity(2, 2), &Mat::identity(2, 2));
        assert!(matches!(refused, Err(LinalgError::Singular { value, .. }) if value == 1.0));
        assert!(discrete_lyapunov_factor(&Mat::identity(2, 2), &Mat::identity(2, 2)).is_err());
        assert!(lyapunov_factor(&Mat::zeros(0, 0), &Mat::zeros(0, 3)).is_ok());
    }
}
