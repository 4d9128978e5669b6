//! The page of a comparison: what changed, by how much, and whether that is more than scatter.

use super::headline::{flags, method_words};
use super::html::{Html, classed, element, note, paragraph, table};
use super::numbers::{fixed, signed, with_sd};
use super::page::{Page, Section};
use super::plot::{Axis, Plot, Plots, Role};
use super::spectra::density_unit;
use super::{argand, scene};
use crate::study::{Change, CompareOutcome, ComparedChannel, ModeChange, NamedChange, UnmatchedMode};

/// The body of a section; none where there is nothing to show in it.
type Draw = fn(&CompareOutcome, &mut Plots) -> Option<Html>;

/// Anchor, heading and body of each section, in the order of the page.
pub(super) const SECTIONS: &[(&str, &str, Draw)] = &[
    ("modes", "Modes", modes),
    ("road", "Road, coherence, delay", |o, _| named(&o.quantities, "quantity (unit in its name)")),
    ("parameters", "Parameters", |o, _| named(&o.parameters, "parameter (unit in its name)")),
    ("unmatched", "Without a partner", unmatched),
    ("shapes", "Shapes side by side", shapes),
    ("spectra", "Measured spectra", spectra),
];

/// The page of a comparison, from its outcome alone: offline, and the same bytes for the same outcome.
///
/// ```
/// use washboard::study::CompareOutcome;
/// let page = washboard::report::compare_page(&CompareOutcome::default(), "A & B");
/// assert!(page.starts_with("<!doctype html>") && page.contains("<h1>A &amp; B</h1>"));
/// ```
#[must_use]
pub fn compare_page(outcome: &CompareOutcome, title: &str) -> String {
    let mut plots = Plots::default();
    let section = |(id, heading, draw): &(&'static str, &'static str, Draw)| {
        draw(outcome, &mut plots).map(|body| Section { id, heading, body })
    };
    let sections = SECTIONS.iter().filter_map(section).collect();
    let page =
        Page { title, subtitle: subtitle(outcome), top: headline(outcome), sections, foot: foot(), plots };
    page.write()
}

fn subtitle(o: &CompareOutcome) -> Html {
    let side = |word: &str, r: &crate::study::ComparedResult| {
        paragraph(format!("{word}: {} · {} · {}", r.recording, method_words(&r.method), r.path))
    };
    side("Before", &o.before).and(side("After", &o.after))
}

fn headline(o: &CompareOutcome) -> Html {
    let (class, verdict) = match (o.comparable, o.judged, o.significant) {
        (false, ..) => ("failed", "These two cannot be compared".to_owned()),
        (true, 0, _) => ("warned", "Differences are shown, none could be judged".to_owned()),
        (true, n, 0) => ("passed", format!("No significant change among {n} numbers")),
        (true, n, 1) => ("warned", format!("1 of {n} numbers changed significantly")),
        (true, n, k) => ("warned", format!("{k} of {n} numbers changed significantly")),
    };
    let chance = format!(
        "At 95 %, up to about {} of {} would be called significant by chance if nothing had changed.",
        fixed(0.05 * o.judged as f64, 1),
        o.judged
    );
    let words = if o.comparable && o.judged > 0 { classed("p", "finding", chance) } else { Html::default() };
    let inside = element("h2", &[], verdict).and(words).and(flags(&o.flags));
    element("section", &[("class", &format!("verdict {class}")), ("id", "result")], inside)
}

/// Before, after, difference, verdict; in units of `scale`.
fn cells(c: &Change, scale: f64) -> [Html; 4] {
    let times = |sd: Option<f64>| sd.map(|s| scale * s);
    let difference = match c.difference_sd {
        Some(_) => signed_with_sd(scale * c.difference, times(c.difference_sd)),
        None => signed_with_sd(scale * c.difference, None),
    };
    let verdict = match (&c.not_judged, c.significant) {
        (Some(why), _) => Html::from(format!("not judged: {why}")),
        (None, true) => classed("strong", "far", "changed"),
        (None, false) => "within the scatter".into(),
    };
    [
        with_sd(scale * c.before, times(c.before_sd)).into(),
        with_sd(scale * c.after, times(c.after_sd)).into(),
        difference.into(),
        verdict,
    ]
}

fn signed_with_sd(value: f64, sd: Option<f64>) -> String {
    let text = with_sd(value, sd);
    // an exponent's bracket takes the sign inside
    if value <= 0.0 || text.starts_with(['(', '−']) { text } else { format!("+{text}") }
}

