//! Real Möbius maps: of points, of Taylor coefficients, and of systems.

use super::super::SubspaceError;
use super::data::{Domain, Point};
use crate::linalg::{C64, CMat, Mat, singular_values, solve};

/// A node farther from the origin than this is too near to infinity to work there.
const FAR: f64 = 5.0;
/// Automorphisms of the disk to choose from where some node is.
const CENTRES: [f64; 6] = [0.5, -0.5, 0.25, -0.25, 0.75, -0.75];
/// A pole this near to infinity, as a share of what a singular value can be, is there.
const IMPROPER: f64 = 1e-13;

/// w = (αz + β)/(γz + δ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mobius {
    pub alpha: f64,
    pub beta: f64,
    pub gamma: f64,
    pub delta: f64,
}

impl Mobius {
    pub const ONE: Mobius = Mobius { alpha: 1.0, beta: 0.0, gamma: 0.0, delta: 1.0 };

    /// From the domain to the disk: (3.5) the other way round.
    pub fn to_disk(domain: Domain) -> Self {
        match domain {
            Domain::Disk => Self::ONE,
            Domain::HalfPlane { lambda_rad_s: l } => Mobius { alpha: 1.0, beta: l, gamma: -1.0, delta: l },
        }
    }

    /// From the domain to a disk in which these points are not near infinity, where a real map can do it.
    pub fn to_work(domain: Domain, points: &[Point]) -> Self {
        let plain = Self::to_disk(domain);
        let farthest = |map: &Mobius| {
            points.iter().map(|z| map.point(*z).map_or(f64::INFINITY, |w| w.norm())).fold(0.0, f64::max)
        };
        if farthest(&plain) <= FAR {
            return plain;
        }
        let turned = |c: f64| plain.then(Mobius { alpha: 1.0, beta: -c, gamma: -c, delta: 1.0 });
        CENTRES
            .iter()
            .map(|c| turned(*c))
            .fold(plain, |best, m| if farthest(&m) < farthest(&best) { m } else { best })
    }

    /// This map, then another.
    fn then(self, next: Mobius) -> Self {
        Mobius {
            alpha: next.alpha * self.alpha + next.beta * self.gamma,
            beta: next.alpha * self.beta + next.beta * self.delta,
            gamma: next.gamma * self.alpha + next.delta * self.gamma,
            delta: next.gamma * self.beta + next.delta * self.delta,
        }
    }

    fn determinant(self) -> f64 {
        self.alpha * self.delta - self.beta * self.gamma
    }

    /// The image of a point, none at infinity.
    pub fn point(self, z: Point) -> Option<C64> {
        let (above, below) = match z {
            Point::Finite(z) => (z * self.alpha + self.beta, z * self.gamma + self.delta),
            Point::Infinity => (C64::new(self.alpha, 0.0), C64::new(self.gamma, 0.0)),
        };
        (below.norm() > 0.0).then(|| above / below)
    }

    /// Taylor coefficients in w from those in z − z₀, or in 1/z at infinity: f(κτ/(1 − ρτ)), τ = w − w₀.
    pub fn series(self, z: Point, f: &[CMat]) -> Vec<CMat> {
        let det = self.determinant();
        let (kappa, rho) = match z {
            Point::Finite(z) => {
                let below = z * self.gamma + self.delta;
                (below * below / det, below * (self.gamma / det))
            }
            Point::Infinity => {
                let real = |x| C64::new(x, 0.0);
                (real(-self.gamma * self.gamma / det), real(-self.delta * self.gamma / det))
            }
        };
        f.iter()
            .enumerate()
            .map(|(j, own)| {
                if j == 0 {
                    return own.clone();
                }
                // Σ_l f_l κ^l ρ^{j−l} C(j − 1, l − 1)
                let mut sum = CMat::zeros(own.nrows(), own.ncols());
                let mut binomial = 1.0;
                for l in 1..=j {
                    let factor = kappa.powu(l as u32) * rho.powu((j - l) as u32) * binomial;
                    sum += &f[l] * faer::Scale(factor);
                    binomial *= (j - l) as f64 / l as f64;
                }
                sum
            })
            .collect()
    }

