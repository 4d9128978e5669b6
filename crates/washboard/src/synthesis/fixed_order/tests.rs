//! Values of every kind of piece against norms and poles of the plant closed by itself, gradients against differences.

use super::problem::{BEYOND, Id, Kind, Of, Problem};
use super::structure::{Local, Structure, controller_of};
use super::targets::{Aim, Channel, Measure, Target};
use super::{starts, verify};
use crate::linalg::{Mat, RealSchur};
use crate::lti::{Continuous, GeneralizedPlant, Signals, StateSpace};
use crate::optimize::{Pieces, Role, SmoothPiece};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Steps of the differences, whose error is of its fourth power: of functions that are smooth at lengths of 1.
const STEP: f64 = 2e-4;
/// What that leaves of a gradient, and what rounding does: near the border of stability derivatives grow with each order.
const SMOOTH: f64 = 1e-7;
/// The step where norms are found by a search, of which the error counts over the step.
const COARSE: f64 = 1e-3;
/// Of differences of norms that are themselves found to 1e-9 or so, over the step.
const FOUND: f64 = 2e-5;
/// Values by two routes.
const SAME: f64 = 1e-8;

/// Limits of the controller: near what random points have, for a norm far below its bound is not searched.
const MAX_POLE: f64 = 20.0;
const MAX_GAIN: f64 = 0.3;
/// Below this, in ln, that is so, and its value is no more than a good guess.
const ROOM: f64 = -0.4;
const GUESS: f64 = 0.1;

/// How strong the plant's feedthroughs are.
#[derive(Clone, Copy, Default)]
struct Through {
    d11: f64,
    d12: f64,
    d21: f64,
    d22: f64,
}

const STATES: usize = 4;
const DISTURBANCES: usize = 3;
const CONTROLS: usize = 2;
const PERFORMANCES: usize = 3;
const MEASUREMENTS: usize = 2;

/// A stable plant with damped and undamped poles.
fn plant(seed: u64, through: Through) -> GeneralizedPlant {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut drawn = |r: usize, c: usize| Mat::from_fn(r, c, |_, _| rng.random_range(-1.0..1.0));
    let (nw, nz) = (DISTURBANCES, PERFORMANCES);
    let free = drawn(STATES, STATES);
    let skew = drawn(STATES, STATES);
    // A = S − Sᵀ − (R Rᵀ/4 + 0.3 I): stable, whatever is drawn
    let a = (&skew - skew.transpose()) * faer::Scale(2.0)
        - &free * free.transpose() * faer::Scale(0.25)
        - Mat::identity(STATES, STATES) * faer::Scale(0.3);
    let b = drawn(STATES, nw + CONTROLS);
    let c = drawn(nz + MEASUREMENTS, STATES);
    let d = drawn(nz + MEASUREMENTS, nw + CONTROLS);
    let d = Mat::from_fn(d.nrows(), d.ncols(), |i, j| {
        let share = match (i < nz, j < nw) {
            (true, true) => through.d11,
            (true, false) => through.d12,
            (false, true) => through.d21,
            (false, false) => through.d22,
        };
        share * d[(i, j)]
    });
    let names = |letter: &str, n: usize| (0..n).map(|k| format!("{letter}{k}")).collect();
    let signals = Signals {
        disturbances: names("w", nw),
        controls: names("u", CONTROLS),
        performances: names("z", nz),
        measurements: names("y", MEASUREMENTS),
    };
    GeneralizedPlant::new(StateSpace::continuous(a, b, c, d).unwrap(), signals).unwrap()
}

fn target(plant: usize, measure: Measure, aim: Aim) -> Target {
    Target { plant, measure, aim, name: "a target".into() }
}

/// Some outputs with weights, from some disturbances: not all, and not in order.
fn channel() -> Channel {
    Channel { outputs: vec![(2, 0.7), (0, 1.9)], disturbances: vec![2, 0] }
}

