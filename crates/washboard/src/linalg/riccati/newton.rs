//! The true residual of a Riccati equation, and Newton's method on it.

use super::super::blocked;
use super::super::dense::{C64, LinalgError, Mat, solve};
use super::super::quasi_triangular::{Equation, Right, substitute};
use super::super::schur::RealSchur;
use super::input::{average, norm};

/// Factorisations of the closed loop at most; a good start needs one.
const ROUNDS: usize = 12;
/// Corrections on one factorisation.
const CORRECTIONS: usize = 2;
/// A correction that does not bring the residual below this part of what it was is the last.
const PROGRESS: f64 = 0.5;
/// At this many n ε the residual is rounding.
const ROUNDING: f64 = 0.25;
/// A change of X below this leaves the closed loop's factorisation and eigenvalues as they are.
const UNCHANGED: f64 = 1e-11;

/// A Riccati equation's data, in scaled states.
#[derive(Debug, Clone)]
pub(super) enum Problem {
    /// AᵀX + XA − XGX + Q = 0.
    Continuous {
        /// A, G and Q.
        a: Mat,
        g: Mat,
        q: Mat,
    },
    /// AᵀXA − X − (AᵀXB + S)(R + BᵀXB)⁻¹(BᵀXA + Sᵀ) + Q = 0.
    Discrete {
        /// A, B, Q, R and S.
        a: Mat,
        b: Mat,
        q: Mat,
        r: Mat,
        s: Mat,
    },
}

/// What an X leaves.
#[derive(Debug, Clone)]
pub(super) struct At {
    /// The equation's left-hand side.
    pub residual: Mat,
    /// Its norm.
    pub left: f64,
    /// The sum of the norms of its terms.
    pub terms: f64,
    /// The sum of the products of their factors' norms: what the residual's rounding goes with.
    pub products: f64,
    /// A − G X or A + B F.
    pub closed_loop: Mat,
    /// F of the discrete equation.
    pub gain: Option<Mat>,
}

impl At {
    /// ‖residual‖ over the sum of its terms' norms.
    pub fn scaled(&self) -> f64 {
        ratio(self.left, self.terms)
    }

    /// ‖residual‖ over the sum of the products of its factors' norms: of the order of ε where nothing is left to win.
    pub fn over_rounding(&self) -> f64 {
        ratio(self.left, self.products)
    }
}

fn ratio(norm: f64, scale: f64) -> f64 {
    if norm == 0.0 { 0.0 } else { norm / scale }
}

impl Problem {
    /// Residual, its scale and the closed loop at X.
    pub fn at(&self, x: &Mat) -> Result<At, LinalgError> {
        match self {
            Self::Continuous { a, g, q } => {
                let closed_loop = a - g * x;
                // XA + (XA)ᵀ − XGX + Q = X A_c + (X A)ᵀ + Q
                let (xa, xgx) = (x * a, x * (a - &closed_loop));
                let mut residual = &xa + xa.transpose() - &xgx + q;
                average(&mut residual);
                let (size, left) = (norm(x), norm(&residual));
                let linear = 2.0 * norm(a) * size + norm(q);
                let (terms, products) = (linear + norm(&xgx), linear + size * size * norm(g));
                Ok(At { residual, left, terms, products, closed_loop, gain: None })
            }
            Self::Discrete { a, b, q, r, s } => {
                let bx = b.transpose() * x;
                let cross = &bx * a + s.transpose();
                let gain = if b.ncols() == 0 { cross.clone() } else { -solve(&(r + &bx * b), &cross)? };
                let closed_loop = a + b * &gain;
                let (control, moved) = (cross.transpose() * &gain, a.transpose() * (x * a));
                let mut residual = &moved - x + &control + q;
                average(&mut residual);
                let size = norm(a);
                let linear = (size * size + 1.0) * norm(x) + norm(q);
                let (terms, products) = (linear + norm(&control), linear + norm(&cross) * norm(&gain));
                let left = norm(&residual);
                Ok(At { residual, left, terms, products, closed_loop, gain: Some(gain) })
            }
        }
    }

