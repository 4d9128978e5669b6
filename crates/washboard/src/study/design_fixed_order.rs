//! `method = "fixed-order"`: from a design's words to goals and bounds of one or several vehicles, and the proof of the result.

use super::design_fixed_outcome::{FixedOrderOutcome, FixedOrderTarget, Stationarity, TargetAim, TargetNorm};
use super::design_fixed_spec::{FreeEntry, StructureEntry, StructureKind, StructureSpec};
use super::design_fixed_starts::{given, invariant_frequencies, regulators};
use super::design_fixed_words::{not_met, not_stabilised, refused};
use super::design_gains::{fast_controller, fastest, largest_gain};
use super::design_methods::Found;
use super::design_mixed::minimal;
use super::design_outcome::{DesignOutcome, DesignStatus, DesignVertex, Measured};
use super::design_outputs::outputs;
use super::design_problem::{GoalBlock, Norm, PeakBlock, Problem};
use super::design_robust::{named_fields, wrong_fields};
use super::{Input, Named, StudyError};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use crate::synthesis::{
    Aim, Channel, Entry, FixedOrder, FixedOrderDesign, FixedOrderEnd, FixedOrderSettings, FixedOrderWork,
    Local, Measure, Structure, SynthesisError, Target, fixed_order,
};
use crate::units::hz;

/// Norms of the search and recomputed ones agree to this, and bounds are exceeded by at most this.
const SAME: f64 = 1e-5;

/// The loop's poles are left of minus this share of the vehicle's fastest pole where no region is asked for.
const CLEAR: f64 = 1e-6;
/// Random starts of a search for bounds alone.
const FEW: usize = 4;

/// One of the vehicles that a controller is for.
struct Member {
    /// Its goal, over its own passive norms.
    problem: Problem,
    at: Named<f64>,
    /// Without modes that no signal shows.
    plant: GeneralizedPlant,
}

/// What a target is in the design's words.
#[derive(Clone)]
struct About {
    name: String,
    norm: TargetNorm,
    aim: TargetAim,
    /// The value is so many times what is minimised, or this is the bound.
    unit: f64,
}

/// All that a fixed-order design is made of.
pub(super) struct Fleet {
    members: Vec<Member>,
    structure: Structure,
    start: Option<StateSpace<Continuous>>,
    /// The file of `start`.
    pub input: Option<Input>,
    targets: Vec<Target>,
    about: Vec<About>,
}

impl Fleet {
    /// # Errors
    /// Fields that the vehicle does not have, a structure that does not fit the plant, a start with other signals.
    pub fn new(problem: &Problem) -> Result<Self, StudyError> {
        let spec = &problem.spec;
        let structure = structure(problem)?;
        let bases: Vec<Vec<(String, f64)>> = if spec.plant.is_empty() {
            vec![Vec::new()]
        } else {
            spec.plant.iter().map(named_fields).collect()
        };
        let members = bases.into_iter().map(|f| Member::new(problem, f)).collect::<Result<Vec<_>, _>>()?;
        let (start, input) = given(problem)?.unzip();
        let (targets, about) = members.iter().enumerate().flat_map(|(k, m)| targets(&m.problem, k)).unzip();
        Ok(Fleet { members, structure, start, input, targets, about })
    }

    fn is_many(&self) -> bool {
        self.members.len() > 1 || self.members.iter().any(|m| !m.at.is_empty())
    }
}

impl Member {
    fn new(problem: &Problem, fields: Vec<(String, f64)>) -> Result<Self, StudyError> {
        let at: Named<f64> = fields.iter().cloned().collect();
        let own = problem.at(&fields).map_err(|e| match e {
            StudyError::Vehicle { source, .. } if !fields.is_empty() => {
                wrong_fields("plant", &at, &source.to_string())
            }
            other => other,
        })?;
        let own = if fields.is_empty() || !problem.spec.normalize_at.is_empty() {
            own
        } else {
            own.over_its_own(&at)?
        };
        let plant = minimal(own.plant.clone()).map_err(|e| fail(problem, e))?;
        Ok(Member { problem: own, at, plant })
    }
}

fn fail(problem: &Problem, e: LtiError) -> StudyError {
    StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) }
}

