//! Units out of the way: states and X scaled by powers of two, exactly.

use super::super::dense::Mat;

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
        let mut scaling = Self { d: vec![1.0; n], rho: matching(a.norm_l2(), g.norm_l2(), q.norm_l2()) };
        for _ in 0..SWEEPS {
            let mut changed = false;
            for i in 0..n {
                let (out_of, into) = scaling.weights(a, g, q, i);
                if !(out_of > 0.0 && into > 0.0 && (out_of / into).is_finite()) {
                    continue;
                }
                let f = power_of_two((into / out_of).sqrt());
                if f * out_of + into / f < WORTH_IT * (out_of + into) {
                    let new = scaling.d[i] * f;
                    if new.log2().abs() <= f64::from(LARGEST_EXPONENT) {
                        scaling.d[i] = new;
                        changed = true;
                    }
                }
            }
            let (sg, sq) = (scaling.g(g).norm_l2(), scaling.q(q).norm_l2());
            let f = matching(scaling.a(a).norm_l2(), sg, sq);
            if f.is_finite() && (scaling.rho * f).log2().abs() <= 2.0 * f64::from(LARGEST_EXPONENT) {
                scaling.rho *= f;
            }
            if !changed {
                break;
            }
        }
        scaling
    }

    /// Whether D = I.
    pub fn keeps_states(&self) -> bool {
        self.d.iter().all(|d| *d == 1.0)
    }

    /// What grows and what shrinks with dᵢ: column i of the Hamiltonian and its row i, without the diagonal.
    fn weights(&self, a: &Mat, g: &Mat, q: &Mat, i: usize) -> (f64, f64) {
        let (mut out_of, mut into) = (0.0, 0.0);
        let d = &self.d;
        for j in 0..d.len() {
            if j != i {
                out_of += a[(j, i)].abs() * (d[i] / d[j]);
                into += a[(i, j)].abs() * (d[j] / d[i]);
            }
            out_of += q[(j, i)].abs() * (d[i] * d[j] / self.rho);
            into += g[(j, i)].abs() * (self.rho / (d[i] * d[j]));
        }
        (out_of, into)
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

    /// F̃ D⁻¹ of u = F̃ x̃.
    pub fn gain(&self, f: &Mat) -> Mat {
        Mat::from_fn(f.nrows(), f.ncols(), |i, j| f[(i, j)] / self.d[j])
    }

    /// D S / ρ.
    pub fn s(&self, s: &Mat) -> Mat {
        Mat::from_fn(s.nrows(), s.ncols(), |i, j| s[(i, j)] * self.d[i] / self.rho)
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
