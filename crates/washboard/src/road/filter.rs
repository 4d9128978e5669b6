//! Rational road filters: state space driven by unit-intensity white noise, of height or of velocity, over time or distance.

use super::RoadError;
use crate::linalg::{C64, CMat, Mat, eigen, solve_complex};

/// What a filter's output is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shapes {
    /// Road height r, m.
    Height,
    /// The time derivative of road height, m/s.
    Velocity,
}

/// y = C(sI − A)⁻¹B + D, driven by unit-intensity white noise (single output, single input).
///
/// A filter over *distance* gives height h(ℓ) from unit-intensity spatial noise; at speed v it is, over time, G(s/v)/√v:
/// the state space (vA, √v B, C, D/√v). A velocity filter over distance gives the slope dh/dℓ, and dh/dt is v times that.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapingFilter {
    a: Mat,
    b: Vec<f64>,
    c: Vec<f64>,
    d: f64,
    of: Shapes,
    over_distance: bool,
}

impl ShapingFilter {
    /// A filter from its state space.
    ///
    /// # Errors
    /// Shapes that do not fit, entries that are not finite, an A with a pole that is not in the open left half plane.
    pub fn new(
        a: Mat,
        b: Vec<f64>,
        c: Vec<f64>,
        d: f64,
        of: Shapes,
        over_distance: bool,
    ) -> Result<Self, RoadError> {
        let n = a.nrows();
        if a.ncols() != n || b.len() != n || c.len() != n {
            return Err(RoadError::Field {
                field: "a",
                expected: "a square matrix with as many rows as b and as many columns as c",
                found: format!("{} × {}, b of {}, c of {}", n, a.ncols(), b.len(), c.len()),
            });
        }
        if !(d.is_finite() && b.iter().chain(&c).all(|v| v.is_finite())) {
            let found = "a value that is not finite".to_owned();
            return Err(RoadError::Field { field: "b, c, d", expected: "finite numbers", found });
        }
        if n > 0 {
            let (poles, _) = eigen(&a).map_err(|e| RoadError::Field {
                field: "a",
                expected: "a finite matrix",
                found: e.to_string(),
            })?;
            let worst = poles.iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max);
            if worst >= 0.0 {
                return Err(RoadError::Field {
                    field: "a",
                    expected: "a stable filter (all poles with negative real part)",
                    found: format!("a pole with real part {worst}"),
                });
            }
        }
        Ok(ShapingFilter { a, b, c, d, of, over_distance })
    }

    /// A filter from poles, zeros and gain (leading coefficient): gain Π(s − zᵢ)/Π(s − pᵢ), real coefficients.
    ///
    /// # Errors
    /// More zeros than poles, poles or zeros that are not closed under conjugation, a pole that is not stable.
    pub fn from_zeros_poles(
        zeros: &[C64],
        poles: &[C64],
        gain: f64,
        of: Shapes,
        over_distance: bool,
    ) -> Result<Self, RoadError> {
        let n = poles.len();
        if zeros.len() > n {
            let found = format!("{} zeros and {n} poles", zeros.len());
            return Err(RoadError::Field { field: "zeros", expected: "no more zeros than poles", found });
        }
        let den = real_polynomial("poles", poles)?;
        let num = real_polynomial("zeros", zeros)?;
        // controllable companion form of num/den, ascending coefficients, den monic of degree n
        let mut padded = num;
        padded.resize(n + 1, 0.0);
        let d = gain * padded[n];
        let a = Mat::from_fn(n, n, |i, j| if i + 1 == n { -den[j] } else { f64::from(u8::from(j == i + 1)) });
        let b = (0..n).map(|i| f64::from(u8::from(i + 1 == n))).collect();
        let c = (0..n).map(|j| gain * padded[j] - d * den[j]).collect();
        ShapingFilter::new(a, b, c, d, of, over_distance)
    }

    /// b/(s + a) of height over time.
    #[must_use]
    pub(crate) fn first_order(a: f64, b: f64) -> Self {
        ShapingFilter {
            a: Mat::from_fn(1, 1, |_, _| -a),
            b: vec![b],
            c: vec![1.0],
            d: 0.0,
            of: Shapes::Height,
            over_distance: false,
        }
    }

    /// White velocity of intensity W: no state, D = √W.
    #[must_use]
    pub(crate) fn white_velocity(intensity: f64) -> Self {
        ShapingFilter {
            a: Mat::zeros(0, 0),
            b: Vec::new(),
            c: Vec::new(),
            d: intensity.sqrt(),
            of: Shapes::Velocity,
            over_distance: false,
        }
    }

    /// The same road seen over time at a speed (itself, where it is over time already).
    #[must_use]
    pub fn over_time(&self, speed_m_s: f64) -> Self {
        if !self.over_distance {
            return self.clone();
        }
        let v = speed_m_s;
        // G(s/v)/√v for height; dh/dt = v dh/dℓ for velocity
        let out = if self.of == Shapes::Velocity { v } else { 1.0 };
        ShapingFilter {
            a: Mat::from_fn(self.a.nrows(), self.a.ncols(), |i, j| v * self.a[(i, j)]),
            b: self.b.iter().map(|x| v.sqrt() * x).collect(),
            c: self.c.iter().map(|x| out * x).collect(),
            d: out * self.d / v.sqrt(),
            of: self.of,
            over_distance: false,
        }
    }

    /// The same road as a filter of height, where a filter of velocity over time has a zero at s = 0, so that its height
    /// does not wander off: r = C A⁻¹ x, since C A⁻¹(A x + B ξ) = C x + D ξ where C A⁻¹ B = D. Itself otherwise.
    #[must_use]
    pub fn as_height(&self) -> Self {
        let n = self.a.nrows();
        if self.of == Shapes::Height || n == 0 {
            return self.clone();
        }
        let row = Mat::from_fn(n, 1, |i, _| self.c[i]);
        // cᵀ A⁻¹ = (A⁻ᵀ c)ᵀ; a stable A has an inverse
        let Ok(x) = crate::linalg::solve(&self.a.transpose().to_owned(), &row) else { return self.clone() };
        let c: Vec<f64> = (0..n).map(|i| x[(i, 0)]).collect();
        let terms: Vec<f64> = c.iter().zip(&self.b).map(|(c, b)| c * b).collect();
        let (sum, size): (f64, f64) = (terms.iter().sum(), terms.iter().map(|t| t.abs()).sum());
        if (sum - self.d).abs() > 1e-12 * (size + self.d.abs()) {
            return self.clone();
        }
        ShapingFilter { c, d: 0.0, of: Shapes::Height, ..self.clone() }
    }

    /// Two-sided S(ω) of height, m²·s/rad.
    #[must_use]
    pub fn height_psd(&self, omega_rad_s: f64, speed_m_s: f64) -> f64 {
        let f = self.over_time(speed_m_s);
        let g = f.response(omega_rad_s).norm_sqr();
        if f.of == Shapes::Velocity { g / (omega_rad_s * omega_rad_s) } else { g }
    }

    /// C(iωI − A)⁻¹B + D of a filter over time.
    fn response(&self, omega_rad_s: f64) -> C64 {
        let n = self.a.nrows();
        let d = C64::new(self.d, 0.0);
        if n == 0 {
            return d;
        }
        let lhs =
            CMat::from_fn(n, n, |i, j| C64::new(-self.a[(i, j)], if i == j { omega_rad_s } else { 0.0 }));
        let rhs = CMat::from_fn(n, 1, |i, _| C64::new(self.b[i], 0.0));
        // a stable A has no eigenvalue on the axis, so the solution exists
        solve_complex(&lhs, &rhs)
            .map(|x| (0..n).map(|i| x[(i, 0)] * self.c[i]).sum::<C64>() + d)
            .unwrap_or(C64::new(f64::NAN, 0.0))
    }

    /// State matrix A.
    #[must_use]
    pub fn a(&self) -> &Mat {
        &self.a
    }

    /// Input column B.
    #[must_use]
    pub fn b(&self) -> &[f64] {
        &self.b
    }

    /// Output row C.
    #[must_use]
    pub fn c(&self) -> &[f64] {
        &self.c
    }

    /// Feedthrough D.
    #[must_use]
    pub fn d(&self) -> f64 {
        self.d
    }

    /// What the output is.
    #[must_use]
    pub fn of(&self) -> Shapes {
        self.of
    }

    /// Whether it runs over distance, and so gives a road of its own at any speed.
    #[must_use]
    pub fn is_over_distance(&self) -> bool {
        self.over_distance
    }

    /// Frequencies |λ| of the filter's poles, rad per its own variable.
    pub(crate) fn corner_frequencies(&self) -> Vec<f64> {
        if self.a.nrows() == 0 {
            return Vec::new();
        }
        eigen(&self.a).map(|(poles, _)| poles.iter().map(|p| p.norm()).collect()).unwrap_or_default()
    }
}

