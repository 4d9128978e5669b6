//! A loop's eigenvalues and what they gain from each entry of the controller.

use super::closed::Open;
use crate::linalg::{C64, CMat, Mat, RealSchur, eigen, small, solve_complex};

/// A shift off the eigenvalue, as a share of the matrix; where the factorisation is singular all the same, farther ones.
const OFF: [f64; 4] = [1e-14, 7e-14, 1e-12, 1e-10];
/// Steps of inverse iteration: the second leaves rounding.
const STEPS: usize = 3;
/// |wᴴv| of unit vectors below this: the eigenvalue has no derivative that a search could use.
const DEFECTIVE: f64 = 1e-14;

/// Eigenvalues nearer to each other than this share of the largest: their vectors are those of one basis.
const ALIKE: f64 = 1e-6;

/// The eigenvalues of a loop, and vectors of those that are asked about.
pub(super) struct Spectrum {
    pub values: Vec<C64>,
    vectors: Vectors,
}

enum Vectors {
    /// All of them, as columns, and the inverse's rows.
    Basis { right: CMat, left: CMat },
    /// From the matrix, row after row, and its largest entry.
    ByIteration { a: Vec<f64>, size: f64 },
}

impl Spectrum {
    /// None where the QR steps do not end, or as [`Spectrum::of`].
    pub fn new(a: &Mat) -> Option<Self> {
        Self::of(a, RealSchur::only_eigenvalues(a).ok()?)
    }

    /// Of eigenvalues that are known already. None where eigenvectors are asked for that are no basis.
    pub fn of(a: &Mat, values: Vec<C64>) -> Option<Self> {
        let n = a.nrows();
        let most = values.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let alike = |i: usize| (0..i).any(|j| (values[i] - values[j]).norm() <= ALIKE * most);
        if (0..n).any(alike) {
            // of an eigenvalue that is several times there inverse iteration knows one vector
            let (values, right) = eigen(a).ok()?;
            let one = CMat::from_fn(n, n, |i, j| C64::new(f64::from(u8::from(i == j)), 0.0));
            let left = solve_complex(&right, &one).ok()?;
            return Some(Spectrum { values, vectors: Vectors::Basis { right, left } });
        }
        let rows: Vec<f64> = (0..n * n).map(|k| a[(k / n, k % n)]).collect();
        let size = rows.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        Some(Spectrum { values, vectors: Vectors::ByIteration { a: rows, size } })
    }

    /// The eigenvalue with the largest real part.
    pub fn rightmost(&self) -> Option<usize> {
        (0..self.values.len()).max_by(|a, b| self.values[*a].re.total_cmp(&self.values[*b].re))
    }

