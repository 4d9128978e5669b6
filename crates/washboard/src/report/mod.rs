//! Offline pages from outcomes alone: one file that fetches nothing, for a screen, a telephone or paper.

mod fit;
mod foot;
mod headline;
mod html;
mod modes;
mod numbers;
mod plot;
mod recording;
mod rejected;
mod road;
mod spectra;
mod truth;

#[cfg(test)]
mod fixture;

use crate::study::IdentifyOutcome;
use html::{Html, code, element, json_script};
use plot::Plot;

const UPLOT_SCRIPT: &str = include_str!("../../assets/uplot/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("../../assets/uplot/uPlot.min.css");
const SCRIPT: &str = include_str!("../../assets/report.js");
const STYLE: &str = include_str!("../../assets/report.css");

/// The plots of a page in the order of their places.
#[derive(Debug, Default)]
struct Plots(Vec<Plot>);

impl Plots {
    /// Keeps a plot and returns its place in the page.
    fn add(&mut self, plot: Plot) -> Html {
        let place = plot.place(self.0.len());
        self.0.push(plot);
        place
    }
}

/// The body of a section; none where the outcome has nothing to show in it.
type Draw = fn(&IdentifyOutcome, &mut Plots) -> Option<Html>;

/// Anchor, heading and body of each section, in the order of the page.
const SECTIONS: &[(&str, &str, Draw)] = &[
    ("truth", "What we knew, what we found", truth::comparison),
    ("modes", "Modes", modes::modes),
    ("spectra", "Spectra", spectra::auto),
    ("cross", "Cross-spectra", spectra::cross),
    ("road", "Road", road::spectrum),
    ("tracks", "Coherence of the tracks", road::tracks),
    ("fit", "Quality of the fit", fit::residual),
    ("parameters", "Parameters", fit::parameters),
    ("stabilization", "Stabilisation", rejected::stabilization),
    ("rejected", "Found and left out", rejected::rejected),
    ("lines", "Spectral lines", rejected::lines),
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
    let drawn: Vec<(&str, &str, Html)> = SECTIONS
        .iter()
        .filter_map(|(id, heading, draw)| draw(outcome, &mut plots).map(|body| (*id, *heading, body)))
        .collect();
    let links = drawn.iter().map(|(id, heading, _)| element("a", &[("href", &format!("#{id}"))], *heading));
    let nav = element("nav", &[("aria-label", "Sections")], links.collect::<Html>());
    let data = json_script("data", &plots.0);
    let nonce = nonce(title, data.as_str());
    let sections = drawn
        .into_iter()
        .map(|(id, heading, body)| element("section", &[("id", id)], element("h2", &[], heading).and(body)));
    let header = element("header", &[], element("h1", &[], title).and(headline::subtitle(outcome)));
    let no_script = "The tables below are complete; the plots need JavaScript, which is switched off here.";
    let body = header
        .and(headline::headline(outcome))
        .and(element("noscript", &[], element("p", &[("class", "note")], no_script)))
        .and(nav)
        .and(element("main", &[], sections.collect::<Html>()))
        .and(foot::foot(outcome))
        .and(data)
        .and(code("script", &nonce, UPLOT_SCRIPT))
        .and(code("script", &nonce, SCRIPT));
    let page = element("html", &[("lang", "en")], head(title, &nonce).and(element("body", &[], body)));
    format!("<!doctype html>\n{}\n", page.as_str())
}

fn head(title: &str, nonce: &str) -> Html {
    let policy = format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; base-uri 'none'; form-action 'none'"
    );
    let policy = [("http-equiv", "Content-Security-Policy"), ("content", policy.as_str())];
    let inside = Html::own("<meta charset=\"utf-8\">")
        .and(html::meta(&policy))
        .and(Html::own("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"))
        .and(element("title", &[], title))
        .and(code("style", nonce, UPLOT_STYLE))
        .and(code("style", nonce, STYLE));
    element("head", &[], inside)
}

/// A word of the page's own data (FNV-1a): only elements with it are obeyed, and no name in a file can contain it.
fn nonce(title: &str, data: &str) -> String {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    format!("{:016x}", title.bytes().chain(data.bytes()).fold(0xcbf2_9ce4_8422_2325, step))
}

#[cfg(test)]
mod tests;
