//! Vector fitting of responses that are sums of delayed parts: common poles, residues a part.

use crate::linalg::{C64, LinalgError, Mat, eigen};
use faer::linalg::solvers::SolveLstsq;

/// Relocations of the poles.
const ROUNDS: usize = 15;
/// A relative motion of all poles below this ends the relocation.
const SETTLED: f64 = 1e-7;
/// What is known statically weighs as so many bins' root.
const STATIC_WEIGHT: f64 = 2.0;
/// Damping ratio of the poles that the relocation starts from.
const START_DAMPING: f64 = 0.2;

/// Responses at frequencies, and what to fit them by.
pub(super) struct Samples<'a> {
    /// ω, in scaled time.
    pub omega: &'a [f64],
    /// One response a sensor.
    pub values: &'a [Vec<C64>],
    /// Their weights.
    pub weights: &'a [Vec<f64>],
    /// e^{−iωτ} of each part.
    pub parts: &'a [Vec<C64>],
    /// What is known at ω = 0.
    pub statics: &'a [Static],
    /// Each part's own response is held small by this share of its weight.
    pub ridge: f64,
}

/// Σ_p height_p T_ip(0) = value_i, the parts without their delays.
pub(super) struct Static {
    /// Of each part.
    pub heights: Vec<f64>,
    /// Of each sensor.
    pub values: Vec<f64>,
}

/// Poles and residues: T_i(ω) ≈ Σ_p part_p(ω) Σ_n r_ipn/(iω − λ_n).
pub(super) struct Fit {
    /// Real poles, and of each complex pair the one with a positive imaginary part.
    pub poles: Vec<C64>,
    /// Coefficients of the real basis: \[sensor\]\[part · states + state\].
    pub coefficients: Vec<Vec<f64>>,
}

impl Samples<'_> {
    /// Fits `pairs` pairs of poles, started evenly over the logarithm of `band` (in scaled rad/s).
    ///
    /// (1 + Σ c_n/(s − a_n)) T_i = Σ_p part_p Σ r_ipn/(s − a_n) is solved in the least-squares sense for real c and r, with c
    /// alone kept of each response's QR; the zeros of the left factor are the next a. Its constant is free, with its mean over
    /// the band held at 1 (relaxed).
    ///
    /// Source: Gustavsen and Semlyen, IEEE Trans. Power Delivery 14 (1999) 1052–1061; Gustavsen, ibid. 21 (2006) 1587–1592;
    /// Deschrijver, Mrozowski, Dhaene, De Zutter, IEEE Microw. Wireless Compon. Lett. 18 (2008) 383–385.
    pub fn fit(&self, pairs: usize, band: [f64; 2]) -> Result<Fit, LinalgError> {
        let place = |k: usize| band[0] * (band[1] / band[0]).powf((k as f64 + 0.5) / pairs as f64);
        let turn = C64::new(-START_DAMPING, (1.0 - START_DAMPING * START_DAMPING).sqrt());
        let mut poles: Vec<C64> = (0..pairs).map(|k| turn * place(k)).collect();
        for _ in 0..ROUNDS {
            let next = self.relocated(&poles)?;
            let moved = poles.len() != next.len()
                || poles.iter().zip(&next).any(|(a, b)| (a - b).norm() > SETTLED * a.norm());
            poles = next;
            if !moved {
                break;
            }
        }
        let coefficients = (0..self.values.len()).map(|i| self.residues(&poles, i)).collect();
        Ok(Fit { poles, coefficients })
    }

    fn relocated(&self, poles: &[C64]) -> Result<Vec<C64>, LinalgError> {
        let phi = self.basis(poles);
        let phi_0 = at_rest(poles);
        let (states, parts, rows) = (order(poles), self.parts.len(), self.omega.len());
        let (known, wide) = (parts * states, parts * states + states + 1);
        let count = states + 1;
        let mut stacked = Mat::zeros(self.values.len() * count + 1, count);
        let mut size = 0.0;
        for (i, (values, weights)) in self.values.iter().zip(self.weights).enumerate() {
            let entry = |k: usize, j: usize| -> C64 {
                let w = weights[k];
                match j {
                    j if j < known => phi[k][j % states] * self.parts[j / states][k] * w,
                    j if j < known + states => -values[k] * phi[k][j - known] * w,
                    _ => -values[k] * w,
                }
            };
            let still = |known_at: &Static, j: usize| -> f64 {
                STATIC_WEIGHT
                    * match j {
                        j if j < known => known_at.heights[j / states] * phi_0[j % states],
                        j if j < known + states => -known_at.values[i] * phi_0[j - known],
                        _ => -known_at.values[i],
                    }
            };
            let (ridge, fixed) = (self.ridge(&phi, i), 2 * rows + self.statics.len());
            let system = Mat::from_fn(fixed + known, wide, |r, j| {
                if r >= fixed {
                    return ridge_entry(&ridge, r - fixed, j);
                }
                if r >= 2 * rows {
                    return still(&self.statics[r - 2 * rows], j);
                }
                let z = entry(r % rows, j);
                if r < rows { z.re } else { z.im }
            });
            let r = system.qr().thin_R().to_owned();
            for a in 0..count {
                for b in a..count {
                    stacked[(i * count + a, b)] = r[(known + a, known + b)];
                }
            }
            size += (0..rows).map(|k| (values[k] * weights[k]).norm_sqr()).sum::<f64>();
        }
        // Re Σ_k σ(ω_k) = bins, weighted as much as all responses
        let last = self.values.len() * count;
        let weight = size.sqrt() / rows as f64;
        for b in 0..count {
            stacked[(last, b)] =
                weight * if b < states { phi.iter().map(|p| p[b].re).sum::<f64>() } else { rows as f64 };
        }
        let right = Mat::from_fn(last + 1, 1, |i, _| if i == last { weight * rows as f64 } else { 0.0 });
        let scale: Vec<f64> = (0..count).map(|b| stacked.col(b).norm_l2().max(f64::MIN_POSITIVE)).collect();
        let scaled = Mat::from_fn(last + 1, count, |i, b| stacked[(i, b)] / scale[b]);
        let solution = scaled.col_piv_qr().solve_lstsq(&right);
        let sigma: Vec<f64> = (0..count).map(|b| solution[(b, 0)] / scale[b]).collect();
        // zeros of σ: the eigenvalues of A − b cᵀ/d
        let d = sigma[states];
        if !(d.abs() > 1e-8 && d.is_finite()) {
            return Err(LinalgError::Singular {
                what: "vector fitting", why: "σ has no constant", value: d
            });
        }
        let (a, b) = realization(poles);
        let zeros = Mat::from_fn(states, states, |i, j| a[(i, j)] - b[i] * sigma[j] / d);
        let mut next: Vec<C64> = eigen(&zeros)?
            .0
            .into_iter()
            .filter(|z| z.im >= 0.0)
            .map(|z| C64::new(-z.re.abs().max(1e-3 * z.norm()), z.im))
            .collect();
        next.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        Ok(next)
    }

    fn residues(&self, poles: &[C64], i: usize) -> Vec<f64> {
        let phi = self.basis(poles);
        let (states, rows) = (order(poles), self.omega.len());
        let wide = self.parts.len() * states;
        let phi_0 = at_rest(poles);
        let (ridge, fixed) = (self.ridge(&phi, i), 2 * rows + self.statics.len());
        let total = fixed + wide;
        let system = Mat::from_fn(total, wide, |r, j| {
            if r >= fixed {
                return ridge_entry(&ridge, r - fixed, j);
            }
            if r >= 2 * rows {
                return STATIC_WEIGHT * self.statics[r - 2 * rows].heights[j / states] * phi_0[j % states];
            }
            let k = r % rows;
            let z: C64 = phi[k][j % states] * self.parts[j / states][k] * self.weights[i][k];
            if r < rows { z.re } else { z.im }
        });
        let right = Mat::from_fn(total, 1, |r, _| {
            if r >= fixed {
                return 0.0;
            }
            if r >= 2 * rows {
                return STATIC_WEIGHT * self.statics[r - 2 * rows].values[i];
            }
            let z: C64 = self.values[i][r % rows] * self.weights[i][r % rows];
            if r < rows { z.re } else { z.im }
        });
        let scale: Vec<f64> = (0..wide).map(|b| system.col(b).norm_l2().max(f64::MIN_POSITIVE)).collect();
        let scaled = Mat::from_fn(total, wide, |r, b| system[(r, b)] / scale[b]);
        let solution = scaled.col_piv_qr().solve_lstsq(&right);
        (0..wide).map(|b| solution[(b, 0)] / scale[b]).collect()
    }

    /// R with |R r| the size of a part's weighted response, times the ridge.
    fn ridge(&self, phi: &[Vec<C64>], i: usize) -> Mat {
        let rows = phi.len();
        let weighted = Mat::from_fn(2 * rows, phi.first().map_or(0, Vec::len), |r, j| {
            let z: C64 = phi[r % rows][j] * (self.ridge * self.weights[i][r % rows]);
            if r < rows { z.re } else { z.im }
        });
        weighted.qr().thin_R().to_owned()
    }

    /// 1/(s − a) of a real pole; of a pair the sum of both fractions, and i times their difference.
    fn basis(&self, poles: &[C64]) -> Vec<Vec<C64>> {
        self.omega.iter().map(|omega| basis(poles, *omega)).collect()
    }
}

