//! What a design costs, said beside what it buys: responses that became worse, noise, a step that is too long.

use super::design_outcome::Measured;
use super::design_outputs::{Lasting, not_decaying};
use super::design_problem::Problem;
use super::design_words::short;
use super::{
    DesignDisturbance, DesignMethod, Discretize, DiscretizeRule, Flag, Infinite, MetricRow, Named,
    ResponseGroup, Rms, StudyError,
};
use crate::linalg::{C64, LinalgError, RealSchur};
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::synthesis::SynthesisError;

/// A response that is so many times the passive one at its worst is worth a warning.
const WORSE_PEAK: f64 = 3.0;
/// A mode slower than the vehicle's slowest, or faster than its fastest, by this factor is worth a warning.
const PACE: f64 = 100.0;
/// What is felt more than without control by this share is worth a warning where the plain rms says the contrary, and an rms that the goal
/// minimises.
const FELT: f64 = 0.01;
/// An output that becomes worse by more than this share is worth a warning.
const WORSE_RMS: f64 = 0.1;

/// Feedthrough around the loop from which on it is noted.
const NEARLY_ALGEBRAIC: f64 = 0.5;

/// Values of a goal that differ by less than this share are the same to a reader.
pub(super) const ALIKE: f64 = 1e-4;

/// A note of a vehicle that has no passive norms.
pub(super) fn unstable_passive(passive: &Measured) -> Option<Flag> {
    let poles: Vec<C64> = passive.poles.iter().map(|p| C64::new(p[0], p[1])).collect();
    let what = not_decaying(&poles).filter(|_| !passive.stable)?;
    let text = format!(
        "the vehicle as stated is not stable without control ({what}): it has no norms, rms and gains of its own, and goals are over \
         those at normalize_at"
    );
    Some(Flag { name: "unstable-passive".into(), text })
}

/// A warning of a controller that its loop alone keeps stable.
pub(super) fn unstable_controller(k: &StateSpace<Continuous>) -> Option<Flag> {
    let poles = k.poles().ok()?;
    let Some(Lasting::Grows(pole)) = not_decaying(&poles) else { return None };
    let swings = if pole.im == 0.0 { String::new() } else { format!(" ± {}i", short(pole.im.abs())) };
    let text = format!(
        "the controller itself is not stable (pole at +{}{swings} 1/s): where its loop is open (a saturated actuator, a failed \
         sensor) it runs away; ask for fewer states or smaller gains, or watch for it",
        short(pole.re)
    );
    Some(Flag { name: "unstable-controller".into(), text })
}

/// A warning of accelerations of the body that are felt more, behind the weighting of ISO 2631-1 or at their peak over the bump: by a little
/// where their rms falls, as it says the contrary, and else by as much as any output.
pub(super) fn felt(rows: &[MetricRow], passive: &Measured, closed: &Measured) -> Option<Flag> {
    let number = |of: &Measured, name: &str| of.rms.get(name).and_then(|r| r.finite());
    let improved = |name: &str| number(closed, name).zip(number(passive, name)).is_some_and(|(a, b)| a < b);
    let worse = rows.iter().filter_map(|row| {
        let name = row.key.strip_prefix("weighted_").or_else(|| row.key.strip_prefix("bump_peak_"))?;
        let change = row.change()?;
        let falls = improved(name);
        (ResponseGroup::of(name) == ResponseGroup::Comfort && change >= if falls { FELT } else { WORSE_RMS })
            .then(|| (falls, format!("{} {:+.1} %", row.what, 100.0 * change)))
    });
    let (falls, worse): (Vec<bool>, Vec<String>) = worse.unzip();
    let what = if falls.iter().all(|f| *f) {
        "the rms of the acceleration is below the passive one, and it is felt more"
    } else {
        "accelerations are felt more than without control"
    };
    let text = format!("{what}: {}", worse.join(", "));
    (!worse.is_empty()).then(|| Flag { name: "felt-more".into(), text })
}

/// A note of a controller that does nothing for its goal.
pub(super) fn no_better(k: &StateSpace<Continuous>, objective: &Named<f64>) -> Option<Flag> {
    let (before, after) = (objective.get("passive")?, objective.get("verified")?);
    let alike = (after / before - 1.0).abs() <= ALIKE && objective.get("worst").is_none();
    let what = if k.order() == 0 { "gain" } else { "controller of this order and structure" };
    alike.then(|| {
        let text = format!(
            "no {what} was found that makes the goal better than no control at all: what is written does next to nothing for it. \
             More states (goal.order), other measurements or larger bounds may"
        );
        Flag { name: "no-gain-better".into(), text }
    })
}

