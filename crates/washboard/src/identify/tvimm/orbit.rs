//! Coordinates of state spaces that ignore the choice of states.

use crate::linalg::{LinalgError, Mat};
use crate::lti::FirstOrder;

/// Where the entries of [A B; C 0] stand in a vector: rows one after another, first those of [A B], then those of C.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entries {
    pub states: usize,
    pub inputs: usize,
    pub outputs: usize,
}

impl Entries {
    pub fn of(system: &FirstOrder) -> Self {
        Entries { states: system.a.nrows(), inputs: system.b.ncols(), outputs: system.c.nrows() }
    }

    pub fn len(self) -> usize {
        self.states * (self.states + self.inputs) + self.outputs * self.states
    }

    /// Rows of [A B; C 0].
    pub fn rows(self) -> usize {
        self.states + self.outputs
    }

    /// First entry and length of a row.
    pub fn row(self, l: usize) -> (usize, usize) {
        let (n, wide) = (self.states, self.states + self.inputs);
        if l < n { (l * wide, wide) } else { (n * wide + (l - n) * n, n) }
    }

    /// Place of entry (l, r) of [A B; C 0].
    pub fn at(self, l: usize, r: usize) -> usize {
        self.row(l).0 + r
    }

    /// The system a step away.
    pub fn moved(self, system: &FirstOrder, step: impl Fn(usize) -> f64) -> FirstOrder {
        let n = self.states;
        FirstOrder {
            a: Mat::from_fn(n, n, |i, j| system.a[(i, j)] + step(self.at(i, j))),
            b: Mat::from_fn(n, self.inputs, |i, j| system.b[(i, j)] + step(self.at(i, n + j))),
            c: Mat::from_fn(self.outputs, n, |i, j| system.c[(i, j)] + step(self.at(n + i, j))),
        }
    }
}

/// An orthonormal basis (entries × free) of the complement of the similarity orbit's tangent at a system.
///
/// A change of states x → (I + T)x moves (A, B, C) by (TA − AT, TB, −CT) and nothing that can be measured: steps are
/// taken at right angles to all of these. Coincident poles are harmless, and no entry is fixed by a convention.
pub(super) fn complement(system: &FirstOrder) -> Result<Mat, LinalgError> {
    let e = Entries::of(system);
    let n = e.states;
    let mut tangent = Mat::zeros(e.len(), n * n);
    for p in 0..n {
        for q in 0..n {
            // T = e_p e_qᵀ
            let column = p * n + q;
            for j in 0..n {
                tangent[(e.at(p, j), column)] += system.a[(q, j)];
                tangent[(e.at(j, q), column)] -= system.a[(j, p)];
            }
            for j in 0..e.inputs {
                tangent[(e.at(p, n + j), column)] += system.b[(q, j)];
            }
            for i in 0..e.outputs {
                tangent[(e.at(n + i, q), column)] -= system.c[(i, p)];
            }
        }
    }
    crate::linalg::check_finite("the orbit's tangent", &tangent)?;
    let q = tangent.qr().compute_Q();
    let free = e.len() - n * n;
    Ok(Mat::from_fn(e.len(), free, |i, j| q[(i, n * n + j)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::C64;

    fn system() -> FirstOrder {
        let value = |i: usize, j: usize| ((7 * i + 3 * j) % 11) as f64 / 11.0 - 0.4;
        FirstOrder {
            a: Mat::from_fn(6, 6, |i, j| value(i, j) - if i == j { 2.0 } else { 0.0 }),
            b: Mat::from_fn(6, 2, |i, j| value(i + 2, j)),
            c: Mat::from_fn(3, 6, |i, j| value(i, j + 5)),
        }
    }

    #[test]
    fn as_many_coordinates_as_a_response_has() {
        let basis = complement(&system()).unwrap();
        assert_eq!((basis.nrows(), basis.ncols()), (36 + 12 + 18, 12 + 18));
        // orthonormal
        let gram = basis.transpose() * &basis;
        for i in 0..30 {
            for j in 0..30 {
                assert!((gram[(i, j)] - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }

    /// Every coordinate changes the response; a change of states is at right angles to all of them.
    #[test]
    fn the_complement_is_what_a_response_shows() {
        let s = system();
        let e = Entries::of(&s);
        let basis = complement(&s).unwrap();
        let h = |s: &FirstOrder| s.response(C64::new(0.1, 1.3)).unwrap();
        let step = 1e-6;
        for z in 0..basis.ncols() {
            let moved = e.moved(&s, |k| step * basis[(k, z)]);
            assert!((h(&moved) - h(&s)).norm_max() > 1e-4 * step, "coordinate {z}");
        }
        let t = Mat::from_fn(6, 6, |i, j| ((5 * i + j) % 7) as f64 - 3.0);
        let (a, b, c) = (&t * &s.a - &s.a * &t, &t * &s.b, -(&s.c * &t));
        let turned = e.moved(&s, |k| {
            let (mut l, mut rest) = (0, k);
            while rest >= e.row(l).1 {
                rest -= e.row(l).1;
                l += 1;
            }
            step * if l >= 6 {
                c[(l - 6, rest)]
            } else if rest < 6 {
                a[(l, rest)]
            } else {
                b[(l, rest - 6)]
            }
        });
        assert!((h(&turned) - h(&s)).norm_max() < 1e-9);
        for z in 0..basis.ncols() {
            let mut along = 0.0;
            for l in 0..9 {
                for r in 0..e.row(l).1 {
                    let change = if l >= 6 {
                        c[(l - 6, r)]
                    } else if r < 6 {
                        a[(l, r)]
                    } else {
                        b[(l, r - 6)]
                    };
                    along += change * basis[(e.at(l, r), z)];
                }
            }
            assert!(along.abs() < 1e-10, "{along}");
        }
    }
}
