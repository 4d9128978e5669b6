//! The discrete algebraic Riccati equation.

use super::super::dense::{Mat, check_square, solve};
use super::super::quasi_triangular::Equation;
use super::condition::Norms;
use super::error::RiccatiError;
use super::input::{average, check, definiteness, norm, semidefinite, symmetric};
use super::newton::Problem;
use super::scaling::Scaling;
use super::{RiccatiSolution, Standard, stabilising};

/// An R whose smallest eigenvalue is below this part of its largest is not inverted: X is shifted first.
const WELL_CONDITIONED: f64 = 1e-6;

/// The stabilising X of AᵀXA − X − (AᵀXB + S)(R + BᵀXB)⁻¹(BᵀXA + Sᵀ) + Q = 0.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `a` | n × n | (A, B) stabilisable; may be singular |
/// | `b` | n × m | may have no column |
/// | `q` | n × n | symmetric, may be indefinite |
/// | `r` | m × m | symmetric, positive semidefinite; 0 where R + BᵀXB is invertible |
/// | `s` | n × m | the cross term, none is 0 |
///
/// u = +F x with the solution's `gain` F = −(R + BᵀXB)⁻¹(BᵀXA + Sᵀ) minimises Σ xᵀQx + 2xᵀSu + uᵀRu.
///
/// # Errors
/// [`RiccatiError`]: as [`care`](super::care), and [`RiccatiError::SingularInput`] where R + BᵀXB stays singular.
///
/// A singular R is never inverted: with X = X₀ + Δ, Δ solves the equation of Q + AᵀX₀A − X₀, R + BᵀX₀B and S + AᵀX₀B,
/// exactly; X₀ are steps of the value iteration, the cost of a finite horizon (of an indefinite cost a multiple of I). Then doubling (Chu, Fan, Lin and Wang
/// 2004), else the ordered Schur form of the pencil's Cayley transform; Newton's method (Hewer 1971) on the true
/// residual follows either.
///
/// ```
/// use washboard::linalg::{Mat, dare};
/// // dead beat: R = 0 and B invertible, so X = Q and u = −B⁻¹A x
/// let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
/// let solution = dare(&one(3.0), &one(2.0), &one(5.0), &one(0.0), None)?;
/// assert!((solution.x[(0, 0)] - 5.0).abs() < 1e-13);
/// assert!((solution.gain[(0, 0)] + 1.5).abs() < 1e-13);
/// # Ok::<(), washboard::linalg::RiccatiError>(())
/// ```
pub fn dare(a: &Mat, b: &Mat, q: &Mat, r: &Mat, s: Option<&Mat>) -> Result<RiccatiSolution, RiccatiError> {
    let n = check_square("A", a)?;
    let m = b.ncols();
    check("A", a, (n, n))?;
    check("B", b, (n, m))?;
    let (q, r) = (symmetric("Q", q, n)?, symmetric("R", r, m)?);
    let s = match s {
        Some(s) => {
            check("S", s, (n, m))?;
            s.clone()
        }
        None => Mat::zeros(n, m),
    };
    semidefinite(&r)?;
    let cost = Cost { a, b, q: &q, r: &r, s: &s };
    let (shift, shifted) = cost.with_invertible_r()?;
    let (sa, g, sq) = shifted.standard(a, b)?;
    let scaling = Scaling::of(&sa, &g, &sq);
    let standard = Standard {
        equation: Equation::Discrete,
        a: scaling.a(&sa),
        g: scaling.g(&g),
        q: scaling.q(&sq),
        reach: scaling.b(b),
        seen: None,
    };
    let problem = Problem::Discrete {
        a: scaling.a(a),
        b: scaling.b(b),
        q: scaling.q(&q),
        r: &r * faer::Scale(1.0 / scaling.rho),
        s: scaling.s(&s),
    };
    // X₀ is scaled like Q
    let shift = shift.map(|x0| scaling.q(&x0));
    let (b, r, s) = (norm(b), norm(&r), norm(&s));
    let norms = Norms { a: norm(a), g: 0.0, q: norm(&q), b, r, s };
    stabilising(&problem, &standard, shift.as_ref(), &scaling, norms)
}

/// Q, R and S after a shift of X.
struct Shifted {
    q: Mat,
    r: Mat,
    s: Mat,
}

