//! Linear time-invariant systems: mechanical systems M q̈ + C q̇ + K q = f, their modes and their modal form.

mod first_order;
mod mechanics;
mod modal;
mod modes;
mod wheeled;

pub use first_order::FirstOrder;
pub use mechanics::{MechanicsError, SecondOrder};
pub use modal::ModalForm;
pub use modes::{Mode, ModeKind, modes};
pub use wheeled::{Parametric, WheeledSystem};
