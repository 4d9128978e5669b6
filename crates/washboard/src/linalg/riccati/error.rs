//! Why a Riccati equation has no solution, or none that this module vouches for.

use super::super::dense::{C64, LinalgError};
use thiserror::Error;

/// What [`care`](super::care), [`care_g`](super::care_g) and [`dare`](super::dare) refuse.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum RiccatiError {
    /// A matrix with a wrong shape or with entries that are not finite, a factorisation that did not converge.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// A matrix that must be symmetric is not.
    #[error(
        "{name}: entries ({row}, {col}) and ({col}, {row}) differ by {difference:.2e}, expected a symmetric matrix"
    )]
    Asymmetric {
        /// Which matrix.
        name: &'static str,
        /// Row of the worst entry.
        row: usize,
        /// Its column.
        col: usize,
        /// By how much it differs from its mirror image.
        difference: f64,
    },
    /// R has a negative eigenvalue.
    #[error("R: smallest eigenvalue {eigenvalue:.3e}, expected a positive (semi)definite matrix")]
    IndefiniteR {
        /// The smallest eigenvalue of R.
        eigenvalue: f64,
    },
    /// A continuous-time R is singular: the control (or measurement noise) is not weighted in every direction, which
    /// is no Riccati equation.
    #[error(
        "R: smallest over largest eigenvalue {ratio:.2e}: a singular R in continuous time is no Riccati equation; weight \
         every input (or give every measurement noise)"
    )]
    SingularR {
        /// Smallest over largest eigenvalue.
        ratio: f64,
    },
    /// R + BᵀXB of the discrete equation is singular for every X that the cost can reach.
    #[error(
        "R + BᵀXB: smallest over largest eigenvalue {ratio:.2e}: an input costs nothing and moves nothing"
    )]
    SingularInput {
        /// Smallest over largest eigenvalue.
        ratio: f64,
    },
    /// An unstable eigenvalue of A that the input does not reach.
    #[error(
        "(A, B) is not stabilisable: eigenvalue {} {:+}i is at distance {distance:.2e} of being uncontrollable",
        eigenvalue.re, eigenvalue.im
    )]
    NotStabilisable {
        /// The eigenvalue.
        eigenvalue: C64,
        /// σ_min [A − λI, B], over the norm of [A, B].
        distance: f64,
    },
    /// Eigenvalues of the Hamiltonian matrix lie on the imaginary axis (of the symplectic pencil: on the unit
    /// circle): no solution stabilises.
    #[error(
        "the Hamiltonian has an eigenvalue at distance {distance:.2e} of the stability boundary, at angular frequency {frequency:.3e}"
    )]
    OnTheBoundary {
        /// Continuous: ω in rad/s. Discrete: the angle in rad a sample.
        frequency: f64,
        /// |Re λ| over the Hamiltonian's norm; discrete: ||z| − 1|.
        distance: f64,
    },
    /// The best X found leaves too large a residual, or does not stabilise.
    #[error(
        "no solution is confirmed: scaled residual {scaled_residual:.2e}, worst closed-loop eigenvalue {margin:.2e}"
    )]
    Unconfirmed {
        /// Of the best X that was found.
        scaled_residual: f64,
        /// max Re λ, or max |λ| − 1, of its closed loop.
        margin: f64,
    },
}