impl Shifted {
    /// A − BR⁻¹Sᵀ, BR⁻¹Bᵀ and Q − SR⁻¹Sᵀ.
    fn standard(&self, a: &Mat, b: &Mat) -> Result<(Mat, Mat, Mat), RiccatiError> {
        let n = a.nrows();
        if b.ncols() == 0 {
            return Ok((a.clone(), Mat::zeros(n, n), self.q.clone()));
        }
        let mut both = Mat::zeros(b.ncols(), 2 * n);
        both.subcols_mut(0, n).copy_from(b.transpose());
        both.subcols_mut(n, n).copy_from(self.s.transpose());
        let over_r = solve(&self.r, &both)?;
        let (rb, rs) = (over_r.subcols(0, n), over_r.subcols(n, n));
        let (mut g, mut q) = (b * rb, &self.q - &self.s * rs);
        average(&mut g);
        average(&mut q);
        Ok((a - b * rs, g, q))
    }
}

struct Cost<'a> {
    a: &'a Mat,
    b: &'a Mat,
    q: &'a Mat,
    r: &'a Mat,
    s: &'a Mat,
}

impl Cost<'_> {
    /// The equation of Δ = X − X₀.
    fn shifted(&self, x0: &Mat) -> Shifted {
        let (xa, xb) = (x0 * self.a, x0 * self.b);
        let mut q = self.q + self.a.transpose() * &xa - x0;
        let mut r = self.r + self.b.transpose() * &xb;
        average(&mut q);
        average(&mut r);
        Shifted { q, r, s: self.s + self.a.transpose() * &xb }
    }

    /// X₀ and the shifted cost: none where R is well conditioned as it is, else value iteration from 0 until it is, else
    /// a multiple of I.
    fn with_invertible_r(&self) -> Result<(Option<Mat>, Shifted), RiccatiError> {
        let n = self.a.nrows();
        let plain = Shifted { q: self.q.clone(), r: self.r.clone(), s: self.s.clone() };
        let found = definiteness(self.r)?;
        if found.ratio > WELL_CONDITIONED {
            return Ok((None, plain));
        }
        // the best conditioned of a horizon of n steps
        let (mut x0, mut best) = (Mat::zeros(n, n), (found, None, plain));
        for _ in 0..n.max(1) {
            let here = self.shifted(&x0);
            let mut next = &x0 + &here.q - &here.s * pseudo_solve(&here.r, &here.s.transpose().to_owned())?;
            average(&mut next);
            let next_cost = self.shifted(&next);
            let found = definiteness(&next_cost.r)?;
            if !next.norm_max().is_finite() {
                break;
            }
            if found.ratio > best.0.ratio {
                let done = found.ratio > WELL_CONDITIONED;
                best = (found, Some(next.clone()), next_cost);
                if done {
                    break;
                }
            }
            x0 = next;
        }
        // an indefinite cost: any X₀ that makes R + BᵀX₀B definite
        if best.0.ratio <= WELL_CONDITIONED && norm(self.b) > 0.0 {
            let size = (norm(self.r) / norm(self.b) / norm(self.b)).max(norm(self.q));
            let x0 = Mat::identity(n, n) * faer::Scale(if size > 0.0 { size } else { 1.0 });
            let cost = self.shifted(&x0);
            let found = definiteness(&cost.r)?;
            if found.ratio > best.0.ratio {
                best = (found, Some(x0), cost);
            }
        }
        let (found, x0, cost) = best;
        if found.definite { Ok((x0, cost)) } else { Err(RiccatiError::SingularInput { ratio: found.ratio }) }
    }
}

/// R⁺ Y of a symmetric R, eigenvalues below [`WELL_CONDITIONED`] of the largest taken as zero.
fn pseudo_solve(r: &Mat, y: &Mat) -> Result<Mat, RiccatiError> {
    let what = "the symmetric QR algorithm";
    let failed = |_| super::super::dense::LinalgError::NoConvergence { what, order: r.nrows() };
    let e = r.self_adjoint_eigen(faer::Side::Lower).map_err(failed)?;
    let (u, values) = (e.U(), e.S().column_vector());
    let largest = (0..r.nrows()).fold(0.0f64, |l, i| l.max(values[i].abs()));
    let mut turned = u.transpose() * y;
    for j in 0..turned.ncols() {
        for i in 0..turned.nrows() {
            let value = values[i];
            turned[(i, j)] = if value > WELL_CONDITIONED * largest { turned[(i, j)] / value } else { 0.0 };
        }
    }
    Ok(u * turned)
}
