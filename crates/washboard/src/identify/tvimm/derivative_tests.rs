//! The free modes' gradient and structured information against differences of their cost and spectra.

use super::information::information;
use super::model::{FreeModel, Point};
use super::orbit::Entries;
use super::score;
use crate::identify::likelihood::checks::{WIDE, assert_gradient, band, dense_information};
use crate::identify::likelihood::{Drive, RoadValues, Whitening};
use crate::linalg::Mat;
use crate::lti::FirstOrder;
use crate::units::Convention;

fn model(kernel: &[f64]) -> FreeModel {
    FreeModel {
        data: band(kernel, 3),
        drive: Drive { speed_m_s: 15.0, convention: Convention::default() },
        at_m: vec![[1.2, 0.7], [-1.3, -0.6]],
        derivatives: vec![2, 1, 2],
        planes: vec![[1.0, 0.2, 0.3], [1.0, -0.1, 0.5], [1.0, 0.4, -0.6]],
    }
}

fn point() -> Point {
    let value = |i: usize, j: usize| ((7 * i + 3 * j) % 11) as f64 / 11.0 - 0.4;
    let a = Mat::from_fn(4, 4, |i, j| match (i, j) {
        (0, 1) | (2, 3) => 1.0 + i as f64,
        (1, 0) | (3, 2) => -1.0 - j as f64,
        _ => 0.2 * value(i, j) - if i == j { 0.5 } else { 0.0 },
    });
    let (b, c) = (Mat::from_fn(4, 2, |i, j| value(i + 2, j)), Mat::from_fn(3, 4, |i, j| value(i, j + 5)));
    Point {
        system: FirstOrder { a, b, c },
        road: RoadValues { ln_s0: 0.3, exponent: 1.8, mu: 2.0, ln_delay: 0.05 },
        ln_noise: vec![-1.0, -2.0, -1.5],
    }
}

/// The point with one of the entries, ln S₀, e, ln μ, ln delay, ln noise moved.
fn moved(at: &Point, i: usize, by: f64) -> Point {
    let e = Entries::of(&at.system);
    let mut at = at.clone();
    match i.checked_sub(e.len()) {
        None => at.system = e.moved(&at.system, |k| if k == i { by } else { 0.0 }),
        Some(0) => at.road.ln_s0 += by,
        Some(1) => at.road.exponent += by,
        Some(2) => at.road.mu *= by.exp(),
        Some(3) => at.road.ln_delay += by,
        Some(c) => at.ln_noise[c - 4] += by,
    }
    at
}

#[test]
fn the_gradient_is_the_differences_of_the_cost() {
    let (model, at) = (model(&WIDE), point());
    let count = Entries::of(&at.system).len() + 4 + 3;
    let other = (0..count).fold(at.clone(), |p, i| moved(&p, i, 0.01 * (i % 5) as f64 - 0.02));
    let measured = model.spectra(&other).unwrap();
    let full = score::full(&model, &model.evaluate(&at).unwrap(), &measured, &at).unwrap();
    let cost = |at: &Point| score::cost(&model, &model.spectra(at).unwrap(), &measured, at).unwrap();
    assert_eq!(full.gradient.len(), count);
    assert!((full.cost / cost(&at) - 1.0).abs() < 1e-12);
    assert_gradient(&full.gradient, &|i, by| cost(&moved(&at, i, by)));
}

/// The information takes derivatives at the middles of bins: a window that sees nothing else.
#[test]
fn the_structured_information_is_that_of_dense_differences() {
    let (model, at) = (model(&[1.0]), point());
    let evaluation = model.evaluate(&at).unwrap();
    let fisher = information(&model, &evaluation, &Whitening::new(&evaluation.s).unwrap(), &at);
    let count = fisher.nrows();
    let s = |i: usize, by: f64| model.spectra(&moved(&at, i, by)).unwrap();
    for a in (0..count).step_by(3).chain(count - 7..count) {
        for b in [a, (a + 5) % count, (a + 17) % count, count - 1 - a % 7] {
            let (found, scale) = (fisher[(a, b)], (fisher[(a, a)] * fisher[(b, b)]).sqrt());
            let dense = dense_information(&s, a, b);
            // differences at 1e-5 leave 1e-8
            assert!((found - dense).abs() < 1e-6 * scale, "({a}, {b}): {found}, {dense}");
        }
    }
}
