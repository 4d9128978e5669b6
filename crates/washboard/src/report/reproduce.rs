//! The page of a reproduction: every published number beside the computed one, the figures, the errata.

use super::design::capital;
use super::html::{Html, classed, element, note, paragraph, table};
use super::page::{Page, Section};
use super::plot::{Axis, Plot, Plots, Role, Series};
use crate::study::{Check, Erratum, Figure, ReproduceOutcome, Titled, chapter_of, number_text as number};

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
    let chapters = chapters(outcome);
    let figures = chapters.iter().map(|c| figures(c, &outcome.figures, &mut plots)).collect();
    let excused = rows_of(outcome, |c| !c.agrees && c.erratum.is_some());
    let sections = [
        section("open", "Neither equal nor excused", rows_of(outcome, |c| !c.is_settled())),
        section("excused", "Numbers that the source has wrong", excused),
        section("figures", "Figures", figures),
        section("numbers", "Numbers", chapters.iter().map(|c| numbers(c, outcome)).collect()),
        section("errata", "Errata of the sources", outcome.errata.iter().map(erratum).collect()),
    ];
    let page = Page {
        title: "Published and computed",
        subtitle: subtitle(outcome),
        top: headline(outcome).and(contents(&chapters, outcome)),
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

/// Parts of the sources in their order, as `thesis.ch-4`.
fn chapters(o: &ReproduceOutcome) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for name in o.titles.iter().map(|t| &t.item).chain(o.figures.iter().map(|f| &f.name)) {
        let chapter = chapter_of(name);
        if !all.contains(&chapter) {
            all.push(chapter);
        }
    }
    all
}

fn chapter_words(chapter: &str) -> String {
    match chapter.split_once(".ch-") {
        Some((source, number)) => format!("{}, chapter {number}", capital(source)),
        None => capital(chapter),
    }
}

/// Links to what each chapter has; none of a page with one chapter.
fn contents(chapters: &[String], o: &ReproduceOutcome) -> Html {
    if chapters.len() < 2 {
        return Html::default();
    }
    let link = |kind: &str, chapter: &str, n: usize| match n {
        0 => element("span", &[], ""),
        1 => element(
            "a",
            &[("href", &format!("#{kind}-{chapter}"))],
            format!("1 {}", kind.trim_end_matches('s')),
        ),
        n => element("a", &[("href", &format!("#{kind}-{chapter}"))], format!("{n} {kind}")),
    };
    let row = |c: &String| {
        let drawn = o.figures.iter().filter(|f| chapter_of(&f.name) == *c).count();
        let compared = o.items.iter().filter(|i| chapter_of(&i.item) == *c).count();
        let name = element("span", &[], chapter_words(c));
        name.and(link("figures", c, drawn)).and(link("numbers", c, compared))
    };
    let rows: Html = chapters.iter().map(row).collect();
    element("nav", &[("class", "chapters"), ("aria-label", "Chapters")], rows)
}

/// A chapter's heading, to which its link leads.
fn heading(kind: &str, chapter: &str) -> Html {
    element("h3", &[("id", &format!("{kind}-{chapter}"))], chapter_words(chapter))
}

fn numbers(chapter: &str, o: &ReproduceOutcome) -> Html {
    let own = o.titles.iter().filter(|t| chapter_of(&t.item) == chapter);
    let all: Html = own.map(|t| item(t, &o.items)).collect();
    if all == Html::default() { all } else { heading("numbers", chapter).and(all) }
}

fn row(c: &Check, with_item: bool) -> Vec<Html> {
    let [published, computed, tolerance] = c.texts();
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
        computed.into(),
        tolerance.into(),
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

fn figures(chapter: &str, all: &[Figure], plots: &mut Plots) -> Html {
    let own = all.iter().filter(|f| chapter_of(&f.name) == chapter);
    let grid: Html = own.map(|f| plots.add(plot(f))).collect();
    if grid == Html::default() { grid } else { heading("figures", chapter).and(classed("div", "grid", grid)) }
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
    use crate::study::{Counts, Curve, Evidence, Relation};

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
            counts: Counts { checks: 3, agree: 1, excused: 1, open: 1, ..Counts::default() },
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
    #[test]
    fn links_lead_to_every_chapter_and_errors_are_at_the_front() {
        let mut o = outcome();
        assert!(!reproduce_page(&o).contains("aria-label=\"Chapters\""), "one chapter needs no list");
        o.titles.push(Titled { item: "paper.table-1".into(), title: "t".into() });
        o.items.push(Check {
            item: "paper.table-1".into(),
            printed: "2560000000".into(),
            ..o.items[0].clone()
        });
        let page = reproduce_page(&o);
        for (to, words) in [
            ("numbers-thesis.ch-0", "3 numbers"),
            ("figures-thesis.ch-0", "1 figure"),
            ("numbers-paper", "1 number"),
        ] {
            assert!(page.contains(&format!("<a href=\"#{to}\">{words}</a>")), "{to}");
            assert!(page.contains(&format!("<h3 id=\"{to}\">")), "{to}");
        }
        assert!(page.contains("Thesis, chapter 0") && !page.contains("figures-paper"));
        assert!(page.contains(">2.56e9<") && !page.contains(">2560000000<"));
        // the excused one is in a table of its own, before the figures
        let excused = page.find("<section id=\"excused\">").unwrap();
        assert!(excused < page.find("<section id=\"figures\">").unwrap());
    }
}
