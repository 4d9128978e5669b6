//! `method = "robust-state-feedback"`: one gain from the vehicle's states for all vehicles of a range.

use super::design_gains::high_gain;
use super::design_limits::within;
use super::design_methods::Found;
use super::design_mixed::{claims, goals, iterations};
use super::design_outcome::{ControllerFile, DesignOutcome, DesignVertex};
use super::design_problem::Problem;
use super::design_search::{Attempt, Made, Try};
use super::design_states::in_states;
use super::{Flag, Named, StudyError};
use crate::linalg::Mat;
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::optimize::SdpSettings;
use crate::synthesis::{
    Assumption, MixedEnd, StateFeedback, SynthesisError, broken_assumptions, lqg_plant, robust_state_feedback,
};

/// A plant in the middle of a range whose entries are this near to the vertices' mean is a mixture of them.
const MIXTURE: f64 = 1e-9;

/// A vehicle of the range, and its plant with its states measured.
pub(super) struct Vertex {
    pub problem: Problem,
    pub at: Named<f64>,
    /// Without weighted controls.
    bare: GeneralizedPlant,
    plant: GeneralizedPlant,
}

/// All that a robust design is made of.
pub(super) struct Family {
    /// The vehicle as it is stated.
    stated: Vertex,
    /// The corners of the range of each plant; the vehicle as stated where there is neither.
    vertices: Vec<Vertex>,
    /// The middle of each range.
    middles: Vec<Vertex>,
    /// Corners of one range, which follow each other in `vertices`.
    corners: usize,
}

impl Family {
    /// # Errors
    /// Fields that the vehicle does not have, measurements that are not its states, a vehicle that no control stabilises.
    pub fn new(problem: &Problem) -> Result<Self, StudyError> {
        let spec = &problem.spec;
        let ranges: Vec<(&str, [f64; 2])> = spec.range.iter().map(|(n, r)| (n, *r)).collect();
        let bases: Vec<Vec<(String, f64)>> = if spec.plant.is_empty() {
            vec![Vec::new()]
        } else {
            spec.plant.iter().map(named_fields).collect()
        };
        check_apart(problem)?;
        let (mut vertices, mut middles) = (Vec::new(), Vec::new());
        let corners = 1usize << ranges.len();
        for base in bases {
            let with = |value: &dyn Fn(usize, [f64; 2]) -> f64| {
                let of = ranges.iter().enumerate().map(|(k, (n, r))| ((*n).to_owned(), value(k, *r)));
                base.iter().cloned().chain(of).collect::<Vec<_>>()
            };
            for corner in 0..corners {
                vertices.push(Vertex::new(problem, with(&|k, r| r[corner >> k & 1]))?);
            }
            if corners > 1 {
                middles.push(Vertex::new(problem, with(&|_, r| 0.5 * (r[0] + r[1])))?);
            }
        }
        let stated = Vertex::new(problem, Vec::new())?;
        Ok(Family { stated, vertices, middles, corners })
    }

    /// Whether there is more than the vehicle as stated.
    fn is_many(&self) -> bool {
        self.vertices.iter().any(|v| !v.at.is_empty())
    }

    /// How far the middles are from the means of their corners, of the largest entry of each matrix.
    fn bend(&self) -> f64 {
        let parts = |p: &GeneralizedPlant| {
            let s = p.system();
            [s.a().clone(), s.b().clone(), s.c().clone(), s.d().clone()]
        };
        let mut most = 0.0f64;
        for (middle, corners) in self.middles.iter().zip(self.vertices.chunks(self.corners)) {
            for (k, m) in parts(&middle.plant).iter().enumerate() {
                let own: Vec<Mat> = corners.iter().map(|v| parts(&v.plant)[k].clone()).collect();
                for i in 0..m.nrows() {
                    for j in 0..m.ncols() {
                        let mean = own.iter().map(|c| c[(i, j)]).sum::<f64>() / own.len() as f64;
                        let size = own.iter().map(|c| c[(i, j)].abs()).fold(m[(i, j)].abs(), f64::max);
                        if size > 0.0 {
                            most = most.max((m[(i, j)] - mean).abs() / size);
                        }
                    }
                }
            }
        }
        most
    }
}