/// A warning where the discrete controller, on the vehicle sampled at its step, is not stable.
pub(super) fn sampled_loop(
    problem: &Problem,
    k: &StateSpace<Continuous>,
    discretize: Discretize,
) -> Result<Option<Flag>, StudyError> {
    let fail =
        |e: SynthesisError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e) };
    let y: Vec<&crate::vehicle::Output> = problem.measurements.iter().collect();
    let all: Vec<usize> = (0..problem.vehicle.actuators().len()).collect();
    let vehicle = problem.vehicle.actuated(&y, &all).map_err(|source| StudyError::Controller {
        name: problem.spec.vehicle.clone(),
        source: Box::new(source),
    })?;
    let discrete = match discretize.rule {
        DiscretizeRule::Tustin => k.tustin(discretize.dt_s),
        DiscretizeRule::ZeroOrderHold => k.sampled(discretize.dt_s),
    };
    let closed = discrete
        .and_then(|d| vehicle.sampled(discretize.dt_s)?.feedback(&d))
        .and_then(|closed| closed.least_stable_pole())
        .map_err(|e| fail(e.into()))?;
    let (pole, margin) = closed.unwrap_or_default();
    Ok((!(margin > 0.0)).then(|| Flag {
        name: "sampled-loop".into(),
        text: format!(
            "at a step of {} s the loop of controller.h and the vehicle is not stable: a pole of size {:.4} (stable: below 1); take a shorter step",
            discretize.dt_s,
            pole.norm()
        ),
    }))
}

/// The controller's feedthrough times the measurements', ρ(D_K D₂₂): at 1 and above e^{−sT} times it turns to 1 right of the axis, at frequencies
/// as high as T is short.
pub(super) fn algebraic_loop(
    problem: &Problem,
    k: &StateSpace<Continuous>,
) -> Result<Option<(Flag, bool)>, StudyError> {
    let fail = |e: LinalgError| StudyError::Design {
        name: problem.spec.vehicle.clone(),
        source: Box::new(LtiError::from(e).into()),
    };
    let around = k.d() * problem.plant.d22();
    let turns = RealSchur::only_eigenvalues(&around).map_err(fail)?;
    let radius = turns.iter().map(|v| v.norm()).fold(0.0, f64::max);
    if radius < NEARLY_ALGEBRAIC {
        return Ok(None);
    }
    let then = if radius >= 1.0 { "any delay" } else { "at 1 any delay" };
    let text = format!(
        "the controller's feedthrough times the measurement's is {} (spectral radius): {then}, however short, makes the loop unstable where \
         no low-pass stands between. Measure what a force does not move at once, or ask for a controller without feedthrough",
        short(radius)
    );
    Ok(Some((Flag { name: "algebraic-loop".into(), text }, radius >= 1.0)))
}

/// Warnings where the loop has poles far slower or faster than any of the vehicle.
pub(super) fn paces(method: DesignMethod, passive: &Measured, closed: &Measured) -> Vec<Flag> {
    let slower = match method {
        DesignMethod::FixedOrder => "ask for a smaller goal.max_pole_rad_s or a goal.max_gain",
        _ => "ask for poles = { max_abs_rad_s = … }, or weight the control (input_weight)",
    };
    let slowest = |m: &Measured| m.poles.iter().map(|p| -p[0]).fold(f64::INFINITY, f64::min);
    let fastest = |m: &Measured| m.poles.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
    let flag = |name: &str, text: String| Flag { name: name.into(), text };
    let (before, after) = (slowest(passive), slowest(closed));
    let slow = (passive.stable && after < before / PACE).then(|| {
        let text = format!(
            "the loop has a mode that decays at {} 1/s, where the vehicle's slowest decays at {}: drifts and offsets stay for long; ask \
             for poles = {{ max_real_rad_s = … }}",
            short(after),
            short(before)
        );
        flag("slow-loop", text)
    });
    let (before, after) = (fastest(passive), fastest(closed));
    let fast = (after > PACE * before).then(|| {
        let text = format!(
            "the loop has a pole at {} rad/s, where the vehicle's fastest is at {}: no actuator follows; {slower}",
            short(after),
            short(before)
        );
        flag("fast-loop", text)
    });
    slow.into_iter().chain(fast).collect()
}

