//! One state feedback for all plants of a polytope: mixed H2/H∞ with pole regions.

use super::goals::{LyapunovScale, MixedGoals};
use super::inequalities::{Closed, Level, Scale, claims, h2, hinf};
use super::parts::{Channel, Parts, Units};
use super::regions;
use super::verify::{MixedAchieved, achieved, with_feedback};
use crate::linalg::Mat;
use crate::lti::{GeneralizedPlant, LtiError};
use crate::optimize::{Expr, Lmi, LmiSolution, Measures, SdpError, SdpSettings, Status, Variable};
use crate::synthesis::{Assumption, SynthesisError, broken_assumptions};

/// What the inequalities promise: bounds, not the norms themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct MixedClaims {
    /// ‖T₂‖ of each H2 goal's weighted outputs is at most this, at every vertex.
    pub h2: Vec<f64>,
    /// ‖T∞‖ of each H∞ goal is at most this.
    pub hinf: Vec<f64>,
    /// Σ α‖T∞‖² + β‖T₂‖² by these bounds.
    pub objective: f64,
    /// The scale s of each H∞ goal's inequality.
    pub scales: Vec<f64>,
}

/// How a design ended.
#[derive(Debug, Clone)]
pub enum MixedEnd<T> {
    /// With a controller.
    Found(T),
    /// No controller meets the goals by one Lyapunov matrix: a multiplier proves it, to `violation`.
    Infeasible {
        /// How well the proof holds.
        violation: f64,
        /// What all bounds on H∞ norms must at least be multiplied by, without the other goals' bounds; none where even
        /// that does not help.
        bounds_times: Option<f64>,
    },
    /// The solver came to no answer.
    Stalled(Measures),
}

/// A state feedback u = Kx.
#[derive(Debug, Clone)]
pub struct StateFeedback {
    /// K, controls × states.
    pub gain: Mat,
    /// The Lyapunov matrix of all vertices: their covariance is at most this, where there is an H2 goal.
    pub lyapunov: Mat,
    /// What the inequalities promise.
    pub claims: MixedClaims,
    /// What the loop of each vertex has.
    pub achieved: Vec<MixedAchieved>,
    /// Iterations of the solver, in double and double-double precision.
    pub iterations: [usize; 2],
}

