//! A linear time-invariant system in state space, ẋ = A x + B u, y = C x + D u, in continuous or discrete time.

use super::{Continuous, Discrete, LtiError, Time};
use crate::linalg::{C64, CMat, Mat, RealSchur, check_finite, solve_complex};

/// G = C (sI − A)⁻¹ B + D, with s = iω in continuous and z = e^{iω dt} in discrete time.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `a` | n × n | states to states |
/// | `b` | n × m | inputs to states |
/// | `c` | p × n | states to outputs |
/// | `d` | p × m | inputs to outputs |
///
/// n, m and p may be 0. All entries are finite.
///
/// ```
/// use washboard::linalg::Mat;
/// use washboard::lti::StateSpace;
/// let one = |x: f64| Mat::from_fn(1, 1, |_, _| x);
/// // 1/(s + 2)
/// let lag = StateSpace::continuous(one(-2.0), one(1.0), one(1.0), one(0.0))?;
/// assert!((lag.frequency_response(&[2.0])?[0][(0, 0)].norm() - 0.125f64.sqrt()).abs() < 1e-15);
/// // (s + 3)/(s + 2): outputs of systems in parallel are added
/// let one_more = lag.parallel(&StateSpace::continuous_gain(one(1.0))?)?;
/// assert!((one_more.frequency_response(&[0.0])?[0][(0, 0)].re - 1.5).abs() < 1e-15);
/// # Ok::<(), washboard::lti::LtiError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace<T: Time> {
    a: Mat,
    b: Mat,
    c: Mat,
    d: Mat,
    time: T,
}

impl StateSpace<Continuous> {
    /// A continuous-time system.
    ///
    /// # Errors
    /// Shapes that do not fit; entries that are not finite.
    pub fn continuous(a: Mat, b: Mat, c: Mat, d: Mat) -> Result<Self, LtiError> {
        Self::new(a, b, c, d, Continuous)
    }

    /// y = D u.
    ///
    /// # Errors
    /// Entries that are not finite.
    pub fn continuous_gain(d: Mat) -> Result<Self, LtiError> {
        Self::gain(d, Continuous)
    }
}

impl StateSpace<Discrete> {
    /// A discrete-time system of step `dt_s`.
    ///
    /// # Errors
    /// Shapes that do not fit; entries that are not finite; a step that is not positive.
    pub fn discrete(a: Mat, b: Mat, c: Mat, d: Mat, dt_s: f64) -> Result<Self, LtiError> {
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            return Err(LtiError::Field {
                field: "dt_s",
                expected: "a positive, finite number",
                found: dt_s,
            });
        }
        Self::new(a, b, c, d, Discrete { dt_s })
    }
}

impl<T: Time> StateSpace<T> {
    /// A system in the time given.
    ///
    /// # Errors
    /// Shapes that do not fit; entries that are not finite.
    pub fn new(a: Mat, b: Mat, c: Mat, d: Mat, time: T) -> Result<Self, LtiError> {
        let (n, m, p) = (a.nrows(), d.ncols(), d.nrows());
        for (name, matrix, expected) in [("A", &a, (n, n)), ("B", &b, (n, m)), ("C", &c, (p, n))] {
            let found = (matrix.nrows(), matrix.ncols());
            if found != expected {
                return Err(LtiError::Shape { name, expected, found });
            }
        }
        for (name, matrix) in [("A", &a), ("B", &b), ("C", &c), ("D", &d)] {
            check_finite(name, matrix)?;
        }
        Ok(StateSpace { a, b, c, d, time })
    }

    /// y = D u.
    ///
    /// # Errors
    /// Entries that are not finite.
    pub fn gain(d: Mat, time: T) -> Result<Self, LtiError> {
        let (m, p) = (d.ncols(), d.nrows());
        Self::new(Mat::zeros(0, 0), Mat::zeros(0, m), Mat::zeros(p, 0), d, time)
    }

