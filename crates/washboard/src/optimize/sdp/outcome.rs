//! What a solver found, and the evidence for it.

use crate::linalg::Mat;

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Feasible and optimal within the tolerances.
    Optimal,
    /// No x satisfies the inequalities: `multiplier` proves it.
    Infeasible,
    /// The objective falls for ever: `x` is the direction that proves it.
    Unbounded,
    /// No progress any more: the best iterate, with how far it came.
    Stalled,
}

/// How well x and Z satisfy the program as it was stated (the tolerance is asked of the scaled one). All relative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// −min eig F(x)/(1 + ‖F₀‖), at least 0.
    pub primal: f64,
    /// ‖F_i•Z − c_i‖/(1 + ‖c‖).
    pub dual: f64,
    /// |cᵀx + F₀•Z|/(1 + |cᵀx|).
    pub gap: f64,
}

impl Measures {
    /// The worst.
    pub fn worst(&self) -> f64 {
        let worst = self.primal.max(self.dual).max(self.gap);
        if self.primal.is_nan() || self.dual.is_nan() || self.gap.is_nan() { f64::INFINITY } else { worst }
    }
}

/// A proof, and how well it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// −F₀•Z of a Z with F_i•Z = 0 (no x is feasible), or −cᵀx of an x with Σ x_iF_i ⪰ 0 (unbounded): positive.
    pub value: f64,
    /// ‖F_i•Z‖, or what Σ x_iF_i lacks to be positive semidefinite, over that value.
    pub violation: f64,
}

/// The end of a search.
#[derive(Debug, Clone)]
pub struct SdpOutcome {
    /// How it ended.
    pub status: Status,
    /// x; a direction where the program is unbounded.
    pub x: Vec<f64>,
    /// cᵀx.
    pub objective: f64,
    /// −F₀•Z: no feasible x is below it.
    pub bound: f64,
    /// S = F(x) of each block.
    pub slack: Vec<Mat>,
    /// Z of each block.
    pub multiplier: Vec<Mat>,
    /// How well it holds.
    pub measures: Measures,
    /// Where the program is infeasible or unbounded.
    pub certificate: Option<Certificate>,
    /// Iterations in double precision, and in double-double.
    pub iterations: [usize; 2],
}
