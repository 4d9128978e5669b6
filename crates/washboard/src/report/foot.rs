//! How to read the numbers, and whose methods they are.

use super::html::{Html, element, note};
use crate::study::{IdentifyOutcome, SCHEMA_VERSION};

/// Conventions, sources, version of the schema.
pub(super) fn foot(outcome: &IdentifyOutcome) -> Html {
    let mut conventions = vec![
        "± is one standard deviation; an interval is 95 %, 1.96 standard deviations either side.",
        "Spectra of channels are one-sided per Hz: their integral over frequency is the variance.",
        "f = |λ|/2π is the undamped frequency of the pole λ; its peak in a spectrum lies lower, and in a hub’s \
         acceleration higher.",
        "Phases are of S₁₂ = E[X₁* X₂]: a second channel that comes later has a falling phase.",
    ];
    let mut sources = Vec::new();
    if outcome.road.is_some() {
        conventions.push(
            "The road’s class is judged on its one-sided density per rad/m at 1 rad/m (ISO 8608’s G_d(Ω)).",
        );
        sources.push("ISO 8608, Mechanical vibration – Road surface profiles – Reporting of measured data");
    }
    if outcome.fit.is_some() {
        conventions.push(
            "χ = n_avg · mean|L⁻¹ŜL⁻ᴴ − I|² with the model’s S = LLᴴ and the measured Ŝ: about 0.4 for a model that \
             explains the data, above 0.6 for one that does not.",
        );
    }
    if outcome.fit.is_some() || outcome.coherence.is_some() {
        sources.push(
            "De Filippis, Palmieri, Soria, Mangialardi, System and source identification from operational vehicle \
             responses: A novel modal model accounting for the track-vehicle interaction",
        );
    }
    if outcome.coherence.is_some() {
        sources.push(
            "Bogsjö, Coherence of road roughness in left and right wheel-path, Vehicle System Dynamics 46 (S1) (2008) \
             599–609",
        );
    }
    if !outcome.stabilization.is_empty() {
        sources.push(
            "Peeters, De Roeck, Reference-based stochastic subspace identification for output-only modal analysis, \
             Mechanical Systems and Signal Processing 13 (1999) 855–878",
        );
    }
    sources.push(
        "Welch, The use of fast Fourier transform for the estimation of power spectra, IEEE Transactions on Audio and \
         Electroacoustics 15 (1967) 70–73",
    );
    let list = |items: Vec<&str>| -> Html {
        element("ul", &[], items.into_iter().map(|i| element("li", &[], i)).collect::<Html>())
    };
    let inside = element("h2", &[], "How to read this")
        .and(list(conventions))
        .and(element("h3", &[], "Sources"))
        .and(list(sources))
        .and(note(format!(
            "Made by washboard from result.json (schema version {SCHEMA_VERSION}) alone. Plots by uPlot, © Leon Sorokin, \
             MIT licence."
        )));
    element("footer", &[("id", "reading")], inside)
}