impl Problem {
    /// The same goal over this vehicle's own passive norms.
    fn over_its_own(self, at: &Named<f64>) -> Result<Problem, StudyError> {
        let passive = self.plant.passive();
        let of = |g: &GoalBlock, norm: Norm| -> Result<GoalBlock, StudyError> {
            let found = norm.of(&passive, &g.members).map_err(|e| fail(&self, e))?;
            if !(found > 0.0 && found.is_finite()) {
                return Err(wrong_fields(
                    "plant",
                    at,
                    &format!("`{}` has a passive norm of {found}", g.name),
                ));
            }
            Ok(GoalBlock { passive: found, ..g.clone() })
        };
        let goals = self.goals.iter().map(|g| of(g, Norm::H2)).collect::<Result<Vec<_>, _>>()?;
        let bounded = self.bounded.iter().map(|g| of(g, Norm::H2)).collect::<Result<Vec<_>, _>>()?;
        let peak = |p: &PeakBlock| Ok(PeakBlock { block: of(&p.block, Norm::Hinf)?, bound: p.bound });
        let peaks = self.peaks.iter().map(peak).collect::<Result<Vec<_>, StudyError>>()?;
        Ok(Problem { goals, bounded, peaks, ..self })
    }
}

/// The structure asked for, for the plant's measurements and actuators.
fn structure(problem: &Problem) -> Result<Structure, StudyError> {
    let spec = &problem.spec;
    let (nu, ny) = (problem.plant.nu(), problem.plant.ny());
    let wrong = |field, expected: String, found: String| StudyError::Setting { field, expected, found };
    let unfit = |e: LtiError| fail(problem, e);
    let asked = spec.goal.order;
    let own_order = |order: usize, why: &str| match asked {
        Some(found) if found != order => {
            Err(wrong("goal.order", format!("{order}, {why}, or nothing"), found.to_string()))
        }
        _ => Ok(order),
    };
    if let Some(StructureSpec::Entries(rows)) = &spec.structure {
        let Some(order) = rows.len().checked_sub(nu) else {
            let expected = format!("a row of each state and of each of the {nu} actuators");
            return Err(wrong("structure", expected, format!("{} rows", rows.len())));
        };
        own_order(order, &format!("the {} rows of structure less {nu} of actuators", rows.len()))?;
        let columns = order + ny;
        if let Some((k, row)) = rows.iter().enumerate().find(|(_, r)| r.len() != columns) {
            let expected = format!("rows of {columns} entries: {order} states, {ny} measurements");
            return Err(wrong("structure", expected, format!("{} in row {}", row.len(), k + 1)));
        }
        let entry = |e: &StructureEntry| match e {
            StructureEntry::Word(FreeEntry::Free) => Entry::Free,
            StructureEntry::Number(v) => Entry::Fixed(*v),
        };
        let entries: Vec<Entry> = rows.iter().flatten().map(entry).collect();
        if !entries.contains(&Entry::Free) {
            return Err(wrong("structure", "an entry that is \"free\"".into(), "numbers alone".into()));
        }
        if let Some(Entry::Fixed(v)) = entries.iter().find(|e| matches!(e, Entry::Fixed(v) if !v.is_finite()))
        {
            return Err(wrong("structure", "finite numbers".into(), v.to_string()));
        }
        return Structure::of_entries(order, nu, ny, entries).map_err(unfit);
    }
    match spec.structure_kind().unwrap_or(StructureKind::Full) {
        StructureKind::Full => Ok(Structure::full(asked.unwrap_or(0), nu, ny)),
        StructureKind::StrictlyProper => {
            let order = asked.unwrap_or(0);
            if order == 0 {
                let expected = "1 or more: without states nothing of a strictly proper controller is left";
                return Err(wrong("goal.order", expected.into(), "0".into()));
            }
            Ok(Structure::full(order, nu, ny).strictly_proper())
        }
        StructureKind::Pid => {
            if (nu, ny) != (1, 1) {
                let found = format!("{ny} measurements and {nu} actuators");
                return Err(wrong(
                    "structure",
                    "one measurement and one actuator of a \"pid\"".into(),
                    found,
                ));
            }
            own_order(2, "integrator and filter of structure = \"pid\"")?;
            Structure::pid(spec.pid_filter_s.unwrap_or(0.0)).map_err(unfit)
        }
        StructureKind::Decentralised => {
            let parts = spec.local.iter().map(|l| local(problem, l)).collect::<Result<Vec<_>, _>>()?;
            let order = parts.iter().map(|p| p.order).sum();
            own_order(order, "the sum of all [[local]] orders")?;
            for (u, actuator) in problem.vehicle.actuators().iter().enumerate() {
                let times = parts.iter().flat_map(|p| &p.controls).filter(|c| **c == u).count();
                if times != 1 {
                    let expected = format!("each of the {nu} actuators in one [[local]]");
                    return Err(wrong(
                        "local.actuators",
                        expected,
                        format!("`{}` {times} times", actuator.name),
                    ));
                }
            }
            Structure::decentralised(nu, ny, &parts).map_err(unfit)
        }
    }
}