/// The state feedback that minimises Σ α‖T∞‖² + β‖T₂‖² at the worst vertex of a polytope of plants, under bounds and with
/// poles in a region.
///
/// One X ≻ 0 and W = KX for all vertices: He(AX + B₂W) + … as of [`MixedGoals`]; what holds at the vertices holds in the
/// polytope, and while the plant moves in it. The vertices share their numbers of states and signals; the controller sees
/// all states. With bounds only on H∞ norms the scale of the common Lyapunov matrix is a variable of the program. With an
/// `interior_gap` in the settings the gain is that of a point well inside, within that share of the least objective, and
/// the end is [`MixedEnd::Stalled`] where the solver passed none: `back_off` of the goals is of output feedback.
///
/// # Errors
/// Goals that say nothing or contradict themselves, vertices of different sizes, a vertex that cannot be stabilised, a
/// closed loop that contradicts its promise.
///
/// Source: Boyd, El Ghaoui, Feron, Balakrishnan, *Linear Matrix Inequalities in System and Control Theory*, ch. 7.
pub fn robust_state_feedback(
    vertices: &[GeneralizedPlant],
    goals: &MixedGoals,
    settings: &SdpSettings,
) -> Result<MixedEnd<StateFeedback>, SynthesisError> {
    let Some(first) = vertices.first() else {
        return Err(SdpError::Empty { variables: 0, blocks: 0 }.into());
    };
    let sizes = |p: &GeneralizedPlant| [p.order(), p.nw(), p.nu(), p.nz()];
    for vertex in vertices {
        if sizes(vertex) != sizes(first) {
            return Err(LtiError::Join {
                what: "vertices: states, disturbances, controls, performances",
                expected: format!("{:?}", sizes(first)),
                found: format!("{:?}", sizes(vertex)),
            }
            .into());
        }
        goals.check(vertex)?;
    }
    let units = Units::of(first);
    let parts: Vec<Parts> = vertices.iter().map(|p| units.parts(p, &goals.h2, &goals.hinf)).collect();
    let minimised = goals.hinf.iter().any(|g| g.weight > 0.0);
    let solve = |scale: LyapunovScale| {
        Program::within(Lmi::new(), &units, &parts, goals, scale, None)?.solve(settings)
    };
    let solved = match goals.scale {
        // γ² and s are both variables: s by a search over numbers
        LyapunovScale::Searched if minimised && !goals.h2.is_empty() => super::scale::search(solve)?,
        scale => solve(scale)?,
    };
    let (program, solution) = solved;
    Ok(match solution.outcome.status {
        // not the optimum in its place: it was asked for a gain that is not there
        Status::Optimal if settings.interior_gap.is_some() && solution.outcome.interior.is_none() => {
            MixedEnd::Stalled(solution.outcome.measures)
        }
        Status::Optimal => {
            let inner = solution.interior().unwrap_or(solution);
            let mut found = program.feedback(&units, goals, &inner);
            for vertex in vertices {
                let closed = with_feedback(vertex, &found.gain)?;
                found.achieved.push(achieved(&closed, goals, &found.claims)?);
            }
            MixedEnd::Found(found)
        }
        Status::Infeasible => {
            for vertex in vertices {
                stabilisable(vertex)?;
            }
            MixedEnd::Infeasible {
                violation: solution.outcome.certificate.map_or(f64::INFINITY, |c| c.violation),
                bounds_times: relaxed(&units, &parts, goals, settings)?,
            }
        }
        _ => MixedEnd::Stalled(solution.outcome.measures),
    })
}

/// Refuses a plant whose controls do not reach an unstable mode.
pub(super) fn stabilisable(plant: &GeneralizedPlant) -> Result<(), SynthesisError> {
    let broken = broken_assumptions(plant)?;
    let fatal: Vec<_> = broken.into_iter().filter(|b| b.assumption == Assumption::Stabilisable).collect();
    if fatal.is_empty() { Ok(()) } else { Err(SynthesisError::Assumptions(fatal)) }
}

/// The least factor on all bounds on H∞ norms that makes these feasible.
fn relaxed(
    units: &Units,
    parts: &[Parts],
    goals: &MixedGoals,
    settings: &SdpSettings,
) -> Result<Option<f64>, SdpError> {
    if goals.hinf.iter().all(|g| g.bound.is_none()) {
        return Ok(None);
    }
    let bare = MixedGoals { h2: Vec::new(), ..goals.clone() };
    let mut lmi = Lmi::new();
    let factor = lmi.scalar();
    let program = Program::within(lmi, units, parts, &bare, LyapunovScale::Fixed(1.0), Some(factor))?;
    let (_, solution) = program.solve(settings)?;
    let found = solution.value(factor)[(0, 0)];
    Ok((solution.outcome.status == Status::Optimal && found > 0.0).then(|| found.sqrt()))
}

/// The inequalities in the plant's units.
pub(super) struct Program {
    lmi: Lmi,
    x: Variable,
    w: Variable,
    z: Vec<Variable>,
    levels: Vec<Level>,
    scales: Vec<Scale>,
}

