//! Nesterov and Todd's scaling of a block: the point where slack and multiplier look alike.

use super::scalar::{MatOf, Real, cast, rounded, symmetric};
use crate::linalg::Mat;
use faer::Side;

/// Slack S and multiplier Z of a block, and G, H = G⁻ᵀ with G⁻¹SG⁻ᵀ = GᵀZG = Λ.
#[derive(Clone)]
pub(super) struct Scaled<T> {
    pub slack: MatOf<T>,
    pub multiplier: MatOf<T>,
    h: MatOf<T>,
    pub lambda: Vec<T>,
}

impl<T: Real> Scaled<T> {
    /// None where S or Z is not positive definite.
    ///
    /// With S = LLᵀ, Z = RRᵀ and RᵀL = UΛVᵀ, G = LVΛ^{−½} and H = RUΛ^{−½}. Where centred, RᵀL is near √μ times an
    /// orthogonal matrix: its singular vectors are asked of double precision, as they choose a basis and no number. S and
    /// Z are what directions move, so that neither feasibility hangs on GᵀH = I.
    pub fn new(slack: MatOf<T>, multiplier: MatOf<T>) -> Option<Self> {
        let n = slack.nrows();
        let (left, right) = (T::cholesky(slack.clone())?, T::cholesky(multiplier.clone())?);
        let product = T::product(right.transpose(), left.as_ref());
        let size = T::of(rounded(&product).norm_max());
        let scaled = MatOf::from_fn(n, n, |i, j| product[(i, j)] / size);
        let svd = rounded(&scaled).svd().ok()?;
        let u: MatOf<T> = cast(&svd.U().to_owned());
        let lambda: Vec<T> = svd.S().column_vector().iter().map(|s| T::of(*s) * size).collect();
        if !lambda.iter().all(|l| l.double() > 0.0 && l.double().is_finite()) {
            return None;
        }
        let root: Vec<T> = lambda.iter().map(|l| l.root()).collect();
        let over = |basis: &MatOf<T>| MatOf::from_fn(n, n, |i, j| basis[(i, j)] / root[j]);
        let h = T::product(right.as_ref(), over(&u).as_ref());
        Some(Scaled { slack, multiplier, h, lambda })
    }

    /// The same block with S and Z over a number.
    pub fn over(mut self, size: T) -> Self {
        let divided = |a: &MatOf<T>| MatOf::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] / size);
        (self.slack, self.multiplier) = (divided(&self.slack), divided(&self.multiplier));
        self.lambda.iter_mut().for_each(|l| *l /= size);
        self
    }

    /// HHᵀ, with which F_i•HHᵀF_jHHᵀ is the Schur complement.
    pub fn metric(&self) -> MatOf<T> {
        symmetric(&T::product(self.h.as_ref(), self.h.transpose()))
    }

    /// Hᵀ dS H, symmetric.
    pub fn inward(&self, ds: &MatOf<T>) -> MatOf<T> {
        symmetric(&T::product(self.h.transpose(), T::product(ds.as_ref(), self.h.as_ref()).as_ref()))
    }

    /// H dZ̃ Hᵀ, symmetric.
    pub fn outward(&self, dz: &MatOf<T>) -> MatOf<T> {
        symmetric(&T::product(T::product(self.h.as_ref(), dz.as_ref()).as_ref(), self.h.transpose()))
    }

    /// The longest step from Λ along a scaled direction: −1/min eig Λ^{−½} d Λ^{−½}.
    pub fn longest(&self, d: &MatOf<T>) -> f64 {
        let n = self.lambda.len();
        let l: Vec<f64> = self.lambda.iter().map(|v| v.double().sqrt()).collect();
        let scaled = Mat::from_fn(n, n, |i, j| d[(i, j)].double() / (l[i] * l[j]));
        let Ok(eigenvalues) = scaled.self_adjoint_eigenvalues(Side::Lower) else { return 0.0 };
        let least = eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
        if least.is_nan() {
            0.0
        } else if least >= 0.0 {
            f64::INFINITY
        } else {
            -1.0 / least
        }
    }

    /// The block at S + α dS and Z + α dZ; None where these are not positive definite.
    pub fn moved(&self, ds: &MatOf<T>, dz: &MatOf<T>, alpha: T) -> Option<Self> {
        let at = |a: &MatOf<T>, d: &MatOf<T>| {
            MatOf::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] + alpha * d[(i, j)])
        };
        Self::new(at(&self.slack, ds), at(&self.multiplier, dz))
    }
}
