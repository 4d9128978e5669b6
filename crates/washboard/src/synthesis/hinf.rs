//! The H∞ controller of full order: bisection on the level, two Riccati equations a level.

use super::h2::symmetric;
use super::{SynthesisError, broken_assumptions};
use crate::linalg::{LinalgError, Mat, care_g, solve, symmetric_eigenvalues};
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};

/// Halvings of the level, at most.
const MOST_LEVELS: usize = 80;
/// X and Y may have eigenvalues this far below zero, as a share of the largest: rounding.
const SEMIDEFINITE: f64 = 1e-9;
/// The controller is taken this far above the least level, then further, until its own norm confirms it.
const BACK_OFF: [f64; 6] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];

/// What the search is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HinfSettings {
    /// The level is found to this share.
    pub tolerance: f64,
    /// Where to start: a level that is surely enough is found from here by doubling.
    pub first_level: f64,
}

impl Default for HinfSettings {
    fn default() -> Self {
        HinfSettings { tolerance: 1e-7, first_level: 1.0 }
    }
}

/// An H∞ controller.
#[derive(Debug, Clone)]
pub struct HinfDesign {
    /// K, of the plant's order.
    pub controller: StateSpace<Continuous>,
    /// The least level: no controller has a smaller norm, to the tolerance.
    pub gamma: f64,
    /// The level that the controller was made for, a little above.
    pub level: f64,
    /// The closed loop's own norm, recomputed from plant and controller.
    pub achieved: f64,
    /// Levels that were looked at.
    pub levels: usize,
}

/// The controller whose ‖T_zw‖∞ is as small as can be, to a tolerance.
///
/// At a level γ there is one exactly where the two Riccati equations of Glover and Doyle have stabilising solutions
/// X ≥ 0 and Y ≥ 0 with ρ(XY) < γ²; γ is bisected, the central controller is taken just above the least level and its
/// closed loop measured: what its own norm does not confirm is not returned.
///
/// D₁₁ and D₂₂ may be any; D₁₂ and D₂₁ are brought to [0; I] and [0 I] by orthogonal matrices and scalings.
///
/// # Errors
/// Every assumption that the plant breaks (see [`broken_assumptions`]); no level up to 1e12 of the first one; a closed
/// loop that contradicts its level.
///
/// Source: Glover and Doyle, Syst. Control Lett. 11 (1988) 167–172; Zhou, Doyle, Glover, *Robust and Optimal Control*,
/// theorem 17.1.
pub fn hinf(plant: &GeneralizedPlant, settings: &HinfSettings) -> Result<HinfDesign, SynthesisError> {
    let broken = broken_assumptions(plant)?;
    if !broken.is_empty() {
        return Err(SynthesisError::Assumptions(broken));
    }
    let normal = Normal::of(plant)?;
    let mut levels = 0;
    let mut feasible = |gamma: f64| {
        levels += 1;
        normal.solve(gamma)
    };
    let (mut low, mut high) = (0.0, settings.first_level.max(f64::MIN_POSITIVE));
    let mut why = String::new();
    let mut found = false;
    for _ in 0..MOST_LEVELS {
        match feasible(high) {
            Ok(_) => {
                found = true;
                break;
            }
            Err(e) => {
                why = e;
                low = high;
                high *= 4.0;
            }
        }
        if high > 1e12 * settings.first_level {
            break;
        }
    }
    if !found {
        return Err(SynthesisError::NoLevel { level: low, why });
    }
    for _ in 0..MOST_LEVELS {
        if high - low <= settings.tolerance * high {
            break;
        }
        // levels are scale-free: the geometric mean, once there is a lower one
        let middle = if low > 0.0 { (low * high).sqrt() } else { high / 16.0 };
        if feasible(middle).is_ok() {
            high = middle
        } else {
            low = middle
        }
        if high < 1e-12 * settings.first_level {
            break;
        }
    }
    let gamma = high;
    let mut last = SynthesisError::NoLevel { level: gamma, why: "no controller near it is confirmed".into() };
    for more in BACK_OFF {
        let level = gamma * (1.0 + more);
        levels += 1;
        let Ok(controller) = normal.solve(level).and_then(|s| normal.controller(&s)) else { continue };
        let measured = plant.close(&controller).and_then(|closed| closed.hinf_norm());
        match measured {
            Ok(norm) if norm.norm <= level * (1.0 + settings.tolerance.max(1e-6)) => {
                return Ok(HinfDesign { controller, gamma, level, achieved: norm.norm, levels });
            }
            Ok(norm) => {
                last = SynthesisError::Refused { what: "the H∞ norm", claimed: level, found: norm.norm };
            }
            Err(e) => last = e.into(),
        }
    }
    Err(last)
}

