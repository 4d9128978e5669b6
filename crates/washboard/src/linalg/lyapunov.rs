//! Lyapunov, discrete Lyapunov and Sylvester equations, by Bartels and Stewart on real Schur forms.

use super::blocked;
use super::dense::{C64, LinalgError, Mat, check_finite, check_square};
use super::quasi_triangular::{Equation, Right, substitute};
use super::schur::RealSchur;

/// Two eigenvalues whose sum (or product less one) is below this many n ε of the matrices' size can't be told apart
/// from a singular equation: they are known to about n ε.
const SEPARATION_EPSILONS: f64 = 10.0;
/// A residual above this many n ε is refined once; below it there is nothing to win.
const REFINE_EPSILONS: f64 = 4.0;
/// Above this scaled residual a result is refused: half the digits are gone although the method is backward stable.
const REFUSED: f64 = 1e-8;

/// The solution of a linear matrix equation, with what it leaves.
#[derive(Debug, Clone)]
pub struct EquationSolution {
    /// X.
    pub x: Mat,
    /// ‖equation at X‖ / (sum of the norms of its terms), Frobenius: of the order of ε for a sound solution.
    pub scaled_residual: f64,
    /// min |λᵢ + μⱼ| (continuous) or min |λᵢμⱼ − 1| (discrete): how far the equation is from having no solution.
    pub separation: f64,
}

/// X with A X + X Aᵀ + Q = 0.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `a` | n × n | no eigenvalue may be another's negative |
/// | `q` | n × n | where it is exactly symmetric, so is X |
///
/// For a stable A and Q = B Bᵀ, X is the stationary covariance of ẋ = A x + B w under unit white noise,
/// ∫₀^∞ e^{At} Q e^{Aᵀt} dt.
///
/// # Errors
/// Shapes that do not fit, entries that are not finite, and [`LinalgError::Singular`] with the measured separation
/// where A and −Aᵀ share (nearly) an eigenvalue.
///
/// Source: Bartels and Stewart, *Algorithm 432*, CACM 15 (1972).
///
/// ```
/// use washboard::linalg::{Mat, lyapunov};
/// let (a, q) = (Mat::from_fn(1, 1, |_, _| -2.0), Mat::from_fn(1, 1, |_, _| 12.0));
/// let solution = lyapunov(&a, &q)?;
/// assert!((solution.x[(0, 0)] - 3.0).abs() < 1e-15);
/// # Ok::<(), washboard::linalg::LinalgError>(())
/// ```
pub fn lyapunov(a: &Mat, q: &Mat) -> Result<EquationSolution, LinalgError> {
    one_matrix(Equation::Continuous, "A X + X Aᵀ + Q = 0", a, q)
}

/// X with A X Aᵀ − X + Q = 0.
///
/// For |λ(A)| < 1 and Q = B Bᵀ, X is the stationary covariance of x⁺ = A x + B w, Σ AᵏQ(Aᵀ)ᵏ. `a` and `q` are n × n;
/// where `q` is exactly symmetric, so is X.
///
/// # Errors
/// Shapes that do not fit, entries that are not finite, and [`LinalgError::Singular`] with the measured separation
/// where A has (nearly) an eigenvalue and its reciprocal.
///
/// Source: Kitagawa, *An algorithm for solving the matrix equation X = FXFᵀ + S*, 1977.
pub fn discrete_lyapunov(a: &Mat, q: &Mat) -> Result<EquationSolution, LinalgError> {
    one_matrix(Equation::Discrete, "A X Aᵀ − X + Q = 0", a, q)
}

/// X with A X + X B = C.
///
/// `a` is m × m, `b` n × n, `c` and X m × n.
///
/// # Errors
/// Shapes that do not fit, entries that are not finite, and [`LinalgError::Singular`] with the measured separation
/// where A and −B share (nearly) an eigenvalue.
///
/// Source: Bartels and Stewart, *Algorithm 432*, CACM 15 (1972).
pub fn sylvester(a: &Mat, b: &Mat, c: &Mat) -> Result<EquationSolution, LinalgError> {
    let (m, n) = (check_square("A", a)?, check_square("B", b)?);
    check_rhs("C", c, (m, n))?;
    let (left, right) = (RealSchur::new(a)?, RealSchur::new(b)?);
    let size = a.norm_l2() + b.norm_l2();
    let separation = separation(Equation::Continuous, &left.eigenvalues(), &right.eigenvalues());
    refuse_singular("A X + X B = C", separation, m.max(n), size)?;
    let solve = |c: &Mat| {
        let f = left.q.transpose() * c * &right.q;
        let y = substitute(Equation::Continuous, &left, Right::Upper(&right), &f);
        &left.q * y * right.q.transpose()
    };
    let left_over = |x: &Mat| c - a * x - x * b;
    finish("A X + X B = C", m.max(n), separation, c, solve, left_over, |x| size * x.norm_l2() + c.norm_l2())
}

