//! Nevanlinna–Pick by mirrored nodes, against Schwarz's and Pick's lemma and against Blaschke products.

use super::poles_and_residues::at;
use std::f64::consts::PI;
use washboard::linalg::{C64, CMat};
use washboard::subspace::{
    Bounded, Domain, InterpolationData, Node, Point, SubspaceError, interpolate_bounded,
};

fn one(x: C64) -> Vec<CMat> {
    vec![CMat::from_fn(1, 1, |_, _| x)]
}

/// |G| on the boundary, least and largest.
fn modulus(found: &Bounded, domain: Domain) -> [f64; 2] {
    (1..200).fold([f64::INFINITY, 0.0], |[low, high], k| {
        let theta = PI * f64::from(k) / 200.0;
        let z = match domain {
            Domain::Disk => C64::from_polar(1.0, theta),
            Domain::HalfPlane { lambda_rad_s } => C64::new(0.0, lambda_rad_s * (theta / 2.0).tan()),
        };
        let size = at(found.interpolant.system.matrices(), z)[(0, 0)].norm();
        [low.min(size), high.max(size)]
    })
}

fn real(z: f64, w: f64) -> Node {
    Node::full(C64::new(z, 0.0), one(C64::new(w, 0.0)))
}

/// f(a) = 0 and f(b) = 1: the least bound is 1/|(a − b)/(1 − ab)|, in x = 1/z.
#[test]
fn two_values_and_schwarzs_lemma() {
    for (a, b) in [(0.5, 0.25), (0.4, -0.3), (0.1, 0.8)] {
        let data =
            InterpolationData::new(Domain::Disk, vec![real(1.0 / a, 0.0), real(1.0 / b, 1.0)]).unwrap();
        let found = interpolate_bounded(&data, None).unwrap();
        let expected = ((1.0 - a * b) / (a - b)).abs();
        assert!((found.least / expected - 1.0).abs() < 1e-12, "{} {expected}", found.least);
        let [low, high] = modulus(&found, Domain::Disk);
        assert!(
            (low / expected - 1.0).abs() < 1e-10 && (high / expected - 1.0).abs() < 1e-10,
            "{low} {high}"
        );
        assert_eq!((found.interpolant.order, found.interpolant.stable), (1, true));
        assert!(found.interpolant.max_error < 1e-10, "{:e}", found.interpolant.max_error);
        let refused = interpolate_bounded(&data, Some(0.9 * expected)).unwrap_err();
        assert!(
            matches!(refused, SubspaceError::Bound { bound, least } if bound < least && (least / expected - 1.0).abs() < 1e-9),
            "{refused}"
        );
    }
}

/// Values of 3 B(x), B a Blaschke product of order 3, at 5 points: the bound is 3 and the function is B.
#[test]
fn a_blaschke_product_comes_back() {
    let zeros = [C64::from_polar(0.6, 0.8), C64::from_polar(0.6, -0.8), C64::new(-0.4, 0.0)];
    let b = |z: C64| {
        let x = C64::new(1.0, 0.0) / z;
        zeros.iter().fold(C64::new(3.0, 0.0), |f, a| f * (x - a) / (C64::new(1.0, 0.0) - x * a.conj()))
    };
    let mut nodes: Vec<Node> = [C64::from_polar(1.4, 0.5), C64::from_polar(2.0, 1.9), C64::new(-1.7, 0.0)]
        .map(|z| Node::full(z, one(if z.im == 0.0 { C64::new(b(z).re, 0.0) } else { b(z) })))
        .into();
    nodes.push(Node::at_infinity(one(C64::new(b(C64::new(1e300, 0.0)).re, 0.0))));
    let data = InterpolationData::new(Domain::Disk, nodes).unwrap();
    let found = interpolate_bounded(&data, None).unwrap();
    println!("{} {:e}", found.least, found.interpolant.max_error);
    assert!((found.bound - 3.0).abs() < 1e-8 && found.interpolant.order == 3 && found.interpolant.stable);
    assert!(found.interpolant.max_error < 1e-9, "{:e}", found.interpolant.max_error);
    for k in 0..20 {
        let z = C64::from_polar(1.0, 0.15 * f64::from(k));
        assert!((at(found.interpolant.system.matrices(), z)[(0, 0)] - b(z)).norm() < 1e-7);
    }
}

/// In the half plane, at the least bound and above it: constant modulus, stable, through the data.
#[test]
fn bounds_above_the_least_are_met_with_equality() {
    let domain = Domain::HalfPlane { lambda_rad_s: 2.0 };
    let nodes = vec![
        Node::full(C64::new(1.0, 2.0), one(C64::new(0.3, -0.8))),
        real(0.7, 1.1),
        Node::full(C64::new(3.0, -5.0), one(C64::new(-0.2, 0.1))),
    ];
    let data = InterpolationData::new(domain, nodes).unwrap();
    let least = interpolate_bounded(&data, None).unwrap();
    // five points with the conjugates: order 4 at the least bound, 5 above it
    for (bound, order) in [(None, 4), (Some(1.05 * least.least), 5), (Some(3.0 * least.least), 5)] {
        let found = interpolate_bounded(&data, bound).unwrap();
        assert_eq!((found.interpolant.order, found.interpolant.stable), (order, true), "{bound:?}");
        assert!(found.interpolant.max_error < 1e-9, "{bound:?}: {:e}", found.interpolant.max_error);
        let [low, high] = modulus(&found, domain);
        assert!(
            (low / found.bound - 1.0).abs() < 1e-8 && (high / found.bound - 1.0).abs() < 1e-8,
            "{low} {high}"
        );
    }
    // no stable function does better: none through the data is below its largest value
    assert!(least.least >= 1.1);
}

#[test]
fn data_that_have_no_bound_of_this_kind_are_refused() {
    let refused = |nodes: Vec<Node>| {
        interpolate_bounded(&InterpolationData::new(Domain::Disk, nodes).unwrap(), None).unwrap_err()
    };
    let boundary = refused(vec![real(2.0, 1.0), real(1.0, 0.5)]);
    assert!(matches!(boundary, SubspaceError::Sample { what: "node", index: 1, .. }), "{boundary}");
    let mut slope = real(2.0, 1.0);
    slope.values.push(CMat::zeros(1, 1));
    let slope = refused(vec![slope]);
    assert!(matches!(slope, SubspaceError::Count { expected: 1, found: 2, .. }), "{slope}");
    let wide = refused(vec![Node::at_infinity(vec![CMat::zeros(1, 2)])]);
    assert!(matches!(wide, SubspaceError::Count { expected: 1, found: 2, .. }), "{wide}");
    let zero =
        InterpolationData::new(Domain::Disk, vec![Node { z: Point::Infinity, ..real(2.0, 0.0) }]).unwrap();
    let zero = interpolate_bounded(&zero, None).unwrap();
    assert_eq!((zero.least, zero.interpolant.order, zero.interpolant.max_error), (0.0, 0, 0.0));
}
