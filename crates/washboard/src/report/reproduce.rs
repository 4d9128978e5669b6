//! The page of a reproduction: every published number beside the computed one, the figures, the errata.

use super::html::{Html, classed, element, note, paragraph, table};
use super::page::{Page, Section};
use super::plot::{Axis, Plot, Plots, Role, Series};
use crate::study::{Check, Erratum, Figure, Relation, ReproduceOutcome, Titled};

/// Digits of a computed number: more than any source prints.
const DIGITS: usize = 7;

/// The page of a reproduction, from its outcome alone: offline, and the same bytes for the same outcome.
///
/// ```
/// use washboard::study::ReproduceOutcome;
/// let page = washboard::report::reproduce_page(&ReproduceOutcome::default());
/// assert!(page.starts_with("<!doctype html>") && !page.contains("id=\"figures\""));
/// ```
#[must_use]
pub fn reproduce_page(outcome: &ReproduceOutcome) -> String {
    let mut plots = Plots::default();
    let section = |id: &'static str, heading: &'static str, body: Html| {
        (body != Html::default()).then_some(Section { id, heading, body })
    };
    let figures = figures(&outcome.figures, &mut plots);
    let sections = [
        section("open", "Neither equal nor excused", rows_of(outcome, |c| !c.is_settled())),
        section("figures", "Figures", figures),
        section("numbers", "Numbers", outcome.titles.iter().map(|t| item(t, &outcome.items)).collect()),
        section("errata", "Errata of the sources", outcome.errata.iter().map(erratum).collect()),
    ];
    let page = Page {
        title: "Published and computed",
        subtitle: subtitle(outcome),
        top: headline(outcome),
        sections: sections.into_iter().flatten().collect(),
        foot: foot(),
        plots,
    };
    page.write()
}

fn subtitle(o: &ReproduceOutcome) -> Html {
    let left: Vec<&str> = o.skipped.iter().chain(&o.skipped_errata).map(String::as_str).collect();
    let skipped = match &left[..] {
        [] => Html::default(),
        names => paragraph(format!("Left out by --quick: {}", names.join(", "))),
    };
    paragraph(format!("{} items, {} numbers, {} figures", o.titles.len(), o.items.len(), o.figures.len()))
        .and(skipped)
}

fn headline(o: &ReproduceOutcome) -> Html {
    let c = &o.counts;
    let class = if c.open > 0 { "failed" } else { "passed" };
    let verdict = c.words();
    let words = format!(
        "{} do not because the source is in error, with evidence below; {} do not and have no such excuse.",
        c.excused, c.open
    );
    let inside = element("h2", &[], verdict).and(classed("p", "finding", words));
    element("section", &[("class", &format!("verdict {class}")), ("id", "result")], inside)
}

fn number(x: f64) -> String {
    let kept: f64 = format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x);
    let text = if kept != 0.0 && !(1e-4..1e7).contains(&kept.abs()) {
        format!("{kept:e}")
    } else {
        (kept + 0.0).to_string()
    };
    text.replace('-', "−")
}

fn row(c: &Check, with_item: bool) -> Vec<Html> {
    let published = match c.relation {
        Relation::Equal => c.printed.replace('-', "−"),
        Relation::AtMost => format!("≤ {}", c.printed),
        Relation::AtLeast => format!("≥ {}", c.printed),
    };
    let verdict = match (c.agrees, &c.erratum) {
        (true, _) => Html::from("agrees"),
        (false, Some(id)) => element("a", &[("href", &format!("#{id}"))], format!("erratum {id}")),
        (false, None) => classed("strong", "far", "differs"),
    };
    let mut cells: Vec<Html> = if with_item { vec![c.item.as_str().into()] } else { Vec::new() };
    let note = c.reference_note.clone().unwrap_or_default();
    cells.extend([
        c.quantity.as_str().into(),
        published.into(),
        number(c.computed).into(),
        number(c.tolerance).into(),
        verdict,
        note.into(),
    ]);
    cells
}

const HEADS: [&str; 6] = ["quantity", "# published", "# computed", "# tolerance", "verdict", "note"];

fn rows_of(o: &ReproduceOutcome, which: fn(&Check) -> bool) -> Html {
    let rows: Vec<_> = o.items.iter().filter(|c| which(c)).map(|c| row(c, true)).collect();
    if rows.is_empty() {
        return Html::default();
    }
    let heads: Vec<&str> = std::iter::once("item").chain(HEADS).collect();
    table("", &heads, rows)
}

