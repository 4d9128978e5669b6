//! Scales under which a program's numbers are of order one, and the way back.

use super::embedding::Iterate;
use super::outcome::{Certificate, Measures, SdpOutcome, Status};
use super::problem::{Atom, Block, Sdp};
use super::scalar::{inner, norm};
use super::schur::Operators;
use super::solve::Ended;
use crate::linalg::Mat;

/// Scales under which all coefficients are of order one.
pub(super) struct Scales {
    variables: Vec<f64>,
    blocks: Vec<f64>,
    objective: f64,
    constants: f64,
}

impl Scales {
    pub fn of(sdp: &Sdp) -> Self {
        let norms: Vec<Vec<f64>> = sdp
            .blocks
            .iter()
            .map(|b| {
                // ‖l rᵀ + r lᵀ‖² = 2(|l|²|r|² + (lᵀr)²); of a sum of atoms their sum at most
                let gram = b.vectors.transpose() * &b.vectors;
                let mut squares = vec![0.0; sdp.objective.len()];
                for a in &b.atoms {
                    let both = gram[(a.left, a.left)] * gram[(a.right, a.right)];
                    let inner = gram[(a.left, a.right)];
                    squares[a.variable] += 2.0 * a.coefficient * a.coefficient * (both + inner * inner);
                }
                squares
            })
            .collect();
        let mut blocks = vec![1.0f64; norms.len()];
        let mut variables = vec![1.0f64; sdp.objective.len()];
        for _ in 0..3 {
            for (i, v) in variables.iter_mut().enumerate() {
                let sum: f64 = norms.iter().zip(&blocks).map(|(n, b)| n[i] / (b * b)).sum();
                *v = if sum > 0.0 { sum.sqrt() } else { 1.0 };
            }
            for (b, n) in blocks.iter_mut().zip(&norms) {
                let largest = n.iter().zip(&variables).map(|(n, v)| n / (v * v)).fold(0.0, f64::max);
                *b = if largest > 0.0 { largest.sqrt() } else { 1.0 };
            }
        }
        let c = sdp.objective.iter().zip(&variables).map(|(c, v)| (c / v) * (c / v)).sum::<f64>().sqrt();
        let f: f64 = sdp.blocks.iter().zip(&blocks).map(|(b, s)| (b.constant.norm_l2() / s).powi(2)).sum();
        let or_one = |v: f64| if v > 0.0 { v } else { 1.0 };
        Scales { variables, blocks, objective: or_one(c), constants: or_one(f.sqrt()) }
    }

    pub fn program(&self, sdp: &Sdp) -> Sdp {
        let objective =
            sdp.objective.iter().zip(&self.variables).map(|(c, v)| c / v / self.objective).collect();
        let blocks = sdp
            .blocks
            .iter()
            .zip(&self.blocks)
            .map(|(b, s)| {
                let n = b.size();
                let atoms = b
                    .atoms
                    .iter()
                    .map(|a| Atom { coefficient: a.coefficient / s / self.variables[a.variable], ..*a });
                Block {
                    constant: Mat::from_fn(n, n, |i, j| b.constant[(i, j)] / s / self.constants),
                    vectors: b.vectors.clone(),
                    atoms: atoms.collect(),
                }
            })
            .collect();
        Sdp { objective, blocks }
    }

    pub fn outcome(&self, sdp: &Sdp, at: &Iterate<f64>, end: Ended) -> SdpOutcome {
        let by = match end.status {
            Status::Infeasible | Status::Unbounded => 1.0,
            _ => at.tau,
        };
        let x: Vec<f64> =
            at.x.iter().zip(&self.variables).map(|(x, v)| x / by * self.constants / v).collect();
        let multiplier: Vec<Mat> = at
            .blocks
            .iter()
            .zip(&self.blocks)
            .map(|(b, s)| {
                let z = &b.multiplier;
                Mat::from_fn(z.nrows(), z.ncols(), |i, j| z[(i, j)] / by * self.objective / s)
            })
            .collect();
        let objective: f64 = sdp.objective.iter().zip(&x).map(|(c, x)| c * x).sum();
        let bound: f64 = -sdp.blocks.iter().zip(&multiplier).map(|(b, z)| inner(&b.constant, z)).sum::<f64>();
        let slack = sdp.at(&x);
        let certificate = match end.status {
            Status::Infeasible => {
                let a = Operators::<f64>::new(sdp).adjoint(multiplier.iter());
                Some(Certificate { value: bound, violation: norm(&a) / bound })
            }
            Status::Unbounded => {
                let direction: Vec<Mat> =
                    slack.iter().zip(&sdp.blocks).map(|(f, b)| f - &b.constant).collect();
                let lack = (-least(&direction)).max(0.0);
                Some(Certificate { value: -objective, violation: lack / -objective })
            }
            _ => None,
        };
        let a = Operators::<f64>::new(sdp).adjoint(multiplier.iter());
        let apart: Vec<f64> = a.iter().zip(&sdp.objective).map(|(a, c)| a - c).collect();
        let constants: f64 = sdp.blocks.iter().map(|b| b.constant.norm_l2().powi(2)).sum();
        let measures = Measures {
            primal: (-least(&slack)).max(0.0) / (1.0 + constants.sqrt()),
            dual: norm(&apart) / (1.0 + norm(&sdp.objective)),
            gap: (objective - bound).abs() / (1.0 + objective.abs()),
        };
        SdpOutcome {
            status: end.status,
            x,
            objective,
            bound,
            slack,
            multiplier,
            measures,
            certificate,
            iterations: end.iterations,
        }
    }
}

/// The smallest eigenvalue of all blocks.
fn least(blocks: &[Mat]) -> f64 {
    blocks
        .iter()
        .filter_map(|f| f.self_adjoint_eigenvalues(faer::Side::Lower).ok())
        .flatten()
        .fold(f64::INFINITY, f64::min)
}
