//! washboard turns what a vehicle feels into what its suspension should do.

pub mod files;
pub mod identify;
pub mod linalg;
pub mod signal;
pub mod units;
