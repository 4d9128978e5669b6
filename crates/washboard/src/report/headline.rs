//! What was found, in plain words, and what a reader must know before any number.

use super::fit::{chi_text, chi_words};
use super::html::{Html, classed, element, paragraph};
use super::numbers::{fixed, with_sd, with_sd_in};
use super::road::one_sided;
use crate::identify::CHI_LIMIT;
use crate::study::{Flag, IdentifyOutcome};

/// Box with verdict, sentence and flags; then the few figures that everybody asks for.
pub(super) fn headline(outcome: &IdentifyOutcome) -> Html {
    headline_beside(outcome, 0)
}

/// The same where designs made of it have so many warnings of their own.
pub(super) fn headline_beside(outcome: &IdentifyOutcome, of_designs: usize) -> Html {
    let (class, verdict) = verdict(outcome);
    let (class, verdict) = match of_designs {
        0 => (class, verdict),
        n => {
            let warnings = if n == 1 { "warning" } else { "warnings" };
            let class = if class == "passed" { "warned" } else { class };
            (class, format!("Identification: {}. Designs: {n} {warnings}, below", verdict.to_lowercase()))
        }
    };
    let inside = element("h2", &[], verdict)
        .and(if outcome.converged { Html::default() } else { flags(&outcome.flags) })
        .and(classed("p", "finding", finding(outcome)))
        .and(if outcome.converged { flags(&outcome.flags) } else { Html::default() });
    let status = element("section", &[("class", &format!("verdict {class}")), ("id", "result")], inside);
    // figures in large type belong to a result
    if outcome.converged { status.and(tiles(outcome)) } else { status }
}

fn verdict(outcome: &IdentifyOutcome) -> (&'static str, String) {
    let misfit = outcome.fit.as_ref().is_some_and(|f| f.chi > CHI_LIMIT);
    let warnings = outcome.flags.len();
    match (outcome.converged, misfit, warnings) {
        (false, ..) => ("failed", "Not converged: these numbers are not a result".to_owned()),
        (true, true, _) => ("warned", "Converged, but the model does not explain the data".to_owned()),
        (true, false, 0) => ("passed", "Converged, without warnings".to_owned()),
        (true, false, 1) => ("warned", "Converged, with one warning".to_owned()),
        (true, false, n) => ("warned", format!("Converged, with {n} warnings")),
    }
}

pub(super) fn flags(flags: &[Flag]) -> Html {
    if flags.is_empty() {
        return Html::default();
    }
    let items = flags.iter().map(|f| {
        let name = classed("code", "", f.name.as_str());
        element("li", &[], Html::from(format!("{} ", f.text)).and(name))
    });
    classed("ul", "flags", items.collect::<Html>())
}

/// One sentence: modes, road, fit.
fn finding(outcome: &IdentifyOutcome) -> String {
    let mut parts = vec![modes_words(outcome)];
    if let Some(road) = &outcome.road {
        let (s0, sd) = one_sided(road);
        parts.push(format!(
            "ISO 8608 class {:?} road, S₀ = {} m³ (one-sided per rad/m)",
            road.class,
            with_sd_in(s0, sd, -6)
        ));
    }
    if let Some(fit) = &outcome.fit {
        parts.push(chi_words(fit.chi));
    }
    if outcome.converged {
        parts.join("; ") + "."
    } else {
        format!("Where it stopped: {}.", parts.join("; "))
    }
}

fn modes_words(outcome: &IdentifyOutcome) -> String {
    let f: Vec<f64> = outcome.modes.iter().map(|m| m.freq_hz).collect();
    match f[..] {
        [] => "no mode".to_owned(),
        [one] => format!("1 mode at {} Hz", fixed(one, 2)),
        [first, .., last] => {
            format!("{} modes from {} to {} Hz", f.len(), fixed(first, 2), fixed(last, 2))
        }
    }
}

fn tiles(outcome: &IdentifyOutcome) -> Html {
    let mut tiles: Vec<(&str, String, String)> =
        vec![("Modes", outcome.modes.len().to_string(), method_words(&outcome.method))];
    if let Some(road) = &outcome.road {
        let e = format!("exponent {}", with_sd(road.exponent, Some(road.exponent_sd)));
        tiles.push(("Road class, ISO 8608", format!("{:?}", road.class), e));
    }
    if let Some(c) = &outcome.coherence {
        tiles.push(("Coherence of tracks, μ", with_sd(c.mu, Some(c.mu_sd)), "Bogsjö’s model".to_owned()));
    }
    if let Some(delay) = outcome.delay_s {
        let sd = outcome.delay_sd_s.map(|s| 1e3 * s);
        let base = outcome
            .recording
            .speed_m_s
            .map_or_else(String::new, |v| format!("{} m at {} m/s", fixed(v * delay, 2), fixed(v, 1)));
        tiles.push(("Delay of the rear axle", format!("{} ms", with_sd(1e3 * delay, sd)), base));
    }
    if let Some(fit) = &outcome.fit {
        tiles.push(("Misfit, χ", chi_text(fit.chi), format!("at most {CHI_LIMIT} is good")));
    }
    let tile = |(name, value, more): (&str, String, String)| {
        let inside: [Html; 3] =
            [element("dt", &[], name), element("dd", &[], value), classed("dd", "more", more)];
        element("div", &[], inside)
    };
    classed("dl", "tiles", tiles.into_iter().map(tile).collect::<Html>())
}

pub(super) fn method_words(method: &str) -> String {
    match method {
        "physical" => "physical model of the vehicle on its road".to_owned(),
        "tvimm" => "track-vehicle interaction modal model".to_owned(),
        "ssi" => "stochastic subspace identification".to_owned(),
        "plscf" => "poly-reference least squares".to_owned(),
        "fdd" => "frequency domain decomposition".to_owned(),
        other => format!("method {other}"),
    }
}

/// The line below the title.
pub(super) fn subtitle(outcome: &IdentifyOutcome) -> Html {
    let r = &outcome.recording;
    let speed = r.speed_m_s.map_or_else(|| "speed unknown".to_owned(), |v| format!("{} m/s", fixed(v, 1)));
    let minutes = r.duration_s / 60.0;
    let duration = if minutes >= 2.0 {
        format!("{} min", fixed(minutes, 1))
    } else {
        format!("{} s", fixed(r.duration_s, 1))
    };
    let text = format!(
        "{} · {duration} · {} channels · {speed} · {}",
        r.name,
        r.channels.len(),
        method_words(&outcome.method)
    );
    paragraph(text)
}
