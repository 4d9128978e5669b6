//! How a shaping filter is fitted: its order, what becomes of feedthrough, how noisy samples are.

use super::{Order, Unpaired, Weights};

/// How noisy samples are.
#[derive(Debug, Clone, PartialEq)]
pub enum ShapeWeights {
    /// All alike: the largest densities count.
    Equal,
    /// R_k = S_k.
    Relative,
    /// R_k = S_k²: errors of the logarithm.
    RelativeSquared,
    /// R_k = L_k or, `squared`, L_k² of densities L that stand in for the samples, as means of their neighbours do.
    Like {
        /// L_k.
        level: Vec<f64>,
        /// Errors of the logarithm.
        squared: bool,
    },
    /// Given.
    Given(Weights),
}

/// How a shaping filter is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeSettings {
    /// n.
    pub order: Order,
    /// p; none takes half of what the samples allow, 64 at most.
    pub block_rows: Option<usize>,
    /// Rows beyond the least that the order asks for, in place of half of what the samples allow: few rows average noise better.
    pub spare_rows: Option<usize>,
    /// λ of s = λ(z − 1)/(z + 1); none takes the geometric mean of the lowest and the highest frequency.
    pub lambda_rad: Option<f64>,
    /// R_k.
    pub weights: ShapeWeights,
    /// What is done with poles that have no mirror image.
    pub unpaired: Unpaired,
    /// ω_r of a factor ω_r/(s + ω_r) that makes a filter with feedthrough strictly proper; none leaves it.
    pub roll_off_rad: Option<f64>,
}

impl ShapeSettings {
    /// A given order, all else by itself.
    #[must_use]
    pub fn new(order: usize) -> Self {
        ShapeSettings {
            order: Order::Given(order),
            block_rows: None,
            spare_rows: None,
            lambda_rad: None,
            weights: ShapeWeights::RelativeSquared,
            unpaired: Unpaired::Fold,
            roll_off_rad: None,
        }
    }
}
