//! Linear algebra: faer's factorisations behind the few names the other layers use, and what control needs that
//! faer lacks.

mod block_diagonal;
mod blocked;
mod dense;
mod expm;
mod factored;
mod least_distance;
mod lyapunov;
mod quadrature;
mod quasi_triangular;
mod rank;
mod riccati;
mod schur;
pub(crate) mod small;
#[cfg(test)]
mod test_matrices;
mod tiny;

pub use block_diagonal::{BlockDiagonal, block_diagonalize};
pub(crate) use dense::check_finite;
pub use dense::{C64, CMat, LinalgError, Mat, eigen, solve, solve_complex, symmetric_eigenvalues};
pub use expm::expm;
pub use factored::{discrete_lyapunov_factor, lyapunov_factor};
pub use least_distance::{least_distance, least_distance_from, nonnegative_least_squares};
pub use lyapunov::{EquationSolution, discrete_lyapunov, lyapunov, sylvester};
pub use quadrature::{Integral, integrate};
pub use rank::{condition_estimate, rank, singular_values};
pub use riccati::{RiccatiError, RiccatiSolution, care, care_g, care_of_output, dare};
pub use schur::RealSchur;
