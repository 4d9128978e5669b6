//! Output feedback of the plant's order: mixed H2/H∞ with pole regions by one Lyapunov matrix.

use super::feedthrough::feedthrough;
use super::goals::{HinfGoal, LyapunovScale, MixedGoals};
use super::inequalities::{Closed, Level, Scale, claims, h2, hinf};
use super::parts::{Channel, Parts, Units};
use super::regions;
use super::scale::search;
use super::state_feedback::{MixedClaims, MixedEnd};
use super::verify::{MixedAchieved, achieved};
use crate::linalg::Mat;
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::optimize::{Expr, Lmi, LmiSolution, SdpError, SdpSettings, Status, Variable};
use crate::synthesis::{Assumption, SynthesisError, broken_assumptions};

/// States of a large plant.
const LARGE: usize = 10;

/// A controller u = K(s) y.
#[derive(Debug, Clone)]
pub struct MixedController {
    /// K, of the plant's order.
    pub controller: StateSpace<Continuous>,
    /// What the inequalities promise.
    pub claims: MixedClaims,
    /// What the closed loop has.
    pub achieved: MixedAchieved,
    /// The least value of the objective, which no controller by one Lyapunov matrix (at the scale of the claims) beats; the
    /// controller gives up a share of it.
    pub optimum: f64,
    /// Whether `optimum` is one: false where the solver stalled on its way, and it is the least value that was reached.
    pub optimal: bool,
    /// The largest over the smallest singular value of I − XY in the units of the program: digits lost on the way back.
    pub condition: f64,
    /// Iterations of the solver, in double and double-double precision.
    pub iterations: [usize; 2],
}

/// The output feedback of the plant's order that minimises Σ α‖T∞‖² + β‖T₂‖² under bounds and with poles in a region.
///
/// With X, Y symmetric and Â, B̂, Ĉ, D̂ for the controller,
/// 𝐗 = \[X I; I Y\], 𝐀 = \[AX + B₂Ĉ, A + B₂D̂C₂; Â, YA + B̂C₂\], 𝐁 = \[B₁ + B₂D̂D₂₁; YB₁ + B̂D₂₁\],
/// 𝐂 = \[C₁X + D₁₂Ĉ, C₁ + D₁₂D̂C₂\], 𝐃 = D₁₁ + D₁₂D̂D₂₁. Where D₁₁ of the H2 goal cannot be cancelled the norm is
/// infinite and nothing is feasible.
///
/// The least value is often approached only with gains that grow without bound: the controller is that of the point of the
/// central path that is within a share `back_off` of it.
///
/// # Errors
/// Goals that say nothing or contradict themselves, a plant that cannot be stabilised or detected, a loop that is not well
/// posed, a closed loop that contradicts its promise.
///
/// Source: Scherer, Gahinet and Chilali, IEEE Trans. Automat. Control 42 (1997) 896–911.
pub fn mixed_h2_hinf(
    plant: &GeneralizedPlant,
    goals: &MixedGoals,
    settings: &SdpSettings,
) -> Result<MixedEnd<MixedController>, SynthesisError> {
    goals.check(plant)?;
    let units = Units::of(plant);
    let parts = units.parts(plant, &goals.h2, &goals.hinf);
    let settings =
        &SdpSettings { interior_gap: (goals.back_off > 0.0).then_some(goals.back_off), ..*settings };
    // a search over scales of a large plant goes on in double-double once: there that takes many seconds
    let large = plant.order() >= LARGE;
    let doubled = std::cell::Cell::new(false);
    let solve = |scale: LyapunovScale| -> Result<_, SdpError> {
        let s = if let LyapunovScale::Fixed(s) = scale { s } else { 1.0 };
        let double_double = settings.double_double && !(large && doubled.get());
        let settings = SdpSettings { double_double, ..*settings };
        let solved = Program::solved(&units, &parts, goals, s, &settings)?;
        doubled.set(doubled.get() || solved.1.outcome.iterations[1] > 0);
        Ok(solved)
    };
    let both = !goals.h2.is_empty() && !goals.hinf.is_empty();
    let (program, solution) = match goals.scale {
        LyapunovScale::Searched if both => search(solve)?,
        scale => solve(scale)?,
    };
    Ok(match solution.outcome.status {
        // a point well inside keeps its promise, whether or not the search that passed it ended
        Status::Optimal | Status::Stalled
            if solution.outcome.status == Status::Optimal || solution.outcome.interior.is_some() =>
        {
            let optimal = solution.outcome.status == Status::Optimal;
            let optimum = solution.outcome.objective;
            let inner = solution.interior().unwrap_or(solution);
            let measures = inner.outcome.measures;
            let Some((controller, claims, condition)) =
                program.controller(&units, &parts, goals, &inner, plant)
            else {
                return Ok(MixedEnd::Stalled(measures));
            };
            let [a, b, c, d] = controller;
            let controller = StateSpace::continuous(a, b, c, d)?;
            let achieved = achieved(&plant.close(&controller)?, goals, &claims)?;
            let iterations = inner.outcome.iterations;
            MixedEnd::Found(MixedController {
                controller,
                claims,
                achieved,
                optimum,
                optimal,
                condition,
                iterations,
            })
        }
        Status::Infeasible => {
            let broken = broken_assumptions(plant)?;
            let needed = [Assumption::Stabilisable, Assumption::Detectable];
            let fatal: Vec<_> = broken.into_iter().filter(|b| needed.contains(&b.assumption)).collect();
            if !fatal.is_empty() {
                return Err(SynthesisError::Assumptions(fatal));
            }
            MixedEnd::Infeasible {
                violation: solution.outcome.certificate.map_or(f64::INFINITY, |c| c.violation),
                bounds_times: relaxed(&units, &parts, goals, settings)?,
            }
        }
        _ => MixedEnd::Stalled(solution.outcome.measures),
    })
}

