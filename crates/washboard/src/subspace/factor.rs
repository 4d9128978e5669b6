//! The spectral factor of S(z) = E + C(zI − A)⁻¹F + its mirror image: stable, minimum phase, and checked against S.

use super::SubspaceError;
use super::summand::Summand;
use crate::linalg::{C64, LinalgError, Mat, RiccatiError, dare, discrete_lyapunov_factor};
use crate::lti::{Discrete, StateSpace};

/// |G G~ − S| over the largest |S| at the angles that are checked.
const VERIFIED: f64 = 1e-9;

/// States whose Hankel singular value is below this share of the largest are left as they are.
const HARDLY_THERE: f64 = 1e-12;

/// G(z) = C(zI − A)⁻¹B + D with G(z)Gᵀ(1/z) = S(z).
#[derive(Debug, Clone)]
pub struct SpectralFactor {
    /// G, stable, with zeros inside the unit circle.
    pub system: StateSpace<Discrete>,
    /// Zeros of G: eigenvalues of A − BD⁻¹C.
    pub zeros: Vec<C64>,
    /// Largest |G G~ − S| over the angles that were checked, as a share of the largest |S|.
    pub error: f64,
}

/// The minimum-phase factor, from the stabilising P of P = APAᵀ + (F − APCᵀ)(E − CPCᵀ)⁻¹(F − APCᵀ)ᵀ:
/// DDᵀ = E − CPCᵀ (D lower triangular), B = (F − APCᵀ)D⁻ᵀ; then G G~ is compared with S at `angles`.
///
/// # Errors
/// A spectrum that is not positive on the whole circle has no such P; a factor that does not give S back.
///
/// Source: (2.81)–(2.83) of the thesis; the equation is solved as the control equation of (Aᵀ, Cᵀ, 0, E, F) for −P.
pub fn spectral_factor(s: &Summand, dt_s: f64, angles: &[f64]) -> Result<SpectralFactor, SubspaceError> {
    let given = s;
    let s = &balanced(s)?;
    let (n, m) = (s.a.nrows(), s.c.nrows());
    let (at, ct) = (s.a.transpose().to_owned(), s.c.transpose().to_owned());
    let solution = dare(&at, &ct, &Mat::zeros(n, n), &s.e, Some(&s.f))?;
    let p = -&solution.x;
    let apc = &s.a * &p * s.c.transpose();
    let inner = &s.e - &s.c * &p * s.c.transpose();
    let even = Mat::from_fn(m, m, |i, j| 0.5 * (inner[(i, j)] + inner[(j, i)]));
    let Ok(root) = even.llt(faer::Side::Lower) else {
        return Err(RiccatiError::SingularInput { ratio: 0.0 }.into());
    };
    let d = root.L().to_owned();
    let mut bt = (&s.f - apc).transpose().to_owned();
    d.as_ref().solve_lower_triangular_in_place(bt.as_mut());
    let b = bt.transpose().to_owned();
    let system = StateSpace::discrete(s.a.clone(), b, s.c.clone(), d, dt_s)?;
    let error = mismatch(given, &system, angles)?;
    if !(error < VERIFIED) {
        return Err(SubspaceError::Unverified { relative: error, limit: VERIFIED });
    }
    Ok(SpectralFactor { system, zeros: solution.closed_loop_eigenvalues, error })
}

/// The same half in balanced states, its Gramians alike and diagonal: the equation's terms are then as large as S needs them.
/// As it is, where states are hardly in S.
fn balanced(s: &Summand) -> Result<Summand, SubspaceError> {
    let n = s.a.nrows();
    let reach = discrete_lyapunov_factor(&s.a, &s.f)?;
    let sight = discrete_lyapunov_factor(&s.a.transpose().to_owned(), &s.c.transpose().to_owned())?;
    let product = sight.transpose() * &reach;
    let svd = product.svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: n })?;
    if n == 0 || !(svd.S()[n - 1] > HARDLY_THERE * svd.S()[0]) {
        return Ok(s.clone());
    }
    let root = |k: usize| svd.S()[k].sqrt();
    let to = &reach * svd.V();
    let to = Mat::from_fn(n, n, |i, j| to[(i, j)] / root(j));
    let from = svd.U().transpose() * sight.transpose();
    let from = Mat::from_fn(n, n, |i, j| from[(i, j)] / root(i));
    Ok(Summand { a: &from * &s.a * &to, c: &s.c * &to, f: &from * &s.f, e: s.e.clone(), folded: s.folded })
}

fn mismatch(s: &Summand, g: &StateSpace<Discrete>, angles: &[f64]) -> Result<f64, SubspaceError> {
    let (mut largest, mut worst) = (0.0f64, 0.0f64);
    for theta in angles {
        let known = s.at(*theta)?;
        let h = g.at(C64::from_polar(1.0, *theta))?;
        let found = &h * h.adjoint();
        largest = largest.max(known.norm_max());
        worst = worst.max((found - known).norm_max());
    }
    if largest > 0.0 {
        return Ok(worst / largest);
    }
    Err(LinalgError::NotFinite { name: "S", row: 0, col: 0, value: largest }.into())
}