impl Vertex {
    fn new(problem: &Problem, fields: Vec<(String, f64)>) -> Result<Self, StudyError> {
        let field = if problem.spec.plant.is_empty() { "range" } else { "plant" };
        let at: Named<f64> = fields.iter().cloned().collect();
        let own = problem.at(&fields).map_err(|e| match e {
            StudyError::Vehicle { source, .. } if !fields.is_empty() => {
                wrong_fields(field, &at, &source.to_string())
            }
            other => other,
        })?;
        let fail = |e: SynthesisError| StudyError::Design {
            name: problem.spec.vehicle.clone(),
            source: Box::new(e),
        };
        let bare = in_states(&own)?;
        let plant = lqg_plant(&bare, &super::design_mixed::weights(&own, 0.0, 0.0)).map_err(fail)?;
        let broken = broken_assumptions(&plant).map_err(fail)?;
        if let Some(b) = broken.iter().find(|b| b.assumption == Assumption::Stabilisable) {
            let place = if fields.is_empty() { "the vehicle as stated".into() } else { words(&at) };
            return Err(StudyError::Setting {
                field: if fields.is_empty() { "vehicle" } else { field },
                expected: "vehicles that the actuators stabilise".into(),
                found: super::design_words::short_numbers(&format!("{place}: {b}")),
            });
        }
        Ok(Vertex { problem: own, at, bare, plant })
    }
}

/// Refuses a field that a further plant states and the range replaces.
fn check_apart(problem: &Problem) -> Result<(), StudyError> {
    let spec = &problem.spec;
    for (k, plant) in spec.plant.iter().enumerate() {
        for (own, _) in plant.iter() {
            if let Some((name, _)) = spec.range.iter().find(|(name, _)| problem.file.overlap(own, name)) {
                return Err(StudyError::Setting {
                    field: "plant",
                    expected: "fields that are not in [range]: each plant has the corners of the range"
                        .into(),
                    found: format!("`{own}` in [[plant]] number {}, and `{name}` in [range]", k + 1),
                });
            }
        }
    }
    Ok(())
}

/// Fields and values as a vehicle takes them.
pub(super) fn named_fields(of: &Named<f64>) -> Vec<(String, f64)> {
    of.iter().map(|(n, v)| (n.to_owned(), *v)).collect()
}

/// A vehicle that its fields make none of.
pub(super) fn wrong_fields(field: &'static str, at: &Named<f64>, found: &str) -> StudyError {
    StudyError::Setting {
        field,
        expected: "fields and values of the vehicle".into(),
        found: if found.ends_with("expected a finite number") {
            format!("{}: values so small or large that the vehicle's equations overflow", words(at))
        } else {
            format!("{}: {found}", words(at))
        },
    }
}

/// Fields and values.
pub(super) fn words(at: &Named<f64>) -> String {
    at.iter().map(|(n, v)| format!("{n} = {}", super::design_goal::plain(*v))).collect::<Vec<_>>().join(", ")
}

