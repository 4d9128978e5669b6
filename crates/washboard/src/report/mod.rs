//! Offline pages from outcomes alone: one file that fetches nothing, for a screen, a telephone or paper.

mod argand;
mod compare;
mod demo;
mod demo_picture;
mod design;
mod design_bode;
mod design_gains;
mod design_metrics;
mod design_poles;
mod design_responses;
mod design_robustness;
mod design_sketch;
mod design_tables;
mod design_targets;
mod figure;
mod fit;
mod foot;
mod headline;
mod html;
mod mac;
mod modes;
mod numbers;
mod page;
mod plot;
mod recording;
mod rejected;
mod reproduce;
mod road;
mod runs;
mod scene;
mod shapes;
mod sketch_parts;
mod sketch_views;
mod spectra;
mod stabilization;
mod sweep;
mod sweep_chart;
mod sweep_detail;
mod sweep_keys;
mod sweep_parallel;
mod tried;
mod truth;

#[cfg(test)]
mod fixture;

use crate::study::IdentifyOutcome;
pub use compare::compare_page;
pub use demo::demo_page;
pub use demo_picture::demo_svg;
pub use design::design_page;
pub use figure::figure_svg;
pub use reproduce::reproduce_page;
pub use sweep::sweep_page;

use html::Html;
use page::{Page, Section};
use plot::Plots;

/// The body of a section; none where the outcome has nothing to show in it.
type Draw = fn(&IdentifyOutcome, &mut Plots) -> Option<Html>;

/// Anchor, heading and body of each section, in the order of the page.
const SECTIONS: &[(&str, &str, Draw)] = &[
    ("truth", "What we knew, what we found", truth::comparison),
    ("modes", "Modes", modes::modes),
    ("shapes", "Shapes in motion", shapes::shapes),
    ("mac", "Likeness of the shapes", mac::mac),
    ("runs", "Each recording by itself", runs::runs),
    ("spectra", "Spectra", spectra::auto),
    ("cross", "Cross-spectra", spectra::cross),
    ("lines", "Spectral lines", rejected::lines),
    ("road", "Road", road::spectrum),
    ("tracks", "Coherence of the tracks", road::tracks),
    ("fit", "Quality of the fit", fit::residual),
    ("tried", "What was tried", tried::tried),
    ("parameters", "Parameters", fit::parameters),
    ("stabilization", "Stabilisation", stabilization::diagram),
    ("rejected", "Found and left out", rejected::rejected),
    ("recording", "Recording", recording::recording),
];

/// The page of an identification: the whole `report.html`, the same bytes for the same outcome.
///
/// Everything is inside: it fetches nothing, and a content security policy forbids that it could. Names from files are
/// escaped, in the markup and in the data of the plots. Sections with nothing to show are left out. Without JavaScript
/// the tables are all there and only the plots are missing.
///
/// ```
/// use washboard::study::IdentifyOutcome;
/// let outcome = IdentifyOutcome { converged: true, method: "ssi".into(), ..IdentifyOutcome::default() };
/// let page = washboard::report::identify_page(&outcome, "A & B");
/// assert!(page.starts_with("<!doctype html>") && page.contains("<h1>A &amp; B</h1>"));
/// assert!(!page.contains("id=\"road\""));
/// ```
#[must_use]
pub fn identify_page(outcome: &IdentifyOutcome, title: &str) -> String {
    let mut plots = Plots::default();
    let sections = identify_sections(outcome, &mut plots);
    let page = Page {
        title,
        subtitle: headline::subtitle(outcome),
        top: headline::headline(outcome),
        sections,
        foot: foot::foot(outcome),
        plots,
    };
    page.write()
}

/// The sections that have something to show.
fn identify_sections(outcome: &IdentifyOutcome, plots: &mut Plots) -> Vec<Section> {
    SECTIONS
        .iter()
        .filter_map(|(id, heading, draw)| draw(outcome, plots).map(|body| Section { id, heading, body }))
        .collect()
}

#[cfg(test)]
mod tests;