fn modes(o: &CompareOutcome, _: &mut Plots) -> Option<Html> {
    if o.modes.is_empty() {
        return None;
    }
    let heads = ["mode", "at 95 %", "# before", "# after", "# difference", "found again by"];
    let rows = |of: fn(&ModeChange) -> &Change, scale: f64| {
        let row = move |m: &ModeChange| {
            let by = match m.mac {
                Some(mac) => format!("its shape (MAC {})", fixed(mac, 3)),
                None => "the nearest pole".to_owned(),
            };
            let [before, after, difference, verdict] = cells(of(m), scale);
            vec![name(m).into(), verdict, before, after, difference, by.into()]
        };
        o.modes.iter().map(row).collect::<Vec<_>>()
    };
    Some(
        table("Frequency, Hz", &heads, rows(|m| &m.freq_hz, 1.0))
            .and(table("Damping ratio, %", &heads, rows(|m| &m.damping, 100.0)))
            .and(note(
                "± is one standard deviation; that of a difference is √(sd² + sd²), as of independent estimates. A \
                 difference beyond 1.96 of it is called changed.",
            )),
    )
}

fn name(m: &ModeChange) -> String {
    if m.label_before == m.label_after {
        m.label_before.clone()
    } else {
        format!("{} → {}", m.label_before, m.label_after)
    }
}

fn named(changes: &[NamedChange], what: &str) -> Option<Html> {
    if changes.is_empty() {
        return None;
    }
    let rows = changes.iter().map(|n| {
        let share = if n.change.before == 0.0 {
            "–".to_owned()
        } else {
            signed(100.0 * n.change.difference / n.change.before, 2)
        };
        let [before, after, difference, verdict] = cells(&n.change, 1.0);
        vec![n.name.as_str().into(), verdict, before, after, difference, share.into()]
    });
    let heads = [what, "at 95 %", "# before", "# after", "# difference", "# %"];
    Some(table("", &heads, rows.collect()))
}

fn unmatched(o: &CompareOutcome, _: &mut Plots) -> Option<Html> {
    let u = &o.unmatched;
    let mode = |which: &str, m: &UnmatchedMode| {
        let (f, zeta) = (fixed(m.freq_hz, 3), fixed(100.0 * m.damping, 1));
        element("li", &[], format!("only {which}: mode {}, {}, {f} Hz, ζ {zeta} %", m.number, m.label))
    };
    let named = |which: &str, n: &String| element("li", &[], format!("only {which}: {n}"));
    let items: Html = u
        .modes_before
        .iter()
        .map(|m| mode("before", m))
        .chain(u.modes_after.iter().map(|m| mode("after", m)))
        .chain(u.names_before.iter().map(|n| named("before", n)))
        .chain(u.names_after.iter().map(|n| named("after", n)))
        .collect();
    (items != Html::default()).then(|| element("ul", &[], items))
}

/// Both shapes of every mode that has them, in one panel and one motion.
fn shapes(o: &CompareOutcome, _: &mut Plots) -> Option<Html> {
    let panel = |m: &ModeChange| {
        let side = |word: &str, points, f: f64| {
            let caption = format!("{word}: {} Hz", fixed(f, 2));
            let drawing = scene::svg(points, &format!("Shape of {} {word}", name(m)))?;
            Some(classed("figure", "vehicle", element("figcaption", &[], caption).and(drawing)))
        };
        let before = side("before", &m.points_before, m.freq_hz.before)?;
        let after = side("after", &m.points_after, m.freq_hz.after)?;
        let likeness = m.mac.map_or_else(String::new, |mac| format!(" · MAC {}", fixed(mac, 3)));
        let inside = element("h3", &[], format!("{} · {}{likeness}", m.before, name(m)))
            .and(classed("div", "moving pair", before.and(after)))
            .and(classed(
                "div",
                "moving pair phases-pair",
                argand::argand(&m.points_before).and(argand::argand(&m.points_after)),
            ));
        let tab = format!("{} {}", m.before, name(m));
        Some(element(
            "div",
            &[("class", "panel"), ("id", &format!("shape-{}", m.before)), ("data-tab", &tab)],
            inside,
        ))
    };
    let panels: Html = o.modes.iter().filter_map(panel).collect();
    (panels != Html::default()).then(|| {
        element("div", &[("class", "player")], panels).and(note(
            "The later shape is turned to the phase of the earlier one. Dashed: at rest. In the circles each arrow is a \
             point’s size and phase.",
        ))
    })
}

