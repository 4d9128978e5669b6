//! Controllers from plants: regulators and filters, H2 and H∞ designs, what no controller can beat, and certificates.
//!
//! A plant is a [`GeneralizedPlant`](crate::lti::GeneralizedPlant); nothing here knows of vehicles
//! ([`achievable`] has a quarter car of its own, exact and in polynomials). The control law is
//! u = +K y everywhere.

pub mod achievable;
mod assumptions;
mod certificate;
mod error;
mod fixed_order;
mod h2;
mod h2_limit;
mod hinf;
mod lqr;
mod mixed;
mod near_limit;
mod pointwise_bound;

pub use assumptions::{Assumption, BrokenAssumption, broken_assumptions};
pub use certificate::{Certificate, ChannelNorms};
pub use error::SynthesisError;
pub use fixed_order::{
    Aim, Channel, Entry, FixedOrder, FixedOrderDesign, FixedOrderEnd, FixedOrderSettings, FixedOrderWork,
    Local, Measure, Structure, Target, TargetValue, fixed_order,
};
pub use h2::{H2Design, LqgWeights, h2, lqg, lqg_plant};
pub use h2_limit::{H2Limit, full_information, h2_limit};
pub use hinf::{HinfDesign, HinfSettings, hinf};
pub use lqr::{Filter, Regulator, kalman, kalman_of_input, lqr, lqr_of_output};
pub use mixed::{
    H2Goal, HinfGoal, LyapunovScale, MixedAchieved, MixedClaims, MixedController, MixedEnd, MixedGoals,
    PoleRegion, StateFeedback, mixed_h2_hinf, robust_state_feedback,
};
pub use near_limit::{NearLimit, NearLimitEnd, NearLimitStep, near_limit};
pub use pointwise_bound::{PointwiseBound, PointwiseLevel, pointwise_bound};
