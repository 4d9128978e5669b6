//! Exact responses in time: to steps, impulses, and inputs that are constant or straight between samples.

use super::connect::{blocks, cut};
use super::{Continuous, Discrete, LtiError, StateSpace, Time};
use crate::linalg::{Mat, expm};

/// What an input does between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// It stays at the sample.
    Zero,
    /// It goes straight to the next one.
    First,
}

impl StateSpace<Continuous> {
    /// The system sampled every `dt_s` behind a zero-order hold: exact for inputs that are constant between samples.
    ///
    /// exp([A B; 0 0] dt) = [Φ Γ; 0 I]: x⁺ = Φ x + Γ u.
    ///
    /// # Errors
    /// A step that is not positive, or so long that the exponential overflows.
    ///
    /// Source: Van Loan, IEEE Trans. Automat. Control 23 (1978) 395–404.
    pub fn sampled(&self, dt_s: f64) -> Result<StateSpace<Discrete>, LtiError> {
        let (phi, gamma, _) = self.transition(dt_s)?;
        StateSpace::discrete(phi, gamma, self.c().clone(), self.d().clone(), dt_s)
    }

    /// Outputs (one row a sample) to inputs (one row a sample), every `dt_s` from rest; exact for the hold given.
    ///
    /// # Errors
    /// A step that is not positive, rows that are not the inputs.
    pub fn respond(&self, inputs: &[Vec<f64>], dt_s: f64, hold: Hold) -> Result<Vec<Vec<f64>>, LtiError> {
        self.respond_from(&vec![0.0; self.order()], inputs, dt_s, hold)
    }

    /// As [`StateSpace::respond`], from an initial state.
    ///
    /// # Errors
    /// As [`StateSpace::respond`]; a state of another length.
    pub fn respond_from(
        &self,
        state: &[f64],
        inputs: &[Vec<f64>],
        dt_s: f64,
        hold: Hold,
    ) -> Result<Vec<Vec<f64>>, LtiError> {
        let (n, m) = (self.order(), self.inputs());
        if state.len() != n {
            return Err(LtiError::Shape { name: "initial state", expected: (n, 1), found: (state.len(), 1) });
        }
        if let Some(row) = inputs.iter().find(|row| row.len() != m) {
            return Err(LtiError::Shape { name: "input row", expected: (1, m), found: (1, row.len()) });
        }
        let (phi, gamma, ramp) = self.transition(dt_s)?;
        let (now, next) = match hold {
            Hold::Zero => (gamma, Mat::zeros(n, m)),
            Hold::First => (&gamma - &ramp, ramp),
        };
        let mut x = state.to_vec();
        let mut outputs = Vec::with_capacity(inputs.len());
        for (k, u) in inputs.iter().enumerate() {
            let sum = |row: &Mat, i: usize, v: &[f64]| -> f64 {
                v.iter().enumerate().map(|(j, v)| row[(i, j)] * v).sum()
            };
            outputs.push((0..self.outputs()).map(|i| sum(self.c(), i, &x) + sum(self.d(), i, u)).collect());
            if let Some(after) = inputs.get(k + 1) {
                x = (0..n).map(|i| sum(&phi, i, &x) + sum(&now, i, u) + sum(&next, i, after)).collect();
            }
        }
        Ok(outputs)
    }

    /// Outputs every `dt_s`, from 0, to a unit step of one input.
    ///
    /// # Errors
    /// As [`StateSpace::respond`]; an input that is none.
    pub fn step(&self, input: usize, dt_s: f64, samples: usize) -> Result<Vec<Vec<f64>>, LtiError> {
        let one = self.select(&(0..self.outputs()).collect::<Vec<_>>(), &[input])?;
        one.respond(&vec![vec![1.0]; samples], dt_s, Hold::Zero)
    }

    /// Outputs every `dt_s`, from just after 0, to a unit impulse at one input; D's own impulse at 0 is left out.
    ///
    /// # Errors
    /// As [`StateSpace::respond`]; an input that is none.
    pub fn impulse(&self, input: usize, dt_s: f64, samples: usize) -> Result<Vec<Vec<f64>>, LtiError> {
        let one = self.select(&(0..self.outputs()).collect::<Vec<_>>(), &[input])?;
        let start: Vec<f64> = (0..self.order()).map(|i| one.b()[(i, 0)]).collect();
        one.respond_from(&start, &vec![vec![0.0]; samples], dt_s, Hold::Zero)
    }

    /// Φ, ∫₀^dt e^{As}B ds, and what a ramp from 0 to 1 over the step gives.
    fn transition(&self, dt_s: f64) -> Result<(Mat, Mat, Mat), LtiError> {
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            let (field, expected) = ("dt_s", "a positive, finite number");
            return Err(LtiError::Field { field, expected, found: dt_s });
        }
        let (n, m) = (self.order(), self.inputs());
        let dt = faer::Scale(dt_s);
        let (a, b) = (self.a() * dt, self.b() * dt);
        let none = |r, c| Mat::zeros(r, c);
        let generator = blocks(&[
            &[&a, &b, &none(n, m)],
            &[&none(m, n), &none(m, m), &Mat::identity(m, m)],
            &[&none(m, n), &none(m, m), &none(m, m)],
        ]);
        let e = expm(&generator)?;
        Ok((cut(&e, 0, 0, n, n), cut(&e, 0, n, n, m), cut(&e, 0, n + m, n, m)))
    }
}

