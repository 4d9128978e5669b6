//! The jobs as data: a specification goes in, an outcome comes out, both serialisable.

mod identify_outcome;

pub use identify_outcome::*;

/// The version of every `result.json`.
pub const SCHEMA_VERSION: u32 = 1;