    /// States to states.
    #[must_use]
    pub fn a(&self) -> &Mat {
        &self.a
    }

    /// Inputs to states.
    #[must_use]
    pub fn b(&self) -> &Mat {
        &self.b
    }

    /// States to outputs.
    #[must_use]
    pub fn c(&self) -> &Mat {
        &self.c
    }

    /// Inputs to outputs.
    #[must_use]
    pub fn d(&self) -> &Mat {
        &self.d
    }

    /// The time it lives in.
    #[must_use]
    pub fn time(&self) -> T {
        self.time
    }

    /// Number of states.
    #[must_use]
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.d.ncols()
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.d.nrows()
    }

    /// The eigenvalues of A, in no particular order; states are balanced for it, so that their units do not matter.
    ///
    /// # Errors
    /// An iteration that does not converge.
    pub fn poles(&self) -> Result<Vec<C64>, LtiError> {
        let (n, time) = (self.order(), self.time);
        // by A alone: what scales B and C is not to disturb it
        let bare = Self::new(self.a.clone(), Mat::zeros(n, 0), Mat::zeros(0, n), Mat::zeros(0, 0), time)?;
        Ok(RealSchur::only_eigenvalues(&bare.balanced_scales()?.0.a)?)
    }

    /// The pole nearest to instability, and how far inside the stable region it is (negative outside); none without states.
    ///
    /// # Errors
    /// An iteration that does not converge.
    pub fn least_stable_pole(&self) -> Result<Option<(C64, f64)>, LtiError> {
        Ok(self.least_stable(&self.poles()?))
    }

    fn least_stable(&self, poles: &[C64]) -> Option<(C64, f64)> {
        poles.iter().map(|p| (*p, self.time.margin(*p))).min_by(|x, y| x.1.total_cmp(&y.1))
    }

    /// Whether all poles are inside the stable region.
    ///
    /// # Errors
    /// An iteration that does not converge.
    pub fn is_stable(&self) -> Result<bool, LtiError> {
        Ok(self.least_stable_pole()?.is_none_or(|(_, margin)| margin > 0.0))
    }

    /// Refuses a system that is not stable, for `what`.
    ///
    /// # Errors
    /// [`LtiError::NotStable`] with the pole.
    pub fn check_stable(&self, what: &'static str) -> Result<(), LtiError> {
        self.check_poles(what, &self.poles()?)
    }

    /// The same where the poles are known.
    pub(super) fn check_poles(&self, what: &'static str, poles: &[C64]) -> Result<(), LtiError> {
        match self.least_stable(poles) {
            Some((pole, margin)) if !(margin > 0.0) => Err(LtiError::NotStable { what, pole, margin }),
            _ => Ok(()),
        }
    }

    /// G at a point of the complex plane (outputs × inputs).
    ///
    /// # Errors
    /// A pole there.
    pub fn at(&self, s: C64) -> Result<CMat, LtiError> {
        let n = self.order();
        let d = complex(&self.d);
        if n == 0 {
            return Ok(d);
        }
        let resolvent = CMat::from_fn(n, n, |i, j| {
            (if i == j { s } else { C64::new(0.0, 0.0) }) - C64::new(self.a[(i, j)], 0.0)
        });
        Ok(complex(&self.c) * solve_complex(&resolvent, &complex(&self.b))? + d)
    }

    /// The system with T x for x: T A T⁻¹, T B, C T⁻¹, D, for a diagonal T.
    ///
    /// # Errors
    /// A factor that is not finite and not zero; a wrong number of them.
    pub fn with_states_scaled(&self, t: &[f64]) -> Result<Self, LtiError> {
        if t.len() != self.order() {
            return Err(LtiError::Shape { name: "T", expected: (self.order(), 1), found: (t.len(), 1) });
        }
        if let Some(found) = t.iter().find(|x| !(x.is_finite() && **x != 0.0)) {
            return Err(LtiError::Field { field: "T", expected: "finite numbers, not zero", found: *found });
        }
        let (n, m, p) = (self.order(), self.inputs(), self.outputs());
        Self::new(
            Mat::from_fn(n, n, |i, j| self.a[(i, j)] * t[i] / t[j]),
            Mat::from_fn(n, m, |i, j| self.b[(i, j)] * t[i]),
            Mat::from_fn(p, n, |i, j| self.c[(i, j)] / t[j]),
            self.d.clone(),
            self.time,
        )
    }

    /// The dual system Gᵀ: Aᵀ, Cᵀ, Bᵀ, Dᵀ.
    #[must_use]
    pub fn transposed(&self) -> Self {
        StateSpace {
            a: self.a.transpose().to_owned(),
            b: self.c.transpose().to_owned(),
            c: self.b.transpose().to_owned(),
            d: self.d.transpose().to_owned(),
            time: self.time,
        }
    }

    /// Some outputs from some inputs, by their indices.
    ///
    /// # Errors
    /// An index that is none.
    pub fn select(&self, outputs: &[usize], inputs: &[usize]) -> Result<Self, LtiError> {
        for (field, indices, count) in
            [("output index", outputs, self.outputs()), ("input index", inputs, self.inputs())]
        {
            if let Some(found) = indices.iter().find(|i| **i >= count) {
                let found = *found as f64;
                return Err(LtiError::Field { field, expected: "an index below their number", found });
            }
        }
        let n = self.order();
        Ok(StateSpace {
            a: self.a.clone(),
            b: Mat::from_fn(n, inputs.len(), |i, j| self.b[(i, inputs[j])]),
            c: Mat::from_fn(outputs.len(), n, |i, j| self.c[(outputs[i], j)]),
            d: Mat::from_fn(outputs.len(), inputs.len(), |i, j| self.d[(outputs[i], inputs[j])]),
            time: self.time,
        })
    }
}

