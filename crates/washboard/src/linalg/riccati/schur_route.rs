//! X from the stable invariant subspace of the 2n × 2n matrix, by its ordered real Schur form.

use super::super::dense::{C64, LinalgError, Mat, solve};
use super::super::schur::RealSchur;
use super::doubling::hamiltonian;
use super::input::average;

/// X = U₂₁ U₁₁⁻¹ of the n eigenvalues of least real part of [A −G; −Q −Aᵀ].
///
/// Source: Laub, *A Schur method for solving algebraic Riccati equations*, IEEE Trans. Autom. Control 24 (1979).
pub(super) fn continuous(a: &Mat, g: &Mat, q: &Mat) -> Result<Mat, LinalgError> {
    subspace(&hamiltonian(a, g, q))
}

/// The same of the pencil [A 0; −Q I] − z [I G; 0 Aᵀ], taken to s = (z − 1)/(z + 1): the circle becomes the axis, and
/// A may be singular.
///
/// Source: Laub (1979), §IV; the pencil by Pappas, Laub and Sandell (1980).
pub(super) fn discrete(a: &Mat, g: &Mat, q: &Mat) -> Result<Mat, LinalgError> {
    subspace(&cayley(a, g, q)?)
}

/// (M + L)⁻¹ (M − L) of that pencil M − z L.
pub(super) fn cayley(a: &Mat, g: &Mat, q: &Mat) -> Result<Mat, LinalgError> {
    let n = a.nrows();
    let one = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let combined = |sign: f64| {
        Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => a[(i, j)] + sign * one(i, j),
            (true, false) => sign * g[(i, j - n)],
            (false, true) => -q[(i - n, j)],
            (false, false) => one(i, j) + sign * a[(j - n, i - n)],
        })
    };
    solve(&combined(1.0), &combined(-1.0))
}

/// Eigenvalues of a 2n × 2n matrix of this kind.
pub(super) fn eigenvalues(matrix: &Mat) -> Result<Vec<C64>, LinalgError> {
    Ok(RealSchur::new(matrix)?.eigenvalues())
}

fn subspace(matrix: &Mat) -> Result<Mat, LinalgError> {
    let n = matrix.nrows() / 2;
    let schur = RealSchur::new(matrix)?;
    let (sorted, count) = schur.reordered(|z| z.re < 0.0)?;
    if count != n {
        let why = "its eigenvalues are not half stable";
        return Err(LinalgError::Singular { what: "the Hamiltonian", why, value: count as f64 });
    }
    let (u11, u21) = (sorted.q.submatrix(0, 0, n, n), sorted.q.submatrix(n, 0, n, n));
    // Xᵀ = U₁₁⁻ᵀ U₂₁ᵀ
    let mut x = solve(&u11.transpose().to_owned(), &u21.transpose().to_owned())?;
    average(&mut x);
    Ok(x)
}

#[cfg(test)]
mod tests {
    use super::super::doubling::Doubling;
    use super::*;
    use crate::linalg::test_matrices::{random, stable};

    /// Two routes agree to this on well-conditioned equations of order 20, before any correction. (Where
    /// unstable modes are barely observed doubling alone loses digits, which Newton brings back.)
    const AGREEMENT: f64 = 1e-10;

    #[test]
    fn both_routes_find_the_same_continuous_solution() {
        for n in [1, 2, 3, 7, 12, 20] {
            let (b, c) = (random(n, n, 3), random(n, n, 4));
            let (g, q) = (&b * b.transpose(), c.transpose() * &c);
            let shift = Mat::identity(n, n);
            for a in [stable(n, 1), stable(n, 2) + &shift * faer::Scale(2.0)] {
                let other = Doubling::cayley(&a, &g, &q).unwrap().run().unwrap().0;
                let x = continuous(&a, &g, &q).unwrap();
                let error = (&x - other).norm_l2() / x.norm_l2();
                assert!(error <= AGREEMENT, "order {n}: {error:e}");
            }
        }
    }

    #[test]
    fn both_routes_find_the_same_discrete_solution_of_a_singular_a() {
        for n in [2, 3, 7, 12, 20] {
            let (b, c) = (random(n, n, 3), random(2, n, 4));
            let (g, q) = (&b * b.transpose(), c.transpose() * &c);
            // rank n − 1, some eigenvalues outside of the circle
            let a = random(n, n - 1, 5) * random(n - 1, n, 6) * faer::Scale(3.0 / n as f64);
            let doubling = Doubling { a: a.clone(), g: g.clone(), h: q.clone(), factorisations: 0 };
            let x = discrete(&a, &g, &q).unwrap();
            assert!((&x - doubling.run().unwrap().0).norm_l2() <= AGREEMENT * x.norm_l2(), "order {n}");
        }
    }
}
