//! The continuous algebraic Riccati equation.

use super::super::dense::{LinalgError, Mat, check_square};
use super::super::quasi_triangular::Equation;
use super::condition::Norms;
use super::error::RiccatiError;
use super::input::{average, check, norm, semidefinite, symmetric};
use super::newton::Problem;
use super::scaling::Scaling;
use super::{RiccatiSolution, Standard, stabilising};
use faer::linalg::solvers::{Llt, Solve};

/// Pivots of R's factor above this part of its largest entry need no eigenvalues to be believed.
const CLEARLY_DEFINITE: f64 = 1e-6;

/// The stabilising X of AᵀX + XA − (XB + S)R⁻¹(BᵀX + Sᵀ) + Q = 0.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `a` | n × n | (A, B) stabilisable |
/// | `b` | n × m | may have no column |
/// | `q` | n × n | symmetric, may be indefinite |
/// | `r` | m × m | symmetric, positive definite |
/// | `s` | n × m | the cross term, none is 0 |
///
/// u = +F x with the solution's `gain` F = −R⁻¹(BᵀX + Sᵀ) minimises ∫ xᵀQx + 2xᵀSu + uᵀRu dt. The filter's
/// equation is the same with Aᵀ, Cᵀ and the noises' covariances.
///
/// # Errors
/// [`RiccatiError`]: shapes, entries that are not finite, asymmetric Q or R, R indefinite or singular, an unstable
/// eigenvalue out of B's reach, Hamiltonian eigenvalues on the axis, a residual that refutes X.
///
/// States are balanced and X is scaled by powers of two inside. Source: see [`care_g`].
///
/// ```
/// use washboard::linalg::{Mat, care};
/// // ẋ = x + u, ∫ 3x² + u²: X² − 2X − 3 = 0, X = 3, F = −3
/// let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
/// let solution = care(&one(1.0), &one(1.0), &one(3.0), &one(1.0), None)?;
/// assert!((solution.x[(0, 0)] - 3.0).abs() < 1e-14);
/// assert!((solution.gain[(0, 0)] + 3.0).abs() < 1e-14);
/// assert!((solution.closed_loop_eigenvalues[0].re + 2.0).abs() < 1e-14);
/// # Ok::<(), washboard::linalg::RiccatiError>(())
/// ```
pub fn care(a: &Mat, b: &Mat, q: &Mat, r: &Mat, s: Option<&Mat>) -> Result<RiccatiSolution, RiccatiError> {
    let n = check_square("A", a)?;
    let m = b.ncols();
    check("A", a, (n, n))?;
    check("B", b, (n, m))?;
    let (q, r) = (symmetric("Q", q, n)?, symmetric("R", r, m)?);
    if let Some(s) = s {
        check("S", s, (n, m))?;
    }
    let root = cholesky(&r)?;
    // G = (L⁻¹Bᵀ)ᵀ(L⁻¹Bᵀ), R = L Lᵀ
    let lower = root.L();
    let mut half_b = b.transpose().to_owned();
    lower.solve_lower_triangular_in_place(half_b.as_mut());
    let mut g = half_b.transpose() * &half_b;
    average(&mut g);
    let solution = match s {
        None => solve(a, &g, &q, Some(&Factors { reach: b.clone(), seen: None }))?,
        Some(s) => {
            let mut half_s = s.transpose().to_owned();
            lower.solve_lower_triangular_in_place(half_s.as_mut());
            let mut q = &q - half_s.transpose() * &half_s;
            average(&mut q);
            let factors = Factors { reach: b.clone(), seen: None };
            solve(&(a - half_b.transpose() * &half_s), &g, &q, Some(&factors))?
        }
    };
    let mut cross = b.transpose() * &solution.x;
    if let Some(s) = s {
        cross += s.transpose();
    }
    let gain = -root.solve(&cross);
    Ok(RiccatiSolution { gain, ..solution })
}

/// L of a positive definite R = L Lᵀ.
fn cholesky(r: &Mat) -> Result<Llt<f64>, RiccatiError> {
    if let Ok(root) = r.llt(faer::Side::Lower) {
        let lower = root.L();
        let least = (0..r.nrows()).fold(f64::INFINITY, |l, i| l.min(lower[(i, i)] * lower[(i, i)]));
        if least > CLEARLY_DEFINITE * r.norm_max() {
            return Ok(root);
        }
    }
    let found = semidefinite(r)?;
    match r.llt(faer::Side::Lower) {
        Ok(root) if found.definite => Ok(root),
        _ => Err(RiccatiError::SingularR { ratio: found.ratio }),
    }
}

/// The stabilising X of AᵀX + XA − XGX + Q = 0, G given directly and perhaps indefinite.
///
/// `a`, `g` and `q` are n × n, G and Q symmetric. G = B₂R⁻¹B₂ᵀ − γ⁻²B₁B₁ᵀ is H∞'s, whose X may be indefinite or not
/// exist. All eigenvalues of A − G X are in the open left half plane; `gain` is −X, as with B = I and R = I.
///
/// # Errors
/// As [`care`]. What does not exist ends in [`RiccatiError::OnTheBoundary`] with the frequency, in
/// [`RiccatiError::NotStabilisable`] or in [`RiccatiError::Unconfirmed`].
///
/// Doubling (Chu, Fan and Lin 2005), else the ordered Schur form of the Hamiltonian (Laub 1979); Newton's method
/// (Kleinman 1968) on the true residual follows either.
pub fn care_g(a: &Mat, g: &Mat, q: &Mat) -> Result<RiccatiSolution, RiccatiError> {
    let n = check_square("A", a)?;
    check("A", a, (n, n))?;
    let (g, q) = (symmetric("G", g, n)?, symmetric("Q", q, n)?);
    solve(a, &g, &q, None)
}

/// What G and Q were made of, where that is known: it tells reach and sight better than the squares.
pub(super) struct Factors {
    /// A matrix with the column space of G.
    pub reach: Mat,
    /// H with Q = HᵀH, where Q and G are positive semidefinite by construction.
    pub seen: Option<Mat>,
}

pub(super) fn solve(
    a: &Mat,
    g: &Mat,
    q: &Mat,
    factors: Option<&Factors>,
) -> Result<RiccatiSolution, RiccatiError> {
    let scaling = Scaling::of(a, g, q);
    let (sa, sg, sq) = (scaling.a(a), scaling.g(g), scaling.q(q));
    for (name, m) in [("A", &sa), ("G", &sg), ("Q", &sq)] {
        if !m.norm_max().is_finite() {
            let value = m.norm_max();
            return Err(LinalgError::NotFinite { name, row: 0, col: 0, value }.into());
        }
    }
    let reach = factors.map_or_else(|| sg.clone(), |f| scaling.b(&f.reach));
    let seen = factors.and_then(|f| f.seen.as_ref()).map(|h| scaling.c(h));
    let problem = Problem::Continuous { a: sa.clone(), g: sg.clone(), q: sq.clone() };
    let standard = Standard { equation: Equation::Continuous, a: sa, g: sg, q: sq, reach, seen };
    let norms = Norms { a: norm(a), g: norm(g), q: norm(q), ..Norms::default() };
    let mut solution = stabilising(&problem, &standard, None, &scaling, norms)?;
    solution.gain = -&solution.x;
    Ok(solution)
}
