//! What the coefficient matrices do: F(x), its adjoint, and the Schur complement, all by Gram matrices of the vectors.

use super::problem::{Atom, Block, Sdp};
use super::scalar::{MatOf, Real, cast};
use rayon::prelude::*;

/// Pairs of variables and atoms below which one core is faster.
const SMALL: usize = 20_000;

/// The coefficients of a block, in some precision.
pub(super) struct Operator<T> {
    pub constant: MatOf<T>,
    vectors: MatOf<T>,
    /// Vectors are the unit vectors: products with them are skipped.
    plain: bool,
    /// Variables that it holds, with their atoms.
    active: Vec<(usize, Vec<Atom>)>,
}

impl<T: Real> Operator<T> {
    pub fn new(block: &Block) -> Self {
        let mut active: Vec<(usize, Vec<Atom>)> = Vec::new();
        for atom in &block.atoms {
            match active.last_mut() {
                Some((variable, atoms)) if *variable == atom.variable => atoms.push(*atom),
                _ => active.push((atom.variable, vec![*atom])),
            }
        }
        let (n, d) = (block.size(), block.vectors.ncols());
        let plain =
            n == d && (0..d).all(|j| (0..n).all(|i| block.vectors[(i, j)] == if i == j { 1.0 } else { 0.0 }));
        Operator { constant: cast(&block.constant), vectors: cast(&block.vectors), plain, active }
    }

    /// Σ x_i F_i.
    pub fn apply(&self, x: &[T]) -> MatOf<T> {
        let d = self.vectors.ncols();
        let mut core = MatOf::zeros(d, d);
        for (variable, atoms) in &self.active {
            for a in atoms {
                core[(a.left, a.right)] += T::of(a.coefficient) * x[*variable];
            }
        }
        let half = if self.plain { core } else { self.spread(&core) };
        MatOf::from_fn(half.nrows(), half.ncols(), |i, j| half[(i, j)] + half[(j, i)])
    }

    /// Adds F_i•Z to each sum.
    pub fn adjoint(&self, z: &MatOf<T>, sums: &mut [T]) {
        let gram = self.gram(z);
        for (variable, atoms) in &self.active {
            for a in atoms {
                sums[*variable] += T::of(2.0 * a.coefficient) * gram[(a.left, a.right)];
            }
        }
    }

    /// Adds F_i•MF_jM to the lower triangle of the Schur complement, of which these are the columns.
    ///
    /// With G = VᵀMV, the part of two atoms is 2cc'(G\[l, l'\]G\[r, r'\] + G\[l, r'\]G\[r, l'\]). Where a variable has many
    /// atoms, VᵀMF_jMV is made once instead.
    pub fn schur(&self, m: &MatOf<T>, columns: &mut [&mut [T]]) {
        let gram = self.gram(m);
        let d = gram.nrows();
        let total: usize = self.active.iter().map(|(_, atoms)| atoms.len()).sum();
        let mut place = vec![usize::MAX; columns.len()];
        self.active.iter().enumerate().for_each(|(k, (variable, _))| place[*variable] = k);
        let flat: &[T] =
            &(0..d).flat_map(|j| (0..d).map(move |i| (i, j))).map(|p| gram[p]).collect::<Vec<_>>();
        let fill = |(variable, column): (usize, &mut &mut [T])| {
            let Some((_, mine)) = self.active.get(place[variable]) else { return };
            let others = &self.active[place[variable]..];
            // by pairs of atoms: 4 per pair; by the product: 4d² an atom here and 2 an atom there
            let by_pairs = 4 * mine.len() * total;
            let by_product = 4 * mine.len() * d * d + 2 * total;
            if by_pairs <= by_product {
                for (other, theirs) in others {
                    let mut sum = T::of(0.0);
                    for a in mine {
                        let (l, r) =
                            (&flat[a.left * d..(a.left + 1) * d], &flat[a.right * d..(a.right + 1) * d]);
                        let mut part = T::of(0.0);
                        for b in theirs {
                            let product = l[b.left] * r[b.right] + l[b.right] * r[b.left];
                            part += T::of(b.coefficient) * product;
                        }
                        sum += T::of(2.0 * a.coefficient) * part;
                    }
                    column[*other] += sum;
                }
                return;
            }
            let mut product = vec![T::of(0.0); d * d];
            for a in mine {
                let (l, r) = (&flat[a.left * d..(a.left + 1) * d], &flat[a.right * d..(a.right + 1) * d]);
                for j in 0..d {
                    let (rj, lj) = (T::of(a.coefficient) * r[j], T::of(a.coefficient) * l[j]);
                    let of_j = &mut product[j * d..(j + 1) * d];
                    for i in 0..d {
                        of_j[i] += l[i] * rj + r[i] * lj;
                    }
                }
            }
            for (other, theirs) in others {
                let mut sum = T::of(0.0);
                for b in theirs {
                    sum += T::of(2.0 * b.coefficient) * product[b.left * d + b.right];
                }
                column[*other] += sum;
            }
        };
        if columns.len() * total < SMALL {
            columns.iter_mut().enumerate().for_each(fill);
        } else {
            columns.par_iter_mut().enumerate().for_each(fill);
        }
    }

    fn gram(&self, z: &MatOf<T>) -> MatOf<T> {
        if self.plain {
            return z.clone();
        }
        T::product(self.vectors.transpose(), T::product(z.as_ref(), self.vectors.as_ref()).as_ref())
    }

    fn spread(&self, core: &MatOf<T>) -> MatOf<T> {
        T::product(T::product(self.vectors.as_ref(), core.as_ref()).as_ref(), self.vectors.transpose())
    }
}

/// All blocks.
pub(super) struct Operators<T> {
    pub objective: Vec<T>,
    pub blocks: Vec<Operator<T>>,
}

impl<T: Real> Operators<T> {
    pub fn new(sdp: &Sdp) -> Self {
        Operators {
            objective: sdp.objective.iter().map(|c| T::of(*c)).collect(),
            blocks: sdp.blocks.iter().map(Operator::new).collect(),
        }
    }

    /// F_i•Z.
    pub fn adjoint<'z>(&self, z: impl Iterator<Item = &'z MatOf<T>>) -> Vec<T>
    where
        T: 'z,
    {
        let mut sums = vec![T::of(0.0); self.objective.len()];
        self.blocks.iter().zip(z).for_each(|(b, z)| b.adjoint(z, &mut sums));
        sums
    }

    /// F_i•MF_jM: its lower triangle.
    pub fn schur(&self, m: &[MatOf<T>]) -> MatOf<T> {
        let count = self.objective.len();
        let mut schur = MatOf::zeros(count, count);
        let mut columns: Vec<&mut [T]> =
            schur.col_iter_mut().filter_map(|c| Some(c.try_as_col_major_mut()?.as_slice_mut())).collect();
        self.blocks.iter().zip(m).for_each(|(b, m)| b.schur(m, &mut columns));
        schur
    }
}