fn problem(plants: &[GeneralizedPlant], targets: &[Target], order: usize) -> Problem {
    let structure = Structure::full(order, CONTROLS, MEASUREMENTS);
    Problem::new(plants, targets, structure, (Some(MAX_POLE), Some(MAX_GAIN)), 0.0, &[])
}

/// A point of which the loops are stable, with numbers in every entry.
fn point(problem: &Problem, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x0070_6f69_6e74);
    let mut x = starts::silent(problem);
    for v in &mut x {
        *v += 0.15 * rng.random_range(-1.0..1.0);
    }
    assert!(problem.pieces(&x).is_some(), "seed {seed}: choose a smaller point");
    x
}

/// Central differences of fourth order.
fn differences(x: &[f64], by: f64, of: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let at = |k: usize, step: f64| {
        let mut moved = x.to_vec();
        moved[k] += step;
        of(&moved)
    };
    (0..x.len())
        .map(|k| {
            let near = at(k, by) - at(k, -by);
            let far = at(k, 2.0 * by) - at(k, -2.0 * by);
            (8.0 * near - far) / (12.0 * by)
        })
        .collect()
}

/// ‖a − b‖ over 1 + ‖b‖.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / (1.0 + norm(&mut b.iter().copied()))
}

fn controller(problem: &Problem, x: &[f64]) -> StateSpace<Continuous> {
    controller_of(&problem.block(x), problem.structure.order()).unwrap()
}

/// What a wanted number is by `GeneralizedPlant::close` and the norms of `lti`, as its pieces measure it.
fn recomputed(
    problem: &Problem,
    plants: &[GeneralizedPlant],
    targets: &[Target],
    k: usize,
    x: &[f64],
) -> f64 {
    let controller = controller(problem, x);
    let Some(t) = targets.get(k) else {
        // the edge of the stable set, and the controller's own limits
        let wanted = &problem.wanted[k];
        return match wanted.kind {
            Kind::Margin => {
                let margin =
                    plants[wanted.plant].close(&controller).unwrap().least_stable_pole().unwrap().unwrap().1;
                -margin / problem.scales.pace + BEYOND
            }
            Kind::Radius => {
                let size = controller.poles().unwrap().iter().map(|p| p.norm()).fold(0.0, f64::max);
                (size / MAX_POLE).ln()
            }
            _ => (controller.hinf_norm().unwrap().norm / MAX_GAIN).ln(),
        };
    };
    let closed = plants[t.plant].close(&controller).unwrap();
    let value = verify::value(&closed, t).unwrap().0;
    match (t.aim, &t.measure) {
        (Aim::Goal(unit), Measure::Abscissa) => value / unit,
        (Aim::Bound(limit), Measure::Abscissa) => (value - limit) / problem.scales.pace,
        (Aim::Goal(unit) | Aim::Bound(unit), _) => (value / unit).ln(),
    }
}