fn one_matrix(
    equation: Equation,
    what: &'static str,
    a: &Mat,
    q: &Mat,
) -> Result<EquationSolution, LinalgError> {
    let n = check_square("A", a)?;
    check_rhs("Q", q, (n, n))?;
    let schur = RealSchur::new(a)?;
    let values = schur.eigenvalues();
    let separation = separation(equation, &values, &values);
    let norm = a.norm_l2();
    let size = if equation == Equation::Continuous { 2.0 * norm } else { norm * norm + 1.0 };
    refuse_singular(what, separation, n, size)?;
    let symmetric = (0..n).all(|j| (0..j).all(|i| q[(i, j)] == q[(j, i)]));
    let solve = |f: &Mat| {
        let f = schur.q.transpose() * f * &schur.q;
        let y = match equation {
            Equation::Continuous => {
                let (t, mut y) = (schur.t.as_ref(), f);
                blocked::sylvester(t, t, y.as_mut(), f64::EPSILON * t.norm_max());
                y
            }
            Equation::Discrete => substitute(equation, &schur, Right::Transposed(&schur), &f),
        };
        let x = &schur.q * y * schur.q.transpose();
        if symmetric { (&x + x.transpose()) * faer::Scale(0.5) } else { x }
    };
    let left_over = |x: &Mat| match equation {
        Equation::Continuous => -(a * x) - x * a.transpose() - q,
        Equation::Discrete => x - a * x * a.transpose() - q,
    };
    let minus_q = -q;
    finish(what, n, separation, &minus_q, solve, left_over, |x| size * x.norm_l2() + q.norm_l2())
}

fn check_rhs(name: &'static str, rhs: &Mat, expected: (usize, usize)) -> Result<(), LinalgError> {
    let found = (rhs.nrows(), rhs.ncols());
    if found != expected {
        return Err(LinalgError::Shape { name, expected, found });
    }
    check_finite(name, rhs)
}

/// min |λ + μ| or min |λμ − 1|.
fn separation(equation: Equation, one: &[C64], other: &[C64]) -> f64 {
    let mut least = f64::INFINITY;
    for a in one {
        for b in other {
            least = least.min(match equation {
                Equation::Continuous => (a + b).norm(),
                Equation::Discrete => (a * b - 1.0).norm(),
            });
        }
    }
    least
}

fn refuse_singular(what: &'static str, separation: f64, n: usize, size: f64) -> Result<(), LinalgError> {
    if separation > SEPARATION_EPSILONS * n as f64 * f64::EPSILON * size {
        return Ok(());
    }
    let why = "two eigenvalues make the equation singular; their separation is too small";
    Err(LinalgError::Singular { what, why, value: separation })
}

