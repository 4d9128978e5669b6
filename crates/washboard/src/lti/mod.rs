//! Linear time-invariant systems: state space in continuous and discrete time, connections, generalised plants;
//! mechanical systems M q̈ + C q̇ + K q = f, their modes and their modal form.

mod connect;
mod error;
mod first_order;
mod frequency;
mod mechanics;
mod modal;
mod modes;
mod plant;
mod state_space;
mod time;
mod wheeled;

pub use error::LtiError;
pub use first_order::FirstOrder;
pub use frequency::Responder;
pub use mechanics::{MechanicsError, SecondOrder};
pub use modal::ModalForm;
pub use modes::{Mode, ModeKind, modes};
pub use plant::{GeneralizedPlant, Signals};
pub use state_space::StateSpace;
pub use time::{Continuous, Discrete, Time};
pub use wheeled::{Parametric, StartedAt, WheeledSystem};
