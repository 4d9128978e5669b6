//! Linear time-invariant systems: mechanical systems M q̈ + C q̇ + K q = f, their modes and their modal form.

mod mechanics;
mod modal;
mod modes;

pub use mechanics::{MechanicsError, SecondOrder};
pub use modal::ModalForm;
pub use modes::{Mode, ModeKind, modes};
