//! Random systems come back from their values, derivatives and directions: orders to 12, 4 × 4, multiplicities to 6.

use super::poles_and_residues::{Sum, at};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use washboard::linalg::C64;
use washboard::subspace::{
    Domain, Interpolant, InterpolationData, Node, Point, Side, SubspaceError, interpolate, loewner,
};

/// What the issue asks for.
const WITHIN: f64 = 1e-8;

const HALF_PLANE: Domain = Domain::HalfPlane { lambda_rad_s: 20.0 };

/// A point of the region, real or complex.
fn place(domain: Domain, real: bool, rng: &mut ChaCha8Rng) -> Point {
    let (angle, size) = (PI * rng.random_range(0.05..0.95), rng.random_range(0.0..1.0));
    let z = match (domain, real) {
        (Domain::Disk, true) => C64::new(if angle < PI / 2.0 { 1.0 } else { -1.0 } * (1.0 + size), 0.0),
        (Domain::Disk, false) => C64::from_polar(1.0 + 0.8 * size, angle),
        (Domain::HalfPlane { lambda_rad_s }, true) => C64::new(lambda_rad_s * 3.0 * size, 0.0),
        (Domain::HalfPlane { lambda_rad_s }, false) => {
            C64::new(lambda_rad_s * 0.5 * size, lambda_rad_s * (angle / 2.0).tan())
        }
    };
    Point::Finite(z)
}

fn direction(count: usize, rng: &mut ChaCha8Rng) -> Vec<C64> {
    (0..count).map(|_| C64::new(rng.random_range(-1.0..1.0), 0.0)).collect()
}

/// Nodes with `needed` real conditions or more, each of a side by `side`.
fn nodes(
    g: &Sum,
    domain: Domain,
    needed: usize,
    multiplicity: usize,
    rng: &mut ChaCha8Rng,
    mut side: impl FnMut(usize, &mut ChaCha8Rng) -> Side,
) -> Vec<Node> {
    let (mut nodes, mut have) = (Vec::new(), 0);
    while have < needed {
        let real = rng.random_range(0.0..1.0) < 0.3;
        let count = rng.random_range(1..=multiplicity);
        let z = if nodes.len() == 1 { Point::Infinity } else { place(domain, real, rng) };
        have += count * if real || z == Point::Infinity { 1 } else { 2 };
        let side = side(nodes.len(), rng);
        nodes.push(g.node(z, count, side));
    }
    nodes
}

/// The largest error on the boundary, over the largest value.
fn elsewhere(found: &Interpolant, g: &Sum, domain: Domain) -> f64 {
    let (mut off, mut size) = (0.0f64, 0.0f64);
    for k in 1..100 {
        let theta = PI * f64::from(k) / 100.0;
        let z = match domain {
            Domain::Disk => C64::from_polar(1.0, theta),
            Domain::HalfPlane { lambda_rad_s } => C64::new(0.0, lambda_rad_s * (theta / 2.0).tan()),
        };
        let expected = g.at(z);
        off = off.max((at(found.system.matrices(), z) - &expected).norm_max());
        size = size.max(expected.norm_max());
    }
    off / size
}

fn radius(domain: Domain) -> [f64; 2] {
    if domain == Domain::Disk { [0.3, 0.9] } else { [3.0, 60.0] }
}

#[test]
fn full_data_of_every_order_and_shape() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let (mut worst, mut worst_elsewhere, mut told) = (0.0f64, 0.0f64, 0);
    for domain in [Domain::Disk, HALF_PLANE] {
        for n in 1..=12 {
            for (p, m) in [(1, 1), (2, 1), (1, 3), (2, 3), (4, 4)] {
                let g = Sum::random(domain, n, (p, m), radius(domain), &mut rng);
                let all = nodes(&g, domain, 2 * n + 1, 6, &mut rng, |_, _| Side::Full);
                let data = InterpolationData::new(domain, all).unwrap();
                let found = interpolate(&data, None).unwrap();
                let off = elsewhere(&found, &g, domain);
                worst = worst.max(found.max_error);
                worst_elsewhere = worst_elsewhere.max(off);
                // of 2n + 1 conditions rounding may hide the weakest mode
                assert!(found.order <= n && n <= found.order + 1, "{domain:?} {n} {p} {m}: {}", found.order);
                told += usize::from(found.order == n && found.stable);
                assert!(found.max_error < WITHIN, "{domain:?} {n} {p} {m}: {:e}", found.max_error);
            }
        }
    }
    assert!(told >= 119, "{told} of 120");
    println!("{told} of 120 orders, at the nodes {worst:e}, on the boundary {worst_elsewhere:e}");
}

