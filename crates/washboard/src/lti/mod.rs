//! Linear time-invariant systems: state space in continuous and discrete time, connections, generalised plants;
//! mechanical systems M q̈ + C q̇ + K q = f, their modes and their modal form.

mod balance;
mod bilinear;
pub(crate) mod connect;
mod error;
mod first_order;
mod frequency;
mod mechanics;
mod modal;
mod modes;
pub(crate) mod norms;
mod pade;
mod plant;
pub(crate) mod rational;
mod reduce;
mod state_space;
mod time;
mod time_response;
mod wheeled;
mod zeros;

pub(crate) use connect::{blocks, cut};
pub use error::LtiError;
pub use first_order::FirstOrder;
pub use frequency::Responder;
pub use mechanics::{MechanicsError, SecondOrder};
pub use modal::ModalForm;
pub use modes::{Mode, ModeKind, modes};
pub use norms::HinfNorm;
pub use pade::pade_delay;
pub use plant::{GeneralizedPlant, Signals};
pub use rational::{Polynomial, Rational, RationalError, RationalFunction, decimal, exact_bits, to_f64};
pub use reduce::Reduced;
pub use state_space::StateSpace;
pub use time::{Continuous, Discrete, Time};
pub use time_response::Hold;
pub use wheeled::{Parametric, StartedAt, WheeledSystem};