/// A part of a decentralised controller, by numbers.
fn local(problem: &Problem, of: &super::LocalSection) -> Result<Local, StudyError> {
    let all = outputs(&problem.vehicle, &of.measurements, "local.measurements")?;
    let measurements = all.iter().map(|o| {
        problem.measurements.iter().position(|m| m == o).ok_or_else(|| StudyError::Setting {
            field: "local.measurements",
            expected: "some of the design's measurements".into(),
            found: format!("`{}`", o.name),
        })
    });
    let known = problem.vehicle.actuators();
    let controls = of.actuators.iter().map(|name| {
        known.iter().position(|a| a.name == *name).ok_or_else(|| {
            let names: Vec<&str> = known.iter().map(|a| a.name.as_str()).collect();
            StudyError::Setting {
                field: "local.actuators",
                expected: format!("actuators of the vehicle: {}", names.join(", ")),
                found: format!("`{name}`"),
            }
        })
    });
    Ok(Local {
        order: of.order,
        measurements: measurements.collect::<Result<_, _>>()?,
        controls: controls.collect::<Result<_, _>>()?,
    })
}

/// Goals and bounds of one vehicle, whose performances are its `reported` outputs.
fn targets(problem: &Problem, plant: usize) -> Vec<(Target, About)> {
    let channel = |outputs: Vec<(usize, f64)>| Channel { outputs, disturbances: Vec::new() };
    let whole = |g: &GoalBlock| channel(g.members.iter().map(|i| (*i, 1.0)).collect());
    let mut all = Vec::new();
    let mut add = |name: &str, measure: Measure, aim: TargetAim, unit: f64| {
        let norm = if matches!(measure, Measure::H2(_)) { TargetNorm::H2 } else { TargetNorm::Hinf };
        let number = if aim == TargetAim::Goal { Aim::Goal(unit) } else { Aim::Bound(unit) };
        let target = Target { plant, measure, aim: number, name: name.to_owned() };
        all.push((target, About { name: name.to_owned(), norm, aim, unit }));
    };
    if !problem.goals.is_empty() {
        let of = |g: &GoalBlock| g.members.iter().map(|i| (*i, g.weight / g.passive)).collect::<Vec<_>>();
        let mut rows: Vec<(usize, f64)> = problem.goals.iter().flat_map(of).collect();
        let rho = problem.spec.input_weight;
        if rho > 0.0 {
            let force = |i: &usize| problem.reported[*i].base == "actuator_force";
            rows.extend((0..problem.reported.len()).filter(force).map(|i| (i, rho.sqrt())));
        }
        add("goal", Measure::H2(channel(rows)), TargetAim::Goal, 1.0);
    }
    for p in &problem.peaks {
        let (b, of) = (&p.block, Measure::Hinf(whole(&p.block)));
        if b.weight > 0.0 {
            add(&b.name, of.clone(), TargetAim::Goal, b.passive / b.weight);
        }
        if let Some(times) = p.bound {
            add(&b.name, of, TargetAim::Bound, times * b.passive);
        }
    }
    for g in &problem.bounded {
        add(&g.name, Measure::H2(whole(g)), TargetAim::Bound, g.weight * g.passive);
    }
    all
}

