//! Linear matrix inequalities as they are written on paper: matrix variables, affine expressions, blocks.

mod expression;
mod program;

pub use expression::{Expr, Variable};
pub use program::{Lmi, LmiSolution};
