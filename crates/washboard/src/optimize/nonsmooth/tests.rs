//! The bundle method and the sampled subdifferential on functions whose minima are known.

use super::{
    BundleEnd, BundleResult, BundleSettings, Descent, Pieces, Role, SmoothPiece, minimize,
    sampled_subdifferential,
};

type Smooth = fn(&[f64]) -> (f64, Vec<f64>);

/// The largest of some smooth functions: those within `near` of the largest are told.
struct Largest {
    of: Vec<(Role, Smooth)>,
    near: f64,
    defined: fn(&[f64]) -> bool,
}

impl Pieces for Largest {
    type Id = usize;

    fn dimension(&self) -> usize {
        2
    }

    fn pieces(&self, x: &[f64]) -> Option<Vec<SmoothPiece<usize>>> {
        if !(self.defined)(x) {
            return None;
        }
        let ids: Vec<usize> = (0..self.of.len()).collect();
        let all: Vec<_> = self.again(&ids.iter().collect::<Vec<_>>(), x).into_iter().flatten().collect();
        let top = |goal: bool| {
            let own = all.iter().filter(|p| (p.role == Role::Goal) == goal).map(|p| p.value);
            own.fold(f64::NEG_INFINITY, f64::max)
        };
        let (goal, bound) = (top(true), top(false));
        let told =
            |p: &SmoothPiece<usize>| p.value >= if p.role == Role::Goal { goal } else { bound } - self.near;
        Some(all.into_iter().filter(told).collect())
    }

    fn again(&self, ids: &[&usize], x: &[f64]) -> Vec<Option<SmoothPiece<usize>>> {
        ids.iter()
            .map(|id| {
                let (role, of) = self.of[**id];
                let (value, gradient) = of(x);
                Some(SmoothPiece { id: **id, role, value, gradient })
            })
            .collect()
    }

    fn apart(&self, one: &usize, other: &usize) -> Option<f64> {
        (one == other).then_some(0.0)
    }
}

fn everywhere(_: &[f64]) -> bool {
    true
}

/// max(‖x − (2, 0)‖², ‖x − (0, 2)‖²) under x₁ + x₂ ≤ 1: 5/2 at (½, ½) with weights ½, ½ and 1.
fn two_bowls(near: f64) -> Largest {
    Largest {
        of: vec![
            (Role::Goal, |x| ((x[0] - 2.0).powi(2) + x[1] * x[1], vec![2.0 * (x[0] - 2.0), 2.0 * x[1]])),
            (Role::Goal, |x| (x[0] * x[0] + (x[1] - 2.0).powi(2), vec![2.0 * x[0], 2.0 * (x[1] - 2.0)])),
            (Role::Bound(0), |x| (x[0] + x[1] - 1.0, vec![1.0, 1.0])),
        ],
        near,
        defined: everywhere,
    }
}

fn weight(found: &BundleResult<usize>, id: usize) -> f64 {
    found.active.iter().filter(|(p, _)| p.id == id).map(|(_, w)| w).sum()
}

