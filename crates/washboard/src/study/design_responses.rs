//! A design in time: over one bump and on a few seconds of random road, the vehicle without control beside the loop.

use super::bump_metrics::passage_s;
use super::design_outputs::shown;
use super::design_problem::Problem;
use super::{BumpSpec, Flag, Named, ResponseGroup, StudyError};
use crate::lti::{Continuous, StateSpace};
use crate::vehicle::{Bump, BumpModes, Control, Output, RoadRun};
use serde::{Deserialize, Serialize};

/// Peaks of both sides that differ by less than this share are alike.
const ALIKE: f64 = 0.01;
/// What is shown after the last wheel has left it, s.
const AFTER_S: f64 = 2.0;
/// A stretch of road, s, its steps, and the throw of its dice.
const ROAD_S: f64 = 4.0;
const ROAD_STEP_S: f64 = 1e-3;
const SEED: u64 = 1;
/// Samples of a curve, at most: peaks are found among all.
const SAMPLES: usize = 400;
/// Digits of a sample.
const DIGITS: usize = 5;

/// Responses in time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DesignResponses {
    /// Over the bump, at the design's speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bump: Option<TimeResponses>,
    /// On a stretch of the design's road, the same one for both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub road: Option<TimeResponses>,
}

/// Curves over one time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TimeResponses {
    /// What the vehicle meets, in words.
    pub what: String,
    /// s.
    pub time_s: Vec<f64>,
    /// Without control.
    pub passive: Named<Vec<f64>>,
    /// In the loop.
    pub closed: Named<Vec<f64>>,
    /// Largest magnitudes without control, of all samples.
    pub passive_peak: Named<f64>,
    /// In the loop; 1 − this over the other one is (5.22).
    pub closed_peak: Named<f64>,
}

/// Both; what cannot be had is a note.
///
/// # Errors
/// A controller that does not fit the vehicle.
pub(super) fn responses(
    problem: &Problem,
    k: &StateSpace<Continuous>,
    passive_is_stable: bool,
) -> Result<(DesignResponses, Vec<Flag>), StudyError> {
    let y: Vec<String> = problem.measurements.iter().map(|o| o.name.clone()).collect();
    let u: Vec<String> = problem.vehicle.actuators().iter().map(|a| a.name.clone()).collect();
    let control = Control::new(&problem.vehicle, k.clone(), &y, &u).map_err(|source| {
        StudyError::Controller { name: problem.spec.vehicle.clone(), source: Box::new(source) }
    })?;
    let all = chosen(problem);
    let one = of_one_track(problem, &all);
    let outputs = if one.len() == all.len() || leans(problem, &all, &control) { all } else { one };
    let controls: Vec<Option<&Control>> =
        if passive_is_stable { vec![Some(&control), None] } else { vec![Some(&control)] };
    let mut notes = Vec::new();
    let mut note = |what: &str, why: String| {
        notes.push(Flag { name: "responses".into(), text: format!("{what}: {why}") })
    };
    let bump = over_bump(problem, &outputs, &controls);
    let bump = bump.map_err(|why| note("no response to a bump is shown", why)).ok();
    let road = on_road(problem, &outputs, &controls);
    let road = road.map_err(|why| note("no response to a stretch of road is shown", why)).ok();
    Ok((DesignResponses { bump, road }, notes))
}

/// Of the body its accelerations, of the wheels travel, deflection and force.
fn chosen(problem: &Problem) -> Vec<&Output> {
    let seen = |o: &&Output| {
        let group = ResponseGroup::of(&o.base);
        let wanted = matches!(
            group,
            ResponseGroup::Comfort
                | ResponseGroup::RattleSpace
                | ResponseGroup::TireLoad
                | ResponseGroup::Force
        );
        let body_point = o.base.starts_with("body_") || o.base.starts_with("tire_force");
        wanted && !body_point && shown(o)
    };
    // white noise of the road's acceleration has no response
    let finite = |o: &&Output| o.r[2].iter().all(|v| *v == 0.0);
    let mut all: Vec<&Output> = problem.reported.iter().filter(seen).filter(finite).collect();
    // corners beside each other
    all.sort_by_key(|o| ResponseGroup::ALL.iter().position(|g| *g == ResponseGroup::of(&o.base)));
    all
}

