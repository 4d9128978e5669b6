//! S Y + Y Rᵀ = F with quasi-triangular S and R, recursively: almost all of the work is matrix products.

use super::tiny::System;
use faer::linalg::matmul::matmul;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

/// Below this order a block is solved by substitution.
const LEAF: usize = 16;

/// A block of at most [`LEAF`] × [`LEAF`], column after column.
type Leaf = [[f64; LEAF]; LEAF];

/// Y with S Y + Y Rᵀ = F, in place of F. S and R are real Schur forms (2 × 2 blocks on the diagonal).
///
/// A pivot smaller than `floor` is replaced by it: the callers measure the residual.
///
/// Source: Jonsson and Kågström, *Recursive blocked algorithms for solving triangular systems, part I*, ACM TOMS 28
/// (2002).
pub(super) fn sylvester(s: MatRef<'_, f64>, r: MatRef<'_, f64>, mut f: MatMut<'_, f64>, floor: f64) {
    let (m, n) = (s.nrows(), r.nrows());
    if m <= LEAF && n <= LEAF {
        leaf(s, r, f, floor);
    } else if m >= n {
        let k = split(s);
        let (s11, s12, _, s22) = s.split_at(k, k);
        let (mut f1, mut f2) = f.split_at_row_mut(k);
        sylvester(s22, r, f2.rb_mut(), floor);
        matmul(f1.rb_mut(), Accum::Add, s12, f2.rb(), -1.0, Par::Seq);
        sylvester(s11, r, f1, floor);
    } else {
        let k = split(r);
        let (r11, r12, _, r22) = r.split_at(k, k);
        let (mut f1, mut f2) = f.rb_mut().split_at_col_mut(k);
        sylvester(s, r22, f2.rb_mut(), floor);
        matmul(f1.rb_mut(), Accum::Add, f2.rb(), r12.transpose(), -1.0, Par::Seq);
        sylvester(s, r11, f1, floor);
    }
}

/// Y with T Y + Y Tᵀ = F for a symmetric F, in place of F.
pub(super) fn lyapunov(t: MatRef<'_, f64>, f: MatMut<'_, f64>, floor: f64) {
    if t.nrows() <= LEAF {
        leaf(t, t, f, floor);
        return;
    }
    let k = split(t);
    let (t11, t12, _, t22) = t.split_at(k, k);
    let (mut f11, mut f12, mut f21, mut f22) = f.split_at_mut(k, k);
    lyapunov(t22, f22.rb_mut(), floor);
    matmul(f12.rb_mut(), Accum::Add, t12, f22.rb(), -1.0, Par::Seq);
    sylvester(t11, t22, f12.rb_mut(), floor);
    f21.copy_from(f12.rb().transpose());
    matmul(f11.rb_mut(), Accum::Add, t12, f21.rb(), -1.0, Par::Seq);
    matmul(f11.rb_mut(), Accum::Add, f12.rb(), t12.transpose(), -1.0, Par::Seq);
    lyapunov(t11, f11, floor);
}

/// The middle, but never within a 2 × 2 block; a multiple of four where it can be.
fn split(t: MatRef<'_, f64>) -> usize {
    let middle = t.nrows().div_ceil(8) * 4;
    if t[(middle, middle - 1)] == 0.0 { middle } else { middle + 1 }
}

/// Substitution, from the last column block and row block on.
fn leaf(s: MatRef<'_, f64>, r: MatRef<'_, f64>, mut f: MatMut<'_, f64>, floor: f64) {
    let (m, n) = (s.nrows(), r.nrows());
    let (sl, rl, mut y) = (load(s), load(r), load(f.rb()));
    let floor = floor.max(f64::MIN_POSITIVE);
    let mut j = n;
    while j > 0 {
        let width = if j >= 2 && rl[j - 2][j - 1] != 0.0 { 2 } else { 1 };
        j -= width;
        for c in j..j + width {
            // columns that are known: F_j − Σ Y_l R_jl
            let (head, tail) = y.split_at_mut(j + width);
            for (l, known) in (j + width..n).zip(tail.iter()) {
                subtract(&mut head[c], rl[l][c], known);
            }
        }
        let mut i = m;
        while i > 0 {
            let height = if i >= 2 && sl[i - 2][i - 1] != 0.0 { 2 } else { 1 };
            i -= height;
            if height == 1 && width == 1 {
                let pivot = sl[i][i] + rl[j][j];
                y[j][i] /= if pivot.abs() < floor { floor } else { pivot };
            } else {
                corner(&sl, &rl, &mut y, (i, height), (j, width), floor);
            }
            for c in j..j + width {
                let column = &mut y[c];
                for k in i..i + height {
                    let factor = column[k];
                    subtract(&mut column[..i], factor, &sl[k]);
                }
            }
        }
    }
    for (j, column) in y.iter().enumerate().take(n) {
        for (i, v) in column.iter().enumerate().take(m) {
            f[(i, j)] = *v;
        }
    }
}

