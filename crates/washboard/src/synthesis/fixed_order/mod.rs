//! Controllers of given order and structure: H∞, H2 and decay over any channels of any number of plants, minimised under
//! bounds by a bundle method.

mod asked;
mod closed;
mod design;
mod eigenvalues;
mod full_order;
mod h2_norm;
mod hessenberg;
mod outcome;
mod peaks;
mod pieces;
mod problem;
mod resolvent;
mod restored;
mod scales;
mod search;
mod settled;
mod starts;
mod structure;
mod targets;
#[cfg(test)]
mod tests;
mod verify;

pub use asked::{FixedOrder, FixedOrderSettings};
pub use design::fixed_order;
pub use outcome::{FixedOrderDesign, FixedOrderEnd, FixedOrderWork, TargetValue};
pub use structure::{Entry, Local, Structure};
pub use targets::{Aim, Channel, Measure, Target};
