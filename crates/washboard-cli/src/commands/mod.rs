//! The commands, one a file: arguments, a call of the library, a table.

pub mod cases;
pub mod compare;
pub mod damping;
pub mod demo;
pub mod design;
pub mod identify;
pub mod interpolate;
pub mod merge;
pub mod modes;
pub mod report;
pub mod reproduce;
pub mod respond;
pub mod ride;
pub mod road;
pub mod simulate;
pub mod sweep;
