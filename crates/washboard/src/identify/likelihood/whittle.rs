//! Whittle's likelihood of spectra, its gradient and its Fisher information.

use crate::linalg::{C64, CMat, Mat};
use rayon::prelude::*;

/// Cost, and what scoring needs of it.
#[derive(Debug, Clone)]
pub(crate) struct Score {
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

/// n_avg · mean |L⁻¹ŜL⁻ᴴ − I|² of every bin: χ is its mean.
pub(crate) fn residuals(model: &[CMat], measured: &[CMat], averages: f64) -> Option<Vec<f64>> {
    model
        .iter()
        .zip(measured)
        .map(|(s, m)| {
            let n = s.nrows() as f64;
            share(s, &[], m).map(|x| averages * x.residual.iter().map(|r| r * r).sum::<f64>() / (n * n))
        })
        .collect()
}

/// n_avg Σ_k (ln|S| + tr S⁻¹Ŝ); None where S is not positive definite.
pub(crate) fn cost(model: &[CMat], measured: &[CMat], averages: f64) -> Option<f64> {
    let shares: Option<Vec<f64>> =
        model.par_iter().zip(measured).map(|(s, m)| share(s, &[], m).map(|x| x.cost)).collect();
    Some(averages * shares?.into_iter().sum::<f64>())
}

/// Cost, gradient and Fisher information over `p` parameters; `slopes(k)` are the ∂S/∂θ at bin k.
///
/// With v_a the entries of L⁻¹(∂S/∂θ_a)L⁻ᴴ and r those of L⁻¹ŜL⁻ᴴ − I: gradient −n_avg Σ v_a·r, information
/// n_avg Σ v_a·v_b. The sums run over bins in order: any number of threads gives the same bits.
pub(crate) fn score(
    model: &[CMat],
    slopes: &(dyn Fn(usize) -> Vec<CMat> + Sync),
    measured: &[CMat],
    averages: f64,
    p: usize,
) -> Option<Score> {
    let shares: Option<Vec<Share>> =
        (0..model.len()).into_par_iter().map(|k| share(&model[k], &slopes(k), &measured[k])).collect();
    let shares = shares?;
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
        gradient[a] *= averages;
        for b in 0..=a {
            let v = averages * fisher[(a, b)];
            fisher[(a, b)] = v;
            fisher[(b, a)] = v;
        }
    }
    Some(Score { cost: averages * total, gradient, fisher })
}

/// The gradient of each block's own cost (up to a constant that all share): n_avg Σ_k v_a · L⁻¹Ŝ_bL⁻ᴴ, [block][θ].
///
/// `blocks[b][k]` are the scaled spectra of a piece of the recording. Their spread over blocks is the gradient's own,
/// whatever the likelihood believes of it.
pub(crate) fn block_gradients(
    model: &[CMat],
    slopes: &(dyn Fn(usize) -> Vec<CMat> + Sync),
    blocks: &[Vec<CMat>],
    averages: f64,
    p: usize,
) -> Option<Vec<Vec<f64>>> {
    let shares: Option<Vec<Share>> = (0..model.len())
        .into_par_iter()
        .map(|k| {
            let mut all = slopes(k);
            all.extend(blocks.iter().map(|b| b[k].clone()));
            share(&model[k], &all, &model[k])
        })
        .collect();
    let shares = shares?;
    let gradient = |b: usize| -> Vec<f64> {
        (0..p)
            .map(|a| -averages * shares.iter().map(|s| dot(&s.rows[a], &s.rows[p + b])).sum::<f64>())
            .collect()
    };
    Some((0..blocks.len()).map(gradient).collect())
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
                let z: C64 = turned[(i, block * n + j)] * std::f64::consts::SQRT_2;
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
