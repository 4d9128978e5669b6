//! The goal of a design in one loop, and nothing else: its value and the norms that it is made of, for many loops beside each other.

use super::design::objective;
use super::design_outcome::Measured;
use super::design_problem::{GoalBlock, Problem};
use super::{DesignMethod, Infinite, Named, Rms};
use crate::linalg::LinalgError;
use crate::lti::{Continuous, LtiError, StateSpace};

/// What a loop makes of the goal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GoalNorms {
    /// Its value; none of a goal that only bounds.
    pub value: Option<f64>,
    /// Norms that are minimised or bounded: `h2_NAME`, `hinf_NAME`.
    pub norms: Named<f64>,
}

impl GoalNorms {
    /// Of the loop with a controller; of one that is not stable, how fast its fastest growing pole does, 1/s (∞ of one that is not well
    /// posed).
    ///
    /// # Errors
    /// A controller of other signals; an iteration that does not converge.
    pub fn of(problem: &Problem, controller: &StateSpace<Continuous>) -> Result<Result<Self, f64>, LtiError> {
        let closed = match problem.plant.close(controller) {
            Err(LtiError::IllPosed { .. }) => return Ok(Err(f64::INFINITY)),
            closed => closed?,
        };
        if !closed.is_stable()? {
            let grows = closed.poles()?.iter().map(|p| p.re).fold(0.0, f64::max);
            return Ok(Err(grows));
        }
        let inputs: Vec<usize> = (0..closed.inputs()).collect();
        let mut measured = Measured { stable: true, ..Measured::default() };
        let mut norms = Named::default();
        let (h2, hinf) = blocks(problem);
        for (name, members) in h2 {
            let norm = match closed.select(&members, &inputs)?.h2_norm() {
                Ok(v) => Rms::Finite(v),
                Err(LtiError::NotStrictlyProper { .. }) => Rms::Infinite(Infinite::Infinite),
                // rounding sees a pole on the axis on either side of it
                Err(LtiError::NotStable { pole, .. }) => return Ok(Err(pole.re.max(0.0))),
                Err(LtiError::Linalg(LinalgError::Singular { value, .. })) => return Ok(Err(value.max(0.0))),
                Err(e) => return Err(e),
            };
            norms.insert(format!("h2_{name}"), norm.finite().unwrap_or(f64::INFINITY));
            measured.h2.insert(name, norm);
        }
        for (name, members) in hinf {
            let norm = closed.select(&members, &inputs)?.hinf_norm()?.norm;
            norms.insert(format!("hinf_{name}"), norm);
            measured.hinf.insert(name, norm);
        }
        let value = problem.has_objective().then(|| objective(problem, &measured));
        Ok(Ok(GoalNorms { value, norms }))
    }

    /// Value and norms over those of another loop; those that are 0 or infinite there are left out.
    pub fn over(&self, nominal: &GoalNorms) -> (Option<f64>, Named<f64>) {
        let usable = |v: &f64| *v > 0.0 && v.is_finite();
        let value = self.value.zip(nominal.value.filter(usable)).map(|(now, then)| now / then);
        let ratios = self.norms.iter().filter_map(|(name, now)| {
            let then = *nominal.norms.get(name)?;
            usable(&then).then(|| (name.to_owned(), now / then))
        });
        (value, ratios.collect())
    }
}

type Blocks = Vec<(String, Vec<usize>)>;

/// Blocks whose H2 norms, and whose H∞ norms, the goal asks for.
fn blocks(problem: &Problem) -> (Blocks, Blocks) {
    let own = |g: &GoalBlock| (g.name.clone(), g.members.clone());
    let goals: Blocks = problem.goals.iter().map(own).collect();
    let peaks: Blocks = problem.peaks.iter().map(|p| own(&p.block)).collect();
    if problem.spec.method == DesignMethod::Hinf {
        return (Vec::new(), goals);
    }
    let mut h2: Blocks = goals;
    h2.extend(problem.bounded.iter().map(own));
    // the weighted force belongs to the value
    if problem.spec.input_weight > 0.0 {
        let force = |i: &usize| problem.reported[*i].base == "actuator_force";
        h2.push(("actuator_force".to_owned(), (0..problem.reported.len()).filter(force).collect()));
    }
    let mut once: Blocks = Vec::new();
    for block in h2.into_iter().filter(|(_, members)| !members.is_empty()) {
        if !once.iter().any(|(name, _)| *name == block.0) {
            once.push(block);
        }
    }
    (once, peaks)
}