/// Without the wheels of the other track.
fn of_one_track<'a>(problem: &Problem, all: &[&'a Output]) -> Vec<&'a Output> {
    let wheels = problem.vehicle.wheels();
    let side = wheels.first().map_or(0.0, |w| w.at_m[1]);
    let other: Vec<String> =
        wheels.iter().filter(|w| w.at_m[1] * side < 0.0).map(|w| format!("_{}", w.name)).collect();
    all.iter().filter(|o| !other.iter().any(|w| o.name.ends_with(w))).copied().collect()
}

/// Whether the loop makes of a bump under both tracks something else on one side than on the other.
fn leans(problem: &Problem, all: &[&Output], control: &Control) -> bool {
    let Ok(found) = over_bump(problem, all, &[Some(control)]) else { return false };
    let peaks = &found.closed_peak;
    peaks.iter().any(|(name, one)| {
        let mirrored = peaks.get(&name.replace("_left", "_right"));
        mirrored.is_some_and(|other| (one - other).abs() > ALIKE * one.max(*other))
    })
}

type Series = Vec<Vec<f64>>;

fn over_bump(
    problem: &Problem,
    outputs: &[&Output],
    controls: &[Option<&Control>],
) -> Result<TimeResponses, String> {
    let stated = problem.spec.metrics.and_then(|m| m.bump);
    let BumpSpec { height_m, length_m } = stated.unwrap_or_default();
    let speed = problem.spec.speed_m_s;
    let bump = Bump::new(height_m, length_m).map_err(|e| e.to_string())?;
    let duration_s = passage_s(&problem.vehicle, length_m, speed) + AFTER_S;
    let modes = BumpModes::Vehicle;
    let run = |c: &Option<&Control>| {
        let found = problem.vehicle.bump_response_for(outputs, bump, speed, duration_s, *c, modes);
        found.map_err(|e| e.to_string())
    };
    let found = controls.iter().map(run).collect::<Result<Vec<_>, _>>()?;
    let last = found.iter().filter_map(|f| f.time_s.last()).copied().fold(f64::INFINITY, f64::min);
    let time_s: Vec<f64> = (0..SAMPLES).map(|k| last * k as f64 / (SAMPLES - 1) as f64).collect();
    let all: Vec<(Vec<f64>, Series)> = found.into_iter().map(|f| (f.time_s, f.outputs)).collect();
    let whose = if stated.is_some() { "" } else { ", the default: [metrics] bump states another" };
    let what = format!("a bump of {height_m} m on {length_m} m at {speed} m/s, ½h(1 − cos 2πvt/l){whose}");
    Ok(gathered(what, time_s, outputs, &all))
}

fn on_road(
    problem: &Problem,
    outputs: &[&Output],
    controls: &[Option<&Control>],
) -> Result<TimeResponses, String> {
    let road = problem.ground.excitation().road().ok_or("a filter of all road inputs has no profile")?;
    let speed_m_s = problem.spec.speed_m_s;
    let run = RoadRun { speed_m_s, duration_s: ROAD_S, dt_s: ROAD_STEP_S, seed: SEED };
    let one = |c: &Option<&Control>| {
        let found = problem.vehicle.run_on_road(outputs, road, run, *c).map_err(|e| e.to_string())?;
        let time_s = (0..found.first().map_or(0, Vec::len)).map(|k| ROAD_STEP_S * k as f64).collect();
        Ok((time_s, found))
    };
    let found: Vec<(Vec<f64>, Series)> = controls.iter().map(one).collect::<Result<_, String>>()?;
    let time_s: Vec<f64> = (0..SAMPLES).map(|k| ROAD_S * k as f64 / SAMPLES as f64).collect();
    let what = format!("{ROAD_S} s of the design's road at {speed_m_s} m/s, the same for both (seed {SEED})");
    Ok(gathered(what, time_s, outputs, &found))
}

