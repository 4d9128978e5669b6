//! Targets at one frequency: A + B V, over its unit or limit.

use crate::linalg::{C64, CMat, Mat};
use crate::synthesis::{Aim, Channel, Measure, Target};

/// σ̄(A + B V(:, columns)), at most `level` for a goal and at most 1 for a bound.
#[derive(Debug, Clone)]
pub(super) struct Term {
    /// p × columns.
    pub a: CMat,
    /// p × nu.
    pub b: CMat,
    /// Columns of V.
    pub columns: Vec<usize>,
    pub goal: bool,
}

/// The share by which a bound may be exceeded and is still met.
const MET: f64 = 1e-6;

/// What one plant's target asks of an H∞ norm.
#[derive(Debug, Clone)]
pub(super) struct Asked {
    rows: Vec<(usize, f64)>,
    columns: Vec<usize>,
    goal: bool,
}

impl Asked {
    /// `None` where it is not about an H∞ norm.
    pub fn new(target: &Target, nw: usize) -> Option<Self> {
        let Measure::Hinf(Channel { outputs, disturbances }) = &target.measure else { return None };
        let (unit, goal) = match target.aim {
            Aim::Goal(unit) => (unit, true),
            // a design may exceed it by as much and keep it
            Aim::Bound(limit) => (limit * (1.0 + MET), false),
        };
        let rows = outputs.iter().filter(|(_, w)| *w > 0.0).map(|(row, w)| (*row, w / unit)).collect();
        let columns = if disturbances.is_empty() { (0..nw).collect() } else { disturbances.clone() };
        Some(Asked { rows, columns, goal })
    }

    pub fn is_goal(&self) -> bool {
        self.goal
    }

    /// Its disturbances without those that reach none of its outputs, which V leaves alone.
    fn live(&self, g: &CMat) -> Vec<usize> {
        let reaches = |c: &usize| self.rows.iter().any(|(row, _)| g[(*row, *c)] != C64::new(0.0, 0.0));
        self.columns.iter().copied().filter(reaches).collect()
    }

    /// The target where the plant has the response `g`, from [w; u], with `nw` disturbances.
    fn term(&self, g: &CMat, nw: usize, used: &[usize]) -> Term {
        let (p, nu) = (self.rows.len(), g.ncols() - nw);
        let own: Vec<usize> = self.columns.iter().copied().filter(|c| used.contains(c)).collect();
        let a = CMat::from_fn(p, own.len(), |i, j| g[(self.rows[i].0, own[j])] * self.rows[i].1);
        let b = CMat::from_fn(p, nu, |i, k| g[(self.rows[i].0, nw + k)] * self.rows[i].1);
        let columns = own.iter().filter_map(|c| used.iter().position(|u| u == c)).collect();
        Term { a, b, columns, goal: self.goal }
    }

    /// ‖B‖: how much of it the control reaches.
    pub fn influence(&self, g: &CMat, nw: usize) -> f64 {
        let of =
            |(row, w): &(usize, f64)| (nw..g.ncols()).map(|k| (g[(*row, k)] * *w).norm_sqr()).sum::<f64>();
        self.rows.iter().map(of).sum::<f64>().sqrt()
    }
}

/// All targets at a frequency, those without control at a zero of G_zu, with the columns of V that any of them has, counted from 0.
pub(super) fn terms(asked: &[Asked], g: &CMat, nw: usize, unreached: &[bool]) -> (Vec<Term>, usize) {
    let mut used: Vec<usize> = asked.iter().flat_map(|t| t.live(g)).collect();
    used.sort_unstable();
    used.dedup();
    let of = |(asked, unreached): (&Asked, &bool)| {
        let mut term = asked.term(g, nw, &used);
        if *unreached {
            term.b = CMat::zeros(term.b.nrows(), term.b.ncols());
        }
        term
    };
    let all = asked.iter().zip(unreached).map(of).filter(|t| t.a.ncols() > 0);
    (all.collect(), used.len())
}

impl Term {
    /// A bound as a goal, its limit the unit.
    pub fn as_goal(&self) -> Self {
        Term { goal: true, ..self.clone() }
    }
}

/// Singular values, descending; `None` for numbers that are none.
pub(super) fn singular(m: &CMat) -> Option<Vec<f64>> {
    let rows = Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)].norm());
    if !rows.norm_max().is_finite() {
        return None;
    }
    m.singular_values().ok()
}