fn load(a: MatRef<'_, f64>) -> Leaf {
    let mut leaf = [[0.0; LEAF]; LEAF];
    for (j, column) in leaf.iter_mut().enumerate().take(a.ncols()) {
        for (i, v) in column.iter_mut().enumerate().take(a.nrows()) {
            *v = a[(i, j)];
        }
    }
    leaf
}

fn subtract(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y -= factor * x;
    }
}

/// One block of Y of which one side is 2: at most four unknowns.
fn corner(
    s: &Leaf,
    r: &Leaf,
    y: &mut Leaf,
    (i, height): (usize, usize),
    (j, width): (usize, usize),
    floor: f64,
) {
    if height * width == 2 {
        // [a b; c d], of a pair against one
        let (m, at) = if height == 2 {
            ([s[i][i] + r[j][j], s[i + 1][i], s[i][i + 1], s[i + 1][i + 1] + r[j][j]], [(j, i), (j, i + 1)])
        } else {
            ([s[i][i] + r[j][j], r[j + 1][j], r[j][j + 1], s[i][i] + r[j + 1][j + 1]], [(j, i), (j + 1, i)])
        };
        let x = two(m, [y[at[0].0][at[0].1], y[at[1].0][at[1].1]], floor);
        (y[at[0].0][at[0].1], y[at[1].0][at[1].1]) = (x[0], x[1]);
        return;
    }
    let mut system = System::new(height * width);
    for c in 0..width {
        for k in 0..height {
            let row = c * height + k;
            (0..height).for_each(|l| system.add(row, c * height + l, s[i + l][i + k]));
            (0..width).for_each(|d| system.add(row, d * height + k, r[j + d][j + c]));
            system.set_rhs(row, y[j + c][i + k]);
        }
    }
    let solution = system.solve_perturbed(floor);
    for c in 0..width {
        for k in 0..height {
            y[j + c][i + k] = solution[c * height + k];
        }
    }
}

/// x of [a b; c d] x = f, with partial pivoting.
fn two([a, b, c, d]: [f64; 4], [f, g]: [f64; 2], floor: f64) -> [f64; 2] {
    let ([a, b, c, d], [f, g]) =
        if a.abs() >= c.abs() { ([a, b, c, d], [f, g]) } else { ([c, d, a, b], [g, f]) };
    let guard = |p: f64| if p.abs() < floor { floor } else { p };
    let a = guard(a);
    let factor = c / a;
    let second = (g - factor * f) / guard(d - factor * b);
    [(f - b * second) / a, second]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::test_matrices::{random, stable};
    use crate::linalg::{Mat, RealSchur};

    /// Backward error per order.
    const BACKWARD: f64 = 1e-14;

    #[test]
    fn leaves_and_recursion_leave_no_residual() {
        for (m, n) in [(1, 1), (2, 5), (16, 16), (17, 3), (3, 40), (33, 34), (70, 50)] {
            let (s, r) = (RealSchur::new(&stable(m, 1)).unwrap().t, RealSchur::new(&stable(n, 2)).unwrap().t);
            let f = random(m, n, 3);
            let mut y = f.clone();
            sylvester(s.as_ref(), r.as_ref(), y.as_mut(), 0.0);
            let rest = (&s * &y + &y * r.transpose() - &f).norm_l2();
            let bound = BACKWARD * (m + n) as f64 * ((s.norm_l2() + r.norm_l2()) * y.norm_l2() + f.norm_l2());
            assert!(rest <= bound, "{m} × {n}: {rest:e}");
        }
    }

    #[test]
    fn a_symmetric_side_has_a_symmetric_solution() {
        for n in [1, 2, 9, 16, 17, 45, 100] {
            let t = RealSchur::new(&stable(n, 7)).unwrap().t;
            let f = random(n, n, 3);
            let f = &f + f.transpose();
            let mut y = f.clone();
            lyapunov(t.as_ref(), y.as_mut(), 0.0);
            let rest = (&t * &y + &y * t.transpose() - &f).norm_l2();
            assert!(
                rest <= BACKWARD * n as f64 * (2.0 * t.norm_l2() * y.norm_l2() + f.norm_l2()),
                "{n}: {rest:e}"
            );
            let mut z: Mat = f.clone();
            sylvester(t.as_ref(), t.as_ref(), z.as_mut(), 0.0);
            assert!((z - &y).norm_l2() <= 1e-12 * y.norm_l2());
        }
    }
}
