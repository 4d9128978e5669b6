//! A damper with a curve: force over velocity, piecewise linear, and its linear equivalent under a Gaussian velocity.

use super::VehicleError;
use crate::linalg::integrate;
use serde::{Deserialize, Serialize};

/// Beyond this many standard deviations a Gaussian has nothing left in double precision.
const REACH: f64 = 9.0;
/// Relative accuracy of the Gaussian's mass in a segment, and the absolute one that is enough.
const MASS_TOLERANCE: [f64; 2] = [1e-14, 1e-16];
/// Evaluations for one segment; some hundred do.
const MAX_EVALUATIONS: usize = 100_000;

/// Points [velocity m/s, force N], joined by straight lines and continued with the outer slopes.
///
/// The velocity is that of the wheel towards the body: compression is positive, and a positive force resists it (pushes
/// the body up and the wheel down). A curve need not pass through the origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct DamperCurve(Vec<[f64; 2]>);

impl DamperCurve {
    /// A curve through points in the order of their velocities.
    ///
    /// # Errors
    /// As [`DamperCurve::check`].
    pub fn new(points: Vec<[f64; 2]>) -> Result<Self, VehicleError> {
        let curve = DamperCurve(points);
        curve.check("damper_curve")?;
        Ok(curve)
    }

    /// Refuses fewer than two points, velocities that do not ascend, and forces that fall: a damper takes energy.
    ///
    /// # Errors
    /// Named `field`.
    pub fn check(&self, field: &str) -> Result<(), VehicleError> {
        let refuse = |expected: &'static str, found: String| {
            Err(VehicleError::Field { field: field.to_owned(), expected, found })
        };
        if self.0.len() < 2 {
            return refuse("at least two points [velocity_m_s, force_n]", self.0.len().to_string());
        }
        if let Some(p) = self.0.iter().find(|p| !p.iter().all(|v| v.is_finite())) {
            return refuse("finite numbers", format!("{p:?}"));
        }
        match self.0.windows(2).find(|w| w[1][0] <= w[0][0] || w[1][1] < w[0][1]) {
            Some(w) => refuse("velocities that ascend and forces that do not fall", format!("{w:?}")),
            None => Ok(()),
        }
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.0
    }

    /// F(v) in N.
    #[must_use]
    pub fn force(&self, velocity_m_s: f64) -> f64 {
        let piece = self.piece(velocity_m_s);
        let [[v0, f0], [v1, f1]] = [self.0[piece], self.0[piece + 1]];
        f0 + (f1 - f0) / (v1 - v0) * (velocity_m_s - v0)
    }

    /// Which straight piece a velocity is on.
    pub(super) fn piece(&self, velocity_m_s: f64) -> usize {
        self.0.partition_point(|p| p[0] < velocity_m_s).clamp(1, self.0.len() - 1) - 1
    }

    fn slopes(&self) -> impl Iterator<Item = ([f64; 2], f64)> + '_ {
        let last = self.0.len() - 2;
        self.0.windows(2).enumerate().map(move |(i, w)| {
            let from = if i == 0 { f64::NEG_INFINITY } else { w[0][0] };
            let to = if i == last { f64::INFINITY } else { w[1][0] };
            ([from, to], (w[1][1] - w[0][1]) / (w[1][0] - w[0][0]))
        })
    }

    /// The steepest slope, N·s/m.
    #[must_use]
    pub fn steepest(&self) -> f64 {
        self.slopes().fold(0.0, |most, (_, slope)| most.max(slope))
    }

    /// Equivalent linear damping E\[F v\]/E\[v²\] of a Gaussian velocity of mean 0 and standard deviation σ.
    ///
    /// By Stein's lemma E\[F v\] = σ² E\[F'(v)\], so c_eq = Σ sᵢ P(vᵢ < v < vᵢ₊₁) with the slopes sᵢ: exact for a
    /// piecewise linear curve. At σ = 0 the mean of the slopes on both sides of v = 0.
    ///
    /// Source: Roberts and Spanos, *Random Vibration and Statistical Linearization* (1990), ch. 5.
    #[must_use]
    pub fn equivalent(&self, sigma_m_s: f64) -> f64 {
        if sigma_m_s <= 0.0 {
            let touching: Vec<f64> = self
                .slopes()
                .filter(|([from, to], _)| *from <= 0.0 && *to >= 0.0)
                .map(|(_, slope)| slope)
                .collect();
            return touching.iter().sum::<f64>() / touching.len().max(1) as f64;
        }
        self.slopes().map(|([from, to], slope)| slope * normal_mass(from / sigma_m_s, to / sigma_m_s)).sum()
    }
}

