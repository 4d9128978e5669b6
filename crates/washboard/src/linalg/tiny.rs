//! Linear systems of at most four unknowns, by Gaussian elimination with complete pivoting, on the stack.

const LARGEST: usize = 4;

/// A x = b with at most four unknowns.
#[derive(Debug, Clone)]
pub(super) struct System {
    order: usize,
    a: [[f64; LARGEST]; LARGEST],
    b: [f64; LARGEST],
}

impl System {
    /// A = 0, b = 0.
    pub fn new(order: usize) -> Self {
        debug_assert!(order <= LARGEST);
        Self { order, a: [[0.0; LARGEST]; LARGEST], b: [0.0; LARGEST] }
    }

    /// Adds to an entry of A.
    pub fn add(&mut self, row: usize, col: usize, value: f64) {
        self.a[row][col] += value;
    }

    /// Sets an entry of b.
    pub fn set_rhs(&mut self, row: usize, value: f64) {
        self.b[row] = value;
    }

    /// x, with every pivot smaller than `floor` replaced by it: what a backward-stable caller checks afterwards.
    pub fn solve_perturbed(mut self, floor: f64) -> [f64; LARGEST] {
        let n = self.order;
        let floor = floor.max(f64::MIN_POSITIVE);
        let mut unknown = [0, 1, 2, 3];
        for k in 0..n {
            let (mut row, mut col, mut best) = (k, k, 0.0);
            for i in k..n {
                for j in k..n {
                    if self.a[i][j].abs() > best {
                        (row, col, best) = (i, j, self.a[i][j].abs());
                    }
                }
            }
            self.a.swap(k, row);
            self.b.swap(k, row);
            if col != k {
                self.a.iter_mut().for_each(|r| r.swap(k, col));
                unknown.swap(k, col);
            }
            if best < floor {
                self.a[k][k] = floor;
            }
            for i in k + 1..n {
                let factor = self.a[i][k] / self.a[k][k];
                for j in k..n {
                    self.a[i][j] -= factor * self.a[k][j];
                }
                self.b[i] -= factor * self.b[k];
            }
        }
        let mut x = [0.0; LARGEST];
        for k in (0..n).rev() {
            let sum: f64 = (k + 1..n).map(|j| self.a[k][j] * x[unknown[j]]).sum();
            x[unknown[k]] = (self.b[k] - sum) / self.a[k][k];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_that_needs_both_pivots_is_solved() {
        let a = [[0.0, 0.0, 2.0, 1.0], [1.0, 0.0, 0.0, 3.0], [0.0, 5.0, 1.0, 0.0], [1e-8, 1.0, 7.0, 2.0]];
        let x = [1.0, -2.0, 3.0, 0.5];
        let mut system = System::new(4);
        for i in 0..4 {
            for j in 0..4 {
                system.add(i, j, a[i][j]);
            }
            system.set_rhs(i, (0..4).map(|j| a[i][j] * x[j]).sum());
        }
        let got = system.solve_perturbed(0.0);
        for i in 0..4 {
            assert!((got[i] - x[i]).abs() < 1e-14);
        }
    }
}