/// The plant with D₁₂ = [0; I], D₂₁ = [0 I] and D₂₂ = 0, and the way back.
struct Normal {
    a: Mat,
    b: Mat,
    c: Mat,
    d11: Mat,
    sizes: Sizes,
    /// u = `u_scale` ũ, ỹ = `y_scale` y.
    u_scale: Mat,
    y_scale: Mat,
    d22: Mat,
}

#[derive(Clone, Copy)]
struct Sizes {
    w1: usize,
    u: usize,
    z1: usize,
    y: usize,
}

/// The two solutions at a level, and what the central controller is made of.
struct Solved {
    gamma: f64,
    f: Mat,
    l: Mat,
    z: Mat,
}

impl Normal {
    fn of(plant: &GeneralizedPlant) -> Result<Self, SynthesisError> {
        let balanced = plant.system().balanced_scales()?.0;
        let p = GeneralizedPlant::new(balanced, plant.signals().clone())?;
        // D₁₂ = [Q₀ Q₁]·[0; T]: z̃ = [Q₀ Q₁]ᵀz with the weighted part last, ũ = T u
        let (turn_z, t_u) = last_block(&p.d12());
        let (turn_w, t_y) = last_block(&p.d21().transpose().to_owned());
        let u_scale = solve(&t_u, &Mat::identity(p.nu(), p.nu()))?;
        let y_scale = solve(&t_y, &Mat::identity(p.ny(), p.ny()))?.transpose().to_owned();
        let (b1, b2) = (p.b1() * &turn_w, p.b2() * &u_scale);
        let (c1, c2) = (turn_z.transpose() * p.c1(), &y_scale * p.c2());
        let n = p.order();
        let b = Mat::from_fn(
            n,
            p.nw() + p.nu(),
            |i, j| {
                if j < p.nw() { b1[(i, j)] } else { b2[(i, j - p.nw())] }
            },
        );
        let c = Mat::from_fn(
            p.nz() + p.ny(),
            n,
            |i, j| if i < p.nz() { c1[(i, j)] } else { c2[(i - p.nz(), j)] },
        );
        let d11 = turn_z.transpose() * p.d11() * &turn_w;
        let sizes = Sizes { w1: p.nw() - p.ny(), u: p.nu(), z1: p.nz() - p.nu(), y: p.ny() };
        Ok(Normal { a: p.a().clone(), b, c, d11, sizes, u_scale, y_scale, d22: p.d22() })
    }

