//! Nodes that are refused, with the numbers.

use washboard::linalg::{C64, CMat};
use washboard::subspace::{Domain, InterpolationData, Node, Point, Side, SubspaceError, interpolate};

fn one(re: f64, im: f64) -> CMat {
    CMat::from_fn(1, 1, |_, _| C64::new(re, im))
}

fn node(re: f64, im: f64, values: Vec<CMat>) -> Node {
    Node::full(C64::new(re, im), values)
}

fn refused(domain: Domain, nodes: Vec<Node>) -> SubspaceError {
    InterpolationData::new(domain, nodes).unwrap_err()
}

#[test]
fn contradictions_are_named_by_both_nodes() {
    let good = || node(1.0, 1.0, vec![one(1.0, 2.0), one(0.5, 0.0)]);
    for (again, derivative, off) in [
        (node(1.0, 1.0, vec![one(1.0, 2.5)]), 0, 0.5),
        (node(1.0, -1.0, vec![one(1.0, 2.0)]), 0, 4.0),
        (node(1.0, -1.0, vec![one(1.0, -2.0), one(0.75, 0.0)]), 1, 0.25),
    ] {
        let found = refused(Domain::Disk, vec![node(3.0, 0.0, vec![one(0.0, 0.0)]), good(), again]);
        assert!(
            matches!(found, SubspaceError::Contradiction { first: 1, second: 2, derivative: d, difference }
                if d == derivative && (difference - off).abs() < 1e-12),
            "{found}"
        );
    }
    // what agrees is one node
    let twice = vec![good(), node(1.0, -1.0, vec![one(1.0, -2.0)]), good()];
    assert!(InterpolationData::new(Domain::Disk, twice).is_ok());
    // v (G u) is (v G) u
    let c = |x: f64| C64::new(x, 0.0);
    let sided = |value: f64| {
        let row = CMat::from_fn(1, 2, |_, j| c([1.0, 2.0][j]));
        let left =
            Node { z: Point::Finite(c(2.0)), values: vec![row], side: Side::Left(vec![c(1.0), c(1.0)]) };
        let column = CMat::from_fn(2, 1, |i, _| c([0.5, value][i]));
        let right =
            Node { z: Point::Finite(c(2.0)), values: vec![column], side: Side::Right(vec![c(1.0), c(1.0)]) };
        InterpolationData::new(Domain::Disk, vec![left, right])
    };
    assert!(sided(2.5).is_ok());
    let found = sided(2.0).unwrap_err();
    assert!(
        matches!(found, SubspaceError::Contradiction { difference, .. } if (difference - 0.5).abs() < 1e-12),
        "{found}"
    );
}

#[test]
fn nodes_must_lie_where_there_are_no_poles() {
    let found =
        refused(Domain::Disk, vec![node(2.0, 0.0, vec![one(1.0, 0.0)]), node(0.3, 0.4, vec![one(1.0, 0.0)])]);
    assert!(
        matches!(found, SubspaceError::NodeInside { index: 1, re, im, inside, .. }
            if re == 0.3 && im == 0.4 && (inside - 0.5).abs() < 1e-12),
        "{found}"
    );
    let half = Domain::HalfPlane { lambda_rad_s: 1.0 };
    let found = refused(half, vec![node(-0.25, 3.0, vec![one(1.0, 0.0)])]);
    assert!(matches!(found, SubspaceError::NodeInside { index: 0, inside, .. } if inside == 0.25), "{found}");
    assert!(InterpolationData::new(half, vec![node(0.0, 3.0, vec![one(1.0, 0.0)])]).is_ok());
    assert!(
        InterpolationData::new(
            Domain::Disk,
            vec![Node::full(C64::from_polar(1.0, 0.7), vec![one(1.0, 0.0)])]
        )
        .is_ok()
    );
    assert!(
        refused(Domain::HalfPlane { lambda_rad_s: -1.0 }, vec![node(1.0, 0.0, vec![one(1.0, 0.0)])])
            .to_string()
            .contains("-1")
    );
}