pub(super) fn by_fixed_order(problem: &Problem, fleet: &Fleet, outcome: &mut DesignOutcome) -> Found {
    let spec = &problem.spec;
    let plants: Vec<GeneralizedPlant> = fleet.members.iter().map(|m| m.plant.clone()).collect();
    let mut frequencies_rad_s: Vec<f64> = Vec::new();
    for omega in fleet.members.iter().flat_map(|m| invariant_frequencies(&m.problem)) {
        if !frequencies_rad_s.contains(&omega) {
            frequencies_rad_s.push(omega);
        }
    }
    let starts: Vec<_> = fleet.start.iter().cloned().chain(regulators(&plants, &fleet.targets)).collect();
    let section = spec.fixed_order.unwrap_or_default();
    let asked = FixedOrder {
        plants,
        targets: fleet.targets.clone(),
        structure: fleet.structure.clone(),
        max_pole_rad_s: Some(spec.max_pole_rad_s()),
        max_gain: spec.goal.max_gain,
        margin_rad_s: spec.poles.and_then(|p| p.max_real_rad_s).map_or_else(|| fleet.clear(), |v| -v),
        starts,
        frequencies_rad_s,
    };
    let ended = match searched(&asked, &section.into()) {
        Err(SynthesisError::Lti(LtiError::NotStable { pole, .. })) => {
            outcome.status = DesignStatus::Refused;
            let found = format!("its loop has a pole at {:e} {:+e}i 1/s", pole.re, pole.im);
            outcome.why = Some(refused(&Named::default(), &found));
            return Ok(None);
        }
        ended => ended?,
    };
    let (design, met) = match ended {
        FixedOrderEnd::NotStabilised { abscissa } => {
            outcome.status = DesignStatus::Stalled;
            let tried = FixedOrderOutcome {
                abscissa_rad_s: Some(abscissa).filter(|a| a.is_finite()),
                starts: asked.starts.len() + 1 + section.tries,
                ..FixedOrderOutcome::default()
            };
            outcome.why = Some(not_stabilised(problem, fleet.structure.order(), &tried));
            outcome.fixed_order = Some(tried);
            return Ok(None);
        }
        FixedOrderEnd::Designed(d) => (d, true),
        FixedOrderEnd::BoundsNotMet(d) => (d, false),
    };
    outcome.fixed_order = Some(fleet.evidence(&design));
    let found = [fastest(&design.controller)?, largest_gain(&design.controller).unwrap_or(f64::INFINITY)];
    if !met {
        outcome.status = DesignStatus::Infeasible;
        outcome.why = Some(not_met(problem, fleet.structure.order(), outcome, found));
        return Ok(None);
    }
    fleet.claim(&design, found, outcome);
    outcome.warnings.extend(fast_controller(problem, &outcome.passive, found));
    Ok(Some(design.controller))
}

/// The design; where its bounds are not met, the one that exceeds them least, or from one that meets them the design again.
fn searched(asked: &FixedOrder, settings: &FixedOrderSettings) -> Result<FixedOrderEnd, SynthesisError> {
    let first = match fixed_order(asked, settings)? {
        FixedOrderEnd::BoundsNotMet(first) => first,
        end => return Ok(end),
    };
    let targets: Vec<Target> = asked.targets.iter().filter(|t| is_bound(t)).cloned().collect();
    if targets.is_empty() || targets.len() == asked.targets.len() {
        return Ok(FixedOrderEnd::BoundsNotMet(first));
    }
    let again = |targets: Vec<Target>, from: &StateSpace<Continuous>, tries: usize| {
        let starts = std::iter::once(from).chain(&asked.starts).cloned().collect();
        let settings = FixedOrderSettings { tries, lower_orders: false, ..*settings };
        // what rounding spoils here leaves the first result as it is
        fixed_order(&FixedOrder { targets, starts, ..asked.clone() }, &settings).ok()
    };
    let mut work = first.work;
    let least = match again(targets, &first.controller, settings.tries.min(FEW)) {
        Some(FixedOrderEnd::Designed(within)) => {
            work = both(work, within.work);
            match again(asked.targets.clone(), &within.controller, 0) {
                Some(FixedOrderEnd::Designed(d)) => {
                    let work = both(work, d.work);
                    return Ok(FixedOrderEnd::Designed(Box::new(FixedOrderDesign { work, ..*d })));
                }
                _ => first,
            }
        }
        Some(FixedOrderEnd::BoundsNotMet(least)) => {
            work = both(work, least.work);
            if least.violation < first.violation { least } else { first }
        }
        _ => first,
    };
    Ok(FixedOrderEnd::BoundsNotMet(Box::new(FixedOrderDesign { work, ..*least })))
}

