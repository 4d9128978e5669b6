//! Linear algebra: faer's factorisations behind the few names the other layers use, and what control needs that
//! faer lacks.

mod blocked;
mod dense;
mod expm;
mod lyapunov;
mod quadrature;
mod quasi_triangular;
mod riccati;
mod schur;
pub(crate) mod small;
#[cfg(test)]
mod test_matrices;
mod tiny;

pub(crate) use dense::check_finite;
pub use dense::{C64, CMat, LinalgError, Mat, eigen, solve, solve_complex, symmetric_eigenvalues};
pub use expm::expm;
pub use lyapunov::{EquationSolution, discrete_lyapunov, lyapunov, sylvester};
pub use quadrature::{Integral, integrate};
pub use riccati::{RiccatiError, RiccatiSolution, care, care_g, dare};
pub use schur::RealSchur;
