//! Substitution for S Y + Y R = F and S Y R − Y = F with quasi-triangular S and R: the core of Bartels–Stewart.

use super::tiny::System;
use super::{Mat, RealSchur};

/// Which equation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Equation {
    /// S Y + Y R = F
    Continuous,
    /// S Y R − Y = F
    Discrete,
}

/// The right-hand factor: T of a Schur form, or its transpose.
#[derive(Debug, Clone, Copy)]
pub(super) enum Right<'a> {
    /// R = T
    Upper(&'a RealSchur),
    /// R = Tᵀ
    Transposed(&'a RealSchur),
}

/// Y, block column by block column, and within one from the bottom row block up.
///
/// Where a small system is singular its pivot is replaced by ε‖S‖: the callers measure the separation before, and
/// the residual after.
pub(super) fn substitute(equation: Equation, left: &RealSchur, right: Right<'_>, f: &Mat) -> Mat {
    let (m, n) = (f.nrows(), f.ncols());
    let s = &left.t;
    let (r, columns) = match right {
        Right::Upper(t) => (t.t.clone(), t.blocks()),
        // the last columns of Tᵀ reach no others: start there
        Right::Transposed(t) => (t.t.transpose().to_owned(), t.blocks().into_iter().rev().collect()),
    };
    let floor = f64::EPSILON * s.norm_max().max(r.norm_max());
    let (row_blocks, mut y) = (left.blocks(), Mat::zeros(m, n));
    for (j, width) in columns {
        // Y is still zero at and beyond the columns that come later
        let mut known = &y * r.subcols(j, width);
        if equation == Equation::Discrete {
            known = s * known;
        }
        let rhs = f.subcols(j, width) - known;
        for &(i, height) in row_blocks.iter().rev() {
            let solution = corner(equation, s, &r, &y, &rhs, (i, height), (j, width), floor);
            for c in 0..width {
                for k in 0..height {
                    y[(i + k, j + c)] = solution[c * height + k];
                }
            }
        }
    }
    y
}

/// The block Y_ij, column by column, once all below and all earlier columns are known.
#[allow(clippy::too_many_arguments)] // one formula's symbols
fn corner(
    equation: Equation,
    s: &Mat,
    r: &Mat,
    y: &Mat,
    rhs: &Mat,
    (i, height): (usize, usize),
    (j, width): (usize, usize),
    floor: f64,
) -> [f64; 4] {
    let below = i + height..s.ncols();
    // S_{i,>i} Y_{>i,j}
    let mut coupled = [[0.0; 2]; 2];
    for c in 0..width {
        for k in 0..height {
            coupled[c][k] = below.clone().map(|l| s[(i + k, l)] * y[(l, j + c)]).sum();
        }
    }
    let mut system = System::new(height * width);
    for c in 0..width {
        for k in 0..height {
            let row = c * height + k;
            match equation {
                Equation::Continuous => {
                    (0..height).for_each(|l| system.add(row, c * height + l, s[(i + k, i + l)]));
                    (0..width).for_each(|d| system.add(row, d * height + k, r[(j + d, j + c)]));
                    system.set_rhs(row, rhs[(i + k, c)] - coupled[c][k]);
                }
                Equation::Discrete => {
                    for d in 0..width {
                        for l in 0..height {
                            system.add(row, d * height + l, s[(i + k, i + l)] * r[(j + d, j + c)]);
                        }
                    }
                    system.add(row, row, -1.0);
                    let through: f64 = (0..width).map(|d| coupled[d][k] * r[(j + d, j + c)]).sum();
                    system.set_rhs(row, rhs[(i + k, c)] - through);
                }
            }
        }
    }
    system.solve_perturbed(floor)
}
