//! The inequalities of H2 and H∞ norms, over the closed loop's matrices after whatever congruence makes them linear.

use super::goals::{LyapunovScale, MixedGoals};
use super::parts::Units;
use super::state_feedback::MixedClaims;
use crate::linalg::Mat;
use crate::optimize::{Expr, Lmi, LmiSolution, Variable};

/// Matrices of a closed loop, affine in the design's variables: 𝐗 and 𝐀, 𝐁, 𝐂, 𝐃 of one channel.
pub(super) struct Closed {
    pub a: Expr,
    pub b: Expr,
    pub c: Expr,
    pub d: Expr,
}

/// The scale of an H∞ inequality: a number, or a variable where the inequality stays linear in it.
#[derive(Clone, Copy)]
pub(super) enum Scale {
    Number(f64),
    Free(Variable),
}

/// γ², a number or a variable.
#[derive(Clone, Copy)]
pub(super) enum Level {
    Number(f64),
    Free(Variable),
}

/// [He 𝐀, s𝐁, 𝐂ᵀ; · −sI, s𝐃ᵀ; · · −sγ²I] ≺ 0: linear in s where 𝐁 and 𝐃 hold no variable, and in γ² where s is a number.
/// A γ that is known divides 𝐂 and 𝐃, so that numbers are of order one.
pub(super) fn hinf(lmi: &mut Lmi, of: &Closed, b: &Mat, d: &Mat, scale: Scale, level: Level) {
    let (p, q) = of.d.shape();
    let (one_w, one_z) = (Mat::identity(q, q), Mat::identity(p, p));
    let over = if let Level::Number(g) = level { g.sqrt().recip() } else { 1.0 };
    let (c, own_d, fixed_d) =
        (of.c.scaled(over), of.d.scaled(over), Mat::from_fn(p, q, |i, j| over * d[(i, j)]));
    let (sb, sd, si, sg) = match (scale, level) {
        (Scale::Number(s), Level::Number(_)) => {
            (of.b.scaled(s), own_d.scaled(s), Expr::identity(q, s), Expr::identity(p, s))
        }
        (Scale::Number(s), Level::Free(g)) => {
            (of.b.scaled(s), own_d.scaled(s), Expr::identity(q, s), g.times(&one_z).scaled(s))
        }
        (Scale::Free(s), _) => (s.times(b), s.times(&fixed_d), s.times(&one_w), s.times(&one_z)),
    };
    let e = Expr::symmetric(vec![vec![of.a.he(), sb, c.t()], vec![-si, sd.t()], vec![-sg]]);
    lmi.negative("the H∞ norm", &e);
}

/// [He 𝐀, 𝐁; · −I] ≺ 0 and [Z, 𝐂; · 𝐗] ≻ 0: tr Z is above ‖T₂‖². The first is one for all goals with the same `disturbances`,
/// and `known` where it is there already.
pub(super) fn h2<'a>(
    lmi: &mut Lmi,
    of: &Closed,
    x: &Expr,
    disturbances: &'a [usize],
    known: &mut Vec<&'a [usize]>,
) -> Variable {
    let (p, q) = of.d.shape();
    let z = lmi.symmetric(p);
    if !known.contains(&disturbances) {
        let e = Expr::symmetric(vec![vec![of.a.he(), of.b.clone()], vec![Expr::identity(q, -1.0)]]);
        lmi.negative("the H2 norm's covariance", &e);
        known.push(disturbances);
    }
    lmi.positive(
        "the H2 norm's outputs",
        Expr::symmetric(vec![vec![z.expr(), of.c.clone()], vec![x.clone()]]),
    );
    z
}

impl Level {
    /// A level of a goal: a number where it is only bounded, else a variable that is minimised and perhaps bounded; the
    /// objective with it.
    pub fn of(
        lmi: &mut Lmi,
        units: &Units,
        bound: Option<f64>,
        weight: f64,
        objective: Expr,
    ) -> (Self, Expr) {
        let bound = bound.map(|b| units.hinf(b).powi(2));
        match bound {
            Some(g) if weight == 0.0 => (Level::Number(g), objective),
            bound => {
                let g = lmi.scalar();
                if let Some(b) = bound {
                    lmi.positive("a bound on an H∞ norm", &Expr::identity(1, b) - &g.expr());
                }
                (Level::Free(g), objective + g.expr().scaled(weight * units.plain_hinf(1.0).powi(2)))
            }
        }
    }
}

/// What a solution promises in the plant's units; `squared` are the bounds on ‖T₂‖².
pub(super) fn claims(
    units: &Units,
    goals: &MixedGoals,
    levels: &[Level],
    squared: Vec<f64>,
    scales: Vec<f64>,
    s: &LmiSolution,
) -> MixedClaims {
    let level = |l: &Level| match l {
        Level::Number(g) => *g,
        Level::Free(g) => s.value(*g)[(0, 0)],
    };
    let hinf: Vec<f64> = levels.iter().map(|l| units.plain_hinf(level(l).max(0.0).sqrt())).collect();
    let objective = goals.hinf.iter().zip(&hinf).map(|(g, v)| g.weight * v * v).sum::<f64>()
        + goals.h2.iter().zip(&squared).map(|(g, z)| g.weight * z).sum::<f64>();
    MixedClaims { h2: squared.iter().map(|z| z.max(0.0).sqrt()).collect(), hinf, objective, scales }
}

impl Scale {
    pub fn of(lmi: &mut Lmi, scale: LyapunovScale, linear: bool) -> Self {
        match scale {
            LyapunovScale::Fixed(s) => Scale::Number(s),
            LyapunovScale::Searched if linear => Scale::Free(lmi.scalar()),
            LyapunovScale::Searched => Scale::Number(1.0),
        }
    }
}
