//! Linear algebra: faer's factorisations behind the few names the other layers use, and what control needs that
//! faer lacks.

mod dense;

pub(crate) use dense::check_finite;
pub use dense::{C64, CMat, LinalgError, Mat, eigen, solve, solve_complex, symmetric_eigenvalues};