impl StateSpace<Discrete> {
    /// Outputs (one row a sample) to inputs (one row a sample) from rest.
    ///
    /// # Errors
    /// Rows that are not the inputs.
    pub fn respond(&self, inputs: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, LtiError> {
        let mut x = vec![0.0; self.order()];
        let mut outputs = Vec::with_capacity(inputs.len());
        for u in inputs {
            if u.len() != self.inputs() {
                let (expected, found) = ((1, self.inputs()), (1, u.len()));
                return Err(LtiError::Shape { name: "input row", expected, found });
            }
            let row = |m: &Mat, d: &Mat, i: usize| -> f64 {
                let of_x: f64 = x.iter().enumerate().map(|(j, v)| m[(i, j)] * v).sum();
                of_x + u.iter().enumerate().map(|(j, v)| d[(i, j)] * v).sum::<f64>()
            };
            outputs.push((0..self.outputs()).map(|i| row(self.c(), self.d(), i)).collect());
            x = (0..self.order()).map(|i| row(self.a(), self.b(), i)).collect();
        }
        Ok(outputs)
    }
}

impl<T: Time> StateSpace<T> {
    /// G(0) or G(1): what a step ends at.
    ///
    /// # Errors
    /// A pole there.
    pub fn dc_gain(&self) -> Result<Mat, LtiError> {
        let g = self.at(self.time().point(0.0))?;
        Ok(Mat::from_fn(g.nrows(), g.ncols(), |i, j| g[(i, j)].re))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oscillator() -> StateSpace<Continuous> {
        // 1/(s² + 2ζω s + ω²) and its derivative
        let a = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-25.0, -1.0]][i][j]);
        let b = Mat::from_fn(2, 1, |i, _| i as f64);
        StateSpace::continuous(a, b, Mat::identity(2, 2), Mat::zeros(2, 1)).unwrap()
    }

    #[test]
    fn step_and_impulse_are_the_known_ones() {
        let (zeta, omega) = (0.1, 5.0);
        let damped = omega * f64::sqrt(1.0 - zeta * zeta);
        let (g, dt) = (oscillator(), 0.07);
        for (k, y) in g.step(0, dt, 60).unwrap().iter().enumerate() {
            let t = dt * k as f64;
            let decay = (-zeta * omega * t).exp();
            let known =
                (1.0 - decay * ((damped * t).cos() + zeta * omega / damped * (damped * t).sin())) / 25.0;
            assert!((y[0] - known).abs() < 1e-14, "{t}");
        }
        for (k, y) in g.impulse(0, dt, 60).unwrap().iter().enumerate() {
            let t = dt * k as f64;
            assert!((y[0] - (-zeta * omega * t).exp() * (damped * t).sin() / damped).abs() < 1e-14, "{t}");
        }
        assert!((g.dc_gain().unwrap()[(0, 0)] - 0.04).abs() < 1e-16);
    }

    #[test]
    fn a_ramp_is_exact_behind_a_first_order_hold() {
        // the response to t is the integral of the step's
        let (g, dt) = (oscillator(), 0.11);
        let ramp: Vec<Vec<f64>> = (0..40).map(|k| vec![dt * f64::from(k)]).collect();
        let y = g.respond(&ramp, dt, Hold::First).unwrap();
        let one = |x: f64| Mat::from_fn(1, 1, |_, _| x);
        let integrator = StateSpace::continuous(one(0.0), one(1.0), one(1.0), one(0.0)).unwrap();
        let through = integrator.series(&g).unwrap().step(0, dt, 40).unwrap();
        for (a, b) in y.iter().zip(&through) {
            assert!((a[0] - b[0]).abs() < 1e-14 && (a[1] - b[1]).abs() < 1e-14);
        }
        assert!((y[30][0] - g.respond(&ramp, dt, Hold::Zero).unwrap()[30][0]).abs() > 1e-4);
    }

    #[test]
    fn sampling_is_the_step_by_step_response() {
        let (g, dt) = (oscillator(), 0.2);
        let u: Vec<Vec<f64>> = (0..20).map(|k| vec![(1.7 * f64::from(k)).sin()]).collect();
        let (a, b) = (g.respond(&u, dt, Hold::Zero).unwrap(), g.sampled(dt).unwrap().respond(&u).unwrap());
        assert!(a.iter().zip(&b).all(|(x, y)| (x[0] - y[0]).abs() < 1e-15));
        assert!(g.respond(&[vec![1.0, 2.0]], dt, Hold::Zero).is_err() && g.sampled(0.0).is_err());
    }
}
