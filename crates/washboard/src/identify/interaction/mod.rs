//! The track-vehicle interaction modal model: output spectra and correlations of a vehicle on a road, written in modes.
//!
//! Source: De Filippis, Palmieri, Soria, Mangialardi, *System and source identification from operational vehicle
//! responses*, eqs. (43)–(46) with the errata that change numbers: the tire factors carry λₙ where (A16)–(A21) print λₘ;
//! e^{λₙτ} stands inside the convolution; output factors come from the output coordinates, input factors from the
//! force coordinates; H₀(τ) = δ(τ).

mod classical;
mod correlation;
mod spectrum;

pub use classical::ClassicalModel;
pub use correlation::CorrelationModel;
pub use spectrum::{Delay, InteractionModel, Term};