impl Program {
    fn within(
        mut lmi: Lmi,
        units: &Units,
        parts: &[Parts],
        goals: &MixedGoals,
        scale: LyapunovScale,
        factor: Option<Variable>,
    ) -> Result<Self, SdpError> {
        let (n, m) = parts[0].b2.shape();
        let (x, w) = (lmi.symmetric(n), lmi.matrix(m, n));
        let mut objective = Expr::zero(1, 1);
        let mut levels = Vec::new();
        let mut scales = Vec::new();
        for goal in &goals.hinf {
            // γ² times a common factor is a number too
            let weight = if factor.is_some() && goal.bound.is_some() { 0.0 } else { goal.weight };
            let (level, more) = Level::of(&mut lmi, units, goal.bound, weight, objective);
            objective = more;
            levels.push(level);
            let linear = matches!(level, Level::Number(_)) && !goals.h2.is_empty();
            scales.push(Scale::of(&mut lmi, scale, linear));
        }
        let mut z: Vec<Variable> = Vec::new();
        for part in parts {
            let a = &(&part.a * x) + &(&part.b2 * w);
            let closed = |c: &Channel| Closed {
                a: a.clone(),
                b: Expr::constant(c.b1.clone()),
                c: &(&c.c1 * x) + &(&c.d12 * w),
                d: Expr::constant(c.d11.clone()),
            };
            for ((channel, level), scale) in part.hinf.iter().zip(&levels).zip(&scales) {
                let of = closed(channel);
                match (factor, level) {
                    // γ² times a common factor: z is divided by γ
                    (Some(f), Level::Number(g)) => {
                        let (c, d) = (of.c.scaled(g.sqrt().recip()), of.d.scaled(g.sqrt().recip()));
                        let of = Closed { c, d, ..of };
                        hinf(&mut lmi, &of, &channel.b1, &channel.d11, *scale, Level::Free(f));
                    }
                    _ => hinf(&mut lmi, &of, &channel.b1, &channel.d11, *scale, *level),
                }
            }
            let mut known = Vec::new();
            for (k, (goal, channel)) in goals.h2.iter().zip(&part.h2).enumerate() {
                let own = h2(&mut lmi, &closed(channel), &x.expr(), &goal.disturbances, &mut known);
                // one Z above all vertices' traces
                if z.len() == k {
                    z.push(lmi.scalar());
                }
                lmi.positive("the H2 norm", &z[k].expr() - &own.expr().trace());
            }
            regions::add(&mut lmi, &units.region(&goals.region), &a, &x.expr());
        }
        lmi.positive("X", x.expr());
        for (goal, z) in goals.h2.iter().zip(&z) {
            if goal.weight > 0.0 {
                objective = objective + z.expr().scaled(goal.weight);
            }
            if let Some(bound) = goal.bound {
                lmi.positive("a bound on the H2 norm", &Expr::identity(1, bound * bound) - &z.expr());
            }
        }
        lmi.minimize(factor.map_or(objective, |f| f.expr()));
        Ok(Program { lmi, x, w, z, levels, scales })
    }

    fn solve(self, settings: &SdpSettings) -> Result<(Self, LmiSolution), SdpError> {
        let solution = self.lmi.solve(settings)?;
        Ok((self, solution))
    }

    fn feedback(&self, units: &Units, goals: &MixedGoals, s: &LmiSolution) -> StateFeedback {
        let (x, w) = (s.value(self.x), s.value(self.w));
        let k = crate::linalg::solve(&x, &w.transpose().to_owned())
            .map_or_else(|_| Mat::zeros(w.nrows(), w.ncols()), |k| k.transpose().to_owned());
        let number = |v: Variable| s.value(v)[(0, 0)];
        let squared = self.z.iter().map(|z| number(*z)).collect();
        let scales = self.scales.iter().map(|s| match s {
            Scale::Number(s) => *s,
            Scale::Free(s) => number(*s),
        });
        let t = &units.states;
        StateFeedback {
            gain: units.gain(&k),
            lyapunov: Mat::from_fn(t.len(), t.len(), |i, j| t[i] * t[j] * x[(i, j)]),
            claims: claims(units, goals, &self.levels, squared, scales.collect(), s),
            achieved: Vec::new(),
            iterations: s.outcome.iterations,
        }
    }
}