    /// The Lyapunov equation of its linearisation.
    pub fn equation(&self) -> Equation {
        match self {
            Self::Continuous { .. } => Equation::Continuous,
            Self::Discrete { .. } => Equation::Discrete,
        }
    }
}

/// The Schur form of A_cᵀ, on which A_cᵀ Y + Y A_c = W (or A_cᵀ Y A_c − Y = W) is solved.
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    pub equation: Equation,
    pub schur: RealSchur,
    /// The closed loop's.
    pub eigenvalues: Vec<C64>,
    /// max Re λ, or max |λ| − 1: negative where the closed loop is stable.
    pub margin: f64,
}

impl Linearised {
    pub fn of(equation: Equation, closed_loop: &Mat) -> Result<Self, LinalgError> {
        let schur = RealSchur::new(&closed_loop.transpose().to_owned())?;
        let eigenvalues = schur.eigenvalues();
        let size = |z: &C64| match equation {
            Equation::Continuous => z.re,
            Equation::Discrete => z.norm() - 1.0,
        };
        let margin = eigenvalues.iter().map(size).fold(f64::NEG_INFINITY, f64::max);
        Ok(Self { equation, schur, eigenvalues, margin })
    }

    /// Ỹ of Y = Z Ỹ Zᵀ, given W̃ = ZᵀWZ.
    pub fn solve_turned(&self, w: Mat) -> Mat {
        match self.equation {
            Equation::Continuous => {
                let mut y = w;
                let t = self.schur.t.as_ref();
                blocked::lyapunov(t, y.as_mut(), f64::EPSILON * t.norm_max());
                y
            }
            Equation::Discrete => {
                substitute(Equation::Discrete, &self.schur, Right::Transposed(&self.schur), &w)
            }
        }
    }

    /// Y.
    pub fn solve(&self, w: &Mat) -> Mat {
        let z = &self.schur.q;
        let mut turned = z.transpose() * w * z;
        average(&mut turned);
        let mut y = z * self.solve_turned(turned) * z.transpose();
        average(&mut y);
        y
    }
}

/// The best iterate of Newton's method.
#[derive(Debug, Clone)]
pub(super) struct Refined {
    pub x: Mat,
    pub at: At,
    pub linearised: Linearised,
    pub factorisations: usize,
}

/// Newton from a stabilising X₀: A_cᵀ D + D A_c = −residual, X ← X + D, as long as the residual falls.
///
/// On one factorisation several corrections are made (a chord method) before the closed loop is factored anew. Source:
/// Kleinman, *On an iterative technique for Riccati equation computations*, IEEE Trans. Autom. Control 13 (1968); Hewer
/// (1971) for the discrete one; Benner and Byers (1998) for the use as a correction.
pub(super) fn refine(problem: &Problem, x0: Mat) -> Result<Refined, LinalgError> {
    let (mut x, mut at) = (x0.clone(), problem.at(&x0)?);
    let rounding = ROUNDING * f64::EPSILON * x.nrows() as f64;
    let mut factorisations = 0;
    loop {
        let linearised = Linearised::of(problem.equation(), &at.closed_loop)?;
        factorisations += 1;
        let (start, mut moved) = (at.scaled(), 0.0f64);
        let corrections = if linearised.margin < 0.0 { CORRECTIONS } else { 0 };
        for _ in 0..corrections {
            let before = at.scaled();
            if before <= rounding {
                break;
            }
            let step = linearised.solve(&at.residual);
            let next = &x - &step;
            let Ok(found) = problem.at(&next) else { break };
            let after = found.scaled();
            if !(after < before) {
                break;
            }
            moved += norm(&step) / norm(&next).max(f64::MIN_POSITIVE);
            (x, at) = (next, found);
            if after > PROGRESS * before {
                break;
            }
        }
        let stuck = !(at.scaled() <= PROGRESS * start);
        if stuck || moved <= UNCHANGED || factorisations >= ROUNDS {
            let linearised = if moved > UNCHANGED {
                factorisations += 1;
                Linearised::of(problem.equation(), &at.closed_loop)?
            } else {
                linearised
            };
            return Ok(Refined { x, at, linearised, factorisations });
        }
    }
}