/// Curves and peaks: first of the loop, then without it.
fn gathered(
    what: String,
    time_s: Vec<f64>,
    outputs: &[&Output],
    found: &[(Vec<f64>, Series)],
) -> TimeResponses {
    let curves = |which: usize| -> Named<Vec<f64>> {
        let Some((t, series)) = found.get(which) else { return Named::default() };
        let all = outputs.iter().zip(series);
        all.map(|(o, y)| (o.name.clone(), time_s.iter().map(|at| rounded(at_time(t, y, *at))).collect()))
            .collect()
    };
    let peaks = |which: usize| -> Named<f64> {
        let Some((_, series)) = found.get(which) else { return Named::default() };
        let peak = |y: &Vec<f64>| y.iter().map(|v| v.abs()).fold(0.0, f64::max);
        outputs.iter().zip(series).map(|(o, y)| (o.name.clone(), peak(y))).collect()
    };
    let (closed, passive) = (curves(0), curves(1));
    let (closed_peak, passive_peak) = (peaks(0), peaks(1));
    let time_s = time_s.into_iter().map(rounded).collect();
    TimeResponses { what, time_s, passive, closed, passive_peak, closed_peak }
}

/// Straight between samples of equal distance.
fn at_time(time_s: &[f64], y: &[f64], at: f64) -> f64 {
    let step = time_s.get(1).copied().unwrap_or(1.0);
    let k = (at / step).floor().max(0.0) as usize;
    let share = at / step - k as f64;
    let value = |k: usize| y.get(k).or(y.last()).copied().unwrap_or(0.0);
    value(k) * (1.0 - share) + value(k + 1) * share
}