    /// The eigenvalue nearest to a value.
    pub fn nearest(&self, value: C64) -> Option<usize> {
        let distance = |k: &usize| (self.values[*k] - value).norm();
        (0..self.values.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// w with wᵀA = λwᵀ and v with A v = λv, wᵀv = 1. None where wᵀv vanishes: at an eigenvalue with fewer vectors than
    /// its multiplicity.
    fn vectors(&self, k: usize) -> Option<(Vec<C64>, Vec<C64>)> {
        let n = self.values.len();
        let (a, size) = match &self.vectors {
            Vectors::Basis { right, left } => {
                return Some((
                    (0..n).map(|i| left[(k, i)]).collect(),
                    (0..n).map(|i| right[(i, k)]).collect(),
                ));
            }
            Vectors::ByIteration { a, size } => (a, *size),
        };
        let mut factors = vec![small::ZERO; n * n];
        let mut pivots = vec![0; n];
        let regular = OFF.iter().any(|off| {
            let shift = self.values[k] + off * size.max(f64::MIN_POSITIVE);
            factors.iter_mut().zip(a).for_each(|(f, a)| *f = C64::new(-a, 0.0));
            (0..n).for_each(|i| factors[i * n + i] += shift);
            small::lu(&mut factors, &mut pivots)
        });
        if !regular {
            return None;
        }
        // entries of no pattern: hardly orthogonal to any vector
        let mut right: Vec<C64> =
            (0..n).map(|i| C64::new(1.0, (1.0 + i as f64 * 0.618_033_988_749_895).fract() - 0.5)).collect();
        let mut left = right.clone();
        for _ in 0..STEPS {
            small::lu_solve(&factors, &pivots, &mut right, 1);
            small::lu_solve_transposed(&factors, &pivots, &mut left, 1);
            for x in [&mut right, &mut left] {
                // by the largest entry first: squares of what is nearly singular overflow
                let most = x.iter().fold(0.0f64, |s, v| s.max(v.re.abs()).max(v.im.abs()));
                x.iter_mut().for_each(|v| *v /= most);
                let length = x.iter().map(|v| v.norm_sqr()).sum::<f64>().sqrt();
                x.iter_mut().for_each(|v| *v /= length);
            }
        }
        let inner: C64 = left.iter().zip(&right).map(|(l, r)| l * r).sum();
        if !(inner.norm() > DEFECTIVE) {
            return None;
        }
        left.iter_mut().for_each(|v| *v /= inner);
        Some((left, right))
    }

    /// Re(along · dλ) by each entry of the block: dλ = wᵀ B dK C v.
    pub fn derivative(&self, k: usize, open: &Open, order: usize, along: C64) -> Option<Mat> {
        let n = self.values.len();
        let np = n - order;
        let (nu, ny) = (open.b2.ncols(), open.c2.nrows());
        let (w, v) = self.vectors(k)?;
        let left: Vec<C64> = w[np..]
            .iter()
            .copied()
            .chain((0..nu).map(|j| (0..np).map(|i| w[i] * open.b2[(i, j)]).sum()))
            .collect();
        let right: Vec<C64> = v[np..]
            .iter()
            .copied()
            .chain((0..ny).map(|i| (0..np).map(|j| v[j] * open.c2[(i, j)]).sum()))
            .collect();
        let g = Mat::from_fn(order + nu, order + ny, |i, j| (along * left[i] * right[j]).re);
        g.norm_max().is_finite().then_some(g)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both routes to the vectors, and the vectors' own equations.
    #[test]
    fn vectors_are_those_of_the_matrix_whether_eigenvalues_are_alone_or_twice_there() {
        let any = |i: usize, j: usize| ((5 * i * i + 7 * j + i * j) as f64 + 0.3).sin();
        let alone = Mat::from_fn(6, 6, |i, j| 10f64.powi(i as i32 - 2) * any(i, j));
        let close = Mat::from_fn(2, 2, |i, j| {
            [[-4.159680215339406, -1.3272620443416434], [1.0050603291838158, -1.8497014384824644]][i][j]
        });
        let twice =
            Mat::from_fn(
                5,
                5,
                |i, j| if i == j { -2.0 - f64::from(u8::from(i > 1)) * i as f64 } else { 0.0 },
            );
        for (a, several) in [(alone, false), (close, false), (twice, true)] {
            let n = a.nrows();
            let s = Spectrum::new(&a).unwrap();
            assert_eq!(matches!(s.vectors, Vectors::Basis { .. }), several);
            let mut seen: Vec<Vec<C64>> = Vec::new();
            for k in 0..n {
                let (w, v) = s.vectors(k).unwrap();
                let size = a.norm_max();
                for i in 0..n {
                    let right: C64 = (0..n).map(|j| v[j] * a[(i, j)]).sum::<C64>() - s.values[k] * v[i];
                    let left: C64 = (0..n).map(|j| w[j] * a[(j, i)]).sum::<C64>() - s.values[k] * w[i];
                    let most = w.iter().map(|z| z.norm()).fold(1.0, f64::max);
                    assert!(
                        right.norm() < 1e-12 * size && left.norm() < 1e-12 * size * most,
                        "{k}: {right} {left}"
                    );
                }
                let inner: C64 = w.iter().zip(&v).map(|(w, v)| w * v).sum();
                assert!((inner - 1.0).norm() < 1e-12, "{inner}");
                // no other eigenvalue's vector, though it be as large
                assert!(
                    seen.iter()
                        .all(|other| { other.iter().zip(&v).map(|(a, b)| a * b).sum::<C64>().norm() < 1e-9 })
                );
                seen.push(w);
            }
        }
    }
}
