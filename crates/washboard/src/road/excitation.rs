//! What drives a vehicle: a road of tracks under its wheels, or the joint filter of all its road inputs.

use super::under_wheels::{wheel_spectrum, wheel_spectrum_without_delayed};
use super::{MatrixFilter, Road, Shapes};
use crate::linalg::{CMat, Mat, eigen};

/// A road of tracks, or the filter of all road inputs at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation<'a> {
    /// One spectrum, a coherence, and delays from places and speed.
    Road(&'a Road),
    /// A spectrum matrix of the road inputs themselves, in the vehicle's order: no coherence and no delay is added.
    Points(&'a MatrixFilter),
}

impl<'a> From<&'a Road> for Excitation<'a> {
    fn from(road: &'a Road) -> Self {
        Excitation::Road(road)
    }
}

impl<'a> From<&'a MatrixFilter> for Excitation<'a> {
    fn from(filter: &'a MatrixFilter) -> Self {
        Excitation::Points(filter)
    }
}

/// ẋ = A x + B ξ, C x + D ξ: heights or velocities of all wheels, from independent white noises of unit intensity.
pub(crate) struct WheelFilter {
    pub a: Mat,
    pub b: Mat,
    pub c: Mat,
    pub d: Mat,
    pub of: Shapes,
}

impl WheelFilter {
    /// The same with one wheel moving alone.
    pub fn of_wheel(&self, wheel: usize) -> Self {
        let only =
            |m: &Mat| Mat::from_fn(m.nrows(), m.ncols(), |i, j| if i == wheel { m[(i, j)] } else { 0.0 });
        WheelFilter { a: self.a.clone(), b: self.b.clone(), c: only(&self.c), d: only(&self.d), of: self.of }
    }
}

impl<'a> Excitation<'a> {
    /// The road of tracks, where it is one.
    #[must_use]
    pub fn road(self) -> Option<&'a Road> {
        match self {
            Excitation::Road(road) => Some(road),
            Excitation::Points(_) => None,
        }
    }

    /// W in m²/s where the velocity under every wheel is white.
    #[must_use]
    pub fn white_intensity(self, speed_m_s: f64) -> Option<f64> {
        self.road().and_then(|r| r.spectrum().white_intensity(speed_m_s))
    }

    /// The spectrum matrix of heights under wheels at places, S_ij = E\[r_i* r_j\], two-sided.
    #[must_use]
    pub fn spectrum(self, at_m: &[[f64; 2]], omega_rad_s: f64, speed_m_s: f64) -> CMat {
        match self {
            Excitation::Road(road) => wheel_spectrum(road, at_m, omega_rad_s, speed_m_s),
            Excitation::Points(filter) => of_points(filter, omega_rad_s, speed_m_s),
        }
    }

    /// [`Excitation::spectrum`] without what is delayed, as an average over many periods of the delays sees it.
    pub(crate) fn spectrum_averaged(self, at_m: &[[f64; 2]], omega_rad_s: f64, speed_m_s: f64) -> CMat {
        match self {
            Excitation::Road(road) => wheel_spectrum_without_delayed(road, at_m, omega_rad_s, speed_m_s),
            Excitation::Points(filter) => of_points(filter, omega_rad_s, speed_m_s),
        }
    }

    /// The band of ω outside which it is zero.
    #[must_use]
    pub fn band_rad_s(self, speed_m_s: f64) -> [f64; 2] {
        match self {
            Excitation::Road(road) => road.spectrum().band_rad_s(speed_m_s),
            Excitation::Points(_) => [0.0, f64::INFINITY],
        }
    }

    /// Frequencies at which it bends, rad/s.
    pub(crate) fn corners_rad_s(self, speed_m_s: f64) -> Vec<f64> {
        match self {
            Excitation::Road(road) => road.spectrum().corners_rad_s(speed_m_s),
            Excitation::Points(filter) => {
                let scale = if filter.is_over_distance() { speed_m_s } else { 1.0 };
                let poles = eigen(filter.system().a()).map(|(poles, _)| poles).unwrap_or_default();
                poles.iter().map(|p| p.norm() * scale).collect()
            }
        }
    }

    /// The rational filter of all wheels over time, where there is one: of a road of tracks every wheel's own, driven by its
    /// own noise (which of these are one is said by coherence and delays).
    pub(crate) fn wheel_filter(self, wheels: usize, speed_m_s: f64) -> Option<WheelFilter> {
        match self {
            Excitation::Road(road) => {
                let f = road.spectrum().shaping_filter(speed_m_s)?;
                let n = f.a().nrows();
                let own = |i: usize, j: usize| (i / n == j / n).then_some((i % n, j % n));
                Some(WheelFilter {
                    a: Mat::from_fn(wheels * n, wheels * n, |i, j| own(i, j).map_or(0.0, |at| f.a()[at])),
                    b: Mat::from_fn(wheels * n, wheels, |i, j| if i / n == j { f.b()[i % n] } else { 0.0 }),
                    c: Mat::from_fn(wheels, wheels * n, |i, j| if j / n == i { f.c()[j % n] } else { 0.0 }),
                    d: Mat::from_fn(wheels, wheels, |i, j| if i == j { f.d() } else { 0.0 }),
                    of: f.of(),
                })
            }
            Excitation::Points(filter) => {
                let f = filter.over_time(speed_m_s).ok()?.as_height();
                let g = f.system();
                Some(WheelFilter {
                    a: g.a().clone(),
                    b: g.b().clone(),
                    c: g.c().clone(),
                    d: g.d().clone(),
                    of: f.of(),
                })
            }
        }
    }
}

fn of_points(filter: &MatrixFilter, omega_rad_s: f64, speed_m_s: f64) -> CMat {
    let nan = || CMat::from_fn(filter.size(), filter.size(), |_, _| crate::linalg::C64::new(f64::NAN, 0.0));
    filter.over_time(speed_m_s).map_or_else(|_| nan(), |f| f.height_spectrum(omega_rad_s))
}
