//! A program of matrix inequalities, as a semidefinite program and back.

use super::expression::{Expr, Term, Variable};
use crate::linalg::Mat;
use crate::optimize::sdp::{Atom, Block, Sdp, SdpError, SdpOutcome, SdpSettings};
use std::collections::HashMap;

/// Symmetric to this share of the largest entry.
const SYMMETRIC: f64 = 1e-10;

/// Minimise a linear objective over matrix variables under matrix inequalities.
#[derive(Debug, Clone, Default)]
pub struct Lmi {
    kinds: Vec<Kind>,
    count: usize,
    objective: Option<Expr>,
    inequalities: Vec<(String, Expr)>,
}

/// How a variable's entries are numbered.
#[derive(Debug, Clone, Copy)]
struct Kind {
    variable: Variable,
    symmetric: bool,
    first: usize,
}

/// What the solver found, by matrix variables.
#[derive(Debug, Clone)]
pub struct LmiSolution {
    kinds: Vec<Kind>,
    /// The semidefinite program's outcome.
    pub outcome: SdpOutcome,
}

impl Kind {
    /// The number of entry (a, b), and of its mirror where it is another.
    fn entry(&self, a: usize, b: usize) -> usize {
        if !self.symmetric {
            return self.first + b * self.variable.shape().0 + a;
        }
        let (a, b) = (a.min(b), a.max(b));
        self.first + b * (b + 1) / 2 + a
    }
}

impl Lmi {
    /// No variable, no inequality.
    pub fn new() -> Self {
        Self::default()
    }

    /// A symmetric n × n variable.
    pub fn symmetric(&mut self, n: usize) -> Variable {
        self.add(n, n, true, n * (n + 1) / 2)
    }

    /// A variable of any shape.
    pub fn matrix(&mut self, rows: usize, cols: usize) -> Variable {
        self.add(rows, cols, false, rows * cols)
    }

    /// A number.
    pub fn scalar(&mut self) -> Variable {
        self.matrix(1, 1)
    }

    fn add(&mut self, rows: usize, cols: usize, symmetric: bool, count: usize) -> Variable {
        let variable = Variable::new(self.kinds.len(), rows, cols);
        self.kinds.push(Kind { variable, symmetric, first: self.count });
        self.count += count;
        variable
    }

    /// Numbers in all variables.
    pub fn variables(&self) -> usize {
        self.count
    }

    /// What is minimised: an expression of one row and column. Its constant is left out.
    pub fn minimize(&mut self, objective: Expr) {
        self.objective = Some(objective);
    }

    /// E ⪰ 0 for a symmetric E; `name` is for errors.
    pub fn positive(&mut self, name: &str, e: Expr) {
        self.inequalities.push((name.to_owned(), e));
    }

    /// E ⪯ 0.
    pub fn negative(&mut self, name: &str, e: &Expr) {
        self.positive(name, -e);
    }

    /// The semidefinite program.
    ///
    /// # Errors
    /// Sizes that do not fit, an inequality that is not symmetric, numbers that are none.
    pub fn program(&self) -> Result<Sdp, SdpError> {
        let shape = |what: &str, expected: &str, found: String| SdpError::Shape {
            what: what.to_owned(),
            expected: expected.to_owned(),
            found,
        };
        let mut objective = vec![0.0; self.count];
        if let Some(e) = &self.objective {
            if let Some(slip) = &e.slip {
                return Err(shape("the objective", "sizes that fit", slip.clone()));
            }
            if e.shape() != (1, 1) {
                return Err(shape("the objective", "1 × 1", format!("{:?}", e.shape())));
            }
            for t in &e.terms {
                let kind = &self.kinds[t.variable];
                for a in 0..t.left.ncols() {
                    for b in 0..t.right.nrows() {
                        let (i, j) = if t.transposed { (b, a) } else { (a, b) };
                        objective[kind.entry(i, j)] += t.left[(0, a)] * t.right[(b, 0)];
                    }
                }
            }
        }
        let mut blocks = Vec::new();
        for (name, e) in &self.inequalities {
            if let Some(slip) = &e.slip {
                return Err(shape(name, "sizes that fit", slip.clone()));
            }
            let (n, m) = e.shape();
            if n != m {
                return Err(shape(name, "a square matrix", format!("{n} × {m}")));
            }
            if n > 0 {
                blocks.push(self.block(name, e)?);
            }
        }
        Sdp::new(objective, blocks)
    }

    /// Solves it.
    ///
    /// # Errors
    /// As [`Lmi::program`]. What has no solution is an outcome.
    pub fn solve(&self, settings: &SdpSettings) -> Result<LmiSolution, SdpError> {
        Ok(LmiSolution { kinds: self.kinds.clone(), outcome: self.program()?.solve(settings) })
    }