fn is_bound(t: &Target) -> bool {
    matches!(t.aim, Aim::Bound(_))
}

fn both(one: FixedOrderWork, other: FixedOrderWork) -> FixedOrderWork {
    FixedOrderWork {
        starts: one.starts + other.starts,
        stabilised: one.stabilised + other.stabilised,
        loops: one.loops + other.loops,
        factorisations: one.factorisations + other.factorisations,
        eigenproblems: one.eigenproblems + other.eigenproblems,
        lyapunov: one.lyapunov + other.lyapunov,
    }
}

impl Fleet {
    /// Poles nearer to the axis than this are on it but for rounding.
    fn clear(&self) -> f64 {
        let fastest = |m: &Member| {
            let poles = m.plant.system().poles().unwrap_or_default();
            poles.iter().map(|p| p.norm()).fold(0.0, f64::max)
        };
        CLEAR * self.members.iter().map(fastest).fold(0.0, f64::max)
    }

    fn evidence(&self, d: &FixedOrderDesign) -> FixedOrderOutcome {
        // where bounds are not met, only these may have been looked at
        let known = |t: &Target| d.values.len() == self.targets.len() || is_bound(t);
        let own = self.targets.iter().zip(&self.about).filter(|(t, _)| known(t));
        let of = |((t, a), v): ((&Target, &About), &crate::synthesis::TargetValue)| FixedOrderTarget {
            name: a.name.clone(),
            vehicle: self.is_many().then_some(t.plant + 1),
            norm: a.norm,
            aim: a.aim,
            value: v.value,
            recomputed: None,
            relative: v.value / a.unit,
            at_hz: v.omega_rad_s.filter(|w| w.is_finite()).map(hz),
            // never −0
            multiplier: v.multiplier + 0.0,
            active_hz: v.active_rad_s.iter().filter(|w| w.is_finite()).map(|w| hz(*w)).collect(),
        };
        let counts = [
            ("loops", d.work.loops),
            ("factorisations", d.work.factorisations),
            ("eigenproblems", d.work.eigenproblems),
            ("lyapunov", d.work.lyapunov),
        ];
        FixedOrderOutcome {
            targets: own.zip(&d.values).map(of).collect(),
            violation: Some(d.violation),
            abscissa_rad_s: None,
            stationarity: d.stationarity.as_ref().map(|s| Stationarity {
                distance: s.distance,
                radius: s.radius,
                points: s.points,
            }),
            converged: d.converged,
            starts: d.work.starts,
            stabilised: d.work.stabilised,
            work: counts.into_iter().map(|(n, v)| (n.to_owned(), v)).collect(),
        }
    }

    fn claim(&self, d: &FixedOrderDesign, [pole, gain]: [f64; 2], outcome: &mut DesignOutcome) {
        if let Some(goal) = d.goal {
            outcome.claimed.insert("objective", goal);
        }
        if !self.is_many() {
            for (a, v) in self.about.iter().zip(&d.values).filter(|(a, _)| a.name != "goal") {
                outcome.claimed.insert(claimed_name(a), v.value);
            }
        }
        if d.controller.order() > 0 {
            outcome.claimed.insert("fastest_controller_pole", pole);
        }
        if gain.is_finite() {
            outcome.claimed.insert("controller_gain", gain);
        }
    }

