//! What `demo` found, as it is written to `result.json`.

use super::{DesignStatus, IdentifyOutcome, Named, Rms};
use serde::{Deserialize, Serialize};

/// The result of `demo`: the keys of `identify` with its `truth`, and what was made of it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DemoOutcome {
    /// What the drive showed.
    #[serde(flatten)]
    pub identified: IdentifyOutcome,
    /// The designs; none where the identification did not converge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub designs: Option<DemoDesigns>,
}

/// Designs on what was identified beside those on the truth, all on the true car.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DemoDesigns {
    /// Forward speed.
    pub speed_m_s: f64,
    /// The filter of the identified road.
    pub filter: DemoFilter,
    /// The filter of the true road, in the same way.
    pub true_filter: DemoFilter,
    /// The true car without control.
    pub passive: DemoRide,
    /// A pair a method.
    pub methods: Vec<DemoMethod>,
    /// Units of the rms.
    pub units: Named<String>,
    /// Of the spectra, Hz.
    pub freq_hz: Vec<f64>,
}

/// A road's shaping filter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DemoFilter {
    /// n of the fit.
    pub order: usize,
    /// States of the filter, the low-pass among them.
    pub states: usize,
    /// As \[re, im\], rad/m.
    pub poles: Vec<[f64; 2]>,
    /// Where the identification saw the road.
    pub band_rad_per_m: [f64; 2],
    /// The law that was fitted is rounded below this.
    pub rounded_below_rad_per_m: f64,
    /// Root mean square of log₁₀ of the filter's density over the road's own law in the band, the rounding in it.
    pub log10_rms_error: f64,
    /// The largest one's magnitude.
    pub log10_max_error: f64,
    /// rad/m.
    pub nu_rad_per_m: Vec<f64>,
    /// The road's law, two-sided with var = (1/2π) ∫ S.
    pub given: Vec<f64>,
    /// The filter's.
    pub fitted: Vec<f64>,
}

/// The true car on the true road.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DemoRide {
    /// Every output and stacked vector, delays and coherence exact.
    pub rms: Named<Rms>,
    /// Largest gains from the white noise behind the true road's filter.
    pub hinf: Named<f64>,
    /// One-sided spectra of a few outputs, unit²/Hz.
    pub psd: Named<Vec<f64>>,
}

/// One method of design, twice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DemoMethod {
    /// `lmi`, `fixed-order`: of its files, too.
    pub name: String,
    /// For a reader.
    pub title: String,
    /// As a design file calls it.
    pub method: String,
    /// Of the goal, whose rms is to be small.
    pub minimized: String,
    /// On identified car and road.
    pub on_identified: DemoController,
    /// On true car and road.
    pub on_true: DemoController,
    /// rms of the first over that of the second on the true car, less 1, where both are finite.
    pub difference: Named<f64>,
}

/// A controller, and what it does in the true car.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DemoController {
    /// Of its design.
    pub status: DesignStatus,
    /// Why there is none, or why the true car's loop has no answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    /// Names of the design's warnings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// States.
    pub order: Option<usize>,
    /// The rms that the design itself expected of what it minimises, on its own car and filter, with control over passive.
    pub expected: Option<f64>,
    /// The true car on the true road.
    pub ride: Option<DemoRide>,
}