/// The least factor on all bounds on H∞ norms that makes these feasible, with all of them times one factor.
fn relaxed(
    units: &Units,
    parts: &Parts,
    goals: &MixedGoals,
    settings: &SdpSettings,
) -> Result<Option<f64>, SdpError> {
    let bounded: Vec<usize> = (0..goals.hinf.len()).filter(|k| goals.hinf[*k].bound.is_some()).collect();
    let [one] = bounded[..] else { return Ok(None) };
    // of one bound, the least norm that the region allows
    let Some(bound) = goals.hinf[one].bound else { return Ok(None) };
    let alone = MixedGoals {
        h2: Vec::new(),
        hinf: vec![HinfGoal { weight: 1.0, bound: None, ..goals.hinf[one].clone() }],
        ..goals.clone()
    };
    let parts = Parts { h2: Vec::new(), hinf: vec![parts.hinf[one].clone()], all_h2: None, ..parts.clone() };
    let (_, solution) = Program::solved(units, &parts, &alone, 1.0, settings)?;
    let found = solution.outcome.objective;
    Ok((solution.outcome.status == Status::Optimal && found > 0.0).then(|| found.sqrt() / bound))
}

struct Program {
    x: Variable,
    y: Variable,
    a: Variable,
    b: Variable,
    c: Variable,
    /// The variables in D̂ = D₀ + N₁V₁ + V₂N₂ᵀ.
    free: Vec<(Mat, Variable, Mat)>,
    d0: Mat,
    z: Vec<Variable>,
    levels: Vec<Level>,
    scale: f64,
}

impl Program {
    fn solved(
        units: &Units,
        parts: &Parts,
        goals: &MixedGoals,
        scale: f64,
        settings: &SdpSettings,
    ) -> Result<(Self, LmiSolution), SdpError> {
        let (n, nu, ny) = (parts.a.nrows(), parts.b2.ncols(), parts.c2.nrows());
        let mut lmi = Lmi::new();
        let (x, y) = (lmi.symmetric(n), lmi.symmetric(n));
        let (a, b, c) = (lmi.matrix(n, n), lmi.matrix(n, ny), lmi.matrix(nu, n));
        let (d, d0, free) = feedthrough(&mut lmi, parts, nu, ny);
        let closed_a = block(
            &(&(&parts.a * x) + &(&parts.b2 * c)),
            &(&Expr::constant(parts.a.clone()) + &(&(&parts.b2 * &d) * &parts.c2)),
            &a.expr(),
            &(&(y * &parts.a) + &(b * &parts.c2)),
        );
        let both = Expr::symmetric(vec![vec![x.expr(), Expr::identity(n, 1.0)], vec![y.expr()]]);
        let closed = |ch: &Channel| Closed {
            a: closed_a.clone(),
            b: stack(
                &(&Expr::constant(ch.b1.clone()) + &(&(&parts.b2 * &d) * &ch.d21)),
                &(&(y * &ch.b1) + &(b * &ch.d21)),
            ),
            c: stack(
                &(&(&ch.c1 * x) + &(&ch.d12 * c)).t(),
                &(&Expr::constant(ch.c1.clone()) + &(&(&ch.d12 * &d) * &parts.c2)).t(),
            )
            .t(),
            d: &Expr::constant(ch.d11.clone()) + &(&(&ch.d12 * &d) * &ch.d21),
        };
        let mut objective = Expr::zero(1, 1);
        let mut levels = Vec::new();
        for (goal, channel) in goals.hinf.iter().zip(&parts.hinf) {
            let (level, more) = Level::of(&mut lmi, units, goal.bound, goal.weight, objective);
            objective = more;
            levels.push(level);
            hinf(&mut lmi, &closed(channel), &channel.b1, &channel.d11, Scale::Number(scale), level);
        }
        let (mut z, mut known) = (Vec::new(), Vec::new());
        for (goal, channel) in goals.h2.iter().zip(&parts.h2) {
            let own = h2(&mut lmi, &closed(channel), &both, &goal.disturbances, &mut known);
            let trace = own.expr().trace();
            if goal.weight > 0.0 {
                objective = objective + trace.scaled(goal.weight);
            }
            if let Some(bound) = goal.bound {
                lmi.positive("a bound on the H2 norm", &Expr::identity(1, bound * bound) - &trace);
            }
            z.push(own);
        }
        regions::add(&mut lmi, &units.region(&goals.region), &closed_a, &both);
        lmi.positive("X and Y", both.clone());
        lmi.minimize(objective);
        let solution = lmi.solve(settings)?;
        Ok((Program { x, y, a, b, c, free, d0, z, levels, scale }, solution))
    }

