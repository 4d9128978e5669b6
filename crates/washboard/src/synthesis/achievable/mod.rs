//! Achievable performance of the quarter car: all stabilising controllers, what every one of them must obey, and designs
//! from a response that obeys it.
//!
//! All of it is exact in the car's decimals ([`RationalFunction`](crate::lti::RationalFunction)); only what is simulated
//! or measured is floating point. Source: Türkay's thesis, chapter 4 and (5.1)–(5.17).

mod approximate;
mod car;
mod closed;
mod constraints;
mod error;
mod hidden;
mod hybrid;
mod log_integral;
mod near_optimal;
mod plant;
mod trade_offs;
mod unimodular;
mod youla;

pub use approximate::{ByTravelAlone, by_travel_alone};
pub use car::{Measurement, QuarterCar, QuarterCarNumbers, Response};
pub use constraints::{Constraint, Constraints, NotAchievable, Proof, Violation};
pub use error::AchievableError;
pub use hidden::{HiddenMode, hidden_modes};
pub use hybrid::{
    Hybrid, HybridAt, HybridCurve, HybridRms, HybridSettings, Psi, hybrid, hybrid_over_tire_damping,
};
pub use log_integral::{LogIntegral, log_integral};
pub use near_optimal::{NearOptimal, Regularisation, near_optimal};
pub use unimodular::{Unimodular, unimodular};
pub use youla::Youla;