    /// F = ½(E + Eᵀ), which is E.
    fn block(&self, name: &str, e: &Expr) -> Result<Block, SdpError> {
        self.check_symmetry(name, e)?;
        let n = e.constant.nrows();
        let constant = Mat::from_fn(n, n, |i, j| 0.5 * (e.constant[(i, j)] + e.constant[(j, i)]));
        let mut table = Table { columns: Vec::new(), places: HashMap::new() };
        let mut atoms: HashMap<(usize, usize, usize), f64> = HashMap::new();
        for t in merged(&e.terms) {
            let kind = &self.kinds[t.variable];
            let lefts: Vec<Option<usize>> =
                (0..t.left.ncols()).map(|a| table.place(t.left.col(a).iter())).collect();
            let rights: Vec<Option<usize>> =
                (0..t.right.nrows()).map(|b| table.place(t.right.row(b).iter())).collect();
            for (a, left) in lefts.iter().enumerate() {
                for (b, right) in rights.iter().enumerate() {
                    let (Some(left), Some(right)) = (*left, *right) else { continue };
                    let entry = kind.entry(a, b);
                    *atoms.entry((entry, left.min(right), left.max(right))).or_default() += 0.5;
                }
            }
        }
        let vectors = Mat::from_fn(n, table.columns.len(), |i, j| table.columns[j][i]);
        let atoms = atoms.into_iter();
        let atoms =
            atoms.map(|((variable, left, right), coefficient)| Atom { variable, left, right, coefficient });
        Ok(Block { constant, vectors, atoms: atoms.collect() })
    }

    /// E at numbers of no pattern is its transpose.
    fn check_symmetry(&self, name: &str, e: &Expr) -> Result<(), SdpError> {
        let x: Vec<f64> = (1..=self.count).map(|i| (i as f64 * 0.754_877_666).fract() - 0.5).collect();
        let mut at = e.constant.clone();
        let mut size = at.norm_max();
        for t in &e.terms {
            let v = value(&self.kinds[t.variable], &x);
            let v = if t.transposed { v.transpose().to_owned() } else { v };
            let part = &t.left * v * &t.right;
            size = size.max(part.norm_max());
            at += part;
        }
        let off = (&at - at.transpose()).norm_max() / size.max(f64::MIN_POSITIVE);
        if off <= SYMMETRIC || !off.is_finite() {
            return Ok(());
        }
        Err(SdpError::Shape {
            what: name.to_owned(),
            expected: "a symmetric matrix".into(),
            found: format!("entries that differ from their mirrors by {off:.1e} of the largest"),
        })
    }
}

impl LmiSolution {
    /// The value of a variable.
    pub fn value(&self, variable: Variable) -> Mat {
        value(&self.kinds[variable.id], &self.outcome.x)
    }
}

fn value(kind: &Kind, x: &[f64]) -> Mat {
    let (n, m) = kind.variable.shape();
    Mat::from_fn(n, m, |a, b| x[kind.entry(a, b)])
}

/// Terms without transposes, those of one variable that share a factor made one.
fn merged(terms: &[Term]) -> Vec<Term> {
    let mut out: Vec<Term> = Vec::new();
    for t in terms {
        // of ½(E + Eᵀ) a term and its transpose say the same
        let turned = |t: &Term| Term {
            variable: t.variable,
            transposed: !t.transposed,
            left: t.right.transpose().to_owned(),
            right: t.left.transpose().to_owned(),
        };
        let t = if t.transposed { turned(t) } else { t.clone() };
        match out.iter_mut().find(|o| o.variable == t.variable && (o.left == t.left || o.right == t.right)) {
            Some(o) if o.left == t.left => o.right = &o.right + &t.right,
            Some(o) => o.left = &o.left + &t.left,
            None => out.push(t),
        }
    }
    out
}

/// Distinct vectors.
struct Table {
    columns: Vec<Vec<f64>>,
    places: HashMap<Vec<u64>, usize>,
}

impl Table {
    /// Its place; None of a zero.
    fn place<'v>(&mut self, vector: impl Iterator<Item = &'v f64>) -> Option<usize> {
        // −0 is 0
        let vector: Vec<f64> = vector.map(|v| v + 0.0).collect();
        if vector.iter().all(|v| *v == 0.0) {
            return None;
        }
        let key = vector.iter().map(|v| v.to_bits()).collect();
        let columns = &mut self.columns;
        Some(*self.places.entry(key).or_insert_with(|| {
            columns.push(vector);
            columns.len() - 1
        }))
    }
}