    /// Both equations at a level; why not, where there is no solution.
    fn solve(&self, gamma: f64) -> Result<Solved, String> {
        let text = |e: LinalgError| e.to_string();
        let Sizes { w1, u, z1, y } = self.sizes;
        let (nw, nz) = (w1 + y, z1 + u);
        let d11 = &self.d11;
        for (block, what) in [
            (d11.submatrix(0, 0, z1, nw).to_owned(), "[D1111 D1112]"),
            (d11.submatrix(0, 0, nz, w1).to_owned(), "[D1111; D1121]"),
        ] {
            let size = if block.nrows() == 0 || block.ncols() == 0 {
                0.0
            } else {
                block.singular_values().map_or(f64::INFINITY, |s| s[0])
            };
            if size >= gamma {
                return Err(format!("feedthrough {what} of {size:e} is not below the level"));
            }
        }
        let b1 = self.b.subcols(0, nw).to_owned();
        let c1 = self.c.subrows(0, nz).to_owned();
        let (b2, c2) = (self.b.subcols(nw, u).to_owned(), self.c.subrows(nz, y).to_owned());
        let g2 = gamma * gamma;
        let turned = |m: &Mat| m.transpose().to_owned();
        let (x, f) = half(&self.a, [&b1, &b2], &c1, d11, z1, g2).map_err(|e| format!("X: {e}"))?;
        let (y_inf, l) =
            half(&turned(&self.a), [&turned(&c1), &turned(&c2)], &turned(&b1), &turned(d11), w1, g2)
                .map_err(|e| format!("Y: {e}"))?;
        let xy = &y_inf * &x;
        let rho = xy
            .eigenvalues()
            .map_err(|_| "the eigenvalues of XY did not converge".to_owned())?
            .iter()
            .map(|v| v.norm())
            .fold(0.0, f64::max);
        if rho >= g2 {
            return Err(format!(
                "the spectral radius of XY, {rho:e}, is not below the level's square, {g2:e}"
            ));
        }
        let n = self.a.nrows();
        let identity = Mat::identity(n, n);
        let z = solve(&(&identity - xy * faer::Scale(1.0 / g2)), &identity).map_err(text)?;
        Ok(Solved { gamma, f, l: l.transpose().to_owned(), z })
    }

    /// The central controller.
    fn controller(&self, s: &Solved) -> Result<StateSpace<Continuous>, String> {
        let text = |e: LinalgError| e.to_string();
        let Sizes { w1, u, z1, y } = self.sizes;
        let (nw, nz, g2) = (w1 + y, z1 + u, s.gamma * s.gamma);
        let block = |i, j, r, c| self.d11.submatrix(i, j, r, c).to_owned();
        let (d1111, d1112) = (block(0, 0, z1, w1), block(0, w1, z1, y));
        let (d1121, d1122) = (block(z1, 0, u, w1), block(z1, w1, u, y));
        let level = |k: usize| Mat::from_fn(k, k, |i, j| if i == j { g2 } else { 0.0 });
        let outer = level(z1) - &d1111 * d1111.transpose();
        let inner = level(w1) - d1111.transpose() * &d1111;
        let over =
            |m: &Mat, rhs: &Mat| if m.nrows() == 0 { Ok(rhs.clone()) } else { solve(m, rhs).map_err(text) };
        let d11_hat = -(&d1121 * d1111.transpose() * over(&outer, &d1112)?) - &d1122;
        let one = |k: usize| Mat::identity(k, k);
        let d12_sq = one(u) - &d1121 * over(&inner, &d1121.transpose().to_owned())?;
        let d21_sq = one(y) - d1112.transpose() * over(&outer, &d1112)?;
        let (d12_hat, d21_hat) = (cholesky(&d12_sq)?, cholesky(&d21_sq)?.transpose().to_owned());
        let (f12, f2) = (s.f.subrows(w1, y).to_owned(), s.f.subrows(nw, u).to_owned());
        let (l12, l2) = (s.l.subcols(z1, u).to_owned(), s.l.subcols(nz, y).to_owned());
        let b2 = self.b.subcols(nw, u).to_owned();
        let c2 = self.c.subrows(nz, y).to_owned();
        let b2_hat = &s.z * (&b2 + l12) * &d12_hat;
        let c2_hat = -(&d21_hat * (c2 + f12));
        let b1_hat = -(&s.z * l2) + &b2_hat * solve(&d12_hat, &d11_hat).map_err(text)?;
        // D̂₂₁⁻¹Ĉ₂, once
        let c2_over = solve(&d21_hat, &c2_hat).map_err(text)?;
        let c1_hat = f2 + &d11_hat * &c2_over;
        let a_hat = &self.a + &self.b * &s.f + &b1_hat * &c2_over;
        let lti = |e: crate::lti::LtiError| e.to_string();
        // back to y and u as they were, then to the plant with D₂₂
        let (us, ys) = (&self.u_scale, &self.y_scale);
        let k = StateSpace::continuous(a_hat, b1_hat * ys, us * c1_hat, us * d11_hat * ys).map_err(lti)?;
        if self.d22.norm_max() == 0.0 {
            return Ok(k);
        }
        let back = StateSpace::continuous_gain(-self.d22.clone()).map_err(lti)?;
        k.feedback(&back).map_err(lti)
    }
}

