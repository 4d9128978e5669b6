//! Mixed H2/H∞ designs by linear matrix inequalities.

mod feedthrough;
mod goals;
mod inequalities;
mod output_feedback;
mod parts;
mod regions;
mod scale;
mod state_feedback;
mod verify;

pub use goals::{H2Goal, HinfGoal, LyapunovScale, MixedGoals, PoleRegion};
pub use output_feedback::{MixedController, mixed_h2_hinf};
pub use state_feedback::{MixedClaims, MixedEnd, StateFeedback, robust_state_feedback};
pub use verify::MixedAchieved;
