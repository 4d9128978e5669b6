//! States scaled so that rows and columns of [A B; C 0] are alike in size.

use super::{LtiError, StateSpace, Time};

/// Sweeps over all states, at most; each takes off a factor of two or more where it changes anything.
const MOST_SWEEPS: usize = 100;
/// A state is scaled where that makes row and column together smaller by this factor.
const WORTH: f64 = 0.95;

impl<T: Time> StateSpace<T> {
    /// The same system with states scaled by powers of two (no rounding) until the norms of a state's row of [A B] and
    /// of its column of [A; C] are within a factor of two of each other, and the scales: new x = diag(scales) x.
    ///
    /// A state without a row or a column (nothing drives it, nothing sees it) is left as it is.
    ///
    /// # Errors
    /// None for a system that could be built, but for numbers that overflow.
    ///
    /// Source: Osborne, J. ACM 7 (1960) 338–345; Parlett and Reinsch, Numer. Math. 13 (1969) 293–304.
    pub fn balanced_scales(&self) -> Result<(Self, Vec<f64>), LtiError> {
        let n = self.order();
        let mut a: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| self.a()[(i, j)].abs()).collect()).collect();
        let size = |m: &crate::linalg::Mat, of_row: Option<usize>, of_col: Option<usize>| -> f64 {
            match (of_row, of_col) {
                (Some(i), _) => (0..m.ncols()).map(|j| m[(i, j)].abs()).sum(),
                (_, Some(j)) => (0..m.nrows()).map(|i| m[(i, j)].abs()).sum(),
                _ => 0.0,
            }
        };
        let mut inputs: Vec<f64> = (0..n).map(|i| size(self.b(), Some(i), None)).collect();
        let mut outputs: Vec<f64> = (0..n).map(|j| size(self.c(), None, Some(j))).collect();
        let mut scales = vec![1.0; n];
        for _ in 0..MOST_SWEEPS {
            let mut changed = false;
            for k in 0..n {
                let row = (0..n).filter(|j| *j != k).map(|j| a[k][j]).sum::<f64>() + inputs[k];
                let col = (0..n).filter(|i| *i != k).map(|i| a[i][k]).sum::<f64>() + outputs[k];
                if !(row > 0.0 && col > 0.0 && row.is_finite() && col.is_finite()) {
                    continue;
                }
                // the power of two nearest to √(col/row)
                let factor = ((col / row).log2() / 2.0).round().clamp(-500.0, 500.0).exp2();
                if row * factor + col / factor < WORTH * (row + col) {
                    changed = true;
                    scales[k] *= factor;
                    for j in (0..n).filter(|j| *j != k) {
                        a[k][j] *= factor;
                        a[j][k] /= factor;
                    }
                    inputs[k] *= factor;
                    outputs[k] /= factor;
                }
            }
            if !changed {
                break;
            }
        }
        Ok((self.with_states_scaled(&scales)?, scales))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{C64, Mat};

    #[test]
    fn wild_units_are_undone_and_the_response_stays() {
        let any = |r, c, s: f64| Mat::from_fn(r, c, |i, j| ((5 * i * i + 7 * j + i * j) as f64 + s).sin());
        let g =
            StateSpace::continuous(any(5, 5, 0.3), any(5, 2, 1.0), any(2, 5, 2.0), any(2, 2, 3.0)).unwrap();
        let units = [1e-9, 1e6, 1.0, 1e12, 1e-3];
        let wild = g.with_states_scaled(&units).unwrap();
        let (calm, _) = wild.balanced_scales().unwrap();
        let (s, size) = (C64::new(0.1, 2.0), |x: &StateSpace<_>| x.a().norm_max());
        assert!(size(&wild) > 1e10 && size(&calm) < 4.0, "{}", size(&calm));
        let error = (calm.at(s).unwrap() - g.at(s).unwrap()).norm_l2();
        assert!(error < 1e-13, "{error:e}");
    }

    #[test]
    fn a_state_that_nothing_drives_stays() {
        let a = Mat::from_fn(2, 2, |i, j| if i == j { -1.0 } else { 0.0 });
        let g = StateSpace::continuous(a, Mat::zeros(2, 1), Mat::zeros(1, 2), Mat::zeros(1, 1)).unwrap();
        assert_eq!(g.balanced_scales().unwrap().1, [1.0, 1.0]);
    }
}