/// The stabilising X ≥ 0 of one equation and its F = −R⁻¹(DᵀC + BᵀX), D = [D₁₁ [0; I]], R = DᵀD − diag(γ²I, 0).
///
/// With the performances parted into those without (C_t, D_t: the first `free`) and with a control (C_b, D_b), u is taken out
/// first: A₁ = A − B₂C_b, B̃ = B₁ − B₂D_b; then w, N = γ²I − D_tᵀD_t:
/// Q = C_tᵀC_t + (D_tᵀC_t)ᵀN⁻¹D_tᵀC_t is a sum of squares, where CᵀC − CᵀD R⁻¹DᵀC is a difference of large numbers.
fn half(
    a: &Mat,
    [b1, b2]: [&Mat; 2],
    c: &Mat,
    d11: &Mat,
    free: usize,
    g2: f64,
) -> Result<(Mat, Mat), String> {
    let text = |e: LinalgError| e.to_string();
    let (nw, u) = (b1.ncols(), b2.ncols());
    let (c_t, c_b) = (c.subrows(0, free).to_owned(), c.subrows(free, u).to_owned());
    let (d_t, d_b) = (d11.subrows(0, free).to_owned(), d11.subrows(free, u).to_owned());
    let b = b1 - b2 * &d_b;
    let n = Mat::from_fn(nw, nw, |i, j| if i == j { g2 } else { 0.0 }) - d_t.transpose() * &d_t;
    let dtc = d_t.transpose() * &c_t;
    let (n_dtc, n_bt) = (solve(&n, &dtc).map_err(text)?, solve(&n, &b.transpose().to_owned()).map_err(text)?);
    let a_h = a - b2 * &c_b + &b * &n_dtc;
    let q = symmetric(&(c_t.transpose() * &c_t + dtc.transpose() * &n_dtc));
    let g = symmetric(&(b2 * b2.transpose() - &b * &n_bt));
    let x = care_g(&a_h, &g, &q).map_err(|e| e.to_string())?.x;
    let values = symmetric_eigenvalues(&x).map_err(text)?;
    let (least, most) = (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0));
    if least < -SEMIDEFINITE * most.abs().max(least.abs()) {
        return Err(format!("smallest eigenvalue {least:e}, expected none below zero"));
    }
    let f_w = n_dtc + n_bt * &x;
    let f_u = -(b2.transpose() * &x + c_b + d_b * &f_w);
    let states = a.ncols();
    let f = Mat::from_fn(nw + u, states, |i, j| if i < nw { f_w[(i, j)] } else { f_u[(i - nw, j)] });
    Ok((x, f))
}

/// A lower triangular L with L Lᵀ = M.
fn cholesky(m: &Mat) -> Result<Mat, String> {
    if m.nrows() == 0 {
        return Ok(m.clone());
    }
    let l = m.llt(faer::Side::Lower).map_err(|_| "a feedthrough stands at the level".to_owned())?;
    Ok(l.L().to_owned())
}

/// For a tall D of full column rank: an orthogonal Q and a T with QᵀD = [0; T].
fn last_block(d: &Mat) -> (Mat, Mat) {
    let (rows, cols) = (d.nrows(), d.ncols());
    let qr = d.qr();
    let (q, t) = (qr.compute_Q(), qr.thin_R().to_owned());
    let turned = Mat::from_fn(rows, rows, |i, j| {
        let from = if j < rows - cols { cols + j } else { j - (rows - cols) };
        q[(i, from)]
    });
    (turned, t)
}
