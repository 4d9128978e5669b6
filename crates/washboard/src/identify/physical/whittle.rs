//! Whittle's likelihood of spectra, its gradient and its Fisher information.

use super::data::BandData;
use super::model::{Evaluation, Layout};
use crate::linalg::{C64, CMat, Mat};
use rayon::prelude::*;

/// Cost n_avg Σ (ln|S| + tr S⁻¹Ŝ), and what scoring needs of it.
pub(super) struct Score {
    pub cost: f64,
    /// Gradient of the cost.
    pub gradient: Vec<f64>,
    /// Fisher information, expectation of the cost's Hessian.
    pub fisher: Mat,
}

/// One bin's share: cost, and the rows of residual and derivatives as real vectors of n² entries.
struct Share {
    cost: f64,
    residual: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

/// The whitened residual L⁻¹ŜL⁻ᴴ − I of every bin, as mean squared modulus of its entries.
pub(super) fn residuals(evaluation: &Evaluation, measured: &[CMat]) -> Option<Vec<f64>> {
    evaluation
        .s
        .iter()
        .zip(measured)
        .map(|(s, m)| {
            let n = s.nrows() as f64;
            share(s, &[], m).map(|x| x.residual.iter().map(|r| r * r).sum::<f64>() / (n * n))
        })
        .collect()
}

/// The cost alone; None where S is not positive definite. `added` is put on the diagonal of the measured spectra.
pub(super) fn cost(evaluation: &Evaluation, data: &BandData, added: &[f64]) -> Option<f64> {
    let shares: Option<Vec<f64>> = evaluation
        .s
        .par_iter()
        .zip(&data.measured)
        .map(|(s, m)| share(s, &[], &loaded(m, added)).map(|x| x.cost))
        .collect();
    Some(data.averages * shares?.into_iter().sum::<f64>())
}

/// Cost, gradient and Fisher information.
///
/// With v_a the entries of L⁻¹(∂S/∂θ_a)L⁻ᴴ and r those of L⁻¹ŜL⁻ᴴ − I: gradient −n_avg Σ v_a·r, information
/// n_avg Σ v_a·v_b. The sums run over bins in order: any number of threads gives the same bits.
pub(super) fn score(
    evaluation: &Evaluation,
    data: &BandData,
    layout: &Layout,
    theta: &[f64],
    added: &[f64],
) -> Option<Score> {
    let shares: Option<Vec<Share>> = (0..evaluation.s.len())
        .into_par_iter()
        .map(|k| {
            share(&evaluation.s[k], &slopes(evaluation, layout, theta, k), &loaded(&data.measured[k], added))
        })
        .collect();
    let shares = shares?;
    let p = layout.len();
    let (mut total, mut gradient, mut fisher) = (0.0, vec![0.0; p], Mat::zeros(p, p));
    for s in &shares {
        total += s.cost;
        for a in 0..p {
            gradient[a] -= dot(&s.rows[a], &s.residual);
            for b in 0..=a {
                fisher[(a, b)] += dot(&s.rows[a], &s.rows[b]);
            }
        }
    }
    for a in 0..p {
        gradient[a] *= data.averages;
        for b in 0..=a {
            let v = data.averages * fisher[(a, b)];
            fisher[(a, b)] = v;
            fisher[(b, a)] = v;
        }
    }
    Some(Score { cost: data.averages * total, gradient, fisher })
}

/// ∂S/∂θ at a bin, noise floors included.
fn slopes(evaluation: &Evaluation, layout: &Layout, theta: &[f64], bin: usize) -> Vec<CMat> {
    let n = layout.channels;
    let mut all = evaluation.ds[bin].clone();
    all.extend((0..n).map(|c| {
        let floor = theta[layout.noise + c].exp();
        CMat::from_fn(n, n, |i, j| C64::new(if i == c && j == c { floor } else { 0.0 }, 0.0))
    }));
    all
}

/// The gradient of each block's own cost (up to a constant that all share): n_avg Σ_k v_a · L⁻¹Ŝ_bL⁻ᴴ, [block][θ].
///
/// `blocks[b][k]` are the scaled spectra of a piece of the recording. Their spread over blocks is the gradient's own,
/// whatever the likelihood believes of it.
pub(super) fn block_gradients(
    evaluation: &Evaluation,
    layout: &Layout,
    theta: &[f64],
    data: &BandData,
    blocks: &[Vec<CMat>],
) -> Option<Vec<Vec<f64>>> {
    let p = layout.len();
    let shares: Option<Vec<Share>> = (0..evaluation.s.len())
        .into_par_iter()
        .map(|k| {
            let mut all = slopes(evaluation, layout, theta, k);
            all.extend(blocks.iter().map(|b| b[k].clone()));
            share(&evaluation.s[k], &all, &data.measured[k])
        })
        .collect();
    let shares = shares?;
    let gradient = |b: usize| -> Vec<f64> {
        (0..p)
            .map(|a| -data.averages * shares.iter().map(|s| dot(&s.rows[a], &s.rows[p + b])).sum::<f64>())
            .collect()
    };
    Some((0..blocks.len()).map(gradient).collect())
}

fn loaded(m: &CMat, added: &[f64]) -> CMat {
    CMat::from_fn(m.nrows(), m.ncols(), |i, j| {
        m[(i, j)] + C64::new(if i == j { added.get(i).copied().unwrap_or(0.0) } else { 0.0 }, 0.0)
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn share(s: &CMat, slopes: &[CMat], measured: &CMat) -> Option<Share> {
    let n = s.nrows();
    let factor = s.llt(faer::Side::Lower).ok()?;
    let l = factor.L();
    let width = slopes.len() + 1;
    let pick = |block: usize| if block == 0 { measured } else { &slopes[block - 1] };
    // L⁻¹ A for all A side by side, then L⁻¹ of the conjugate transposes: L⁻¹AL⁻ᴴ of Hermitian A
    let mut stack = CMat::from_fn(n, n * width, |i, j| pick(j / n)[(i, j % n)]);
    l.solve_lower_triangular_in_place(stack.as_mut());
    let mut turned = CMat::from_fn(n, n * width, |i, j| stack[(j % n, j - j % n + i)].conj());
    l.solve_lower_triangular_in_place(turned.as_mut());
    let entries = |block: usize| -> Vec<f64> {
        let mut v = Vec::with_capacity(n * n);
        for i in 0..n {
            v.push(turned[(i, block * n + i)].re);
            for j in 0..i {
                let z = turned[(i, block * n + j)] * std::f64::consts::SQRT_2;
                v.push(z.re);
                v.push(z.im);
            }
        }
        v
    };
    let whitened = entries(0);
    let mut residual = whitened;
    let (mut at, mut trace, mut log_det) = (0, 0.0, 0.0);
    for i in 0..n {
        trace += residual[at];
        residual[at] -= 1.0;
        log_det += 2.0 * l[(i, i)].re.ln();
        at += 1 + 2 * i;
    }
    let cost = log_det + trace;
    cost.is_finite().then(|| Share { cost, residual, rows: (1..width).map(entries).collect() })
}
