//! Units out of the way: states and X scaled by powers of two, exactly.

use super::super::dense::Mat;
use super::input::norm;

/// Sweeps of balancing; three are usual.
const SWEEPS: usize = 8;
/// A state is rescaled where that takes this factor off its row and column together: Parlett and Reinsch's .95.
const WORTH_IT: f64 = 0.95;
/// Exponents of a scale stay within ± this, so that squares neither overflow nor vanish.
const LARGEST_EXPONENT: i32 = 200;

/// x = D x̃ and X = ρ D⁻¹ X̃ D⁻¹.
#[derive(Debug, Clone)]
pub(super) struct Scaling {
    /// The diagonal of D.
    pub d: Vec<f64>,
    /// ρ.
    pub rho: f64,
}

impl Scaling {
    /// Balances the Hamiltonian [A −G; −Q −Aᵀ] by diag(D, D⁻¹), after ‖G‖ and ‖Q‖ are made equal by ρ.
    ///
    /// Source: Osborne (1960), Parlett and Reinsch (1969), kept symplectic as by Benner, *Symplectic balancing of
    /// Hamiltonian matrices*, SIAM J. Sci. Comput. 22 (2000).
    pub fn of(a: &Mat, g: &Mat, q: &Mat) -> Self {
        let n = a.nrows();
        let mut scaling = Self { d: vec![1.0; n], rho: matching(norm(a), norm(g), norm(q)) };
        // magnitudes, in the scaling so far
        let mut now = [a.clone(), scaling.g(g), scaling.q(q)];
        for _ in 0..SWEEPS {
            let mut changed = false;
            for i in 0..n {
                let (out_of, into) = weights(&now, i);
                let ratio = into / out_of;
                // rounds to 1, or has nothing to weigh against
                if (0.5..=2.0).contains(&ratio) || !(ratio > 0.0 && ratio.is_finite()) {
                    continue;
                }
                let f = power_of_two(ratio.sqrt());
                let new = scaling.d[i] * f;
                let within = new.log2().abs() <= f64::from(LARGEST_EXPONENT);
                if within && f * out_of + into / f < WORTH_IT * (out_of + into) {
                    scaling.d[i] = new;
                    rescale(&mut now, i, f);
                    changed = true;
                }
            }
            if !changed {
                break;
            }
            let [a, g, q] = &mut now;
            let f = matching(norm(a), norm(g), norm(q));
            if f != 1.0 && (scaling.rho * f).log2().abs() <= 2.0 * f64::from(LARGEST_EXPONENT) {
                scaling.rho *= f;
                *g *= faer::Scale(f);
                *q *= faer::Scale(1.0 / f);
            }
        }
        scaling
    }

    /// Whether D = I.
    pub fn keeps_states(&self) -> bool {
        self.d.iter().all(|d| *d == 1.0)
    }

    /// D⁻¹ A D.
    pub fn a(&self, a: &Mat) -> Mat {
        Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * (self.d[j] / self.d[i]))
    }

    /// ρ D⁻¹ G D⁻¹; X of X̃ too.
    pub fn g(&self, g: &Mat) -> Mat {
        Mat::from_fn(g.nrows(), g.ncols(), |i, j| g[(i, j)] / self.d[i] / self.d[j] * self.rho)
    }

    /// D Q D / ρ.
    pub fn q(&self, q: &Mat) -> Mat {
        Mat::from_fn(q.nrows(), q.ncols(), |i, j| q[(i, j)] * self.d[i] * self.d[j] / self.rho)
    }

    /// D⁻¹ B.
    pub fn b(&self, b: &Mat) -> Mat {
        Mat::from_fn(b.nrows(), b.ncols(), |i, j| b[(i, j)] / self.d[i])
    }

    /// H D.
    pub fn c(&self, h: &Mat) -> Mat {
        Mat::from_fn(h.nrows(), h.ncols(), |i, j| h[(i, j)] * self.d[j])
    }

    /// F̃ D⁻¹ of u = F̃ x̃.
    pub fn gain(&self, f: &Mat) -> Mat {
        Mat::from_fn(f.nrows(), f.ncols(), |i, j| f[(i, j)] / self.d[j])
    }

    /// D S / ρ.
    pub fn s(&self, s: &Mat) -> Mat {
        Mat::from_fn(s.nrows(), s.ncols(), |i, j| s[(i, j)] * self.d[i] / self.rho)
    }
}

/// What grows and what shrinks with dᵢ: column i of the Hamiltonian and its row i, without A's diagonal.
fn weights([a, g, q]: &[Mat; 3], i: usize) -> (f64, f64) {
    let sum = |column: &[f64]| column.iter().map(|v| v.abs()).sum::<f64>();
    let own = a[(i, i)].abs();
    let row: f64 = (0..a.ncols()).map(|j| a[(i, j)].abs()).sum();
    let out_of = sum(a.col_as_slice(i)) - own + sum(q.col_as_slice(i));
    (out_of.max(0.0), (row - own + sum(g.col_as_slice(i))).max(0.0))
}

/// dᵢ times f: A's column and Q's row and column grow, A's row and G's row and column shrink.
fn rescale([a, g, q]: &mut [Mat; 3], i: usize, f: f64) {
    for m in [&mut *a, &mut *q] {
        m.col_as_slice_mut(i).iter_mut().for_each(|v| *v *= f);
    }
    g.col_as_slice_mut(i).iter_mut().for_each(|v| *v /= f);
    for j in 0..a.ncols() {
        a[(i, j)] /= f;
        g[(i, j)] /= f;
        q[(i, j)] *= f;
    }
}

/// ρ that makes ρ‖G‖ and ‖Q‖/ρ equal, or the one of them that is not zero equal to ‖A‖.
fn matching(a: f64, g: f64, q: f64) -> f64 {
    let a = if a > 0.0 { a } else { 1.0 };
    let rho = match (g > 0.0, q > 0.0) {
        (true, true) => q.sqrt() / g.sqrt(),
        (true, false) => a / g,
        (false, true) => q / a,
        (false, false) => 1.0,
    };
    if rho > 0.0 && rho.is_finite() { power_of_two(rho) } else { 1.0 }
}

fn power_of_two(x: f64) -> f64 {
    x.log2().round().clamp(f64::from(-2 * LARGEST_EXPONENT), f64::from(2 * LARGEST_EXPONENT)).exp2()
}
