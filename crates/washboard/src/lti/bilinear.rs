//! The bilinear map between the half plane and the disk, and discretisation.

use super::{Continuous, Discrete, LtiError, StateSpace};
use crate::linalg::{Mat, solve};

impl StateSpace<Continuous> {
    /// G(s) with s = λ (z − 1)/(z + 1): the left half plane becomes the unit disk, norms over frequency stay.
    ///
    /// A_d = (λI − A)⁻¹(λI + A), B_d = √(2λ) (λI − A)⁻¹B, C_d = √(2λ) C (λI − A)⁻¹, D_d = D + C (λI − A)⁻¹B.
    /// With λ = 2/dt it is Tustin's rule.
    ///
    /// # Errors
    /// A λ that is not positive, a step that is not, a pole at λ.
    pub fn bilinear(&self, lambda_rad_s: f64, dt_s: f64) -> Result<StateSpace<Discrete>, LtiError> {
        check_lambda(lambda_rad_s)?;
        let n = self.order();
        let shifted = |sign: f64| {
            Mat::from_fn(n, n, |i, j| sign * self.a()[(i, j)] + if i == j { lambda_rad_s } else { 0.0 })
        };
        let (a, b, c, d) = mapped(&shifted(-1.0), &shifted(1.0), self.b(), self.c(), self.d(), lambda_rad_s)?;
        StateSpace::discrete(a, b, c, d, dt_s)
    }

    /// Tustin's rule: integrals by trapezia of the step, s = (2/dt)(z − 1)/(z + 1).
    ///
    /// # Errors
    /// As [`StateSpace::bilinear`].
    pub fn tustin(&self, dt_s: f64) -> Result<StateSpace<Discrete>, LtiError> {
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            let (field, expected) = ("dt_s", "a positive, finite number");
            return Err(LtiError::Field { field, expected, found: dt_s });
        }
        self.bilinear(2.0 / dt_s, dt_s)
    }
}

impl StateSpace<Discrete> {
    /// G(z) with z = (λ + s)/(λ − s): the inverse of [`StateSpace::bilinear`].
    ///
    /// # Errors
    /// A λ that is not positive, a pole at −1.
    pub fn inverse_bilinear(&self, lambda_rad_s: f64) -> Result<StateSpace<Continuous>, LtiError> {
        check_lambda(lambda_rad_s)?;
        let n = self.order();
        // s = λ (z − 1)/(z + 1): A = λ (A_d + I)⁻¹(A_d − I), B = √(2λ) (A_d + I)⁻¹B_d, and likewise
        let plus = Mat::from_fn(n, n, |i, j| self.a()[(i, j)] + if i == j { 1.0 } else { 0.0 });
        let minus =
            Mat::from_fn(n, n, |i, j| lambda_rad_s * (self.a()[(i, j)] - if i == j { 1.0 } else { 0.0 }));
        let (a, b, c, over) = {
            let (a, b, c, over) = mapped(&plus, &minus, self.b(), self.c(), self.d(), lambda_rad_s)?;
            // feedthrough is D_d − C_d (A_d + I)⁻¹B_d
            (a, b, c, self.d() * faer::Scale(2.0) - over)
        };
        StateSpace::continuous(a, b, c, over)
    }
}

/// left⁻¹·right, √(2λ) left⁻¹B, √(2λ) C left⁻¹, D + C left⁻¹B.
fn mapped(
    left: &Mat,
    right: &Mat,
    b: &Mat,
    c: &Mat,
    d: &Mat,
    lambda: f64,
) -> Result<(Mat, Mat, Mat, Mat), LtiError> {
    if left.nrows() == 0 {
        return Ok((left.clone(), b.clone(), c.clone(), d.clone()));
    }
    let root = (2.0 * lambda).sqrt();
    let over_b = solve(left, b)?;
    let c_over = solve(&left.transpose().to_owned(), &c.transpose().to_owned())?.transpose().to_owned();
    Ok((solve(left, right)?, &over_b * faer::Scale(root), c_over * faer::Scale(root), d + c * over_b))
}

fn check_lambda(lambda: f64) -> Result<(), LtiError> {
    if lambda > 0.0 && lambda.is_finite() {
        return Ok(());
    }
    let (field, expected) = ("lambda_rad_s", "a positive, finite number");
    Err(LtiError::Field { field, expected, found: lambda })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::C64;

    fn system() -> StateSpace<Continuous> {
        let any = |r, c, s: f64| Mat::from_fn(r, c, |i, j| ((5 * i * i + 7 * j + i * j) as f64 + s).sin());
        StateSpace::continuous(any(4, 4, 0.3), any(4, 2, 1.0), any(3, 4, 2.0), any(3, 2, 3.0)).unwrap()
    }

    #[test]
    fn the_map_is_its_substitution_and_goes_back() {
        let (g, lambda) = (system(), 3.7);
        let d = g.bilinear(lambda, 0.1).unwrap();
        let z = C64::new(0.4, 0.8);
        let s = (z - 1.0) / (z + 1.0) * lambda;
        assert!((d.at(z).unwrap() - g.at(s).unwrap()).norm_l2() < 1e-12);
        let back = d.inverse_bilinear(lambda).unwrap();
        for (x, y) in [(back.a(), g.a()), (back.b(), g.b()), (back.c(), g.c()), (back.d(), g.d())] {
            assert!((x - y).norm_l2() < 1e-12 * y.norm_l2());
        }
    }

    #[test]
    fn tustin_of_an_integrator_is_the_trapezium_rule() {
        let one = |x: f64| Mat::from_fn(1, 1, |_, _| x);
        let integrator = StateSpace::continuous(one(0.0), one(1.0), one(1.0), one(0.0)).unwrap();
        let d = integrator.tustin(0.1).unwrap();
        // dt/2 (z + 1)/(z − 1)
        assert!((d.at(C64::new(3.0, 0.0)).unwrap()[(0, 0)].re - 0.1).abs() < 1e-15);
        assert!(integrator.tustin(-1.0).is_err() && integrator.bilinear(0.0, 1.0).is_err());
        // a pole at λ has no image
        let unstable = StateSpace::continuous(one(2.0), one(1.0), one(1.0), one(0.0)).unwrap();
        assert!(unstable.bilinear(2.0, 1.0).is_err());
    }
}