#[test]
fn data_of_one_side_and_of_both() {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    let mut worst = [0.0f64; 3];
    for domain in [Domain::Disk, HALF_PLANE] {
        for n in 1..=8 {
            for (p, m) in [(2, 2), (3, 2), (2, 4)] {
                let g = Sum::random(domain, n, (p, m), radius(domain), &mut rng);
                for (k, worst) in worst.iter_mut().enumerate() {
                    let needed = (2 * n + 1) * p.max(m) + 2;
                    let all = nodes(&g, domain, needed, 3, &mut rng, |at, rng| match (k, at % 2) {
                        (0, _) | (2, 0) => Side::Right(direction(m, rng)),
                        _ => Side::Left(direction(p, rng)),
                    });
                    let data = InterpolationData::new(domain, all).unwrap();
                    let found = interpolate(&data, None).unwrap();
                    let values = &found.singular_values;
                    assert_eq!(found.order, n, "{domain:?} {k} {n} {p} {m}: {values:?}");
                    assert!(found.max_error < WITHIN, "{domain:?} {k} {n} {p} {m}: {:e}", found.max_error);
                    *worst = worst.max(found.max_error);
                }
            }
        }
    }
    println!("right, left, both: {worst:?}");
}

/// The Löwner matrix finds the same function.
#[test]
fn two_routes_one_function() {
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    for domain in [Domain::Disk, HALF_PLANE] {
        for n in 1..=6 {
            for (p, m) in [(1, 1), (2, 3), (3, 1)] {
                let g = Sum::random(domain, n, (p, m), radius(domain), &mut rng);
                let all = nodes(&g, domain, 2 * n + 3, 4, &mut rng, |_, _| Side::Full);
                let data = InterpolationData::new(domain, all).unwrap();
                let (one, two) = (interpolate(&data, None).unwrap(), loewner(&data, None).unwrap());
                assert_eq!((one.order, two.order), (n, n), "{domain:?} {p} {m} {:?}", two.singular_values);
                assert!(two.max_error < WITHIN, "{domain:?} {n} {p} {m} {:e}", two.max_error);
                let off = elsewhere(&one, &g, domain).max(elsewhere(&two, &g, domain));
                assert!(off < WITHIN, "{domain:?} {n} {p} {m}: {off:e}");
            }
        }
    }
}

/// N simple nodes on the boundary, as many as measurements have: the whole response comes back.
#[test]
fn responses_at_simple_nodes_give_the_whole_function() {
    let mut rng = ChaCha8Rng::seed_from_u64(34);
    let mut worst = 0.0f64;
    for domain in [Domain::Disk, HALF_PLANE] {
        for n in [1, 4, 8, 12] {
            for (p, m) in [(1, 1), (4, 2)] {
                let g = Sum::random(domain, n, (p, m), radius(domain), &mut rng);
                let all = (0..2 * n + 2).map(|k| {
                    let theta = PI * (k as f64 + 0.5) / (2 * n + 2) as f64;
                    let z = match domain {
                        Domain::Disk => C64::from_polar(1.0, theta),
                        Domain::HalfPlane { lambda_rad_s } => {
                            C64::new(0.0, lambda_rad_s * (theta / 2.0).tan())
                        }
                    };
                    g.node(Point::Finite(z), 1, Side::Full)
                });
                let data = InterpolationData::new(domain, all.collect()).unwrap();
                let found = interpolate(&data, None).unwrap();
                assert_eq!((found.order, found.stable), (n, true), "{domain:?} {n} {p} {m}");
                worst = worst.max(elsewhere(&found, &g, domain));
            }
        }
    }
    println!("on the boundary {worst:e}");
    assert!(worst < WITHIN, "{worst:e}");
}

/// N = 2n + 1 real conditions tell an order n; one less does not, and the rank that is missing is said.
#[test]
fn as_little_data_as_can_be_and_less() {
    let mut rng = ChaCha8Rng::seed_from_u64(35);
    for n in 1..=5usize {
        let g = Sum::random(Domain::Disk, n, (1, 1), [0.3, 0.8], &mut rng);
        let nodes = |complex: usize, real: bool| {
            let mut all: Vec<Node> = (0..complex)
                .map(|k| C64::from_polar(1.1, PI * (k as f64 + 0.5) / complex as f64))
                .map(|z| g.node(Point::Finite(z), 1, Side::Full))
                .collect();
            if real {
                all.push(g.node(Point::Finite(C64::new(1.2, 0.0)), 1, Side::Full));
            }
            InterpolationData::new(Domain::Disk, all).unwrap()
        };
        let found = interpolate(&nodes(n, true), None).unwrap();
        assert_eq!(found.order, n);
        assert!(elsewhere(&found, &g, Domain::Disk) < WITHIN);
        let short = interpolate(&nodes(n, false), None).unwrap_err();
        assert!(
            matches!(short, SubspaceError::TooLittleData { rank, missing: 1, .. } if rank == n),
            "{n}: {short}"
        );
        let short = interpolate(&nodes(n, true), Some(n + 2)).unwrap_err();
        assert!(
            matches!(short, SubspaceError::TooLittleData { most, missing: 2, .. } if most == n),
            "{n}: {short}"
        );
        let above = interpolate(&nodes(n + 3, true), Some(n + 1)).unwrap_err();
        assert!(matches!(above, SubspaceError::OrderAboveRank { rank, .. } if rank == n), "{n}: {above}");
    }
}