fn item(titled: &Titled, checks: &[Check]) -> Html {
    let own: Vec<&Check> = checks.iter().filter(|c| c.item == titled.item).collect();
    if own.is_empty() {
        return Html::default();
    }
    let agree = own.iter().filter(|c| c.agrees).count();
    let summary = format!("{}: {} ({agree} of {} agree)", titled.item, titled.title, own.len());
    let rows = own.into_iter().map(|c| row(c, false)).collect();
    let inside = element("summary", &[], summary).and(table("", &HEADS, rows));
    element("details", &[("id", &titled.item), ("open", "")], inside)
}

fn figures(all: &[Figure], plots: &mut Plots) -> Html {
    let grid: Html = all.iter().map(|f| plots.add(plot(f))).collect();
    if grid == Html::default() { grid } else { classed("div", "grid", grid) }
}

fn plot(f: &Figure) -> Plot {
    let axis =
        |label: &str, log: bool| Axis { label: label.to_owned(), unit: String::new(), log, range: None };
    let title = format!("{}: {}", f.name, f.title);
    let mut plot = Plot::new(title, &f.x, axis(&f.x_label, f.x_log), axis(&f.y_label, f.y_log));
    for (sign, curve) in f.curves.iter().enumerate() {
        let y = curve.y.iter().map(|v| Some(*v)).collect();
        plot.push(Series { label: curve.label.clone(), role: Role::Line, y, sign, ..Series::default() });
    }
    plot
}

fn erratum(e: &Erratum) -> Html {
    let heading = element("h3", &[("id", &e.id)], format!("{}: {}", e.id, e.place));
    let words = paragraph(format!("Printed: {}. Right: {}.", e.printed, e.right));
    if e.evidence.is_empty() {
        return heading.and(words).and(note("An error of print: there is no number to compute."));
    }
    let rows = e
        .evidence
        .iter()
        .map(|n| vec![n.what.as_str().into(), number(n.as_printed).into(), number(n.right).into()]);
    heading.and(words).and(table("", &["number", "# as printed", "# computed"], rows.collect()))
}

fn foot() -> Html {
    let words = "Made by washboard from result.json alone. The tolerance is a unit of the last printed place, as the thesis truncates and \
                 rounds, where the note does not say otherwise; 0 is of exact fractions and counts. Plots by uPlot, © Leon Sorokin, MIT licence.";
    element("footer", &[("id", "reading")], note(words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Counts, Curve, Evidence};

    fn outcome() -> ReproduceOutcome {
        let check = |agrees: bool, erratum: Option<&str>| Check {
            item: "thesis.sec-0.0".into(),
            quantity: "<b>".into(),
            published: -0.5,
            printed: "-0.5".into(),
            computed: -0.123_456_789,
            tolerance: 0.1,
            relation: Relation::Equal,
            agrees,
            reference_note: Some("a note".into()),
            erratum: erratum.map(str::to_owned),
        };
        ReproduceOutcome {
            items: vec![check(true, None), check(false, Some("E0.1")), check(false, None)],
            titles: vec![Titled { item: "thesis.sec-0.0".into(), title: "t".into() }],
            counts: Counts { checks: 3, agree: 1, excused: 1, open: 1, inputs: 0 },
            figures: vec![Figure {
                name: "thesis.fig-0.1".into(),
                title: "f".into(),
                x_label: "x".into(),
                x_log: false,
                y_label: "y".into(),
                y_log: true,
                x: vec![1.0, 2.0],
                curves: vec![Curve { label: "c".into(), y: vec![1.0, 2.0] }],
            }],
            errata: vec![Erratum {
                id: "E0.1".into(),
                place: "p".into(),
                printed: "a".into(),
                right: "b".into(),
                evidence: vec![Evidence { what: "n".into(), as_printed: 1.0, right: 2.0 }],
            }],
            skipped: vec!["thesis.fig-0.2".into()],
            skipped_errata: vec![],
        }
    }

    #[test]
    fn every_row_says_whether_it_agrees_and_what_excuses_it() {
        let page = reproduce_page(&outcome());
        assert!(page.contains("1 of 3 computed numbers agree") && page.contains("class=\"verdict failed\""));
        assert!(page.contains("<a href=\"#E0.1\">erratum E0.1</a>") && page.contains("<h3 id=\"E0.1\">"));
        assert!(page.contains("−0.1234568") && page.contains("&lt;b&gt;") && !page.contains("<b>"));
        assert!(page.contains("\"role\":\"line\"") && page.contains("thesis.fig-0.2"));
        assert!(page.contains("<section id=\"open\">"));
        assert_eq!(page, reproduce_page(&outcome()));
    }
}
