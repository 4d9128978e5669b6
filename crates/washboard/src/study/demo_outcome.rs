//! What `demo` found, as it is written to `result.json`.

use super::{DesignStatus, Flag, IdentifyOutcome, Named, Rms};
use serde::{Deserialize, Serialize};

/// A bound that is exceeded by less than this share is kept: rounding of per cents that people read.
const BEYOND: f64 = 0.005;

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
    /// States of the filter, the low-pass among them where there is one.
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

impl DemoFilter {
    /// `order 1`, with its states where a low-pass adds some.
    #[must_use]
    pub fn order_words(&self) -> String {
        if self.states > self.order {
            format!("order {}, {} states with the low-pass", self.order, self.states)
        } else {
            format!("order {}", self.order)
        }
    }
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

/// A bound of a design, as a multiple of the passive value, and what its own car and filter have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DemoBound {
    /// The output.
    pub name: String,
    /// As the design file has it.
    pub bound: f64,
    /// The H2 norm with the approximated delay, which is what is bounded.
    pub kept: Option<f64>,
    /// The rms with the exact delay.
    pub with_exact_delay: Option<f64>,
}

impl DemoMethod {
    /// All that is to be known before the controller of the identified car is built: what the true car makes of its bounds
    /// (`beyond-bound`), and the design's own warnings.
    #[must_use]
    pub fn warnings(&self, passive: &DemoRide) -> Vec<Flag> {
        let beyond = |text: String| Flag { name: "beyond-bound".to_owned(), text: text + "." };
        let of_bounds = self.beyond_bounds(passive).into_iter().map(beyond);
        of_bounds.chain(self.on_identified.warnings.iter().cloned()).collect()
    }

    /// Why the true car exceeds a bound of the design on the identified one: a sentence a bound that it exceeds.
    #[must_use]
    pub fn beyond_bounds(&self, passive: &DemoRide) -> Vec<String> {
        let c = &self.on_identified;
        let of = |ride: &DemoRide, name: &str| ride.rms.get(name).and_then(|r| r.finite());
        let sentence = |b: &DemoBound| {
            let found = of(c.ride.as_ref()?, &b.name)? / of(passive, &b.name)?;
            if found <= b.bound * (1.0 + BEYOND) {
                return None;
            }
            let (kept, exact) = (b.kept?, b.with_exact_delay?);
            let percent = |v: f64| format!("{:.1} %", 100.0 * v);
            let why = if exact > b.bound * (1.0 + BEYOND) {
                format!(
                    "the same design on its own car has {} with the exact delay: the approximation of the delay is what the bound misses",
                    percent(exact)
                )
            } else {
                format!(
                    "its own car has {} with the exact delay, too: the true car and road are others",
                    percent(exact)
                )
            };
            Some(format!(
                "{}: {} of passive in the true car, where the design bounds it at {:.0} %. The bound is on the norm of the identified car, \
                 whose rear wheels follow by Padé's approximation (order {}) of the delay: there it is {}; {why}",
                b.name.replace('_', " "),
                percent(found),
                100.0 * b.bound,
                c.delay_order,
                percent(kept)
            ))
        };
        c.bounds.iter().filter_map(sentence).collect()
    }
}

/// A controller, and what it does in the true car.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DemoController {
    /// Of its design.
    pub status: DesignStatus,
    /// Why there is none, or why the true car's loop has no answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    /// The design's warnings, and its note of an actuator; of a design on the identified car all that `design` gives.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Flag>,
    /// What the design bounds.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bounds: Vec<DemoBound>,
    /// Order of Padé's approximation of the rear wheels' delay in the plant that it was designed on.
    #[serde(default)]
    pub delay_order: usize,
    /// States.
    pub order: Option<usize>,
    /// The rms that the design itself expected of what it minimises, on its own car and filter, with control over passive.
    pub expected: Option<f64>,
    /// The true car on the true road.
    pub ride: Option<DemoRide>,
}
