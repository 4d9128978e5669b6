//! The page as a whole: what it contains, what it must never do.

use super::fixture::{NASTY, full, sparse};
use super::page::{SCRIPTS, STYLES, UPLOT_SCRIPT, UPLOT_STYLE};
use super::plot::Plot;
use super::*;

/// The page's text between the first `open` after `from` and the next `close`.
fn between<'a>(page: &'a str, open: &str, close: &str) -> &'a str {
    page.split_once(open).unwrap().1.split_once(close).unwrap().0
}

/// The part of [`NASTY`] that would be an attribute: as text in an attribute's value it is harmless.
const NASTY_ATTRIBUTE: &str = " onerror=alert(1)";

/// Tags of the markup, the insides of script and style elements left out.
fn tags(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = page;
    while let Some((_, after)) = rest.split_once('<') {
        let (tag, more) = after.split_once('>').unwrap();
        found.push(tag.to_owned());
        let name = tag.split(' ').next().unwrap();
        rest = if matches!(name, "script" | "style") {
            &more[more.find(&format!("</{name}")).unwrap()..]
        } else {
            more
        };
    }
    found
}

fn sections(page: &str) -> Vec<String> {
    let ids = tags(page).into_iter().filter_map(|t| t.strip_prefix("section id=\"").map(str::to_owned));
    ids.map(|t| t.trim_end_matches('"').to_owned()).collect()
}

#[test]
fn every_tag_is_closed_and_no_name_became_one() {
    for outcome in [full(), sparse()] {
        let page = identify_page(&outcome, NASTY);
        let mut open: Vec<String> = Vec::new();
        for tag in tags(&page) {
            let name = tag.split(' ').next().unwrap().to_owned();
            match name.strip_prefix('/') {
                Some(end) => assert_eq!(open.pop().as_deref(), Some(end)),
                None if matches!(name.as_str(), "!doctype" | "meta") => {}
                None => open.push(name),
            }
        }
        assert!(open.is_empty(), "never closed: {open:?}");
        assert!(!tags(&page).iter().any(|t| t.starts_with("img")));
        assert!(page.contains("&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;"));
        // the data, uPlot and our own
        assert_eq!(page.matches("<script").count(), 2 + SCRIPTS.len());
        assert_eq!(page.matches("</script>").count(), 2 + SCRIPTS.len());
    }
}

#[test]
fn a_full_outcome_has_all_sections_and_a_sparse_one_only_its_own() {
    let all: Vec<&str> = SECTIONS.iter().map(|(id, ..)| *id).collect();
    assert_eq!(sections(&identify_page(&full(), "t")), all);
    let page = identify_page(&sparse(), "t");
    assert_eq!(sections(&page), ["modes", "spectra", "cross", "stabilization", "recording"]);
    assert!(!page.contains("ISO 8608") && !page.contains("Bogsjö") && !page.contains("NaN"));
}

#[test]
fn plots_are_read_back_equal() {
    let page = identify_page(&full(), "t");
    let json = between(&page, "<script type=\"application/json\" id=\"data\">", "</script>");
    let mut plots = Plots::default();
    for (.., draw) in SECTIONS {
        draw(&full(), &mut plots);
    }
    let read: Vec<Plot> = serde_json::from_str(json).unwrap();
    assert_eq!(read, plots.0);
    assert!(read.iter().any(|p| p.title == NASTY));
    assert_eq!(tags(&page).iter().filter(|t| t.contains("data-plot=")).count(), read.len());
}

#[test]
fn nothing_is_fetched() {
    let page = identify_page(&full(), "t");
    // every attribute is written name="value", and a quote inside a value is escaped
    let markup = tags(&page).join("\n");
    for word in [" src=\"", " action=\"", " style=\"", " on"] {
        assert!(!markup.replace(NASTY_ATTRIBUTE, "").contains(word), "{word}");
    }
    assert!(
        !tags(&page)
            .iter()
            .any(|t| ["link", "iframe", "object", "embed", "base"].iter().any(|w| t.starts_with(w)))
    );
    assert!(markup.split(" href=\"").skip(1).all(|link| link.starts_with('#')));
    for own in SCRIPTS.into_iter().chain(STYLES).chain([UPLOT_STYLE]) {
        for word in [
            "http:",
            "https:",
            "@import",
            "url(",
            "fetch(",
            "XMLHttpRequest",
            "import(",
            "eval(",
            "innerHTML",
        ] {
            assert!(!own.contains(word), "{word}");
        }
    }
    for word in ["fetch(", "XMLHttpRequest", "WebSocket", "sendBeacon", "</script"] {
        assert!(!UPLOT_SCRIPT.contains(word), "{word}");
    }
    assert!(
        between(&page, "Content-Security-Policy\" content=\"", "\"")
            .starts_with("default-src &#39;none&#39;;")
    );
}