/// Checks all pieces at a point by differences of themselves, and the highest of each wanted number by an independent
/// route, where no other is near it. How many pieces, and how many numbers.
fn check(plants: &[GeneralizedPlant], targets: &[Target], order: usize, seed: u64) -> (usize, usize) {
    let problem = problem(plants, targets, order);
    let x = point(&problem, seed);
    let pieces = problem.pieces(&x).unwrap();
    for p in &pieces {
        let value = |x: &[f64]| problem.again(&[&p.id], x).pop().flatten().unwrap().value;
        assert!((value(&x) - p.value).abs() < SAME, "{:?}", p.id);
        let found = distance(&p.gradient, &differences(&x, STEP, value));
        assert!(found < SMOOTH, "seed {seed}, order {order}, {:?}: {found:e}", p.id);
    }
    let mut alone = 0;
    for k in 0..problem.wanted.len() {
        let mut own: Vec<&SmoothPiece<Id>> = pieces.iter().filter(|p| p.id.target == k).collect();
        own.sort_by(|a, b| b.value.total_cmp(&a.value));
        let of = |x: &[f64]| recomputed(&problem, plants, targets, k, x);
        let is_edge = problem.wanted[k].role == Role::Edge;
        let Some(top) = own.first() else {
            // eigenvalues far inside their bound have no pieces
            assert!(
                problem.wanted[k].role != Role::Goal && of(&x) < if is_edge { -0.09 } else { -0.69 },
                "seed {seed}, want {k}: {}",
                of(&x)
            );
            continue;
        };
        let searched =
            matches!(problem.wanted[k].kind, Kind::Hinf(_)) && problem.wanted[k].role != Role::Goal;
        if searched && top.value < ROOM {
            let short = of(&x) - top.value;
            assert!(short > -SAME && short < GUESS, "seed {seed}, want {k}: {short:e}");
            continue;
        }
        assert!((of(&x) - top.value).abs() < SAME, "seed {seed}, want {k}: {} {}", of(&x), top.value);
        // the largest of several has no one gradient; places beside a flat top are no peaks of their own
        let beside = |p: &&&SmoothPiece<Id>| p.value > top.value - 0.05 && !same_peak(&p.id, &top.id);
        if own.iter().skip(1).find(beside).is_some() {
            continue;
        }
        alone += 1;
        let found = distance(&top.gradient, &differences(&x, COARSE, of));
        assert!(found < FOUND, "seed {seed}, order {order}, want {k}, {:?}: {found:e}", top.id);
    }
    (pieces.len(), alone)
}

fn same_peak(one: &Id, other: &Id) -> bool {
    match (&one.of, &other.of) {
        (Of::Peak(a), Of::Peak(b)) => (a.omega / b.omega).ln().abs() < 0.3,
        _ => false,
    }
}

#[test]
fn peaks_of_several_outputs_with_feedthrough_everywhere_and_without() {
    let (mut pieces, mut alone) = (0, 0);
    for seed in 0..6 {
        for d22 in [0.0, 0.4] {
            let plant = plant(seed, Through { d11: 0.3, d12: 0.5, d21: 0.5, d22 });
            let all =
                Channel { outputs: (0..PERFORMANCES).map(|i| (i, 1.0)).collect(), disturbances: vec![] };
            let targets = [
                target(0, Measure::Hinf(all), Aim::Goal(2.0)),
                target(0, Measure::Hinf(channel()), Aim::Bound(1.5)),
            ];
            for order in 0..3 {
                let found = check(std::slice::from_ref(&plant), &targets, order, seed);
                pieces += found.0;
                alone += found.1;
            }
        }
    }
    // 36 problems of 2 to 4 numbers each, those far inside a bound left out: a loop that checks nothing is no test
    assert!(pieces > 200 && alone > 60, "{pieces} {alone}");
}

#[test]
fn h2_norms_and_abscissas_of_two_plants() {
    let (mut pieces, mut alone) = (0, 0);
    for seed in 10..15 {
        // an H2 norm is finite where D₁₂D_K D₂₁ is 0: without the one, then without the other
        for (d12, d21) in [(0.5, 0.0), (0.0, 0.5)] {
            for d22 in [0.0, 0.4] {
                let through = Through { d12, d21, d22, ..Through::default() };
                let plants = [plant(seed, through), plant(seed + 100, through)];
                let targets = [
                    target(0, Measure::H2(channel()), Aim::Goal(1.3)),
                    target(1, Measure::H2(channel()), Aim::Bound(0.8)),
                    target(0, Measure::Abscissa, Aim::Bound(-0.1)),
                    target(1, Measure::Abscissa, Aim::Goal(0.7)),
                ];
                for order in 0..3 {
                    let found = check(&plants, &targets, order, seed);
                    pieces += found.0;
                    alone += found.1;
                }
            }
        }
    }
    assert!(pieces > 150 && alone > 100, "{pieces} {alone}");
}