/// Solves, measures what is left over, refines once where that helps, and refuses what the residual refutes.
fn finish(
    what: &'static str,
    n: usize,
    separation: f64,
    rhs: &Mat,
    solve: impl Fn(&Mat) -> Mat,
    left_over: impl Fn(&Mat) -> Mat,
    scale: impl Fn(&Mat) -> f64,
) -> Result<EquationSolution, LinalgError> {
    let measure = |x: &Mat| {
        let rest = left_over(x);
        let scaled = rest.norm_l2() / scale(x).max(f64::MIN_POSITIVE);
        (rest, scaled)
    };
    let mut x = solve(rhs);
    let (rest, mut scaled_residual) = measure(&x);
    if scaled_residual > REFINE_EPSILONS * n as f64 * f64::EPSILON {
        let refined = &x + solve(&rest);
        let (_, better) = measure(&refined);
        if better < scaled_residual {
            (x, scaled_residual) = (refined, better);
        }
    }
    if scaled_residual.is_finite() && scaled_residual <= REFUSED {
        Ok(EquationSolution { x, scaled_residual, separation })
    } else {
        let why = "the solution leaves a residual";
        Err(LinalgError::Singular { what, why, value: scaled_residual })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::expm;
    use crate::linalg::test_matrices::{all, random, stable};

    /// Backward error per order.
    const BACKWARD: f64 = 1e-14;

    fn covariance(n: usize, seed: u64) -> Mat {
        let b = random(n, n, seed);
        let q = &b * b.transpose();
        Mat::from_fn(n, n, |i, j| if i <= j { q[(i, j)] } else { q[(j, i)] })
    }

    #[test]
    fn lyapunov_leaves_no_residual_and_is_symmetric() {
        for n in [1, 2, 3, 5, 8, 20, 40] {
            let (a, q) = (stable(n, n as u64), covariance(n, 9));
            let s = lyapunov(&a, &q).unwrap();
            let rest = (&a * &s.x + &s.x * a.transpose() + &q).norm_l2();
            let bound = BACKWARD * n as f64 * (2.0 * a.norm_l2() * s.x.norm_l2() + q.norm_l2());
            assert!(rest <= bound, "order {n}: {rest:e}");
            assert!((&s.x - s.x.transpose()).norm_max() == 0.0);
            assert!(crate::linalg::symmetric_eigenvalues(&s.x).unwrap()[0] > 0.0, "a covariance");
        }
    }

    #[test]
    fn lyapunov_of_an_unsymmetric_q_and_of_hard_matrices() {
        for (name, a) in all() {
            let n = a.nrows();
            let q = random(n, n, 4);
            if let Ok(s) = lyapunov(&a, &q) {
                let rest = (&a * &s.x + &s.x * a.transpose() + &q).norm_l2();
                let bound = BACKWARD * n as f64 * (2.0 * a.norm_l2() * s.x.norm_l2() + q.norm_l2());
                assert!(rest <= bound, "{name}: {rest:e}");
            }
        }
    }

    #[test]
    fn discrete_lyapunov_is_the_sum_of_powers() {
        for n in [1, 2, 3, 6, 11] {
            let (a, q) = (random(n, n, 3) * faer::Scale(0.8 / n as f64), covariance(n, 2));
            let x = discrete_lyapunov(&a, &q).unwrap().x;
            let (mut power, mut sum) = (Mat::identity(n, n), Mat::zeros(n, n));
            for _ in 0..400 {
                sum += &power * &q * power.transpose();
                power = &a * power;
            }
            assert!((&x - sum).norm_l2() <= 1e-12 * x.norm_l2(), "order {n}");
        }
        // unstable too: the equation has a solution
        let (a, q) = (random(9, 9, 8) * faer::Scale(2.0), covariance(9, 1));
        let s = discrete_lyapunov(&a, &q).unwrap();
        let rest = (&a * &s.x * a.transpose() - &s.x + &q).norm_l2();
        assert!(rest <= 1e-12 * (a.norm_l2().powi(2) * s.x.norm_l2() + q.norm_l2()), "{rest:e}");
    }

    #[test]
    fn sylvester_returns_the_x_that_made_c() {
        for (m, n) in [(1, 1), (2, 1), (1, 2), (4, 7), (20, 9)] {
            let (a, b) = (stable(m, 1), stable(n, 2));
            let x = random(m, n, 6);
            let c = &a * &x + &x * &b;
            let got = sylvester(&a, &b, &c).unwrap();
            assert!((got.x - x).norm_l2() < 1e-11 * (m * n) as f64, "{m} × {n}");
        }
    }

    #[test]
    fn a_two_by_two_by_hand() {
        // ẍ + 2ζω ẋ + ω²x = w: var x = 1/(4ζω³), var ẋ = 1/(4ζω)
        let (zeta, omega) = (0.3, 7.0);
        let a = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-omega * omega, -2.0 * zeta * omega]][i][j]);
        let q = Mat::from_fn(2, 2, |i, j| if i + j == 2 { 1.0 } else { 0.0 });
        let x = lyapunov(&a, &q).unwrap().x;
        assert!((x[(0, 0)] * 4.0 * zeta * omega.powi(3) - 1.0).abs() < 1e-13);
        assert!((x[(1, 1)] * 4.0 * zeta * omega - 1.0).abs() < 1e-13);
        assert!(x[(0, 1)].abs() < 1e-16);
    }

    #[test]
    fn lyapunov_is_the_integral_over_time() {
        let n = 5;
        let (a, q) = (stable(n, 12), covariance(n, 5));
        // Simpson's rule on e^{At} Q e^{Aᵀt}; the slowest rate is about one half
        let (h, steps) = (0.005, 16_000);
        let step = expm(&(&a * faer::Scale(h))).unwrap();
        let (mut now, mut sum) = (q.clone(), Mat::zeros(n, n));
        for k in 0..=steps {
            let weight = if k == 0 || k == steps { 1.0 } else { [2.0, 4.0][k % 2] };
            sum += &now * faer::Scale(weight * h / 3.0);
            now = &step * now * step.transpose();
        }
        let x = lyapunov(&a, &q).unwrap().x;
        assert!((&x - sum).norm_l2() < 1e-8 * x.norm_l2());
    }

    #[test]
    fn a_singular_equation_is_refused_with_its_separation() {
        let turn = random(4, 4, 1).qr().compute_Q();
        let d = Mat::from_fn(4, 4, |i, j| if i == j { [1.0, -1.0, 2.0, 5.0][i] } else { 0.0 });
        let a = &turn * d * turn.transpose();
        let refused = lyapunov(&a, &Mat::identity(4, 4));
        assert!(matches!(refused, Err(LinalgError::Singular { value, .. }) if value < 1e-13), "{refused:?}");
        let swing = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-1.0, 0.0]][i][j]);
        assert!(lyapunov(&swing, &Mat::identity(2, 2)).is_err());
        assert!(discrete_lyapunov(&swing, &Mat::identity(2, 2)).is_err());
        assert!(sylvester(&swing, &swing, &Mat::identity(2, 2)).is_err());
        assert!(lyapunov(&swing, &Mat::identity(3, 3)).is_err());
    }
}
