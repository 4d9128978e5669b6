//! A step from the pieces' linear models: the quadratic program of a bundle, solved by its dual.

use super::pieces::{EDGE, Levels, Role, SmoothPiece, merit};
use super::simplex::{dot, minimize};

/// What the model says.
#[derive(Debug, Clone)]
pub(super) struct Step {
    /// d.
    pub direction: Vec<f64>,
    /// Σ weight · gradient, which is −H d.
    pub slope: Vec<f64>,
    /// Weight of each piece: a goal's sum to 1, a bound's to at most ρ.
    pub weights: Vec<f64>,
    /// What the merit is to lose.
    pub decrease: f64,
    /// Of the penalty, the share that no bound needs.
    pub slack: f64,
    /// max(0, c + ∇cᵀd).
    pub violation: f64,
}

/// min over d of max(fᵢ + gᵢᵀd) + ρ max(0, cⱼ + aⱼᵀd) + ½ dᵀW⁻¹d, by its dual over weights λ of the pieces:
///
/// min ½ ‖Σλᵢgᵢ + ρΣμⱼaⱼ‖²_W − Σλᵢfᵢ − ρΣμⱼcⱼ, Σλ = 1, Σμ = 1 (a piece of 0 among the bounds), d = −W(Σλg + ρΣμa).
///
/// Edges are a third group, as bounds with a penalty of their own. `w` is n × n, row after row. With `exceeded` the bounds' piece of 0 is left out: c > 0 around here. None where numbers overflow or there are no pieces.
pub(super) fn step<I>(pieces: &[SmoothPiece<I>], w: &[f64], penalty: f64, exceeded: bool) -> Option<Step> {
    let n = pieces.first()?.gradient.len();
    let group_of = |p: &SmoothPiece<I>| match p.role {
        Role::Goal => 0,
        Role::Bound(_) => 1,
        Role::Edge => 2,
    };
    let penalties = [1.0, penalty, EDGE * penalty];
    let scale = |p: &SmoothPiece<I>| penalties[group_of(p)];
    let present: Vec<usize> = (0..3).filter(|g| pieces.iter().any(|p| group_of(p) == *g)).collect();
    let place = |g: usize| present.iter().position(|p| *p == g).unwrap_or(0);
    // groups that have a piece of 0
    let free: Vec<usize> = present.iter().copied().filter(|g| *g == 2 || (*g == 1 && !exceeded)).collect();
    let m = pieces.len() + free.len();
    let turned: Vec<Vec<f64>> = pieces.iter().map(|p| symmetric_times(w, &p.gradient)).collect();
    let mut q = vec![0.0; m * m];
    for (i, p) in pieces.iter().enumerate() {
        for (j, r) in pieces.iter().enumerate().take(i + 1) {
            let v = scale(p) * scale(r) * dot(&p.gradient, &turned[j]);
            q[i * m + j] = v;
            q[j * m + i] = v;
        }
    }
    let mut values: Vec<f64> = pieces.iter().map(|p| scale(p) * p.value).collect();
    let mut group: Vec<usize> = pieces.iter().map(|p| place(group_of(p))).collect();
    for g in &free {
        values.push(0.0);
        group.push(place(*g));
    }
    let lambda = minimize(&q, &values, &group, present.len())?;
    let weights: Vec<f64> = pieces.iter().zip(&lambda).map(|(p, l)| scale(p) * l).collect();
    let sum = |of: &dyn Fn(usize) -> f64| -> f64 { (0..pieces.len()).map(|i| weights[i] * of(i)).sum() };
    let slope: Vec<f64> = (0..n).map(|k| sum(&|i| pieces[i].gradient[k])).collect();
    let direction: Vec<f64> = (0..n).map(|k| -sum(&|i| turned[i][k])).collect();
    let then: Vec<SmoothPiece<()>> = pieces
        .iter()
        .map(|p| SmoothPiece {
            id: (),
            role: p.role,
            value: p.value + dot(&p.gradient, &direction),
            gradient: Vec::new(),
        })
        .collect();
    let decrease = merit(pieces, penalty) - merit(&then, penalty);
    let slack = match free.iter().position(|g| *g == 1) {
        Some(k) => lambda[pieces.len() + k],
        None => f64::from(u8::from(!present.contains(&1))),
    };
    direction.iter().all(|v| v.is_finite()).then(|| Step {
        direction,
        slope,
        weights,
        decrease,
        slack,
        violation: Levels::of(&then).bound,
    })
}

fn symmetric_times(w: &[f64], v: &[f64]) -> Vec<f64> {
    w.chunks_exact(v.len().max(1)).map(|row| dot(row, v)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(role: Role, value: f64, gradient: [f64; 2]) -> SmoothPiece<()> {
        SmoothPiece { id: (), role, value, gradient: gradient.to_vec() }
    }

    #[test]
    fn a_step_between_two_slopes_ends_on_their_kink() {
        // max(x + 1, −x + 1 + y/2) with W = 1: the gradients' nearest point to 0
        let pieces = [piece(Role::Goal, 1.0, [1.0, 0.0]), piece(Role::Goal, 1.0, [-1.0, 0.5])];
        let s = step(&pieces, &[1.0, 0.0, 0.0, 1.0], 1.0, false).unwrap();
        let kink = dot(&pieces[0].gradient, &s.direction) - dot(&pieces[1].gradient, &s.direction);
        assert!(kink.abs() < 1e-9 && s.decrease > 0.0, "{s:?}");
        assert!((s.weights[0] - 9.0 / 17.0).abs() < 1e-7, "{s:?}");
    }

    #[test]
    fn a_bound_is_met_where_its_penalty_is_worth_it() {
        // minimise x under x ≥ 1 (1 − x ≤ 0) from 3, W = 10: to the bound, where its weight is 1 and slack is left
        let pieces = [piece(Role::Goal, 3.0, [1.0, 0.0]), piece(Role::Bound(0), -2.0, [-1.0, 0.0])];
        let w = [10.0, 0.0, 0.0, 10.0];
        let s = step(&pieces, &w, 4.0, false).unwrap();
        assert!((s.direction[0] + 2.0).abs() < 1e-7 && s.violation < 1e-7, "{s:?}");
        assert!((s.weights[1] - 0.8).abs() < 1e-6 && (s.slack - 0.8).abs() < 1e-6, "{s:?}");
        // a penalty below 1 is not enough: the step goes on
        let s = step(&pieces, &w, 0.5, false).unwrap();
        assert!(s.violation > 1.0 && s.slack < 1e-6, "{s:?}");
    }

    #[test]
    fn bounds_alone_are_brought_to_zero() {
        let pieces = [piece(Role::Bound(0), 2.0, [1.0, 0.0]), piece(Role::Bound(1), 1.0, [0.0, 1.0])];
        let s = step(&pieces, &[10.0, 0.0, 0.0, 10.0], 1.0, false).unwrap();
        assert!(s.violation < 1e-6 && s.decrease > 2.0 - 1e-6, "{s:?}");
    }
}
