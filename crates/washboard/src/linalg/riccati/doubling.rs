//! The structure-preserving doubling algorithm: n × n products and one LU a step, quadratic convergence.

use super::super::dense::Mat;
use super::input::average;
use super::lu::Lu;
use faer::linalg::matmul::matmul;
use faer::{Accum, Par};

/// Steps before it gives up: 2⁴⁰ samples. A solution on the boundary converges by a bit a step and ends here.
const STEPS: usize = 40;
/// The next step's change is about the square of this one's: below this the last step was the last that counts.
const CONVERGED: f64 = 1e-8;
/// A growth of the iterates beyond this is a divergence.
const DIVERGED: f64 = 1e100;
/// Of the shift's A − γI the smallest pivot over the largest: above the first no other shift is tried, below the
/// second none is sound.
const GOOD_PIVOT: f64 = 1e-3;
const SMALLEST_PIVOT: f64 = 1e-10;
/// Other shifts, over the mean rate.
const OTHER_SHIFTS: [f64; 5] = [1.7, 0.55, 3.1, 0.3, 6.0];

/// X = Aᵀ X (I + G X)⁻¹ A + H: what doubling solves, and its iterates (A_k, G_k, H_k).
#[derive(Debug, Clone)]
pub(super) struct Doubling {
    pub a: Mat,
    pub g: Mat,
    pub h: Mat,
    /// LU factorisations so far, 2n × 2n ones counted 8.
    pub factorisations: usize,
}

impl Doubling {
    /// The Cayley transform of AᵀX + XA − XGX + Q = 0, with the same X; none where no shift is sound.
    ///
    /// A_γ = A − γI, W = A_γᵀ + Q A_γ⁻¹ G; Â = I + 2γ W⁻ᵀ, Ĝ = 2γ A_γ⁻¹ G W⁻¹, Ĥ = 2γ W⁻¹ Q A_γ⁻¹.
    ///
    /// γ is the geometric mean of |λ| of the Hamiltonian, that is |det|^{1/2n}: of rates from slow to fast the middle.
    ///
    /// Source: Chu, Fan and Lin, *A structure-preserving doubling algorithm for continuous-time algebraic Riccati
    /// equations*, Linear Algebra Appl. 396 (2005), eq. (2.6).
    pub fn cayley(a: &Mat, g: &Mat, q: &Mat) -> Option<Self> {
        let n = a.nrows();
        let mean = mean_rate(a, g, q);
        let mut factorisations = 8;
        let (mut lu, mut lu_w) = (Lu::new(n, n), Lu::new(n, n));
        let mut pivots = |gamma: f64| {
            lu.matrix().copy_from(a);
            (0..n).for_each(|i| lu.matrix()[(i, i)] -= gamma);
            lu.factor();
            factorisations += 1;
            let (least, largest) = lu.pivots().fold((f64::MAX, 0.0f64), |(l, h), p| (l.min(p), h.max(p)));
            least / largest
        };
        // an eigenvalue of an unstable A near γ costs as many digits as the pivots say
        let (mut gamma, mut best) = (mean, pivots(mean));
        if !(best > GOOD_PIVOT) {
            for other in OTHER_SHIFTS.map(|f| f * mean) {
                let found = pivots(other);
                if found > best || best.is_nan() {
                    (gamma, best) = (other, found);
                }
            }
            pivots(gamma);
        }
        if !(best > SMALLEST_PIVOT) {
            return None;
        }
        let mut inverse_g = g.clone(); // A_γ⁻¹ G
        lu.solve(inverse_g.as_mut());
        let w = lu_w.matrix();
        w.copy_from(a.transpose());
        (0..n).for_each(|i| w[(i, i)] -= gamma);
        matmul(&mut *w, Accum::Add, q, &inverse_g, 1.0, Par::Seq);
        lu_w.factor();
        factorisations += 1;
        let scale = 2.0 * gamma;
        // the transform is 2γ W⁻¹ itself
        let mut inverse = Mat::zeros(n, n);
        (0..n).for_each(|i| inverse[(i, i)] = scale);
        lu_w.solve(inverse.as_mut());
        // Ĥ = (A_γ⁻ᵀ (2γ W⁻¹ Q)ᵀ)ᵀ and symmetric
        let mut h = Mat::zeros(n, n);
        matmul(&mut h, Accum::Replace, q, inverse.transpose(), 1.0, Par::Seq);
        lu.solve_transposed(h.as_mut());
        let mut g_hat = &inverse_g * &inverse;
        average(&mut h);
        average(&mut g_hat);
        inverse_g.copy_from(inverse.transpose());
        let mut a_hat = inverse_g;
        (0..n).for_each(|i| a_hat[(i, i)] += 1.0);
        let size = a_hat.norm_max() + h.norm_max() + g_hat.norm_max();
        (size.is_finite() && size < DIVERGED).then_some(Self { a: a_hat, g: g_hat, h, factorisations })
    }