    /// Every vehicle's loop from vehicle and controller alone, beside what is claimed of it: a contradiction refuses.
    ///
    /// # Errors
    /// A vehicle that has no norms.
    pub fn confirm(&self, k: &StateSpace<Continuous>, outcome: &mut DesignOutcome) -> Result<(), StudyError> {
        let mut worst = f64::NEG_INFINITY;
        for (number, member) in self.members.iter().enumerate() {
            let p = &member.problem;
            let closed = match p.measure(Some(k)) {
                // next to the axis
                Err(StudyError::Ride { source, .. }) => {
                    return Ok(self.refuse(refused(&member.at, &source.to_string()), outcome));
                }
                measured => measured?,
            };
            if let Some(found) = self.contradiction(number, &closed, outcome) {
                return Ok(self.refuse(refused(&member.at, &found), outcome));
            }
            let value = super::design::objective(p, &closed);
            worst = worst.max(value);
            if self.is_many() {
                let passive = p.measure(None)?;
                let mut objective = Named::default();
                if p.has_objective() {
                    objective.insert("passive", super::design::objective(p, &passive));
                    objective.insert("closed", value);
                }
                let at = member.at.clone();
                outcome.vertices.push(DesignVertex {
                    at,
                    corner: true,
                    passive,
                    closed,
                    nominal: None,
                    objective,
                });
            }
        }
        if let Some(claimed) = outcome.claimed.get("objective").copied() {
            outcome.claimed.insert("objective_recomputed", worst);
            if worst > claimed * (1.0 + SAME) {
                let found = format!("the goal is claimed to be {claimed:e} and recomputed as {worst:e}");
                self.refuse(refused(&Named::default(), &found), outcome);
            } else if self.is_many() {
                outcome.objective.insert("worst", worst);
            }
        }
        Ok(())
    }

    fn refuse(&self, why: String, outcome: &mut DesignOutcome) {
        outcome.status = DesignStatus::Refused;
        outcome.why = Some(why);
        outcome.vertices.clear();
    }

    /// What a loop has beside what is claimed of it; in words where the two differ.
    fn contradiction(&self, number: usize, closed: &Measured, outcome: &mut DesignOutcome) -> Option<String> {
        let slowest = closed.poles.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let spec = &outcome.design;
        let margin = spec.poles.and_then(|p| p.max_real_rad_s).unwrap_or(0.0);
        if !closed.stable || slowest > margin * (1.0 - SAME) {
            return Some(format!(
                "the loop has a pole with real part {slowest:e} 1/s, where {margin} is allowed"
            ));
        }
        if let Some(found) = outcome.claimed.get("fastest_controller_pole")
            && *found > spec.max_pole_rad_s() * (1.0 + SAME)
        {
            return Some(format!("the controller has a pole at {found:e} rad/s"));
        }
        if let (Some(most), Some(found)) = (spec.goal.max_gain, outcome.claimed.get("controller_gain"))
            && *found > most * (1.0 + SAME)
        {
            return Some(format!("the controller has a gain of {found:e}, where {most:e} is allowed"));
        }
        let p = &self.members[number].problem;
        let block = outcome.fixed_order.as_mut()?;
        let own = self.targets.iter().zip(&self.about).zip(&mut block.targets);
        for ((_, a), shown) in own.filter(|((t, _), _)| t.plant == number) {
            let recomputed = match (a.norm, a.aim) {
                (TargetNorm::H2, TargetAim::Goal) => super::design::squared_h2(p, closed).sqrt(),
                (TargetNorm::H2, TargetAim::Bound) => {
                    closed.h2.get(&a.name).and_then(|r| r.finite()).unwrap_or(f64::INFINITY)
                }
                (TargetNorm::Hinf, _) => closed.hinf.get(&a.name).copied().unwrap_or(f64::INFINITY),
            };
            shown.recomputed = Some(recomputed).filter(|v| v.is_finite());
            let differs = !((recomputed - shown.value).abs() <= SAME * shown.value);
            let exceeds = a.aim == TargetAim::Bound && recomputed > a.unit * (1.0 + SAME);
            if differs || exceeds {
                let norm = if a.norm == TargetNorm::H2 { "H2 norm" } else { "largest gain" };
                return Some(format!(
                    "the {norm} of {} is claimed to be {:e} and recomputed as {recomputed:e}",
                    a.name, shown.value
                ));
            }
            if !self.is_many() && a.name != "goal" {
                outcome.claimed.insert(format!("{}_recomputed", claimed_name(a)), recomputed);
            }
        }
        None
    }
}

fn claimed_name(a: &About) -> String {
    let norm = if a.norm == TargetNorm::H2 { "h2" } else { "hinf" };
    format!("{norm}_{}", a.name)
}