#[test]
fn the_same_outcome_gives_the_same_bytes_and_survives_result_json() {
    let json = serde_json::to_string(&full()).unwrap();
    let again: IdentifyOutcome = serde_json::from_str(&json).unwrap();
    assert_eq!(identify_page(&full(), "t"), identify_page(&again, "t"));
}

#[test]
fn a_failure_stands_before_every_number() {
    let mut outcome = full();
    outcome.converged = false;
    let page = identify_page(&outcome, "t");
    let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is missing"));
    assert!(at("Not converged") < at("the flag says") && at("the flag says") < at("Where it stopped"));
    assert!(at("Where it stopped") < at("id=\"modes\"") && !page.contains("class=\"tiles\""));
    outcome.converged = true;
    outcome.fit.as_mut().unwrap().chi = 56.0;
    assert!(identify_page(&outcome, "t").contains("does not explain the data"));
}

#[test]
fn the_headline_says_what_was_found() {
    let page = identify_page(&full(), "t");
    let finding = between(&page, "<p class=\"finding\">", "</p>");
    assert_eq!(
        finding,
        "2 modes from 1.06 to 8.04 Hz; ISO 8608 class C road, S₀ = (14.9 ± 0.2)·10⁻⁶ m³ (one-sided per rad/m); \
         the model explains the data (χ = 0.39, limit 0.6)."
    );
    assert!(page.contains("1.064 ± 0.012") && page.contains("1.040 to 1.088"));
}

#[test]
fn values_that_are_none_do_not_reach_the_page() {
    let mut outcome = full();
    outcome.spectra.channels[0].measured[3] = f64::NAN;
    outcome.modes[0].freq_hz = f64::NAN;
    outcome.road.as_mut().unwrap().roughness_m3 = f64::INFINITY;
    outcome.fit.as_mut().unwrap().residual.clear();
    let page = identify_page(&outcome, "t");
    let json = between(&page, "id=\"data\">", "</script>");
    assert!(!tags(&page).iter().any(|t| t.contains("NaN") || t.contains("inf")));
    assert!(serde_json::from_str::<Vec<Plot>>(json).is_ok());
}

#[test]
fn what_others_fill_in_reaches_the_page_with_its_numbers() {
    let page = identify_page(&full(), "t");
    for text in [
        "<td class=\"number\">0.877</td><td class=\"number\">−12.3</td>", // MPC and mean phase
        "class=\"number shade-3\">0.25</td>",                             // MAC
        ">0.500</td><td class=\"number\">53.1</td>",                      // size and phase of 0.3 + 0.4 i
        "7 modes were chosen; they explain the data (χ = 0.41).",
        "<td class=\"number\">50.0</td>", // BIC above the least
        "1 of 2 starts came to the best end.",
        "<td class=\"number\">12.3 ± 0.4</td>", // ms of a clock
        "the run’s flag says &lt;/script&gt;",
        "<td class=\"number\">177.33</td>", // ms from front to rear at 15 m/s
        "href=\"#shape-2\"",
    ] {
        assert!(page.contains(text), "{text}");
    }
    let mut plots = Plots::default();
    spectra::auto(&full(), &mut plots);
    // the numbers on the plots are explained below them
    assert!(page.contains("Dashed verticals are the modes: 1 heave (1.06 Hz), 2 &lt;/script&gt;"));
    let [high, low, _, measured] = &plots.0[0].series[..] else { panic!("{:?}", plots.0[0].series) };
    let at = |s: &plot::Series| s.y[5].unwrap();
    // six digits are kept of each
    assert!((at(high) / at(measured) - 1.2).abs() < 1e-5 && (at(low) / at(measured) - 0.84).abs() < 1e-5);
}

#[test]
fn what_is_empty_leaves_no_trace() {
    let page = identify_page(&sparse(), "t");
    for text in ["MPC", "href=\"#shape-", "class=\"player\"", "class=\"mac\"", "95 % interval of a measured"]
    {
        assert!(!page.contains(text), "{text}");
    }
}