pub(super) fn complex(m: &Mat) -> CMat {
    CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_by_name() {
        let m = |r, c| Mat::zeros(r, c);
        let refused = |a, b, c, d| StateSpace::continuous(a, b, c, d).unwrap_err().to_string();
        assert!(refused(m(2, 3), m(2, 1), m(1, 2), m(1, 1)).starts_with("A: expected shape (2, 2)"));
        assert!(refused(m(2, 2), m(3, 1), m(1, 2), m(1, 1)).starts_with("B: expected shape (2, 1)"));
        assert!(refused(m(2, 2), m(2, 1), m(1, 3), m(1, 1)).starts_with("C: expected shape (1, 2)"));
        let mut bad = m(2, 2);
        bad[(1, 0)] = f64::NAN;
        assert!(refused(bad, m(2, 1), m(1, 2), m(1, 1)).starts_with("A: entry (1, 0) is NaN"));
        assert!(StateSpace::discrete(m(1, 1), m(1, 1), m(1, 1), m(1, 1), 0.0).is_err());
        assert!(StateSpace::continuous(m(0, 0), m(0, 0), m(0, 0), m(0, 0)).is_ok());
    }

    #[test]
    fn the_margin_is_that_of_the_worst_pole() {
        let a = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-4.0, -0.4]][i][j]);
        let (b, c, d) = (Mat::zeros(2, 1), Mat::zeros(1, 2), Mat::zeros(1, 1));
        let g = StateSpace::continuous(a.clone(), b.clone(), c.clone(), d.clone()).unwrap();
        assert!((g.least_stable_pole().unwrap().unwrap().1 - 0.2).abs() < 1e-14);
        assert!(g.check_stable("a norm").is_ok());
        // |λ| = 2 in discrete time
        let g = StateSpace::discrete(a, b, c, d, 0.1).unwrap();
        assert!((g.least_stable_pole().unwrap().unwrap().1 + 1.0).abs() < 1e-14);
        assert!(
            g.check_stable("a norm").unwrap_err().to_string().starts_with("a norm needs a stable system")
        );
    }
}