/// The rms of road and sensors' noise together, where both are finite.
pub(super) fn with_noise(
    problem: &Problem,
    k: &StateSpace<Continuous>,
    measured: &Measured,
) -> Result<Named<Rms>, StudyError> {
    let fail =
        |e: SynthesisError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e) };
    let noise = vec![problem.spec.noises().sensor_noise; problem.measurements.len()];
    let noisy = problem.plant.with_sensor_noise(&noise).map_err(|e| fail(e.into()))?;
    let closed = noisy.close(k).map_err(|e| fail(e.into()))?;
    let sensors: Vec<usize> = (problem.plant.nw()..noisy.nw()).collect();
    let mut both = Named::default();
    for (name, members) in problem.blocks() {
        let part = closed.select(&members, &sensors).map_err(|e| fail(e.into()))?.h2_norm();
        let road = measured.rms.get(&name).and_then(|r| r.finite());
        let rms = match (part, road) {
            (Ok(noise), Some(road)) => Rms::Finite(noise.hypot(road)),
            _ => Rms::Infinite(Infinite::Infinite),
        };
        both.insert(name, rms);
    }
    Ok(both)
}

/// A warning where the sensors' noise makes outputs of the goal worse than passive.
pub(super) fn louder(problem: &Problem, passive: &Measured, measured: &Measured) -> Option<Flag> {
    let worse = problem.goals.iter().filter_map(|g| {
        let noisy = measured.rms_with_noise.get(&g.name)?.finite()?;
        let passive = passive.rms.get(&g.name)?.finite()?;
        (noisy > passive).then(|| format!("{} {:+.0} %", g.name, 100.0 * (noisy / passive - 1.0)))
    });
    let worse: Vec<String> = worse.collect();
    let spec = &problem.spec;
    let road = match spec.disturbance {
        DesignDisturbance::RoadVelocity => problem.ground.excitation().white_intensity(spec.speed_m_s),
        DesignDisturbance::RoadNoise => Some(1.0),
        DesignDisturbance::RoadDisplacement => None,
    };
    let own = road.map_or_else(String::new, |v| format!("; this road's is {}", short(v)));
    (!worse.is_empty()).then(|| Flag {
        name: "noise".into(),
        text: format!(
            "with the sensor noise stated, outputs are worse than passive: {}. The filter trusts the sensors as \
             lqg.process_noise (road) over lqg.sensor_noise says: give both as they are{own}, or take rms as the \
             road's part alone",
            worse.join(", ")
        ),
    })
}

