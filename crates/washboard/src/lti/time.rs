//! Continuous and discrete time: where the axis of frequencies lies, and what is stable.

use crate::linalg::C64;
use std::fmt::Debug;

/// ẋ = A x + B u.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Continuous;

/// x⁺ = A x + B u, a step of `dt_s` seconds later.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrete {
    /// The step, s.
    pub dt_s: f64,
}

/// The time that a system lives in.
pub trait Time: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// The point of the complex plane where a frequency is looked at: iω, or e^{iω dt}.
    fn point(self, omega_rad_s: f64) -> C64;
    /// How far inside the stable region a pole lies: −Re λ, or 1 − |λ|; negative outside.
    fn margin(self, pole: C64) -> f64;
    /// Where a pole's peak lies on the axis of frequencies, and half its width, both in rad/s.
    fn peak(self, pole: C64) -> (f64, f64);
    /// The point at infinite frequency: none, or −1.
    fn last_point(self) -> Option<C64>;
}

impl Time for Continuous {
    fn point(self, omega_rad_s: f64) -> C64 {
        C64::new(0.0, omega_rad_s)
    }

    fn margin(self, pole: C64) -> f64 {
        -pole.re
    }

    fn peak(self, pole: C64) -> (f64, f64) {
        let square = (pole.im - pole.re) * (pole.im + pole.re);
        (if square > 0.0 { square.sqrt() } else { pole.norm() }, pole.re.abs())
    }

    fn last_point(self) -> Option<C64> {
        None
    }
}

impl Time for Discrete {
    fn point(self, omega_rad_s: f64) -> C64 {
        let (sin, cos) = (omega_rad_s * self.dt_s).sin_cos();
        C64::new(cos, sin)
    }

    fn margin(self, pole: C64) -> f64 {
        1.0 - pole.norm()
    }

    fn peak(self, pole: C64) -> (f64, f64) {
        (pole.arg().abs() / self.dt_s, (1.0 - pole.norm()).abs() / self.dt_s)
    }

    fn last_point(self) -> Option<C64> {
        Some(C64::new(-1.0, 0.0))
    }
}