#[test]
fn the_smooth_function_for_unstable_loops_and_the_abscissa() {
    for seed in 20..26 {
        for d22 in [0.0, 0.4] {
            let through = Through { d11: 0.1, d12: 0.2, d21: 0.3, d22 };
            let plants = [plant(seed, through), plant(seed + 100, through)];
            let all = Channel { outputs: vec![(0, 1.0)], disturbances: vec![] };
            let targets = [target(0, Measure::Hinf(all), Aim::Goal(1.0))];
            for order in 0..3 {
                let problem = problem(&plants, &targets, order);
                let x = point(&problem, seed);
                let closed =
                    |x: &[f64]| plants.each_ref().map(|p| p.close(&controller(&problem, x)).unwrap());
                let shift = 0.6;
                // tr P is ‖(sI − A + γI)⁻¹‖₂²
                let recomputed = |x: &[f64]| {
                    let squares = closed(x).map(|c| {
                        let n = c.order();
                        let one = || Mat::identity(n, n);
                        let moved = c.a() - one() * faer::Scale(shift);
                        StateSpace::continuous(moved, one(), one(), Mat::zeros(n, n))
                            .unwrap()
                            .h2_norm()
                            .unwrap()
                    });
                    0.5 * squares.iter().map(|h| h * h).sum::<f64>().ln()
                };
                let (value, gradient) = problem.smoothed(&x, shift).unwrap();
                assert!((value - recomputed(&x)).abs() < SAME, "{value} {}", recomputed(&x));
                let found = distance(&gradient, &differences(&x, STEP, recomputed));
                assert!(found < SMOOTH, "seed {seed}, order {order}: {found:e}");

                let rightmost = |x: &[f64]| {
                    let all = closed(x).map(|c| -c.least_stable_pole().unwrap().unwrap().1);
                    all.iter().copied().fold(f64::NEG_INFINITY, f64::max) / problem.scales.pace
                };
                let (value, gradient) = problem.abscissa(&x).unwrap();
                assert!((value - rightmost(&x)).abs() < SAME, "{value} {}", rightmost(&x));
                let found = distance(&gradient, &differences(&x, COARSE, rightmost));
                assert!(found < FOUND, "seed {seed}, order {order}: {found:e}");
                assert!((problem.rightmost(&x).unwrap() / problem.scales.pace - value).abs() < SAME);
            }
        }
    }
}

#[test]
fn a_controller_with_two_states_less_is_given_pairs_that_oscillate_and_one_with_one_less_slow_and_fast_ones()
{
    let plant = plant(5, Through::default());
    let targets = [target(0, Measure::Hinf(channel()), Aim::Goal(1.0))];
    let problem = problem(std::slice::from_ref(&plant), &targets, 2);
    let gain = Mat::from_fn(CONTROLS, MEASUREMENTS, |i, j| [[0.1, -0.2], [0.05, 0.3]][i][j]);
    let none = |r: usize, c: usize| Mat::zeros(r, c);
    let without = StateSpace::continuous(none(0, 0), none(0, 2), none(2, 0), gain.clone()).unwrap();
    let one = StateSpace::continuous(none(1, 1) - Mat::identity(1, 1), none(1, 2), none(2, 1), gain.clone())
        .unwrap();
    let mut oscillating = 0;
    for (from, least) in [(without, 3), (one, 3)] {
        let begun = starts::fitted(&problem, &from, 1);
        assert!(begun.len() >= least, "{}", begun.len());
        let mut slowest = Vec::new();
        for x in &begun {
            let k = controller(&problem, x);
            // whatever the new states are, nothing reads them yet
            assert!(distance(&k.d().row(0).iter().copied().collect::<Vec<_>>(), &[0.1, -0.2]) < 1e-12);
            assert_eq!(k.c().norm_max(), 0.0);
            let poles = RealSchur::only_eigenvalues(k.a()).unwrap();
            assert!(poles.iter().all(|p| p.re < 0.0), "{poles:?}");
            oscillating += usize::from(poles.iter().any(|p| p.im > 0.5 * p.norm()));
            slowest.push(poles.iter().map(|p| p.norm()).fold(f64::INFINITY, f64::min));
        }
        slowest.sort_by(f64::total_cmp);
        slowest.dedup_by(|a, b| (*a / *b - 1.0).abs() < 1e-9);
        assert!(slowest.len() >= 2, "{slowest:?}");
    }
    assert_eq!(oscillating, 2);
}