/// What a reader must know: responses that became much worse somewhere.
pub(super) fn worse(problem: &Problem, passive: &Measured, closed: &Measured) -> Vec<Flag> {
    let (mut peaks, mut rms) = (Vec::new(), Vec::new());
    // a whole vector that is worse speaks for its corners
    let blocks =
        problem.blocks().into_iter().map(|(name, members)| (name, problem.reported[members[0]].base.clone()));
    let blocks: Vec<(String, String)> = blocks.filter(|(n, _)| !n.starts_with("actuator_force")).collect();
    let mut said: [Vec<&str>; 2] = [Vec::new(), Vec::new()];
    let peaks_too = problem.peaks.iter().map(|p| &p.block);
    let minimised: Vec<&str> =
        problem.goals.iter().chain(peaks_too).filter(|g| g.weight > 0.0).map(|g| g.name.as_str()).collect();
    let is_goal = |name: &str| minimised.contains(&name);
    for (name, base) in &blocks {
        if let (Some(before), Some(after)) = (passive.hinf.get(name), closed.hinf.get(name))
            && *after > WORSE_PEAK * before
            && *before > 0.0
            && !said[0].contains(&base.as_str())
        {
            let at = closed.hinf_at_rad_s.get(name).copied().flatten();
            let place = at.map_or_else(
                || "at high frequencies".to_owned(),
                |w| format!("at {:.2} Hz", crate::units::hz(w)),
            );
            peaks.push(format!("{name} {:.1} times {place}", after / before));
            said[0].push(name);
        }
        if let (Some(Some(before)), Some(Some(after))) =
            (passive.rms.get(name).map(|r| r.finite()), closed.rms.get(name).map(|r| r.finite()))
            && after > (1.0 + if is_goal(name) { FELT } else { WORSE_RMS }) * before
            && !said[1].contains(&base.as_str())
        {
            let whose = if is_goal(name) { " (the goal's own)" } else { "" };
            rms.push(if before > 0.0 {
                format!("{name} {:+.1} %{whose}", 100.0 * (after / before - 1.0))
            } else {
                format!("{name} {}, where there is none without control{whose}", short(after))
            });
            said[1].push(name);
        }
    }
    let flag = |name: &str, text: &str, which: &[String]| {
        (!which.is_empty()).then(|| Flag { name: name.into(), text: format!("{text}: {}", which.join(", ")) })
    };
    let peaks = flag("worse-peak", "the largest gain is far above the passive one", &peaks);
    let rms = flag("worse-rms", "on this road the rms is above the passive one", &rms);
    peaks.into_iter().chain(rms).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Mat;
    use crate::study::design_problem::Norm;
    use crate::study::{DesignSpec, Goal, MetricGroup};

    #[test]
    fn feedthrough_around_the_loop_is_told_from_one_half_on() {
        let spec = DesignSpec {
            vehicle: "case:turkay-quarter-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["sprung_acceleration".into()],
            goal: Goal {
                minimize: [("suspension_travel".to_owned(), 1.0)].into_iter().collect(),
                ..Goal::default()
            },
            ..DesignSpec::default()
        };
        let problem = Problem::new(&spec, Norm::H2).unwrap();
        let mass = problem.file.quarter_car.as_ref().unwrap().sprung_mass_kg;
        let gain = |share: f64| StateSpace::continuous_gain(Mat::from_fn(1, 1, |_, _| share * mass)).unwrap();
        // a force acts on the body's acceleration by −1/m_s
        for (share, warned) in [(0.4, None), (-0.6, Some(false)), (0.99, Some(false)), (-11.0, Some(true))] {
            let found = algebraic_loop(&problem, &gain(share)).unwrap();
            assert_eq!(found.as_ref().map(|f| f.1), warned, "{share}");
            if let Some((flag, _)) = found {
                assert!(flag.text.contains(&format!("is {} ", f64::abs(share))), "{}", flag.text);
            }
        }
        // with −0.9 or −1.1 a delay of 1 µs: its poles are those of 1 + share·e^{−sT} at high frequencies
        for (share, stable) in [(0.9, true), (1.1, false)] {
            let delay = crate::lti::pade_delay(1e-6, 4).unwrap();
            let closed = problem.plant.close(&gain(share).series(&delay).unwrap()).unwrap();
            let grows = closed.poles().unwrap().iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(grows < 1e3, stable, "{share}: {grows}");
        }
    }

    fn controller(pole: f64) -> StateSpace<Continuous> {
        let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
        StateSpace::continuous(one(pole), one(1.0), one(1.0), one(0.0)).unwrap()
    }

    #[test]
    fn a_controller_that_runs_away_by_itself_is_told() {
        let told = unstable_controller(&controller(0.078)).unwrap();
        assert!(told.text.contains("pole at +0.078 1/s"), "{}", told.text);
        assert!(unstable_controller(&controller(-0.078)).is_none());
    }

    #[test]
    fn an_acceleration_that_is_felt_more_is_told_where_its_rms_falls() {
        let row = |key: &str, values: [f64; 2]| MetricRow {
            group: MetricGroup::Comfort,
            key: key.into(),
            what: key.replace('_', " "),
            unit: "m/s²".into(),
            values: values.map(Some),
            words: Default::default(),
        };
        let rows = [
            row("weighted_sprung_acceleration", [1.0, 1.03]),
            row("bump_peak_sprung_acceleration", [1.0, 1.005]),
            row("bump_peak_suspension_travel", [1.0, 2.0]),
        ];
        let measured = |rms: f64| Measured {
            rms: ["sprung_acceleration", "suspension_travel"]
                .map(|n| (n.to_owned(), Rms::Finite(rms)))
                .into_iter()
                .collect(),
            ..Measured::default()
        };
        let told = felt(&rows, &measured(1.0), &measured(0.9)).unwrap();
        assert!(told.text.ends_with(": weighted sprung acceleration +3.0 %"), "{}", told.text);
        // where the rms rises, too, as much as of any output
        assert!(felt(&rows, &measured(1.0), &measured(1.1)).is_none());
        let far = [row("bump_peak_sprung_acceleration", [1.0, 1.255])];
        let told = felt(&far, &measured(1.0), &measured(1.05)).unwrap();
        assert!(
            told.text.starts_with("accelerations are felt more") && told.text.contains("+25.5 %"),
            "{}",
            told.text
        );
    }
}