pub(super) fn by_robust(problem: &Problem, family: &Family, outcome: &mut DesignOutcome) -> Found {
    let region = problem.spec.poles.unwrap_or_default().region().unwrap_or_default();
    let plants: Vec<GeneralizedPlant> = family.vertices.iter().map(|v| v.plant.clone()).collect();
    let as_asked = Try { times: 1.0, back_off: 0.0, region, added_weight: 0.0, patient: true };
    let solve = |tried: Try| {
        if tried.added_weight == 0.0 {
            return feedback(&family.stated.problem, &plants, tried);
        }
        let weights = super::design_mixed::weights(&family.stated.problem, 0.0, tried.added_weight);
        let weighted = family.vertices.iter().map(|v| lqg_plant(&v.bare, &weights));
        feedback(&family.stated.problem, &weighted.collect::<Result<Vec<_>, _>>()?, tried)
    };
    let Some(kept) = within(problem, 0.0, region, outcome, solve)? else { return Ok(None) };
    let found = &kept.of;
    let all = goals(&family.stated.problem, &plants[0], as_asked);
    claims(problem, &all, &found.claims, &found.achieved, outcome);
    kept.claim(outcome);
    outcome.warnings.extend(high_gain(problem, &outcome.passive, &kept.controller));
    iterations(found.iterations, outcome);
    if family.is_many() {
        let own = std::slice::from_ref(&family.stated.plant);
        match feedback(&family.stated.problem, own, as_asked)? {
            Attempt::Found(made) => {
                outcome.claimed.insert("nominal_objective", made.of.claims.objective);
                outcome.nominal = Some(named(problem, &made.controller));
            }
            _ => {
                let text =
                    "the vehicle as stated has no such design by itself, and so there is none beside it";
                outcome.notes.push(Flag { name: "no-nominal".into(), text: text.into() });
            }
        }
        let bend = family.bend();
        if bend > MIXTURE {
            let text = format!(
                "between the corners of `range` the vehicle is not a mixture of them (its matrices bend by up to {:.2} %): the bounds hold \
                 at the corners, and in between they are only looked at in the middle",
                100.0 * bend
            );
            outcome.warnings.push(Flag { name: "corners-only".into(), text });
        }
    }
    Ok(Some(kept.controller))
}

fn feedback(
    problem: &Problem,
    plants: &[GeneralizedPlant],
    tried: Try,
) -> Result<Attempt<StateFeedback>, SynthesisError> {
    let gap = (tried.back_off > 0.0).then_some(tried.back_off);
    let settings = SdpSettings { interior_gap: gap, double_double: tried.patient, ..SdpSettings::default() };
    let all = goals(problem, &plants[0], tried);
    Ok(match robust_state_feedback(plants, &all, &settings)? {
        MixedEnd::Found(of) => {
            let poles = of.achieved.iter().flat_map(|a| a.poles.iter().copied()).collect();
            let controller = StateSpace::continuous_gain(of.gain.clone())?;
            Attempt::Found(Box::new(Made { controller, of, poles }))
        }
        MixedEnd::Infeasible { bounds_times, .. } => Attempt::Infeasible(bounds_times),
        MixedEnd::Stalled(measures) => Attempt::Stalled(measures),
    })
}

fn named(problem: &Problem, k: &StateSpace<Continuous>) -> ControllerFile {
    let y = problem.measurements.iter().map(|o| o.name.clone()).collect();
    let u = problem.vehicle.actuators().iter().map(|a| a.name.clone()).collect();
    ControllerFile::new(k, y, u)
}

impl Family {
    /// Each vehicle of the range without control, with the robust gain and with the nominal one.
    pub fn measure(&self, k: &StateSpace<Continuous>, outcome: &mut DesignOutcome) -> Result<(), StudyError> {
        if !self.is_many() {
            return Ok(());
        }
        let nominal = match &outcome.nominal {
            Some(file) => Some(file.state_space().map_err(|e| StudyError::Design {
                name: self.stated.problem.spec.vehicle.clone(),
                source: Box::new(e.into()),
            })?),
            None => None,
        };
        for (vertex, corner) in
            self.vertices.iter().map(|v| (v, true)).chain(self.middles.iter().map(|v| (v, false)))
        {
            let p = &vertex.problem;
            let passive = p.measure(None)?;
            let closed = p.measure(Some(k))?;
            let nominal = nominal.as_ref().map(|n| p.measure(Some(n))).transpose()?;
            let mut objective = Named::default();
            objective.insert("passive", super::design::objective(p, &passive));
            objective.insert("closed", super::design::objective(p, &closed));
            if let Some(n) = nominal.as_ref().filter(|n| n.stable) {
                objective.insert("nominal", super::design::objective(p, n));
            }
            outcome.vertices.push(DesignVertex {
                at: vertex.at.clone(),
                corner,
                passive,
                closed,
                nominal,
                objective,
            });
        }
        Ok(())
    }
}