fn spectra(o: &CompareOutcome, plots: &mut Plots) -> Option<Html> {
    let s = &o.spectra;
    let mut x: Vec<f64> =
        s.freq_before_hz.iter().chain(&s.freq_after_hz).copied().filter(|f| *f > 0.0).collect();
    x.sort_by(f64::total_cmp);
    x.dedup();
    let (first, last) = (*x.first()?, *x.last()?);
    let at = |bins: &[f64], values: &[f64]| -> Vec<Option<f64>> {
        let mut known = bins.iter().zip(values).peekable();
        x.iter()
            .map(|f| {
                while known.next_if(|(b, _)| *b < f).is_some() {}
                known.next_if(|(b, _)| *b == f).map(|(_, v)| *v)
            })
            .collect()
    };
    let mut draw = |c: &ComparedChannel| {
        let y_axis = Axis::new("", &density_unit(&c.unit), true);
        let mut plot =
            Plot::new(c.channel.as_str(), &x, Axis::new("frequency", "Hz", true).within(first, last), y_axis)
                .curve("before", Role::Before, at(&s.freq_before_hz, &c.before))
                .curve("after", Role::After, at(&s.freq_after_hz, &c.after));
        plot.group = "frequency".to_owned();
        if plot.series.is_empty() { Html::default() } else { plots.add(plot) }
    };
    let grid: Html = s.channels.iter().map(&mut draw).collect();
    (grid != Html::default()).then(|| {
        classed("div", "grid", grid).and(note(
            "Welch’s estimates of the channels that both recordings have, one-sided densities per Hz. A road of another \
             roughness or another speed changes them without a change of the vehicle.",
        ))
    })
}

fn foot() -> Html {
    element(
        "footer",
        &[("id", "reading")],
        note(
            "Made by washboard from result.json alone. Modes are found again by the likeness of their shapes at the points that \
         both have (MAC, the modal assurance criterion), else by the nearest pole. Plots by uPlot, © Leon Sorokin, MIT \
         licence.",
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{NASTY, full, sparse};
    use crate::study::compare_outcomes;

    fn changed() -> CompareOutcome {
        let (before, mut after) = (full(), full());
        after.modes[0].freq_hz = 1.2;
        after.spectra.freq_hz.iter_mut().for_each(|f| *f += 0.1);
        compare_outcomes(&before, &after)
    }

    #[test]
    fn the_numbers_are_the_outcomes() {
        let page = compare_page(&changed(), NASTY);
        // 1.2 − 1.064, and 0.0123 √2
        assert!(page.contains("+0.136 ± 0.017") && page.contains("class=\"far\">changed<"), "{page}");
        assert!(page.contains("1 of 9 numbers changed significantly") && page.contains("MAC 1.000"));
        for (id, ..) in SECTIONS.iter().filter(|(id, ..)| *id != "unmatched") {
            assert!(page.contains(&format!("<section id=\"{id}\">")), "{id}");
        }
        assert!(!page.contains("<img") && page.contains("&lt;img"));
        assert_eq!(page, compare_page(&changed(), NASTY));
    }

    #[test]
    fn both_spectra_keep_their_own_bins() {
        let outcome = changed();
        let mut plots = Plots::default();
        spectra(&outcome, &mut plots).unwrap();
        let plot = &plots.0[0];
        // 39 bins above zero before, 40 after, none in common
        assert_eq!((plot.x.len(), plot.series.len()), (79, 2));
        assert_eq!(plot.series.iter().map(|s| s.y.iter().flatten().count()).collect::<Vec<_>>(), [39, 40]);
        assert!((0..79).all(|k| plot.series[0].y[k].is_some() != plot.series[1].y[k].is_some()));
    }

    #[test]
    fn what_cannot_be_judged_is_said() {
        let mut without = sparse();
        for m in &mut without.modes {
            (m.freq_sd_hz, m.damping_sd) = (None, None);
        }
        let page = compare_page(&compare_outcomes(&full(), &without), "t");
        assert!(
            page.contains("not judged: no standard deviation after") && page.contains("none could be judged")
        );
        assert!(page.contains("only before: coherence.mu") && !page.contains("id=\"shapes\""));
        let mut failed = full();
        failed.converged = false;
        let page = compare_page(&compare_outcomes(&full(), &failed), "t");
        assert!(page.contains("These two cannot be compared") && !page.contains(">changed<"));
    }
}
