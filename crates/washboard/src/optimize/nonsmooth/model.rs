//! A step from the pieces' linear models: the quadratic program of a bundle, solved by its dual.

use super::pieces::{Role, SmoothPiece, levels, merit};
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
/// `w` is n × n, row after row. None where numbers overflow or there are no pieces.
pub(super) fn step<I>(pieces: &[SmoothPiece<I>], w: &[f64], penalty: f64) -> Option<Step> {
    let n = pieces.first()?.gradient.len();
    let goals = pieces.iter().any(|p| p.role == Role::Goal);
    let bounds = pieces.iter().any(|p| p.role != Role::Goal);
    let scale = |p: &SmoothPiece<I>| if p.role == Role::Goal { 1.0 } else { penalty };
    let of_group = |p: &SmoothPiece<I>| usize::from(goals && p.role != Role::Goal);
    // the piece of 0, where there are bounds
    let m = pieces.len() + usize::from(bounds);
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
    let mut group: Vec<usize> = pieces.iter().map(of_group).collect();
    if bounds {
        values.push(0.0);
        group.push(usize::from(goals));
    }
    let lambda = minimize(&q, &values, &group, usize::from(goals) + usize::from(bounds))?;
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
    let slack = if bounds { lambda[m - 1] } else { 1.0 };
    direction.iter().all(|v| v.is_finite()).then(|| Step {
        direction,
        slope,
        weights,
        decrease,
        slack,
        violation: levels(&then).1,
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
        let s = step(&pieces, &[1.0, 0.0, 0.0, 1.0], 1.0).unwrap();
        let kink = dot(&pieces[0].gradient, &s.direction) - dot(&pieces[1].gradient, &s.direction);
        assert!(kink.abs() < 1e-9 && s.decrease > 0.0, "{s:?}");
        assert!((s.weights[0] - 9.0 / 17.0).abs() < 1e-7, "{s:?}");
    }

    #[test]
    fn a_bound_is_met_where_its_penalty_is_worth_it() {
        // minimise x under x ≥ 1 (1 − x ≤ 0) from 3, W = 10: to the bound, where its weight is 1 and slack is left
        let pieces = [piece(Role::Goal, 3.0, [1.0, 0.0]), piece(Role::Bound(0), -2.0, [-1.0, 0.0])];
        let w = [10.0, 0.0, 0.0, 10.0];
        let s = step(&pieces, &w, 4.0).unwrap();
        assert!((s.direction[0] + 2.0).abs() < 1e-7 && s.violation < 1e-7, "{s:?}");
        assert!((s.weights[1] - 0.8).abs() < 1e-6 && (s.slack - 0.8).abs() < 1e-6, "{s:?}");
        // a penalty below 1 is not enough: the step goes on
        let s = step(&pieces, &w, 0.5).unwrap();
        assert!(s.violation > 1.0 && s.slack < 1e-6, "{s:?}");
    }

    #[test]
    fn bounds_alone_are_brought_to_zero() {
        let pieces = [piece(Role::Bound(0), 2.0, [1.0, 0.0]), piece(Role::Bound(1), 1.0, [0.0, 1.0])];
        let s = step(&pieces, &[10.0, 0.0, 0.0, 10.0], 1.0).unwrap();
        assert!(s.violation < 1e-6 && s.decrease > 2.0 - 1e-6, "{s:?}");
    }
}
