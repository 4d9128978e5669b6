//! Subspace identification: rational models of power spectra and of analytic functions from samples at any frequencies;
//! interpolation of values and derivatives.

mod analytic;
mod error;
mod factor;
mod interpolation;
mod poles;
mod positivity;
mod range;
mod samples;
mod shape;
mod shape_settings;
mod spectrum;
mod spectrum_settings;
mod summand;
mod toeplitz;

pub use analytic::{AnalyticModel, AnalyticSettings, Part, fit_analytic, magnitude_of_phase};
pub use error::SubspaceError;
pub use factor::{SpectralFactor, spectral_factor};
pub use interpolation::{
    Bounded, Domain, Interpolant, InterpolationData, Measured, Node, Point, PrintedForm, PrintedSteps,
    Realisation, Side, fit_response, interpolate, interpolate_bounded, loewner, printed_steps,
    projected_singular_values,
};
pub use positivity::Repair;
pub use range::Route;
pub use samples::{Samples, Weights};
pub(crate) use shape::log10_errors;
pub use shape::{ShapeFit, ShapeProblem, fit_shape};
pub use shape_settings::{ShapeSettings, ShapeWeights};
pub use spectrum::{SpectrumModel, fit_spectrum};
pub use spectrum_settings::{Order, OrderTried, SpectrumSettings, Unpaired};
pub use summand::Summand;