#[test]
fn a_convex_goal_under_a_bound_ends_at_its_optimum_with_its_multipliers() {
    // told of all pieces, or of the largest alone, so that the kink has to be learnt; penalties above and below the
    // multiplier of 1
    for near in [10.0, 0.0] {
        for penalty in [4.0, 0.1] {
            for start in [[3.0, 5.0], [-4.0, 0.3], [2.0, 0.0], [0.5, -30.0]] {
                let settings = BundleSettings { penalty, ..BundleSettings::default() };
                let found = minimize(&two_bowls(near), &start, &settings).unwrap();
                let off = (found.x[0] - 0.5).hypot(found.x[1] - 0.5);
                // the merit is flat to the tolerance of 1e-8: √ of it in x, along the bound where it is curved
                assert!(off < 1e-4, "{near} {penalty} {start:?}: {found:?}");
                assert!((found.goal - 2.5).abs() < 1e-6 && found.violation < 1e-7, "{found:?}");
                assert!(found.end != BundleEnd::Budget && found.penalty >= 1.0 - 1e-9, "{found:?}");
                for (id, known) in [(0, 0.5), (1, 0.5), (2, 1.0)] {
                    assert!(
                        (weight(&found, id) - known).abs() < 1e-3,
                        "{near} {penalty} {start:?}: {found:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_narrow_valley_with_a_kink_along_it_is_followed_to_its_end() {
    // max over ± of ±8(x₁² − x₂) + (1 − x₁)²: 0 at (1, 1)
    let valley = |near: f64| Largest {
        of: vec![
            (Role::Goal, |x| {
                let r = x[0] * x[0] - x[1];
                (8.0 * r + (1.0 - x[0]).powi(2), vec![16.0 * x[0] - 2.0 * (1.0 - x[0]), -8.0])
            }),
            (Role::Goal, |x| {
                let r = x[0] * x[0] - x[1];
                (-8.0 * r + (1.0 - x[0]).powi(2), vec![-16.0 * x[0] - 2.0 * (1.0 - x[0]), 8.0])
            }),
        ],
        near,
        defined: everywhere,
    };
    for near in [100.0, 0.0] {
        let found = minimize(&valley(near), &[-1.3, 0.7], &BundleSettings::default()).unwrap();
        assert!(found.goal < 1e-6 && found.goal >= 0.0 && found.iterations < 150, "{near}: {found:?}");
    }
}

#[test]
fn bounds_that_exclude_each_other_are_exceeded_by_the_least_possible() {
    // (x₁ − 3)² + x₂² under x₁ ≥ 1 and x₁ ≤ −1: both are exceeded by 1 at 0, for which the penalty must be above 6
    let torn = Largest {
        of: vec![
            (Role::Goal, |x| ((x[0] - 3.0).powi(2) + x[1] * x[1], vec![2.0 * (x[0] - 3.0), 2.0 * x[1]])),
            (Role::Bound(0), |x| (1.0 - x[0], vec![-1.0, 0.0])),
            (Role::Bound(1), |x| (1.0 + x[0], vec![1.0, 0.0])),
        ],
        near: 0.1,
        defined: everywhere,
    };
    for start in [[5.0, 2.0], [-7.0, 0.1]] {
        let found = minimize(&torn, &start, &BundleSettings::default()).unwrap();
        assert!((found.violation - 1.0).abs() < 1e-6 && found.penalty > 6.0, "{found:?}");
    }
    // without a goal too
    let bounds = Largest { of: torn.of[1..].to_vec(), ..torn };
    let found = minimize(&bounds, &[5.0, 2.0], &BundleSettings::default()).unwrap();
    assert!((found.violation - 1.0).abs() < 1e-6 && found.goal == f64::NEG_INFINITY, "{found:?}");
}

#[test]
fn where_functions_are_not_defined_nothing_goes() {
    let mut walled = two_bowls(0.1);
    // the optimum (½, ½) stands 1e-3 before the wall
    walled.defined = |x| x[0] < 0.501;
    assert!(minimize(&walled, &[2.0, 0.0], &BundleSettings::default()).is_none());
    let found = minimize(&walled, &[-4.0, 7.0], &BundleSettings::default()).unwrap();
    assert!((found.goal - 2.5).abs() < 1e-5 && found.x[0] < 0.501, "{found:?}");
}

#[test]
fn no_steps_say_what_the_start_is() {
    let settings = BundleSettings { iterations: 0, ..BundleSettings::default() };
    let found = minimize(&two_bowls(0.1), &[1.0, 1.0], &settings).unwrap();
    assert_eq!((found.x, found.goal, found.violation), (vec![1.0, 1.0], 2.0, 1.0));
    assert_eq!((found.end, found.iterations, found.evaluations), (BundleEnd::Budget, 0, 1));
}

#[test]
fn the_distance_from_the_gradients_is_zero_at_an_optimum_and_the_slope_elsewhere() {
    let bowls = two_bowls(0.1);
    let at = |x: [f64; 2], penalty: f64| {
        sampled_subdifferential(&bowls, &x, penalty, 1e-4, 20, 7).unwrap().distance
    };
    // gradients within 1e-4 differ by 2e-4 at most
    let near = |found: f64, known: f64| (found - known).abs() < 5e-4;
    assert!(at([0.5, 0.5], 4.0) < 1e-5, "{:e}", at([0.5, 0.5], 4.0));
    // a penalty of ½ leaves half of (−1, −1)
    assert!(near(at([0.5, 0.5], 0.5), 0.5f64.sqrt()), "{}", at([0.5, 0.5], 0.5));
    // on the kink at 0, away from the bound: the middle of (−4, 0) and (0, −4)
    assert!(near(at([0.0, 0.0], 4.0), 8f64.sqrt()), "{}", at([0.0, 0.0], 4.0));
    // (0, −2): the second bowl alone
    assert!(near(at([0.0, -2.0], 4.0), 8.0), "{}", at([0.0, -2.0], 4.0));
}

#[test]
fn samples_see_a_kink_that_the_point_itself_does_not() {
    // 2e-4 beside the kink along the bound, told of one bowl alone: gradients within 1e-3 hold 0 nearly, at the point
    // they do not
    let bowls = two_bowls(0.0);
    let x = [0.5002, 0.4998];
    let wide = sampled_subdifferential(&bowls, &x, 4.0, 1e-3, 40, 7).unwrap();
    let narrow = sampled_subdifferential(&bowls, &x, 4.0, 1e-6, 40, 7).unwrap();
    assert!(wide.distance < 5e-3 && wide.points == 41, "{wide:?}");
    // (1, −3) and the bound's (1, 1) with weight 1
    assert!((narrow.distance - 8f64.sqrt()).abs() < 5e-3, "{narrow:?}");
}

/// −x + 2x²/(x² + .0025) falls from 0 into a narrow dip, and steps that are too long show planes that would make a kink of 0.
#[test]
fn a_failed_step_makes_no_optimum_of_where_it_began() {
    let dip = Largest {
        of: vec![(Role::Goal, |x| {
            let q = x[0] * x[0] + 0.0025;
            (-x[0] + 2.0 * x[0] * x[0] / q + x[1] * x[1], vec![-1.0 + 0.01 * x[0] / (q * q), 2.0 * x[1]])
        })],
        near: 0.1,
        defined: |x| x[0] < 1.0,
    };
    let found = minimize(&dip, &[0.0, 0.0], &BundleSettings::default()).unwrap();
    // the dip's bottom: −1 + .01 x/(x² + .0025)² = 0 at 6.25e-4, where it is −3.12e-4
    assert!(found.goal < -3.1e-4 && (found.x[0] > 6e-4), "{found:?}");
    let slope = sampled_subdifferential(&dip, &found.x, 4.0, 1e-7, 10, 7).unwrap().distance;
    assert!(slope < 1e-2, "{slope} {found:?}");
}

/// x² under x ≥ 20, seen in tenths, from 0 with steps of 1 at most: the bound can't be met at once, which is no reason for a larger penalty
/// than the 400 that holds the optimum.
#[test]
fn a_bound_that_is_many_steps_away_does_not_drive_the_penalty_up() {
    let far = Largest {
        of: vec![
            (Role::Goal, |x| (x[0] * x[0] + x[1] * x[1], vec![2.0 * x[0], 2.0 * x[1]])),
            (Role::Bound(0), |x| (0.1 * (20.0 - x[0]), vec![-0.1, 0.0])),
        ],
        near: 0.1,
        defined: everywhere,
    };
    let settings = BundleSettings { longest: 0.2, ..BundleSettings::default() };
    let found = minimize(&far, &[0.0, 0.0], &settings).unwrap();
    assert!((found.x[0] - 20.0).abs() < 1e-4 && found.violation < 1e-6, "{found:?}");
    assert!((400.0..1e4).contains(&found.penalty), "{found:?}");
}

/// The goal falls up to an edge at x₁ = 0, where a bound far from met hides it among bounds: the search slides along the edge to where
/// the bound is met.
#[test]
fn an_edge_is_slid_along_however_far_a_bound_is_exceeded() {
    let edge = Largest {
        of: vec![
            (Role::Goal, |x| (3.0 * x[0] + 0.01 * x[1] * x[1], vec![3.0, 0.02 * x[1]])),
            (Role::Bound(0), |x| (5.0 + x[1] + x[0], vec![1.0, 1.0])),
            (Role::Edge, |x| (1e-6 - x[0], vec![-1.0, 0.0])),
        ],
        near: 100.0,
        defined: |x| x[0] > 0.0,
    };
    // all told: the edge is among the pieces however much lower than the bound it is
    let found = minimize(&edge, &[2.0, 7.0], &BundleSettings::default()).unwrap();
    assert!(found.violation < 1e-6 && found.x[1] <= -4.99 && found.x[0] < 1e-3, "{found:?}");
}

/// Where a bound is exceeded its whole penalty pulls: x = 0 of x² under x ≥ 1 is as far from stationary as ρ says.
#[test]
fn an_exceeded_bound_pulls_with_all_its_penalty() {
    let apart = Largest {
        of: vec![
            (Role::Goal, |x| (x[0] * x[0] + x[1] * x[1], vec![2.0 * x[0], 2.0 * x[1]])),
            (Role::Bound(0), |x| (1.0 - x[0], vec![-1.0, 0.0])),
        ],
        near: 0.1,
        defined: everywhere,
    };
    let found = sampled_subdifferential(&apart, &[0.0, 0.0], 7.0, 1e-5, 10, 7).unwrap();
    assert!((found.distance - 7.0).abs() < 1e-3, "{found:?}");
    // and the least excess of two bounds that contradict each other is stationary
    let torn = Largest {
        of: vec![
            (Role::Bound(0), |x| (1.0 - x[0], vec![-1.0, 0.0])),
            (Role::Bound(1), |x| (1.0 + x[0], vec![1.0, 0.0])),
        ],
        ..apart
    };
    let at = |x: f64| sampled_subdifferential(&torn, &[x, 0.0], 7.0, 1e-5, 10, 7).unwrap().distance;
    assert!(at(0.0) < 1e-6 && (at(0.5) - 7.0).abs() < 1e-6, "{} {}", at(0.0), at(0.5));
}

#[test]
fn a_descent_that_is_stopped_goes_on_as_if_it_had_not_been() {
    let problem = two_bowls(0.1);
    let settings = BundleSettings::default();
    let whole = minimize(&problem, &[3.0, -1.0], &settings).unwrap();
    assert!(whole.iterations > 4, "{whole:?}");
    let mut parts = Descent::from(&problem, &[3.0, -1.0], &settings).unwrap();
    let mut stood = parts.stands();
    for steps in [1, 2, 4] {
        parts.to(steps);
        assert!(parts.stands() != stood, "{steps}: no step was made from {stood:?}");
        stood = parts.stands();
    }
    parts.to(settings.iterations);
    let parts = parts.result();
    assert_eq!((parts.x, parts.iterations, parts.end), (whole.x, whole.iterations, whole.end));
}
