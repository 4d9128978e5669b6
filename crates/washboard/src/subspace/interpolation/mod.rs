//! Lagrange–Sylvester interpolation: the rational matrix function of least order through values and derivatives.
//!
//! Data are carried to a plane where no node is at infinity ([`plane`]), written as conditions on Taylor coefficients
//! ([`conditions`]), freed of what any input could explain ([`projection`]), and read off as A, C, then B, D ([`realise`]).

mod agreement;
mod basis;
mod conditions;
mod data;
mod evaluate;
mod interpolate;
mod loewner;
mod pick;
mod plane;
mod polish;
mod printed;
mod projection;
mod realise;
mod response;

pub use data::{Domain, InterpolationData, Node, Point, Side};
pub use evaluate::Realisation;
pub use interpolate::{Interpolant, interpolate};
pub use loewner::loewner;
pub use pick::{Bounded, interpolate_bounded};
pub use printed::{PrintedForm, PrintedSteps, printed_steps, projected_singular_values};
pub use response::{Measured, fit_response};
