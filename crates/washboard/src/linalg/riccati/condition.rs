//! How far X may be wrong: Kenney and Hewer's bound of the relative condition, and the forward error that the residual
//! leaves.

use super::super::dense::Mat;
use super::super::quasi_triangular::Equation;
use super::input::norm;
use super::newton::Refined;
use super::scaling::Scaling;

/// Steps of the power method on a positive semidefinite matrix; the norm is then known to a few per cent.
const POWER_STEPS: usize = 6;
/// The residual's own rounding, in n ε of its terms' factors.
const ROUNDING: f64 = 0.25;
/// Newton's theorem: below one quarter a solution is near.
const KANTOROVICH: f64 = 0.25;

/// Norms of the data in the states of the caller; what an equation lacks is 0.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Norms {
    pub a: f64,
    pub g: f64,
    pub q: f64,
    pub b: f64,
    pub r: f64,
    pub s: f64,
}

/// What the linearised equation says of the error of X.
#[derive(Debug, Clone, Copy)]
pub(super) struct Errors {
    /// Relative condition number.
    pub condition: f64,
    /// Relative forward error.
    pub forward: f64,
    /// Whether the residual is so small that Newton's theorem (Kantorovich) proves a solution nearby.
    pub proven: bool,
}

/// K = (‖H₀‖‖Q‖ + 2 √(‖H₀‖‖H₂‖) ‖A‖ + ‖H₂‖‖G‖) / ‖X‖ with Ω(Y) = A_cᵀY + YA_c, Ω(H₀) = −I, Ω(H₂) = −X².
///
/// Ω⁻¹ and Z ↦ Ω⁻¹(XZX) keep their sign on semidefinite matrices, so that ‖H₀‖ and ‖H₂‖ are their 2-norms; the middle
/// term bounds Z ↦ Ω⁻¹(ZᵀX + XZ). In discrete time Ω(Y) = A_cᵀYA_c − Y, X A_c takes the place of X, and with
/// ΔX = −Ω⁻¹(ΔQ + FᵀΔR F + ΔS F + (ΔS F)ᵀ + (ΔA + ΔB F)ᵀX A_c + its transpose) ‖Q‖ becomes ‖Q‖ + 2‖S‖‖F‖ + ‖R‖‖F‖²,
/// ‖A‖ becomes ‖A‖ + ‖B‖‖F‖ and G is not there.
///
/// Source: Kenney and Hewer, *The sensitivity of the algebraic and differential Riccati equations*, SIAM J. Control
/// Optim. 28 (1990), theorem 2; Byers (1985); Gahinet, Laub, Kenney and Hewer (1990) for the discrete Ω.
pub(super) fn errors(refined: &Refined, g: &Mat, scaling: &Scaling, norms: &Norms) -> Errors {
    let (n, rho) = (refined.x.nrows(), scaling.rho);
    let linearised = &refined.linearised;
    let (z, equation) = (&linearised.schur.q, linearised.equation);
    let x = scaling.g(&refined.x); // in the caller's states
    let size = norm(&x);
    let two_norm = |y: &Mat| power_norm(y, z, scaling);
    let minus = |m: Mat| linearised.solve_turned(m * faer::Scale(-1.0));
    // in scaled states: Ω̃(H) = −I
    let plain = minus(Mat::identity(n, n));
    let plain_norm = two_norm(&plain);
    // Ω(H₀) = −I means Ω̃(D H₀ D) = −D²
    let h0 = if scaling.keeps_states() {
        plain_norm
    } else {
        let dz = Mat::from_fn(n, n, |i, j| scaling.d[i] * z[(i, j)]);
        two_norm(&minus(dz.transpose() * &dz))
    };
    // Ω(H₂) = −PᵀP, P = X or X A_c: Ω̃ of −(P D Z)ᵀ(P D Z)
    let p = match equation {
        Equation::Continuous => &refined.x * z,
        Equation::Discrete => &refined.x * (&refined.at.closed_loop * z),
    };
    let p = Mat::from_fn(n, n, |i, j| p[(i, j)] * (rho / scaling.d[i]));
    let h2 = two_norm(&minus(p.transpose() * &p));
    // what A and Q stand for where B, R and S are data
    let f = refined.at.gain.as_ref().map_or(0.0, |f| scaling.gain(f).norm_l2());
    let (to_a, to_q) = (norms.a + norms.b * f, norms.q + f * (2.0 * norms.s + f * norms.r));
    let condition = (h0 * to_q + 2.0 * (h0 * h2).sqrt() * to_a + h2 * norms.g) / size;
    let rounding = ROUNDING * n as f64 * f64::EPSILON * refined.at.products;
    let left = refined.at.left + rounding;
    // |Ω̃⁻¹(E)| ≤ ‖E‖ H̃
    let forward = 2.0 * left * rho * plain_norm / size;
    let simple = norm(&plain);
    let proven = left * simple * simple * norm(g) < KANTOROVICH
        || left * norm_of_curvature(refined, &plain, g) < KANTOROVICH;
    let known = |v: f64| if size > 0.0 && !v.is_nan() { v } else { f64::INFINITY };
    Errors { condition: known(condition), forward: known(forward), proven }
}

/// c with |Ω⁻¹(E G E)| ≤ δ c |E| for the errors |E| ≤ δ H that a residual of norm δ leaves, Ω(H) = −I: Newton's next
/// step over this one's.
fn norm_of_curvature(refined: &Refined, h: &Mat, g: &Mat) -> f64 {
    let linearised = &refined.linearised;
    let z = &linearised.schur.q;
    let quadratic = h * (z.transpose() * g * z) * h;
    // A_c in these coordinates is Tᵀ
    let t = &linearised.schur.t;
    let quadratic = match linearised.equation {
        Equation::Continuous => quadratic,
        Equation::Discrete => t * quadratic * t.transpose(),
    };
    let size = norm(h);
    if size == 0.0 {
        return 0.0;
    }
    let next = linearised.solve_turned(quadratic * faer::Scale(-1.0));
    norm(&next) / size
}

/// ‖D⁻¹ Z Y Zᵀ D⁻¹‖₂ of a positive semidefinite Y, by the power method.
fn power_norm(y: &Mat, z: &Mat, scaling: &Scaling) -> f64 {
    let n = y.nrows();
    let turned;
    let y = if scaling.keeps_states() {
        y
    } else {
        let dz = Mat::from_fn(n, n, |i, j| z[(i, j)] / scaling.d[i]);
        turned = &dz * y * dz.transpose();
        &turned
    };
    let Some(at) = (0..n).max_by(|i, j| y[(*i, *i)].total_cmp(&y[(*j, *j)])) else { return 0.0 };
    // the column of the largest diagonal entry is where one step from its unit vector leads
    let mut v = y.col_as_slice(at).to_vec();
    let mut next = vec![0.0; n];
    let mut value = 0.0;
    for _ in 0..POWER_STEPS {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return norm(y);
        }
        next.fill(0.0);
        for (j, x) in v.iter().enumerate() {
            let factor = x / length;
            next.iter_mut().zip(y.col_as_slice(j)).for_each(|(s, y)| *s += factor * y);
        }
        std::mem::swap(&mut v, &mut next);
        value = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    }
    value
}