    /// H_k to convergence, which is X; none where it diverges.
    ///
    /// A ← A (I + GH)⁻¹ A, G ← G + A (I + GH)⁻¹ G Aᵀ, H ← H + Aᵀ H (I + GH)⁻¹ A.
    ///
    /// Source: Chu, Fan, Lin and Wang, *Structure-preserving algorithms for periodic discrete-time algebraic Riccati
    /// equations*, Int. J. Control 77 (2004), algorithm 3.
    pub fn run(mut self) -> Option<(Mat, usize)> {
        let n = self.a.nrows();
        let (mut w, mut ha) = (Mat::zeros(n, n), Mat::zeros(n, n));
        let (mut both, mut turned) = (Mat::zeros(n, 2 * n), Mat::zeros(n, 2 * n));
        let mut lu = Lu::new(n, 2 * n);
        for _ in 0..STEPS {
            let Self { a, g, h, factorisations } = &mut self;
            matmul(lu.matrix(), Accum::Replace, &*g, &*h, 1.0, Par::Seq);
            (0..n).for_each(|i| lu.matrix()[(i, i)] += 1.0);
            both.subcols_mut(0, n).copy_from(&*a);
            both.subcols_mut(n, n).copy_from(&*g);
            lu.factor();
            *factorisations += 1;
            lu.solve(both.as_mut());
            // A [V₁ V₂], and H A before A changes
            matmul(&mut turned, Accum::Replace, &*a, &both, 1.0, Par::Seq);
            matmul(&mut ha, Accum::Replace, &*h, &*a, 1.0, Par::Seq);
            matmul(&mut *g, Accum::Add, turned.subcols(n, n), a.transpose(), 1.0, Par::Seq);
            let v1 = both.subcols(0, n);
            matmul(&mut w, Accum::Replace, v1.transpose(), &ha, 1.0, Par::Seq);
            average(&mut w);
            average(g);
            *h += &w;
            a.copy_from(turned.subcols(0, n));
            let (change, size) = (w.norm_max(), h.norm_max());
            if !(size < DIVERGED && a.norm_max() < DIVERGED && g.norm_max() < DIVERGED) {
                return None;
            }
            if change <= CONVERGED * size {
                return Some((self.h, self.factorisations));
            }
        }
        None
    }
}

/// |det [A −G; −Q −Aᵀ]|^{1/2n}, with pivots below ε of the largest taken as that.
fn mean_rate(a: &Mat, g: &Mat, q: &Mat) -> f64 {
    let n = a.nrows();
    let mut lu = Lu::new(2 * n, 0);
    *lu.matrix() = hamiltonian(a, g, q);
    lu.factor();
    let largest = lu.pivots().fold(0.0f64, f64::max);
    let floor = (f64::EPSILON * largest).max(f64::MIN_POSITIVE);
    let sum: f64 = lu.pivots().map(|p| p.max(floor).log2()).sum();
    let mean = (sum / (2 * n) as f64).exp2();
    if mean.is_finite() { mean } else { 1.0 }
}

/// [A −G; −Q −Aᵀ].
pub(super) fn hamiltonian(a: &Mat, g: &Mat, q: &Mat) -> Mat {
    let n = a.nrows();
    Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) => a[(i, j)],
        (true, false) => -g[(i, j - n)],
        (false, true) => -q[(i - n, j)],
        (false, false) => -a[(j - n, i - n)],
    })
}