    /// With I − XY = MNᵀ: D = D̂, C = (Ĉ − D C₂X)M⁻ᵀ, B = N⁻¹(B̂ − YB₂D),
    /// A = N⁻¹(Â − NBC₂X − YB₂CMᵀ − Y(A + B₂DC₂)X)M⁻ᵀ.
    fn controller(
        &self,
        units: &Units,
        parts: &Parts,
        goals: &MixedGoals,
        s: &LmiSolution,
        plant: &GeneralizedPlant,
    ) -> Option<([Mat; 4], MixedClaims, f64)> {
        let n = parts.a.nrows();
        let (x, y) = (s.value(self.x), s.value(self.y));
        let (ah, bh, ch) = (s.value(self.a), s.value(self.b), s.value(self.c));
        let mut d = self.d0.clone();
        for (left, v, right) in &self.free {
            d += left * s.value(*v) * right;
        }
        let svd = (Mat::identity(n, n) - &x * &y).svd().ok()?;
        let sigma: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let condition = sigma.first()? / sigma.last()?;
        let root = |m: faer::MatRef<'_, f64>| Mat::from_fn(n, n, |i, j| m[(i, j)] * sigma[j].sqrt());
        let (m, nn) = (root(svd.U()), root(svd.V()));
        let right = |a: &Mat| -> Option<Mat> {
            // a M⁻ᵀ
            Some(crate::linalg::solve(&m, &a.transpose().to_owned()).ok()?.transpose().to_owned())
        };
        let left = |a: &Mat| crate::linalg::solve(&nn, a).ok();
        let c = right(&(&ch - &d * &parts.c2 * &x))?;
        let b = left(&(&bh - &y * &parts.b2 * &d))?;
        let inner = &ah
            - &nn * &b * &parts.c2 * &x
            - &y * &parts.b2 * &c * m.transpose()
            - &y * (&parts.a + &parts.b2 * &d * &parts.c2) * &x;
        let a = left(&right(&inner)?)?;
        // to the plant's units, then around D₂₂: K(I + D₂₂K)⁻¹
        let (f, g, rate) = (&units.controls, &units.measurements, units.rate);
        let a = Mat::from_fn(n, n, |i, j| a[(i, j)] * rate);
        let b = Mat::from_fn(n, g.len(), |i, j| b[(i, j)] * rate / g[j]);
        let c = Mat::from_fn(f.len(), n, |i, j| f[i] * c[(i, j)]);
        let d = Mat::from_fn(f.len(), g.len(), |i, j| f[i] * d[(i, j)] / g[j]);
        let d22 = plant.d22();
        let around = Mat::identity(g.len(), g.len()) + &d22 * &d;
        let (dc, dd) = (&d22 * &c, Mat::identity(g.len(), g.len()));
        let p = crate::linalg::solve(&around, &dc).ok()?;
        let q = crate::linalg::solve(&around, &dd).ok()?;
        let matrices = [&a - &b * &p, &b * &q, &c - &d * &p, &d * &q];
        if !matrices.iter().all(|m| m.norm_max().is_finite()) {
            return None;
        }
        let trace = |z: &Variable| {
            let z = s.value(*z);
            (0..z.nrows()).map(|i| z[(i, i)]).sum::<f64>()
        };
        let squared = self.z.iter().map(trace).collect();
        let scales = vec![self.scale; self.levels.len()];
        let claims = claims(units, goals, &self.levels, squared, scales, s);
        Some((matrices, claims, condition))
    }
}

/// \[a b; c d\].
fn block(a: &Expr, b: &Expr, c: &Expr, d: &Expr) -> Expr {
    stack(&stack(&a.t(), &b.t()).t(), &stack(&c.t(), &d.t()).t())
}

/// \[a; b\].
fn stack(a: &Expr, b: &Expr) -> Expr {
    let (n, m) = (a.shape().0, b.shape().0);
    let top = Mat::from_fn(n + m, n, |i, j| if i == j { 1.0 } else { 0.0 });
    let bottom = Mat::from_fn(n + m, m, |i, j| if i == n + j { 1.0 } else { 0.0 });
    &(&top * a) + &(&bottom * b)
}
