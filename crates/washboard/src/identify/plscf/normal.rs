//! The reduced normal equations of S⁺A ≈ B, accumulated once at the highest order.

use super::spectra::Lines;
use crate::identify::operational::OperationalError;
use crate::linalg::{C64, LinalgError, Mat};

/// A pivot of the numerator's Gram matrix below this part of its diagonal has lost all digits: lines that cover too
/// little of the circle can't tell so high an order.
const PIVOT: f64 = 1e-12;

/// Sums over lines, and the numerator's Cholesky factor.
///
/// With the monomials Ω_j = z^j: R = Re Σ Ωᴴ Ω, S_o = −Re Σ Ωᴴ (Ω ⊗ S⁺_o), T = Re Σ_o Σ (Ω ⊗ S⁺_o)ᴴ (Ω ⊗ S⁺_o), all of
/// them Toeplitz in the powers.
pub(super) struct NormalEquations {
    /// Outputs.
    pub outputs: usize,
    /// References, the size of a coefficient.
    pub references: usize,
    /// L of R = L Lᵀ.
    factor: Mat,
    /// Y_o = L⁻¹ S_o, one below the other by power: row (j, o) = j · outputs + o.
    y: Mat,
    /// T by the difference of powers, from −n to n.
    t: Vec<Mat>,
    max_order: usize,
}

impl NormalEquations {
    /// Of these lines, up to `order` or as far as the lines can tell.
    pub fn new(lines: &Lines, order: usize) -> Result<Self, OperationalError> {
        let (l, m) = (lines.outputs, lines.references);
        let sums = Sums::new(lines, order);
        let gram = |j: usize, k: usize| sums.r[order + k - j];
        let (factor, size) = cholesky(order + 1, gram);
        let Some(max_order) = size.checked_sub(1) else {
            return Err(
                LinalgError::Singular { what: "the lines", why: "no line has weight", value: 0.0 }.into()
            );
        };
        // forward substitution, each output and column alone
        let mut y = Mat::zeros(size * l, size * m);
        for column in 0..size * m {
            let (k, b) = (column / m, column % m);
            for o in 0..l {
                for j in 0..size {
                    let known: f64 = (0..j).map(|i| factor[(j, i)] * y[(i * l + o, column)]).sum();
                    y[(j * l + o, column)] = (sums.s[order + k - j][(o, b)] - known) / factor[(j, j)];
                }
            }
        }
        let t = sums.t[order - max_order..=order + max_order].to_vec();
        Ok(Self { outputs: l, references: m, factor, y, t, max_order })
    }

    /// The highest order that the lines can tell, at most the one asked for.
    pub fn max_order(&self) -> usize {
        self.max_order
    }

    /// M = T − Σ_o S_oᵀ R⁻¹ S_o of an order: (n + 1)m square, by the power.
    pub fn reduced(&self, order: usize) -> Mat {
        let (l, m) = (self.outputs, self.references);
        let y = self.y.submatrix(0, 0, (order + 1) * l, (order + 1) * m);
        let eliminated = y.transpose() * y;
        let size = (order + 1) * m;
        Mat::from_fn(size, size, |i, j| {
            self.t[self.max_order + j / m - i / m][(i % m, j % m)] - eliminated[(i, j)]
        })
    }

    /// The numerator's coefficients of a denominator's α ((n + 1)m × m): B_j as outputs × m, j = 0 … n.
    ///
    /// β_o = −R⁻¹ S_o α = −L⁻ᵀ Y_o α
    pub fn numerator(&self, order: usize, alpha: &Mat) -> Vec<Mat> {
        let (l, m) = (self.outputs, self.references);
        let mut b = -(self.y.submatrix(0, 0, (order + 1) * l, (order + 1) * m) * alpha);
        for j in (0..=order).rev() {
            for (o, c) in (0..l * m).map(|oc| (oc / m, oc % m)) {
                let known: f64 = (j + 1..=order).map(|i| self.factor[(i, j)] * b[(i * l + o, c)]).sum();
                b[(j * l + o, c)] = (b[(j * l + o, c)] - known) / self.factor[(j, j)];
            }
        }
        (0..=order).map(|j| b.subrows(j * l, l).to_owned()).collect()
    }
}

/// The sums by the difference d of powers, from −n to n.
struct Sums {
    r: Vec<f64>,
    s: Vec<Mat>,
    t: Vec<Mat>,
}

impl Sums {
    fn new(lines: &Lines, order: usize) -> Self {
        let (l, m) = (lines.outputs, lines.references);
        let count = 2 * order + 1;
        let (mut r, mut s, mut t) =
            (vec![0.0; count], vec![Mat::zeros(l, m); count], vec![Mat::zeros(m, m); count]);
        for ((z, weight), v) in lines.z.iter().zip(&lines.weight).zip(&lines.values) {
            // Σ_o conj(S_oa) S_ob
            let mut square = vec![C64::new(0.0, 0.0); m * m];
            for row in v.chunks(m) {
                for (ab, sum) in square.iter_mut().enumerate() {
                    *sum += row[ab / m].conj() * row[ab % m];
                }
            }
            let mut turn = z.conj().powu(order as u32) * *weight;
            for d in 0..count {
                r[d] += turn.re;
                for b in 0..m {
                    for o in 0..l {
                        s[d][(o, b)] -= (turn * v[o * m + b]).re;
                    }
                    for a in 0..m {
                        t[d][(a, b)] += (turn * square[a * m + b]).re;
                    }
                }
                turn *= z;
            }
        }
        Self { r, s, t }
    }
}

/// L of a symmetric matrix, as far as its pivots are worth something, and how far that is.
fn cholesky(size: usize, entry: impl Fn(usize, usize) -> f64) -> (Mat, usize) {
    let mut factor = Mat::zeros(size, size);
    for j in 0..size {
        for i in 0..=j {
            let known: f64 = (0..i).map(|k| factor[(j, k)] * factor[(i, k)]).sum();
            let rest = entry(i, j) - known;
            if i < j {
                factor[(j, i)] = rest / factor[(i, i)];
            } else if rest > PIVOT * entry(j, j) {
                factor[(j, j)] = rest.sqrt();
            } else {
                return (factor, j);
            }
        }
    }
    (factor, size)
}