/// P(a < z < b) of a standard normal z.
fn normal_mass(a: f64, b: f64) -> f64 {
    let (a, b) = (a.clamp(-REACH, REACH), b.clamp(-REACH, REACH));
    if a >= b {
        return 0.0;
    }
    let inner = [-3.0, -1.0, 0.0, 1.0, 3.0].into_iter().filter(|p| *p > a && *p < b);
    let points: Vec<f64> = [a].into_iter().chain(inner).chain([b]).collect();
    let density = |z: f64, out: &mut [f64]| {
        out[0] = (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
    };
    integrate(density, 1, &points, MASS_TOLERANCE[0], &[MASS_TOLERANCE[1]], MAX_EVALUATIONS).values[0]
}

/// A damper of a vehicle that has a curve: its own velocity ż_u − ż_b as a row over q̇.
#[derive(Debug, Clone, PartialEq)]
pub struct Damper {
    /// The corner's name; empty for the only one of a quarter car.
    pub name: String,
    /// Compression velocity = row · q̇.
    pub row: Vec<f64>,
    /// What stands for it in C, N·s/m.
    pub linear: f64,
    /// What it does.
    pub curve: DamperCurve,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digressive() -> DamperCurve {
        DamperCurve::new(vec![[-0.5, -1500.0], [-0.1, -900.0], [0.0, 0.0], [0.1, 300.0], [1.0, 1200.0]])
            .unwrap()
    }

    #[test]
    fn forces_lie_on_the_lines_and_their_continuations() {
        let curve = digressive();
        for (v, f) in
            [(-1.0, -2250.0), (-0.3, -1200.0), (-0.1, -900.0), (0.0, 0.0), (0.05, 150.0), (2.0, 2200.0)]
        {
            assert!((curve.force(v) - f).abs() < 1e-9, "{v}: {}", curve.force(v));
        }
    }

    /// E[Fv]/E[v²] by quadrature of F v φ itself, without Stein's lemma.
    #[test]
    fn the_equivalent_is_its_definition() {
        let curve = digressive();
        for sigma in [0.01, 0.1, 0.4, 3.0] {
            let product = |z: f64, out: &mut [f64]| {
                let v = sigma * z;
                out[0] = curve.force(v) * v * (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
            };
            let mut points: Vec<f64> = curve.points().iter().map(|p| p[0] / sigma).collect();
            points.extend((-9..=9).map(f64::from));
            points.retain(|p| p.abs() <= REACH);
            points.sort_by(f64::total_cmp);
            points.dedup();
            let mean = integrate(product, 1, &points, 1e-13, &[], MAX_EVALUATIONS).values[0];
            let expected = mean / (sigma * sigma);
            assert!((curve.equivalent(sigma) / expected - 1.0).abs() < 1e-11, "{sigma}");
        }
        // the two slopes that meet at 0, and far out the outer ones
        assert!((curve.equivalent(0.0) - 6000.0).abs() < 1e-9);
        assert!((curve.equivalent(1e-9) - 6000.0).abs() < 1e-4);
        assert!((curve.equivalent(1e6) - 1250.0).abs() < 1e-2);
    }

    #[test]
    fn a_straight_line_is_its_slope() {
        let line = DamperCurve::new(vec![[-1.0, -1400.0], [0.2, 280.0], [0.7, 980.0]]).unwrap();
        for sigma in [0.0, 1e-3, 0.3, 10.0] {
            assert!((line.equivalent(sigma) / 1400.0 - 1.0).abs() < 1e-13);
        }
        assert!((line.steepest() - 1400.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        for (points, text) in [
            (vec![[0.0, 0.0]], "at least two points"),
            (vec![[0.0, 0.0], [0.0, 1.0]], "velocities that ascend"),
            (vec![[0.0, 0.0], [1.0, -1.0]], "forces that do not fall"),
            (vec![[0.0, f64::NAN], [1.0, 1.0]], "finite numbers"),
        ] {
            let e = DamperCurve::new(points).unwrap_err().to_string();
            assert!(e.contains(text), "{e}");
        }
    }
}
