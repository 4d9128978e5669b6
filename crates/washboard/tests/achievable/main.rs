//! Achievable performance of the quarter car: the thesis's chapter 4, exactly.

#![allow(clippy::unwrap_used)]

mod cars;
mod constraints;
mod hybrid;
mod interpolation;
mod near_optimal;
mod parametrisation;
mod trade_offs;
