//! A semidefinite program: a linear objective under linear matrix inequalities.

use super::SdpError;
use crate::linalg::Mat;

/// A part of a coefficient matrix: coefficient · (l rᵀ + r lᵀ), with l and r columns of the block's `vectors`.
///
/// Variables of matrix inequalities come as products L X R + RᵀXᵀLᵀ, whose coefficient of X_ab is l_a r_bᵀ + r_b l_aᵀ: the
/// many coefficients share few vectors, and everything that an interior-point method asks of them is in Gram matrices of
/// these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atom {
    /// Which variable it belongs to.
    pub variable: usize,
    /// Column of l.
    pub left: usize,
    /// Column of r.
    pub right: usize,
    /// Factor.
    pub coefficient: f64,
}

/// F(x) = F₀ + Σ x_i F_i ⪰ 0, symmetric n × n.
#[derive(Debug, Clone)]
pub struct Block {
    /// F₀.
    pub constant: Mat,
    /// n × d: what the atoms are made of.
    pub vectors: Mat,
    /// The parts of all F_i, in any order.
    pub atoms: Vec<Atom>,
}

/// min cᵀx subject to F(x) ⪰ 0 for each block; its dual is max −Σ F₀•Z subject to F_i•Z = c_i, Z ⪰ 0.
#[derive(Debug, Clone)]
pub struct Sdp {
    pub(super) objective: Vec<f64>,
    pub(super) blocks: Vec<Block>,
}

impl Block {
    /// From entries of symmetric matrices, as SDPA's files have them: (variable, row, column, value), each pair of rows and
    /// columns once.
    pub fn from_entries(constant: Mat, entries: &[(usize, usize, usize, f64)]) -> Self {
        let n = constant.nrows();
        let atoms = entries
            .iter()
            .map(|&(variable, left, right, value)| {
                let coefficient = if left == right { 0.5 * value } else { value };
                Atom { variable, left, right, coefficient }
            })
            .collect();
        Block { constant, vectors: Mat::identity(n, n), atoms }
    }

    /// n.
    pub fn size(&self) -> usize {
        self.constant.nrows()
    }
}

impl Sdp {
    /// Checks the sizes and that every number is one.
    ///
    /// # Errors
    /// [`SdpError`] with what does not fit.
    pub fn new(objective: Vec<f64>, mut blocks: Vec<Block>) -> Result<Self, SdpError> {
        if objective.is_empty() || blocks.is_empty() || blocks.iter().all(|b| b.size() == 0) {
            return Err(SdpError::Empty { variables: objective.len(), blocks: blocks.len() });
        }
        let finite = |what: &dyn Fn() -> String, value: f64| {
            if value.is_finite() { Ok(()) } else { Err(SdpError::NotFinite { what: what(), value }) }
        };
        for (i, c) in objective.iter().enumerate() {
            finite(&|| format!("objective[{i}]"), *c)?;
        }
        for (k, block) in blocks.iter_mut().enumerate() {
            let (n, d) = (block.size(), block.vectors.ncols());
            let shape = |what: &str, expected: String, found: String| SdpError::Shape {
                what: format!("block {k}: {what}"),
                expected,
                found,
            };
            if block.constant.ncols() != n {
                let found = format!("{n} × {}", block.constant.ncols());
                return Err(shape("the constant matrix", format!("{n} × {n}"), found));
            }
            if block.vectors.nrows() != n {
                let found = format!("{} rows", block.vectors.nrows());
                return Err(shape("the vectors", format!("{n} rows"), found));
            }
            for j in 0..n {
                for i in 0..n {
                    finite(&|| format!("block {k}: constant[{i}, {j}]"), block.constant[(i, j)])?;
                    if block.constant[(i, j)] != block.constant[(j, i)] {
                        let found = format!("{} and {}", block.constant[(i, j)], block.constant[(j, i)]);
                        return Err(shape(&format!("the constant at ({i}, {j})"), "symmetry".into(), found));
                    }
                }
                for c in 0..d {
                    finite(&|| format!("block {k}: vectors[{j}, {c}]"), block.vectors[(j, c)])?;
                }
            }
            for atom in &block.atoms {
                finite(
                    &|| format!("block {k}: a coefficient of variable {}", atom.variable),
                    atom.coefficient,
                )?;
                if atom.variable >= objective.len() {
                    let found = atom.variable.to_string();
                    return Err(shape("a variable", format!("below {}", objective.len()), found));
                }
                if atom.left.max(atom.right) >= d {
                    let found = atom.left.max(atom.right).to_string();
                    return Err(shape("a vector", format!("below {d}"), found));
                }
            }
            block.atoms.retain(|a| a.coefficient != 0.0);
            block.atoms.sort_by_key(|a| (a.variable, a.left, a.right));
        }
        Ok(Sdp { objective, blocks })
    }

    /// How many variables.
    pub fn variables(&self) -> usize {
        self.objective.len()
    }

    /// c.
    #[must_use]
    pub fn objective(&self) -> &[f64] {
        &self.objective
    }

    /// F(x) of each block.
    pub fn at(&self, x: &[f64]) -> Vec<Mat> {
        self.blocks
            .iter()
            .map(|b| {
                let mut f = b.constant.clone();
                let d = b.vectors.ncols();
                let mut core = Mat::zeros(d, d);
                for a in &b.atoms {
                    core[(a.left, a.right)] += a.coefficient * x[a.variable];
                }
                let half = &b.vectors * core * b.vectors.transpose();
                for j in 0..f.ncols() {
                    for i in 0..f.nrows() {
                        f[(i, j)] += half[(i, j)] + half[(j, i)];
                    }
                }
                f
            })
            .collect()
    }
}
