//! Identification of vehicles and roads from responses alone.

pub mod interaction;
