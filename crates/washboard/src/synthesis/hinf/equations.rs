//! The two Riccati equations of a level, and the central controller from their solutions.

use super::super::SynthesisError;
use super::super::h2::symmetric;
use crate::linalg::{LinalgError, Mat, care_g, solve, symmetric_eigenvalues};
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};

/// X and Y may have eigenvalues this far below zero, as a share of the largest: rounding.
const SEMIDEFINITE: f64 = 1e-9;

/// Why a level is not feasible.
pub(super) struct Refused {
    pub why: String,
    /// Whether by a number that is far from rounding: feedthrough, a negative eigenvalue, a spectral radius; not where an
    /// equation was not solved.
    pub by_theory: bool,
}

impl Refused {
    fn by_theory(why: String) -> Self {
        Self { why, by_theory: true }
    }

    fn unsolved(why: impl std::fmt::Display) -> Self {
        Self { why: why.to_string(), by_theory: false }
    }
}

/// The plant with D₁₂ = [0; I], D₂₁ = [0 I] and D₂₂ = 0, and the way back.
pub(super) struct Normal {
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
pub(super) struct Solved {
    pub gamma: f64,
    /// Of both closed loops A − GX: the real part nearest to the axis; and the norms of X and Y.
    pub margins: [f64; 2],
    pub sizes: [f64; 2],
    f: Mat,
    l: Mat,
    z: Mat,
}

impl Normal {
    pub(super) fn of(plant: &GeneralizedPlant) -> Result<Self, SynthesisError> {
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
    pub(super) fn solve(&self, gamma: f64) -> Result<Solved, Refused> {
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
                let why = format!("feedthrough {what} of {size:e} is not below the level");
                return Err(Refused::by_theory(why));
            }
        }
        let b1 = self.b.subcols(0, nw).to_owned();
        let c1 = self.c.subrows(0, nz).to_owned();
        let (b2, c2) = (self.b.subcols(nw, u).to_owned(), self.c.subrows(nz, y).to_owned());
        let g2 = gamma * gamma;
        let turned = |m: &Mat| m.transpose().to_owned();
        let named = |name: &str, e: Refused| Refused { why: format!("{name}: {}", e.why), ..e };
        let x = half(&self.a, [&b1, &b2], &c1, d11, z1, g2).map_err(|e| named("X", e))?;
        let y_inf = half(&turned(&self.a), [&turned(&c1), &turned(&c2)], &turned(&b1), &turned(d11), w1, g2)
            .map_err(|e| named("Y", e))?;
        let xy = &y_inf.x * &x.x;
        let values =
            xy.eigenvalues().map_err(|_| Refused::unsolved("the eigenvalues of XY did not converge"))?;
        let rho = values.iter().map(|v| v.norm()).fold(0.0, f64::max);
        if rho >= g2 {
            let why = format!("the spectral radius of XY, {rho:e}, is not below the level's square, {g2:e}");
            return Err(Refused::by_theory(why));
        }
        let n = self.a.nrows();
        let identity = Mat::identity(n, n);
        let z = solve(&(&identity - xy * faer::Scale(1.0 / g2)), &identity).map_err(Refused::unsolved)?;
        Ok(Solved {
            gamma,
            margins: [x.margin, y_inf.margin],
            sizes: [x.x.norm_l2(), y_inf.x.norm_l2()],
            f: x.gain,
            l: turned(&y_inf.gain),
            z,
        })
    }

    /// The central controller.
    pub(super) fn controller(&self, s: &Solved) -> Result<StateSpace<Continuous>, String> {
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

/// One equation's solution.
struct Half {
    x: Mat,
    gain: Mat,
    /// Of A − GX: the real part nearest to the axis.
    margin: f64,
}

/// The stabilising X ≥ 0 of one equation and its F = −R⁻¹(DᵀC + BᵀX), D = [D₁₁ [0; I]], R = DᵀD − diag(γ²I, 0).
///
/// With the performances parted into those without (C_t, D_t: the first `free`) and with a control (C_b, D_b), u is taken out
/// first: A₁ = A − B₂C_b, B̃ = B₁ − B₂D_b; then w, N = γ²I − D_tᵀD_t:
/// Q = C_tᵀC_t + (D_tᵀC_t)ᵀN⁻¹D_tᵀC_t is a sum of squares, where CᵀC − CᵀD R⁻¹DᵀC is a difference of large numbers.
fn half(a: &Mat, [b1, b2]: [&Mat; 2], c: &Mat, d11: &Mat, free: usize, g2: f64) -> Result<Half, Refused> {
    let unsolved = |e: LinalgError| Refused::unsolved(e);
    let (nw, u) = (b1.ncols(), b2.ncols());
    let (c_t, c_b) = (c.subrows(0, free).to_owned(), c.subrows(free, u).to_owned());
    let (d_t, d_b) = (d11.subrows(0, free).to_owned(), d11.subrows(free, u).to_owned());
    let b = b1 - b2 * &d_b;
    let n = Mat::from_fn(nw, nw, |i, j| if i == j { g2 } else { 0.0 }) - d_t.transpose() * &d_t;
    let dtc = d_t.transpose() * &c_t;
    let (n_dtc, n_bt) =
        (solve(&n, &dtc).map_err(unsolved)?, solve(&n, &b.transpose().to_owned()).map_err(unsolved)?);
    let a_h = a - b2 * &c_b + &b * &n_dtc;
    let q = symmetric(&(c_t.transpose() * &c_t + dtc.transpose() * &n_dtc));
    let g = symmetric(&(b2 * b2.transpose() - &b * &n_bt));
    let solution = care_g(&a_h, &g, &q).map_err(Refused::unsolved)?;
    let x = solution.x;
    let values = symmetric_eigenvalues(&x).map_err(unsolved)?;
    let (least, most) = (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0));
    if least < -SEMIDEFINITE * most.abs().max(least.abs()) {
        let why = format!("smallest eigenvalue {least:e}, expected none below zero");
        return Err(Refused::by_theory(why));
    }
    let f_w = n_dtc + n_bt * &x;
    let f_u = -(b2.transpose() * &x + c_b + d_b * &f_w);
    let states = a.ncols();
    let gain = Mat::from_fn(nw + u, states, |i, j| if i < nw { f_w[(i, j)] } else { f_u[(i - nw, j)] });
    let margin = solution.closed_loop_eigenvalues.iter().map(|z| z.re.abs()).fold(f64::INFINITY, f64::min);
    Ok(Half { x, gain, margin })
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
