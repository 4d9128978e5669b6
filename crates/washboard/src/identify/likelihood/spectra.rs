//! Hermitian matrices at many frequencies as real numbers: half the memory and arithmetic of complex ones.

use crate::linalg::{C64, CMat};

/// n × n Hermitian matrices, one after another. In each block of n² numbers place i n + j holds Re S_ij for i ≤ j and
/// Im S_ji for i > j.
#[derive(Debug, Clone)]
pub(crate) struct Spectra {
    n: usize,
    values: Vec<f64>,
}

impl Spectra {
    pub fn new(n: usize, values: Vec<f64>) -> Self {
        Spectra { n, values }
    }

    /// The Hermitian parts that the upper triangles say.
    pub fn of(n: usize, matrices: impl Iterator<Item = CMat>) -> Self {
        let mut values = Vec::new();
        for m in matrices {
            values.extend((0..n * n).map(|k| {
                let (i, j) = (k / n, k % n);
                if i <= j { m[(i, j)].re } else { m[(j, i)].im }
            }));
        }
        Spectra { n, values }
    }

    /// Rows of each matrix.
    pub fn order(&self) -> usize {
        self.n
    }

    pub fn len(&self) -> usize {
        self.values.len() / (self.n * self.n)
    }

    pub fn blocks(&self) -> std::slice::ChunksExact<'_, f64> {
        self.values.chunks_exact(self.n * self.n)
    }

    pub fn block(&self, k: usize) -> &[f64] {
        &self.values[k * self.n * self.n..(k + 1) * self.n * self.n]
    }

    pub fn block_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.values[k * self.n * self.n..(k + 1) * self.n * self.n]
    }

    /// Entry by entry of three.
    pub fn combined(of: [&Spectra; 3], combine: impl Fn([f64; 3]) -> f64) -> Self {
        let [a, b, c] = of;
        let values = a.values.iter().zip(&b.values).zip(&c.values);
        Spectra { n: a.n, values: values.map(|((a, b), c)| combine([*a, *b, *c])).collect() }
    }

    /// The diagonals with `more` added.
    #[must_use]
    pub fn raised(&self, more: &[f64]) -> Self {
        let mut out = self.clone();
        for k in 0..out.len() {
            let (n, block) = (self.n, out.block_mut(k));
            more.iter().enumerate().for_each(|(i, m)| block[i * n + i] += m);
        }
        out
    }

    /// Matrices with each row and column scaled.
    pub fn matrices(&self, scale: &[f64]) -> Vec<CMat> {
        let n = self.n;
        let mut whole = vec![C64::new(0.0, 0.0); n * n];
        self.blocks()
            .map(|block| {
                unpack(block, &mut whole, n);
                CMat::from_fn(n, n, |i, j| whole[i * n + j] * (scale[i] * scale[j]))
            })
            .collect()
    }

    /// Σ_k of entry (i, i).
    pub fn diagonal_sum(&self, i: usize) -> f64 {
        self.blocks().map(|b| b[i * self.n + i]).sum()
    }
}

/// A block as a matrix, row after row.
pub(crate) fn unpack(block: &[f64], into: &mut [C64], n: usize) {
    for i in 0..n {
        into[i * n + i] = C64::new(block[i * n + i], 0.0);
        for j in i + 1..n {
            let v = C64::new(block[i * n + j], block[j * n + i]);
            into[i * n + j] = v;
            into[j * n + i] = v.conj();
        }
    }
}

/// The block of a Hermitian matrix whose entries of the upper triangle a function gives.
pub(crate) fn pack(block: &mut [f64], n: usize, of: impl Fn(usize, usize) -> C64) {
    for i in 0..n {
        block[i * n + i] = of(i, i).re;
        for j in i + 1..n {
            let v = of(i, j);
            (block[i * n + j], block[j * n + i]) = (v.re, v.im);
        }
    }
}
