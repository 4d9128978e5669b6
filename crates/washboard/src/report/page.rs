//! The frame of every page: head with its policy, title, links to the sections, scripts.

use super::html::{self, Html, code, element, json_script};
use super::plot::Plots;

pub(super) const UPLOT_SCRIPT: &str = include_str!("../../assets/uplot/uPlot.iife.min.js");
pub(super) const UPLOT_STYLE: &str = include_str!("../../assets/uplot/uPlot.min.css");
/// Our own scripts, in the order in which they need each other.
pub(super) const SCRIPTS: [&str; 5] = [
    include_str!("../../assets/numbers.js"),
    include_str!("../../assets/overlay.js"),
    include_str!("../../assets/plots.js"),
    include_str!("../../assets/shapes.js"),
    include_str!("../../assets/sweep.js"),
];
pub(super) const STYLES: [&str; 4] = [
    include_str!("../../assets/report.css"),
    include_str!("../../assets/shapes.css"),
    include_str!("../../assets/sweep.css"),
    include_str!("../../assets/sketch.css"),
];

/// A part of the page that a link leads to.
#[derive(Debug)]
pub(super) struct Section {
    /// Anchor.
    pub id: &'static str,
    /// Heading.
    pub heading: &'static str,
    /// What stands below it.
    pub body: Html,
}

/// A page.
#[derive(Debug)]
pub(super) struct Page<'a> {
    /// Its heading, and the browser's.
    pub title: &'a str,
    /// The line below.
    pub subtitle: Html,
    /// Verdict and figures.
    pub top: Html,
    /// What the links lead to.
    pub sections: Vec<Section>,
    /// How to read it.
    pub foot: Html,
    /// What the places of its plots show.
    pub plots: Plots,
}

impl Page<'_> {
    /// The whole file, the same bytes for the same page.
    pub fn write(self) -> String {
        let link = |s: &Section| element("a", &[("href", &format!("#{}", s.id))], s.heading);
        let links = self.sections.iter().map(link).collect::<Html>();
        let nav = element("nav", &[("aria-label", "Sections")], links);
        let data = json_script("data", &self.plots.0);
        let nonce = nonce(self.title, data.as_str());
        let sections = self
            .sections
            .into_iter()
            .map(|s| element("section", &[("id", s.id)], element("h2", &[], s.heading).and(s.body)));
        let header = element("header", &[], element("h1", &[], self.title).and(self.subtitle));
        let no_script = "The tables below are complete; the plots and the motion need JavaScript, which is switched off \
                         here.";
        let body = header
            .and(self.top)
            .and(element("noscript", &[], element("p", &[("class", "note")], no_script)))
            .and(nav)
            .and(element("main", &[], sections.collect::<Html>()))
            .and(self.foot)
            .and(data)
            .and(code("script", &nonce, UPLOT_SCRIPT))
            .and(SCRIPTS.map(|s| code("script", &nonce, s)));
        let page =
            element("html", &[("lang", "en")], head(self.title, &nonce).and(element("body", &[], body)));
        format!("<!doctype html>\n{}\n", page.as_str())
    }
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
        .and(STYLES.map(|s| code("style", nonce, s)));
    element("head", &[], inside)
}

/// A word of the page's own data (FNV-1a): only elements with it are obeyed, and no name in a file can contain it.
fn nonce(title: &str, data: &str) -> String {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    format!("{:016x}", title.bytes().chain(data.bytes()).fold(0xcbf2_9ce4_8422_2325, step))
}