fn basis(poles: &[C64], omega: f64) -> Vec<C64> {
    let s = C64::new(0.0, omega);
    let mut row = Vec::with_capacity(order(poles));
    for a in poles {
        let near = (s - a).inv();
        if a.im > 0.0 {
            let far = (s - a.conj()).inv();
            row.extend([near + far, (near - far) * C64::new(0.0, 1.0)]);
        } else {
            row.push(near);
        }
    }
    row
}

/// Entry of the ridge's rows, one triangle a part, in the columns of the parts.
fn ridge_entry(triangle: &Mat, row: usize, column: usize) -> f64 {
    let n = triangle.ncols();
    if row / n == column / n && row % n <= column % n { triangle[(row % n, column % n)] } else { 0.0 }
}

/// The basis at ω = 0, which is real.
fn at_rest(poles: &[C64]) -> Vec<f64> {
    basis(poles, 0.0).iter().map(|z| z.re).collect()
}

/// States of a list of poles.
pub(super) fn order(poles: &[C64]) -> usize {
    poles.iter().map(|p| if p.im > 0.0 { 2 } else { 1 }).sum()
}

/// A and b with Σ_n c_n φ_n(s) = cᵀ(sI − A)⁻¹b.
pub(super) fn realization(poles: &[C64]) -> (Mat, Vec<f64>) {
    let n = order(poles);
    let (mut a, mut b, mut at) = (Mat::zeros(n, n), vec![0.0; n], 0);
    for p in poles {
        a[(at, at)] = p.re;
        if p.im > 0.0 {
            (a[(at, at + 1)], a[(at + 1, at)], a[(at + 1, at + 1)]) = (p.im, -p.im, p.re);
            b[at] = 2.0;
            at += 2;
        } else {
            b[at] = 1.0;
            at += 1;
        }
    }
    (a, b)
}
