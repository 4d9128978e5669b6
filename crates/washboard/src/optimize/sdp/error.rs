//! What a semidefinite program refuses before it is solved.

use thiserror::Error;

/// A program that is none.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum SdpError {
    /// A number is NaN or infinite.
    #[error("{what} is {value}, expected a finite number")]
    NotFinite {
        /// Which number.
        what: String,
        /// The number.
        value: f64,
    },
    /// A matrix or an index does not fit.
    #[error("{what}: expected {expected}, found {found}")]
    Shape {
        /// What does not fit.
        what: String,
        /// What was expected.
        expected: String,
        /// What was given.
        found: String,
    },
    /// The program has no variable or no inequality.
    #[error(
        "a semidefinite program needs at least one variable and one inequality, found {variables} and {blocks}"
    )]
    Empty {
        /// Variables.
        variables: usize,
        /// Inequalities.
        blocks: usize,
    },
}
