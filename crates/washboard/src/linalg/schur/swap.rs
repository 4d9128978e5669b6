//! Swapping two adjacent diagonal blocks of a real Schur form by an orthogonal similarity.

use super::block::standardise_at;
use super::francis::{reflect_cols, reflect_rows, reflector};
use super::{LinalgError, Mat};
use crate::linalg::tiny;

/// What the eliminated block may keep, relative to the blocks: LAPACK's dlaexc takes 10 ε, dtgsy2 users 30 ε.
const KEPT: f64 = 30.0 * f64::EPSILON;

/// Swaps the blocks of sizes p (at `row`) and r (below it): T ← ZᵀTZ, Q ← QZ.
///
/// With T₁₁X − XT₂₂ = γT₁₂ the columns of [−X; γI] span the invariant subspace of T₂₂; its QR factor is Z.
pub(super) fn swap_adjacent(
    q: &mut Mat,
    t: &mut Mat,
    row: usize,
    p: usize,
    r: usize,
) -> Result<(), LinalgError> {
    let (n, m) = (t.nrows(), p + r);
    let size = (row..row + m)
        .flat_map(|j| (row..row + m).map(move |i| (i, j)))
        .fold(0.0f64, |s, at| s.max(t[at].abs()));
    // (I ⊗ T₁₁ − T₂₂ᵀ ⊗ I) vec X = vec T₁₂
    let mut system = tiny::System::new(p * r);
    for c in 0..r {
        for i in 0..p {
            let equation = c * p + i;
            for k in 0..p {
                system.add(equation, c * p + k, t[(row + i, row + k)]);
            }
            for k in 0..r {
                system.add(equation, k * p + i, -t[(row + p + k, row + p + c)]);
            }
            system.set_rhs(equation, t[(row + i, row + p + c)]);
        }
    }
    let solution = system.solve_perturbed(f64::EPSILON * size);
    // γ ≤ 1 keeps the columns of order one
    let gamma = 1.0 / solution.iter().fold(1.0f64, |s, x| s.max(x.abs()));
    let mut basis = Mat::zeros(m, r);
    for c in 0..r {
        for i in 0..p {
            basis[(i, c)] = -gamma * solution[c * p + i];
        }
        basis[(p + c, c)] = gamma;
    }
    // first on the blocks alone: what is refused must leave T and Q as they are
    let mut steps: Vec<(Vec<f64>, f64)> = Vec::with_capacity(r);
    let mut local = t.submatrix(row, row, m, m).to_owned();
    for c in 0..r {
        let mut v: Vec<f64> = (c..m).map(|i| basis[(i, c)]).collect();
        let (_, tau) = reflector(&mut v);
        reflect_rows(&mut basis, &v, tau, c, c);
        reflect_rows(&mut local, &v, tau, c, 0);
        reflect_cols(&mut local, &v, tau, c, m);
        steps.push((v, tau));
    }
    let mut kept: f64 = 0.0;
    for i in r..m {
        for j in 0..r {
            kept = kept.max(local[(i, j)].abs());
        }
    }
    if kept > KEPT * size {
        return Err(LinalgError::Singular {
            what: "reordering a real Schur form",
            why: "two diagonal blocks are too close to be swapped",
            value: kept / size,
        });
    }
    for (c, (v, tau)) in steps.iter().enumerate() {
        reflect_rows(t, v, *tau, row + c, row);
        reflect_cols(t, v, *tau, row + c, row + m);
        reflect_cols(q, v, *tau, row + c, n);
    }
    for i in row + r..row + m {
        for j in row..row + r {
            t[(i, j)] = 0.0;
        }
    }
    for (at, width) in [(row, r), (row + r, p)] {
        if width == 2 {
            standardise_at(q, t, at);
        }
    }
    Ok(())
}
