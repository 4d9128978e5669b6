//! Which mode of one result is which of another.

use super::compare_outcome::MatchedBy;
use super::identify_outcome::{IdentifiedMode, ShapePoint};
use crate::linalg::C64;

/// Shapes less alike than this are of different modes.
const LEAST_MAC: f64 = 0.5;
/// A single point is alike with every other.
const LEAST_POINTS: usize = 2;
/// What a pole's distance takes from the likeness of shapes: enough to tell apart what the points do not.
const POLE_WEIGHT: f64 = 0.25;
/// Without shapes, poles further apart than this (a quarter in frequency, or 25 points of damping) are of different modes.
const FARTHEST: f64 = 0.25;

/// Two modes that are one, by their places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub before: usize,
    pub after: usize,
    pub by: MatchedBy,
    pub mac: Option<f64>,
}

/// The pairs of modes in the order of `before`: the most alike shapes first, then, of modes that have no points in
/// common with those left, the nearest poles.
pub(super) fn matched(before: &[IdentifiedMode], after: &[IdentifiedMode]) -> Vec<Pair> {
    let mut candidates: Vec<(bool, f64, Pair)> = Vec::new();
    for (i, a) in before.iter().enumerate() {
        for (j, b) in after.iter().enumerate() {
            let far = distance(a, b);
            let mac = mac(&a.points, &b.points);
            let pair = |by| Pair { before: i, after: j, by, mac };
            match mac {
                Some(mac) if mac >= LEAST_MAC => {
                    candidates.push((false, POLE_WEIGHT * far.min(1.0) - mac, pair(MatchedBy::Shape)));
                }
                None if far <= FARTHEST => candidates.push((true, far, pair(MatchedBy::Pole))),
                _ => {}
            }
        }
    }
    candidates.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut pairs: Vec<Pair> = Vec::new();
    for (.., pair) in candidates {
        if !pairs.iter().any(|p| p.before == pair.before || p.after == pair.after) {
            pairs.push(pair);
        }
    }
    pairs.sort_by_key(|p| p.before);
    pairs
}

/// √((ln f₂/f₁)² + (ζ₂ − ζ₁)²): a share of the frequency beside points of damping.
fn distance(a: &IdentifiedMode, b: &IdentifiedMode) -> f64 {
    (b.freq_hz / a.freq_hz).ln().hypot(b.damping - a.damping)
}

/// The components of both at the points that both have: of one name and place, in their order.
fn common(a: &[ShapePoint], b: &[ShapePoint]) -> Vec<(C64, C64)> {
    let value = |p: &ShapePoint| C64::new(p.re, p.im);
    let mut free: Vec<&ShapePoint> = b.iter().collect();
    let mut both = Vec::new();
    for p in a {
        if let Some(k) = free.iter().position(|q| q.name == p.name && q.place == p.place) {
            both.push((value(p), value(free.remove(k))));
        }
    }
    both
}

/// |aᴴb|²/(aᴴa · bᴴb); none of fewer than two points.
fn mac(a: &[ShapePoint], b: &[ShapePoint]) -> Option<f64> {
    let both = common(a, b);
    if both.len() < LEAST_POINTS {
        return None;
    }
    let across: C64 = both.iter().map(|(u, v)| u.conj() * v).sum();
    let (uu, vv) = both.iter().fold((0.0, 0.0), |(u2, v2), (u, v)| (u2 + u.norm_sqr(), v2 + v.norm_sqr()));
    (uu > 0.0 && vv > 0.0).then(|| across.norm_sqr() / (uu * vv))
}

/// `b` turned so that aᴴb is real and positive: a shape's phase is free.
pub(super) fn aligned(a: &[ShapePoint], b: &[ShapePoint]) -> Vec<ShapePoint> {
    let across: C64 = common(a, b).iter().map(|(u, v)| u.conj() * v).sum();
    let turn = if across.norm() > 0.0 { across.conj() / across.norm() } else { C64::new(1.0, 0.0) };
    let turned = |p: &ShapePoint| {
        let z = C64::new(p.re, p.im) * turn;
        ShapePoint { re: z.re, im: z.im, ..p.clone() }
    };
    b.iter().map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(freq_hz: f64, damping: f64, shape: &[(f64, f64)]) -> IdentifiedMode {
        let point = |(k, (re, im)): (usize, &(f64, f64))| ShapePoint {
            name: k.to_string(),
            place: "body".into(),
            at_m: [k as f64, 0.0],
            re: *re,
            im: *im,
        };
        let points = shape.iter().enumerate().map(point).collect();
        IdentifiedMode { freq_hz, damping, points, ..IdentifiedMode::default() }
    }

    fn places(pairs: &[Pair]) -> Vec<(usize, usize, MatchedBy)> {
        pairs.iter().map(|p| (p.before, p.after, p.by)).collect()
    }

    #[test]
    fn shapes_decide_where_frequencies_cross() {
        let (bounce, pitch) = ([(1.0, 0.0), (0.9, 0.0)], [(1.0, 0.0), (-0.9, 0.1)]);
        let before = [mode(1.0, 0.3, &bounce), mode(1.3, 0.3, &pitch)];
        // after a change of springs pitch is the lower one; the whole shape is turned, which means nothing
        let turned = pitch.map(|(re, im)| (-im, re));
        let after = [mode(1.1, 0.3, &turned), mode(1.4, 0.3, &bounce)];
        let pairs = matched(&before, &after);
        assert_eq!(places(&pairs), [(0, 1, MatchedBy::Shape), (1, 0, MatchedBy::Shape)]);
        assert!((pairs[1].mac.unwrap() - 1.0).abs() < 1e-12, "a turn does not change the likeness");
        let back = aligned(&before[1].points, &after[0].points);
        assert!(back.iter().zip(&before[1].points).all(|(a, b)| (a.re - b.re).hypot(a.im - b.im) < 1e-12));
    }

    #[test]
    fn poles_decide_between_shapes_that_the_points_do_not_tell_apart() {
        let same = [(1.0, 0.0), (1.0, 0.0)];
        let before = [mode(1.0, 0.3, &same), mode(8.0, 0.3, &same)];
        let after = [mode(8.2, 0.3, &same), mode(1.1, 0.3, &same)];
        assert_eq!(places(&matched(&before, &after)), [(0, 1, MatchedBy::Shape), (1, 0, MatchedBy::Shape)]);
    }

    #[test]
    fn without_points_the_nearest_poles_are_one_and_far_ones_are_not() {
        let before = [mode(1.0, 0.3, &[]), mode(1.1, 0.3, &[]), mode(5.0, 0.1, &[])];
        let after = [mode(1.09, 0.31, &[]), mode(9.0, 0.1, &[])];
        assert_eq!(places(&matched(&before, &after)), [(1, 0, MatchedBy::Pole)]);
        // one point is alike with every other: its mode is matched by the pole
        let one = [mode(1.0, 0.3, &[(1.0, 0.0)])];
        let pairs = matched(&one, &[mode(1.01, 0.3, &[(0.2, 0.9)])]);
        assert_eq!((pairs[0].by, pairs[0].mac), (MatchedBy::Pole, None));
        // shapes that are known to differ are not matched by their poles
        let a = [mode(1.0, 0.3, &[(1.0, 0.0), (1.0, 0.0)])];
        assert!(matched(&a, &[mode(1.0, 0.3, &[(1.0, 0.0), (-1.0, 0.0)])]).is_empty());
    }
}