    /// A, B, C, D in z from those in w.
    ///
    /// # Errors
    /// A system with a pole at z = ∞.
    pub fn system_back(self, [a, b, c, d]: [&Mat; 4]) -> Result<[Mat; 4], SubspaceError> {
        let n = a.nrows();
        if n == 0 || self == Self::ONE {
            return Ok([a.clone(), b.clone(), c.clone(), d.clone()]);
        }
        let shifted =
            |x: f64, y: f64| Mat::from_fn(n, n, |i, j| y * a[(i, j)] + if i == j { x } else { 0.0 });
        let e = shifted(self.alpha, -self.gamma);
        let least = singular_values(&e)?.last().copied().unwrap_or(0.0);
        let distance = least / (self.alpha.abs() + self.gamma.abs() * a.norm_l2());
        if !(distance > IMPROPER) {
            return Err(SubspaceError::Improper { order: n, distance });
        }
        // (wI − A)⁻¹ = γE⁻¹ + (γA_z + δI)(zI − A_z)⁻¹E⁻¹, E = αI − γA, A_z = E⁻¹(δA − βI)
        let az = solve(&e, &shifted(-self.beta, self.delta))?;
        let bz = solve(&e, b)?;
        let after =
            Mat::from_fn(n, n, |i, j| self.gamma * az[(i, j)] + if i == j { self.delta } else { 0.0 });
        let dz = d + c * &bz * faer::Scale(self.gamma);
        Ok([az, bz, c * after, dz])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The notes: s = λ(z − 1)/(z + 1) has the Taylor coefficients c_j = −2λ(−1)^j/(z₀ + 1)^{j+1}.
    #[test]
    fn the_series_of_s_is_the_notes() {
        let (lambda, s) = (3.0, C64::new(0.7, 1.9));
        let map = Mobius::to_disk(Domain::HalfPlane { lambda_rad_s: lambda });
        let z = map.point(Point::Finite(s)).unwrap();
        assert!(((z - 1.0) / (z + 1.0) * lambda - s).norm() < 1e-14);
        let one = |x: C64| CMat::from_fn(1, 1, |_, _| x);
        let zero = C64::new(0.0, 0.0);
        let f: Vec<CMat> = [s, C64::new(1.0, 0.0), zero, zero, zero, zero].map(one).into();
        for (j, c) in map.series(Point::Finite(s), &f).iter().enumerate().skip(1) {
            let expected = (z + 1.0).powi(-(j as i32) - 1) * (-2.0 * lambda * (-1f64).powi(j as i32));
            assert!((c[(0, 0)] - expected).norm() < 1e-12 * expected.norm(), "{j}");
        }
        // 1/s at infinity is (z + 1)/(λ(z − 1)): −(z + 1)/(2λ) − (z + 1)²/(4λ) − …
        let f: Vec<CMat> = [zero, C64::new(1.0, 0.0), zero, zero].map(one).into();
        for (j, c) in map.series(Point::Infinity, &f).iter().enumerate().skip(1) {
            assert!((c[(0, 0)].re + 0.5f64.powi(j as i32) / lambda).abs() < 1e-14, "{j}");
        }
    }

    #[test]
    fn a_map_of_systems_is_its_substitution() {
        let any =
            |r, c, s: f64| Mat::from_fn(r, c, |i, j| ((5 * i * i + 7 * j + i * j) as f64 + s).sin() * 0.4);
        let (a, b, c, d) = (any(4, 4, 0.3), any(4, 2, 1.0), any(3, 4, 2.0), any(3, 2, 3.0));
        let g = |[a, b, c, d]: [&Mat; 4], z: C64| {
            crate::lti::StateSpace::discrete(a.clone(), b.clone(), c.clone(), d.clone(), 1.0)
                .and_then(|g| g.at(z))
                .unwrap()
        };
        let map =
            Mobius::to_work(Domain::HalfPlane { lambda_rad_s: 2.0 }, &[Point::Finite(C64::new(2.0, 0.0))]);
        assert!(map.gamma != -1.0 && map.point(Point::Finite(C64::new(2.0, 0.0))).is_some());
        let back = map.system_back([&a, &b, &c, &d]).unwrap();
        let z = C64::new(0.4, 1.8);
        let w = map.point(Point::Finite(z)).unwrap();
        let (x, y) = (g([&a, &b, &c, &d], w), g(back.each_ref(), z));
        assert!(x.nrows() == 3 && (&x - &y).norm_l2() < 1e-12 * x.norm_l2());
    }
}