#[test]
fn a_structures_feedthrough_is_a_structure_of_its_own() {
    let local = |signal: usize| Local { order: 1, measurements: vec![signal], controls: vec![signal] };
    let two = Structure::decentralised(2, 2, &[local(0), local(1)]).unwrap();
    let gains = two.feedthrough().unwrap();
    assert_eq!((gains.order(), gains.rows(), gains.cols()), (0, 2, 2));
    assert_eq!(gains.free(), [(0, 0), (1, 1)]);
    assert!(two.strictly_proper().feedthrough().is_none());
}

#[test]
fn a_loop_that_is_not_stable_has_no_pieces() {
    let plant = plant(3, Through::default());
    let all = Channel { outputs: vec![(0, 1.0)], disturbances: vec![] };
    let targets = [target(0, Measure::Hinf(all), Aim::Goal(1.0))];
    let problem = problem(&[plant], &targets, 1);
    let mut x = point(&problem, 3);
    assert!(problem.smoothed(&x, 0.0).is_some());
    // A_K = +pace and nothing else: the controller's own pole is the loop's
    x.iter_mut().for_each(|v| *v = 0.0);
    x[0] = 1.0;
    assert!(problem.pieces(&x).is_none());
    assert!(problem.smoothed(&x, 0.0).is_none());
    assert!((problem.abscissa(&x).unwrap().0 - 1.0).abs() < SAME);
}

#[test]
fn a_margin_is_an_edge_that_slopes() {
    let plant = plant(4, Through::default());
    let all = Channel { outputs: vec![(0, 1.0)], disturbances: vec![] };
    let targets = [target(0, Measure::Hinf(all), Aim::Goal(1.0))];
    let structure = Structure::full(0, CONTROLS, MEASUREMENTS);
    let with = |margin: f64| {
        Problem::new(std::slice::from_ref(&plant), &targets, structure.clone(), (None, None), margin, &[])
    };
    let x = vec![0.0; CONTROLS * MEASUREMENTS];
    let own = -with(0.0).rightmost(&x).unwrap();
    assert!(own > 0.0);
    for share in [0.99, 1.01] {
        let problem = with(share * own);
        let pieces = problem.pieces(&x).unwrap();
        let edge = pieces.iter().find(|p| p.role == Role::Edge).unwrap();
        let over = (share - 1.0) * own / problem.scales.pace + BEYOND;
        assert!(
            (edge.value - over).abs() < 1e-9 && edge.gradient.iter().any(|g| *g != 0.0),
            "{edge:?} {over}"
        );
    }
}

/// Nothing comes through a controller of no gain: its bound has no slope there, and the point is one to begin with.
#[test]
fn no_gain_keeps_every_bound_of_the_gain() {
    let plant = plant(4, Through::default());
    let all = Channel { outputs: vec![(0, 1.0)], disturbances: vec![] };
    let targets = [target(0, Measure::Hinf(all), Aim::Goal(1.0))];
    let structure = Structure::full(0, CONTROLS, MEASUREMENTS);
    let problem = Problem::new(&[plant], &targets, structure, (None, Some(1e-3)), 0.0, &[]);
    let pieces = problem.pieces(&[0.0; CONTROLS * MEASUREMENTS]).unwrap();
    assert!(pieces.iter().any(|p| p.role == Role::Goal));
    assert!(pieces.iter().all(|p| p.role == Role::Goal || p.value < 0.0));
}
