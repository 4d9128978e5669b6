//! washboard turns what a vehicle feels into what its suspension should do.

pub mod cases;
pub mod files;
pub mod identify;
pub mod linalg;
pub mod lti;
pub mod report;
pub mod road;
pub mod signal;
pub mod study;
pub mod units;
pub mod vehicle;
