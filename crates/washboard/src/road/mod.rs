//! Roads: the spectrum of one track, the coherence of parallel tracks, and both under the wheels of a moving vehicle.

mod coherence;
mod excitation;
mod filter;
mod matrix_filter;
mod matrix_filter_file;
mod measured;
mod profile;
mod spec;
mod spec_build;
mod spec_table;
mod spectrum;
mod under_wheels;

pub use coherence::Coherence;
pub use excitation::Excitation;
pub(crate) use excitation::WheelFilter;
pub use filter::{Shapes, ShapingFilter};
pub use matrix_filter::MatrixFilter;
pub use matrix_filter_file::{MatrixFilterKind, MatrixFilterSpec};
pub(crate) use measured::detrended;
pub use measured::{MeasuredSpectrum, spectrum_of_profile};
pub use profile::{ProfileSettings, random_profile};
pub use spec::{CoherenceKind, CoherenceSpec, FilterOutput, FilterVariable, RoadKind, RoadSpec};
pub use spectrum::{IsoClass, Spectrum};
pub use under_wheels::{SAME_TRACK_M, wheel_spectrum};

use thiserror::Error;

/// What is refused of a road.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum RoadError {
    /// A field has a value that it cannot have.
    #[error("{field}: expected {expected}, found {found}")]
    Field {
        /// The field, as it is written in a road file.
        field: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// A field does not belong to this kind of road.
    #[error("{field}: not a field of a road of kind `{kind}`; its fields are {allowed}")]
    Stray {
        /// The field.
        field: String,
        /// The kind of road.
        kind: &'static str,
        /// What may stand there.
        allowed: String,
    },
}

/// A road: the spectrum of one track, and how parallel tracks are related.
///
/// The tracks are one homogeneous Gaussian random field (De Filippis et al., section 2.2): every track has the same
/// spectrum, and the cross-spectrum of two is Γ S.
#[derive(Debug, Clone, PartialEq)]
pub struct Road {
    spectrum: Spectrum,
    coherence: Coherence,
}

impl Road {
    /// A road of a spectrum and a coherence; both are valid by construction.
    #[must_use]
    pub fn new(spectrum: Spectrum, coherence: Coherence) -> Self {
        Road { spectrum, coherence }
    }

    /// The spectrum of one track.
    #[must_use]
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// The relation of parallel tracks.
    #[must_use]
    pub fn coherence(&self) -> &Coherence {
        &self.coherence
    }

    /// The same spectrum with another coherence.
    #[must_use]
    pub fn with_coherence(&self, coherence: Coherence) -> Self {
        Road { spectrum: self.spectrum.clone(), coherence }
    }
}
