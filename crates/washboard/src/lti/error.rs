//! What is refused of systems and of what is asked about them.

use crate::linalg::{C64, LinalgError};
use thiserror::Error;

/// A wrong call, or an assumption that a system breaks.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum LtiError {
    /// A matrix has the wrong shape.
    #[error("{name}: expected shape {expected:?}, found {found:?}")]
    Shape {
        /// Which matrix.
        name: &'static str,
        /// Rows and columns that were expected.
        expected: (usize, usize),
        /// Rows and columns that were given.
        found: (usize, usize),
    },
    /// Two systems can't be joined.
    #[error("{what}: expected {expected}, found {found}")]
    Join {
        /// What is joined.
        what: &'static str,
        /// What was expected.
        expected: String,
        /// What was found.
        found: String,
    },
    /// A loop has no unique signals: I − D₁D₂ is singular.
    #[error("{what} is not well posed: its direct feedthrough loop has reciprocal condition {rcond:e}")]
    IllPosed {
        /// Which loop.
        what: &'static str,
        /// Reciprocal condition number of I − D₁D₂.
        rcond: f64,
    },
    /// A pole that is not stable, where stability is needed.
    #[error("{what} needs a stable system; a pole is at {} {:+}i, {margin:e} inside the stable region", pole.re, pole.im)]
    NotStable {
        /// What was asked.
        what: &'static str,
        /// The worst pole.
        pole: C64,
        /// −Re λ, or 1 − |λ|.
        margin: f64,
    },
    /// Feedthrough where none may be.
    #[error("{what} is infinite: the direct feedthrough D has norm {norm:e}, expected 0")]
    NotStrictlyProper {
        /// What was asked.
        what: &'static str,
        /// ‖D‖.
        norm: f64,
    },
    /// A signal of no such name.
    #[error("no {what} `{name}`{}; there are {known}", suggestion.as_ref().map(|s| format!(" (did you mean `{s}`?)")).unwrap_or_default())]
    Unknown {
        /// Disturbance, control, performance or measurement.
        what: &'static str,
        /// The name.
        name: String,
        /// The nearest known one.
        suggestion: Option<String>,
        /// All known ones.
        known: String,
    },
    /// A number outside what it may be.
    #[error("{field}: expected {expected}, found {found}")]
    Field {
        /// Which number.
        field: &'static str,
        /// What was expected.
        expected: &'static str,
        /// What was found.
        found: f64,
    },
    /// Linear algebra refused.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}