/// Π(s − rᵢ) with real coefficients, ascending.
fn real_polynomial(field: &'static str, roots: &[C64]) -> Result<Vec<f64>, RoadError> {
    let mut p = vec![C64::new(1.0, 0.0)];
    for r in roots {
        let mut next = vec![C64::new(0.0, 0.0); p.len() + 1];
        for (i, c) in p.iter().enumerate() {
            next[i + 1] += c;
            next[i] -= c * r;
        }
        p = next;
    }
    let size = p.iter().map(|c| c.norm()).fold(0.0, f64::max);
    // conjugate pairs typed with ten digits leave about 1e-10
    if p.iter().any(|c| !(c.im.abs() <= 1e-8 * size)) {
        let found = "a complex value without its conjugate".to_owned();
        return Err(RoadError::Field { field, expected: "complex values in conjugate pairs", found });
    }
    Ok(p.iter().map(|c| c.re).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::Spectrum;

    #[test]
    fn the_first_order_road_as_a_filter_over_distance() {
        let (a, b, v) = (0.0572, 0.0195, 20.0);
        let filter =
            ShapingFilter::from_zeros_poles(&[], &[C64::new(-a, 0.0)], b, Shapes::Height, true).unwrap();
        let road = Spectrum::first_order(b, a).unwrap();
        for omega in [0.1, 1.0, 10.0, 200.0] {
            assert!((filter.height_psd(omega, v) / road.psd(omega, v) - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn zeros_poles_and_gain_are_the_transfer_function() {
        let poles = [C64::new(-1.0, 3.0), C64::new(-1.0, -3.0), C64::new(-0.4, 0.0)];
        let zeros = [C64::new(-2.0, 0.5), C64::new(-2.0, -0.5), C64::new(0.7, 0.0)];
        let f = ShapingFilter::from_zeros_poles(&zeros, &poles, 0.3, Shapes::Height, false).unwrap();
        for omega in [0.0, 0.5, 3.0, 40.0] {
            let s = C64::new(0.0, omega);
            let mut g = C64::new(0.3, 0.0);
            for i in 0..3 {
                g = g * (s - zeros[i]) / (s - poles[i]);
            }
            assert!((f.height_psd(omega, 1.0) / g.norm_sqr() - 1.0).abs() < 1e-12);
        }
        let unpaired = ShapingFilter::from_zeros_poles(&[], &poles[..1], 1.0, Shapes::Height, false);
        assert!(unpaired.is_err());
        let unstable =
            ShapingFilter::from_zeros_poles(&[], &[C64::new(1.0, 0.0)], 1.0, Shapes::Height, false);
        assert!(unstable.is_err());
    }
}
