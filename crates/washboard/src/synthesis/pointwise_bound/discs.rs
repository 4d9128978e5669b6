//! One control and one disturbance: discs in the plane of V, and the least level at which they meet.

use super::terms::Term;
use crate::linalg::C64;

/// Discs are larger by this share at least than they are, so that rounding finds no gap where there is none.
const SLACK: f64 = 1e-12;
/// The bisection's end, relative.
const CLOSE: f64 = 1e-10;
/// Halvings; [`CLOSE`] ends them before.
const MOST: usize = 200;

/// |a + b v|² = ρ²|v − c|² + d².
#[derive(Debug, Clone, Copy)]
struct Bowl {
    centre: C64,
    rho: f64,
    least: f64,
    goal: bool,
    /// Of the centre and of ρ, relative.
    slack: f64,
}

#[derive(Debug, Clone, Copy)]
struct Disc {
    centre: C64,
    radius: f64,
    slack: f64,
}

/// The least of the largest goal under the bounds; `None` where the bounds have no V in common.
///
/// `doubt` is the responses' relative error: what it may do to a bowl's centre and to what is left of A there is in favour
/// of a lower level.
pub(super) fn least_level(terms: &[Term], doubt: f64) -> Option<f64> {
    let bowls: Vec<Bowl> = terms.iter().map(|t| Bowl::new(t, doubt.max(SLACK))).collect();
    let start = common(&bowls, f64::INFINITY)?;
    let goals = || bowls.iter().filter(|b| b.goal);
    let mut low = goals().map(|b| b.least).fold(0.0, f64::max);
    let mut high = goals().map(|b| b.at(start)).fold(low, f64::max);
    for _ in 0..MOST {
        if high - low <= CLOSE * high {
            break;
        }
        let middle = 0.5 * (low + high);
        match common(&bowls, middle) {
            Some(_) => high = middle,
            None => low = middle,
        }
    }
    Some(low)
}

impl Bowl {
    fn new(term: &Term, slack: f64) -> Self {
        let entries = || (0..term.a.nrows()).map(|i| (term.a[(i, 0)], term.b[(i, 0)]));
        let rho = entries().map(|(_, b)| b.norm_sqr()).sum::<f64>().sqrt();
        let across: C64 = entries().map(|(a, b)| b.conj() * a).sum();
        let centre = if rho > 0.0 { -across / (rho * rho) } else { C64::new(0.0, 0.0) };
        let least = entries().map(|(a, b)| (a + b * centre).norm_sqr()).sum::<f64>().sqrt();
        // one output that the control reaches can be made 0
        let least = if term.a.nrows() == 1 && rho > 0.0 { 0.0 } else { least };
        // A and B ρ·centre may be far larger than their sum
        let size = entries().map(|(a, _)| a.norm_sqr()).sum::<f64>().sqrt() + rho * centre.norm();
        let least = (least - slack * size).max(0.0);
        Bowl { centre, rho, least, goal: term.goal, slack }
    }

    fn at(&self, v: C64) -> f64 {
        (self.rho * (v - self.centre).norm()).hypot(self.least)
    }

    /// Where it is at most `level`: `Err` nowhere, `Ok(None)` everywhere.
    fn disc(&self, level: f64) -> Result<Option<Disc>, ()> {
        if self.least > level * (1.0 + self.slack) {
            return Err(());
        }
        if self.rho == 0.0 || level.is_infinite() {
            return Ok(None);
        }
        let radius = ((level - self.least).max(0.0) * (level + self.least)).sqrt() / self.rho;
        Ok(Some(Disc { centre: self.centre, radius, slack: self.slack }))
    }
}

/// A V at which all goals are at most `level` and all bounds at most 1: where discs meet, a centre or a corner of two of
/// them is in all.
fn common(bowls: &[Bowl], level: f64) -> Option<C64> {
    let discs = bowls.iter().map(|b| b.disc(if b.goal { level } else { 1.0 }));
    let discs: Vec<Disc> = discs.collect::<Result<Vec<_>, ()>>().ok()?.into_iter().flatten().collect();
    if discs.is_empty() {
        // without a disc everything will do: the least of all
        return Some(bowls.iter().find(|b| b.rho > 0.0).map_or(C64::new(0.0, 0.0), |b| b.centre));
    }
    let inside = |v: &C64| discs.iter().all(|d| (v - d.centre).norm() <= d.radius + d.slack());
    let mut candidates: Vec<C64> = discs.iter().map(|d| d.centre).collect();
    for (i, one) in discs.iter().enumerate() {
        for other in &discs[i + 1..] {
            candidates.extend(one.corners(other));
        }
    }
    candidates.into_iter().find(inside)
}

impl Disc {
    fn slack(&self) -> f64 {
        self.slack * (self.radius + self.centre.norm())
    }

    /// Where two circles cross, and the middle between; touching within rounding counts.
    fn corners(&self, other: &Disc) -> Vec<C64> {
        let between = other.centre - self.centre;
        let distance = between.norm();
        if distance == 0.0 {
            return Vec::new();
        }
        let along = 0.5 * (distance + (self.radius - other.radius) * (self.radius + other.radius) / distance);
        let half = ((self.radius - along) * (self.radius + along)).max(0.0).sqrt();
        let direction = between / distance;
        let middle = self.centre + direction * along;
        let across = C64::new(-direction.im, direction.re) * half;
        vec![middle + across, middle - across, middle]
    }
}
