//! Subspace identification: rational models of power spectra and of analytic functions from samples at any frequencies.

mod analytic;
mod error;
mod factor;
mod positivity;
mod range;
mod samples;
mod shape;
mod spectrum;
mod summand;
mod toeplitz;

pub use analytic::{AnalyticModel, AnalyticSettings, Part, fit_analytic, magnitude_of_phase};
pub use error::SubspaceError;
pub use factor::{SpectralFactor, spectral_factor};
pub use positivity::Repair;
pub use range::Route;
pub use samples::{Samples, Weights};
pub use shape::{ShapeFit, ShapeSettings, ShapeWeights, fit_shape};
pub use spectrum::{Order, OrderTried, SpectrumModel, SpectrumSettings, Unpaired, fit_spectrum};
pub use summand::Summand;