fn rounded(v: f64) -> f64 {
    format!("{v:.*e}", DIGITS - 1).parse().unwrap_or(v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Mat;
    use crate::study::design_problem::Norm;
    use crate::study::{DesignDisturbance, DesignSpec, Goal, MetricsSection, RespondSpec, design, respond};

    /// Half a digit of what is kept of a sample.
    const KEPT: f64 = 1e-4;

    #[test]
    fn the_bump_is_the_one_of_respond_and_curves_are_short() {
        let minimize = ["heave_acceleration", "suspension_travel"];
        let spec = DesignSpec {
            vehicle: "case:turkay-half-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 12.5,
            measurements: vec!["suspension_travel".into()],
            input_weight: 1e-9,
            delay_order: 2,
            goal: Goal {
                minimize: minimize.iter().map(|n| ((*n).to_owned(), 1.0)).collect(),
                ..Goal::default()
            },
            metrics: Some(MetricsSection {
                stroke_m: Some(0.08),
                bump: Some(BumpSpec { height_m: 0.05, length_m: 1.5 }),
            }),
            ..DesignSpec::default()
        };
        let o = design(&spec).unwrap().0;
        let r = o.responses.as_ref().unwrap();
        let (bump, road) = (r.bump.as_ref().unwrap(), r.road.as_ref().unwrap());
        let folder = std::env::temp_dir().join(format!("washboard-bump-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("k.json");
        std::fs::write(&file, serde_json::to_string(o.controller.as_ref().unwrap()).unwrap()).unwrap();
        let asked = |controller| RespondSpec {
            vehicle: spec.vehicle.clone(),
            speed_m_s: 12.5,
            bump: Some([0.05, 1.5]),
            direction: None,
            controller,
        };
        let closed = respond(&asked(Some(file))).unwrap().0.bump.unwrap();
        let passive = respond(&asked(None)).unwrap().0.bump.unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        // the one stated, as the metrics have it, and both say so
        assert!(
            bump.what.starts_with("a bump of 0.05 m on 1.5 m at 12.5 m/s") && !bump.what.contains("default")
        );
        let words = o.metrics_words();
        assert!(words.contains("0.05 m high and 1.5 m long") && words.contains("12.5 m/s"), "{words}");
        let peak = |m: &Option<crate::study::RideMetrics>| m.as_ref().unwrap().bump.clone().unwrap().peak;
        let metrics = o.metrics.as_ref().unwrap();
        for (own, known) in
            [(&bump.passive_peak, peak(&metrics.passive)), (&bump.closed_peak, peak(&metrics.closed))]
        {
            let (a, b) = (own.get("heave_acceleration").unwrap(), known.get("heave_acceleration").unwrap());
            assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        }
        for (own, known) in [(&bump.passive_peak, passive), (&bump.closed_peak, closed)] {
            assert!(own.iter().count() >= 6);
            for (name, peak) in own.iter() {
                let other = *known.peak.get(name).unwrap();
                assert!((peak - other).abs() <= 1e-9 * other, "{name}: {peak} {other}");
            }
            let drawn = if own == &bump.passive_peak { &bump.passive } else { &bump.closed };
            // drawn at another time: straight between the samples that `respond` writes
            let travel = drawn.get("suspension_travel_front").unwrap();
            let top = known.peak.get("suspension_travel_front").unwrap();
            let step = known.time_s[1];
            for (t, v) in bump.time_s.iter().zip(travel) {
                let k = (t / step) as usize;
                let all = known.response.get("suspension_travel_front").unwrap();
                let (a, b) = (all[k.min(all.len() - 1)], all[(k + 1).min(all.len() - 1)]);
                let expected = a + (b - a) * (t / step - k as f64).min(1.0);
                assert!((v - expected).abs() < 2e-3 * top, "{t}: {v} {expected}");
            }
        }
        for t in [bump, road] {
            assert!(t.time_s.len() <= SAMPLES && t.time_s.is_sorted());
            assert!(t.passive.iter().chain(t.closed.iter()).all(|(_, y)| y.len() == t.time_s.len()));
        }
        // the same road: the passive vehicle's travel is not the loop's, and both move
        let (a, b) = (&road.passive, &road.closed);
        let most = |of: &Named<Vec<f64>>| {
            of.get("suspension_travel_rear").unwrap().iter().map(|v| v.abs()).fold(0.0, f64::max)
        };
        assert!(most(a) > 1e-3 && most(b) > 1e-3 && a != b);
        assert!((rounded(1.234567) - 1.2346).abs() < KEPT * 1e-4);
    }

    #[test]
    fn both_sides_are_shown_where_they_differ() {
        let spec = DesignSpec {
            vehicle: "case:guiggiani-full-car".into(),
            road: "case:turkay-first-order".into(),
            speed_m_s: 20.0,
            disturbance: DesignDisturbance::RoadNoise,
            measurements: vec!["suspension_travel".into()],
            goal: Goal {
                minimize: [("suspension_travel".to_owned(), 1.0)].into_iter().collect(),
                ..Goal::default()
            },
            ..DesignSpec::default()
        };
        let problem = Problem::new(&spec, Norm::H2).unwrap();
        let none = |r: usize, c: usize| Mat::zeros(r, c);
        for (right, shown) in [(2e3, false), (4e3, true)] {
            let d = Mat::from_fn(4, 4, |i, j| {
                if i != j {
                    0.0
                } else if i % 2 == 0 {
                    2e3
                } else {
                    right
                }
            });
            let k = StateSpace::continuous(none(0, 0), none(0, 4), none(4, 0), d).unwrap();
            let bump = responses(&problem, &k, true).unwrap().0.bump.unwrap();
            let names: Vec<&str> = bump.closed.iter().map(|(n, _)| n).collect();
            assert!(names.contains(&"suspension_travel_front_left"), "{names:?}");
            assert_eq!(names.contains(&"suspension_travel_front_right"), shown, "{names:?}");
        }
    }

    #[test]
    fn fast_controllers_have_a_response_over_the_default_bump() {
        let spec = DesignSpec {
            vehicle: "case:turkay-quarter-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            goal: Goal {
                minimize: [("suspension_travel".to_owned(), 1.0)].into_iter().collect(),
                ..Goal::default()
            },
            ..DesignSpec::default()
        };
        let problem = Problem::new(&spec, Norm::H2).unwrap();
        // a spring behind a filter far faster than any mode
        let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
        let k = StateSpace::continuous(one(-1e5), one(1e5), one(3e3), one(0.0)).unwrap();
        let (found, notes) = responses(&problem, &k, true).unwrap();
        assert!(notes.is_empty(), "{notes:?}");
        let what = found.bump.unwrap().what;
        assert!(what.contains("0.1 m on 2 m at 20 m/s") && what.contains("the default"), "{what}");
        // the same loop with samples for its own modes cannot be had, and says why
        let y = ["suspension_travel".to_owned()];
        let control = Control::new(&problem.vehicle, k, &y, &["actuator".to_owned()]).unwrap();
        let z = [problem.vehicle.output("suspension_travel").unwrap()];
        let e = problem.vehicle.bump_response(&z, Bump::new(0.1, 2.0).unwrap(), 20.0, 3.0, Some(&control));
        let e = e.unwrap_err().to_string();
        assert!(e.contains("samples, more than 4e5") && e.contains("1.00e5 rad/s"), "{e}");
    }
}