#[test]
fn shapes_and_values_are_checked() {
    let found = refused(Domain::Disk, vec![node(2.0, 0.0, vec![one(1.0, 0.0), CMat::zeros(1, 2)])]);
    assert!(
        matches!(
            found,
            SubspaceError::NodeShape { index: 0, derivative: 1, expected: (1, 1), found: (1, 2) }
        ),
        "{found}"
    );
    let found = refused(Domain::Disk, vec![node(2.0, 0.0, vec![one(1.0, 0.5)])]);
    assert!(
        matches!(found, SubspaceError::NotReal { index: 0, derivative: 0, imaginary } if imaginary == 0.5),
        "{found}"
    );
    let found = refused(Domain::Disk, vec![Node::at_infinity(vec![one(1.0, 0.0), one(0.0, 1.0)])]);
    assert!(matches!(found, SubspaceError::NotReal { derivative: 1, .. }), "{found}");
    let found = refused(Domain::Disk, vec![node(2.0, 0.0, vec![one(f64::NAN, 0.0)])]);
    assert!(matches!(found, SubspaceError::Sample { index: 0, .. }), "{found}");
    let wrong = Node { side: Side::Left(vec![C64::new(0.0, 0.0)]), ..node(2.0, 0.0, vec![one(1.0, 0.0)]) };
    assert!(refused(Domain::Disk, vec![wrong]).to_string().contains("a direction that is zero"));
    let wrong = Node { side: Side::Left(vec![C64::new(1.0, 0.0); 3]), ..node(2.0, 0.0, vec![one(1.0, 0.0)]) };
    let found = refused(Domain::Disk, vec![node(3.0, 0.0, vec![one(1.0, 0.0)]), wrong]);
    assert!(found.to_string().contains("node 1: a direction of 3 entries, expected 1"), "{found}");
    assert!(matches!(refused(Domain::Disk, Vec::new()), SubspaceError::Count { .. }));
    assert!(
        refused(Domain::Disk, vec![node(3.0, 0.0, vec![one(1.0, 0.0)]), node(2.0, 0.0, Vec::new())])
            .to_string()
            .contains("no values")
    );
}

/// One direction on the right says nothing of the other input.
#[test]
fn a_direction_that_is_never_asked_is_a_missing_rank() {
    let g = |z: f64| 1.0 / (z - 0.5);
    let nodes = (1..8).map(|k| {
        let z = 1.0 + 0.3 * f64::from(k);
        let column = CMat::from_fn(2, 1, |i, _| C64::new(g(z) * (1.0 + i as f64), 0.0));
        let u = vec![C64::new(1.0, 0.0), C64::new(0.0, 0.0)];
        Node { z: Point::Finite(C64::new(z, 0.0)), values: vec![column], side: Side::Right(u) }
    });
    let data = InterpolationData::new(Domain::Disk, nodes.collect()).unwrap();
    let found = interpolate(&data, Some(1)).unwrap_err();
    assert!(matches!(found, SubspaceError::MissingDirections { rank: 1, needed: 2 }), "{found}");
}

/// No proper function of order 1 goes through values of z itself; what is not stable is said and not refused.
#[test]
fn improper_and_unstable_functions_are_told_apart() {
    let half = Domain::HalfPlane { lambda_rad_s: 1.0 };
    let through = |f: &dyn Fn(f64) -> f64, domain| {
        let nodes = [1.5, 2.0, 3.0, 4.0, 5.0].map(|s| node(s, 0.0, vec![one(f(s), 0.0)]));
        interpolate(&InterpolationData::new(domain, nodes.into()).unwrap(), None)
    };
    let found = through(&|s| s, half).unwrap_err();
    assert!(matches!(found, SubspaceError::Improper { order: 1, .. }), "{found}");
    let found = through(&|z| 1.0 / (z - 1.25), Domain::Disk).unwrap();
    assert!(!found.stable && found.order == 1 && found.max_error < 1e-12);
    // an order too low is an answer with its error
    let found = through(&|z| 1.0 / (z - 0.5) + 1.0 / (z + 0.5), Domain::Disk).unwrap();
    assert!(found.order == 2 && found.meets_its_data());
    let nodes =
        [1.5, 2.0, 3.0, 4.0, 5.0].map(|z| node(z, 0.0, vec![one(1.0 / (z - 0.5) + 1.0 / (z + 0.5), 0.0)]));
    let found = interpolate(&InterpolationData::new(Domain::Disk, nodes.into()).unwrap(), Some(1)).unwrap();
    assert!(found.order == 1 && !found.meets_its_data());
}
