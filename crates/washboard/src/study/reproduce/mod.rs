//! The job `reproduce`: every published number computed again, beside what is printed.
//!
//! Nothing here is copied from a source but what is printed, as its digits; what is computed comes from the library. A number that disagrees
//! says so, and an erratum excuses it only with evidence that is computed, too.

mod chapter_2;
mod chapter_3;
mod chapter_4_car;
mod chapter_4_figures;
mod chapter_4_hybrid;
mod chapter_4_identities;
mod chapter_4_lqg;
mod chapter_4_propositions;
mod chapter_5_bump;
mod chapter_5_feedback;
mod chapter_5_fixed;
mod chapter_5_limits;
mod chapter_6_feedback;
mod chapter_6_figures;
mod chapter_6_limits;
mod chapter_7_car;
mod chapter_7_design;
mod chapter_7_figures;
mod chapter_7_fixed;
mod chapter_8_cabin;
mod chapter_8_figures;
mod context;
mod errata;
mod errata_2;
mod errata_3;
mod errata_4;
mod errata_5;
mod errata_6;
mod errata_7;
mod errata_8;
mod errata_8_kinematics;
mod errata_list;
mod errata_paper;
mod error;
mod item;
pub mod lmi_cars;
mod markdown;
mod paper_car;
mod paper_road;
mod paper_spectra;
mod registry;
mod shared;

pub use error::ReproduceError;
pub use item::{Check, Curve, Erratum, Evidence, Figure, Relation, number_text};
pub use markdown::errata_markdown;

use self::context::Context;
use self::item::Sheet;
use self::registry::{ITEMS, Item};
use super::{Input, StudyError};
use crate::cases::{CaseKind, find};
use crate::files::nearest;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Which items, and whether long searches and simulations are left out.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReproduceSpec {
    /// `thesis.fig-4.3`, or all of `thesis.ch-4`, `thesis` or `paper`; everything where there are none.
    #[serde(default)]
    pub items: Vec<String>,
    /// Leaves out what takes long; its items are named in `skipped`.
    #[serde(default)]
    pub quick: bool,
}

/// Every number, figure and erratum of the items asked for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ReproduceOutcome {
    /// Numbers, in the order of the sources.
    pub items: Vec<Check>,
    /// What each item is.
    pub titles: Vec<Titled>,
    /// How many of the numbers agree, are excused by an erratum, or neither.
    pub counts: Counts,
    /// Figures.
    pub figures: Vec<Figure>,
    /// What is wrong in the sources: of whole chapters that were asked for, and what a number here names.
    pub errata: Vec<Erratum>,
    /// Items that `quick` left out.
    pub skipped: Vec<String>,
    /// Errata that `quick` left out, as their evidence takes long.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub skipped_errata: Vec<String>,
}

/// An item's name in words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Titled {
    /// `thesis.fig-4.3`.
    pub item: String,
    /// In words.
    pub title: String,
}

/// How many numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// In all, inputs among them.
    pub checks: usize,
    /// That agree, inputs among them.
    pub agree: usize,
    /// That do not, because of an error of the source that is shown.
    pub excused: usize,
    /// That do not, without an excuse.
    pub open: usize,
    /// Of those that agree, inputs of the computation, as printed: parameters that a source states.
    #[serde(default)]
    pub inputs: usize,
    /// Numbers that are computed: all but these inputs, which are no result of a computation.
    #[serde(default)]
    pub computed: usize,
    /// Those of them that agree.
    #[serde(default)]
    pub computed_agree: usize,
}

impl Counts {
    /// Of checks.
    fn of(items: &[Check]) -> Self {
        let count = |which: fn(&Check) -> bool| items.iter().filter(|c| which(c)).count();
        let inputs = count(|c| c.agrees && c.is_input());
        let agree = count(|c| c.agrees);
        Counts {
            checks: items.len(),
            agree,
            excused: count(|c| !c.agrees && c.erratum.is_some()),
            open: count(|c| !c.is_settled()),
            inputs,
            computed: items.len() - inputs,
            computed_agree: agree - inputs,
        }
    }

    /// `4 of 6 computed numbers agree, 3 inputs as printed`.
    #[must_use]
    pub fn words(&self) -> String {
        // of results that were written before these two were counted, too
        let (agree, of) = (self.agree.saturating_sub(self.inputs), self.checks.saturating_sub(self.inputs));
        let inputs = match self.inputs {
            0 => String::new(),
            1 => ", 1 input as printed".to_owned(),
            n => format!(", {n} inputs as printed"),
        };
        format!("{agree} of {of} computed numbers agree{inputs}")
    }
}

/// Computes the items that a spec names, and says what was read.
///
/// # Errors
/// A name that is none (with the nearest one); an item that cannot be computed.
pub fn reproduce(spec: &ReproduceSpec) -> Result<(ReproduceOutcome, Vec<Input>), StudyError> {
    let asked = spec.items.iter().map(|name| resolved(name)).collect::<Result<Vec<String>, _>>()?;
    let chosen = choose(&asked);
    let skipped: Vec<&Item> = chosen.iter().copied().filter(|i| spec.quick && i.slow).collect();
    let run: Vec<&Item> = chosen.iter().copied().filter(|i| !(spec.quick && i.slow)).collect();
    let failed = |item: &str| {
        let item = item.to_owned();
        move |source| StudyError::Reproduce { item, source: Box::new(source) }
    };
    let context = Context::new().map_err(failed("thesis.table-4.1"))?;
    let sheet = |item: &&Item| {
        let mut sheet = Sheet::new(item.name);
        (item.run)(&context, &mut sheet).map_err(failed(item.name))?;
        Ok::<_, StudyError>(sheet)
    };
    let sheets: Vec<Sheet> = run.par_iter().map(sheet).collect::<Result<_, _>>()?;
    let titles = run.iter().map(|i| Titled { item: i.name.to_owned(), title: i.title.to_owned() }).collect();
    let (mut items, mut figures) = (Vec::new(), Vec::new());
    for sheet in sheets {
        items.extend(sheet.checks);
        figures.extend(sheet.figures);
    }
    let named = |id: &str| items.iter().any(|c: &Check| c.erratum.as_deref() == Some(id));
    let whole = |id: &str| {
        let chapter = id.trim_start_matches('E').split('.').next().unwrap_or_default();
        let (source, chapter) = match chapter {
            "P" => ("paper", None),
            n => ("thesis", Some(format!("thesis.ch-{n}"))),
        };
        asked.is_empty() || asked.iter().any(|g| g == source || Some(g) == chapter.as_ref())
    };
    let wanted = errata::all().into_iter().filter(|e| named(e.id) || whole(e.id));
    let (late, shown): (Vec<_>, Vec<_>) = wanted.partition(|e| spec.quick && e.slow && !named(e.id));
    let skipped_errata = late.iter().map(|e| e.id.to_owned()).collect();
    let errata = shown
        .into_par_iter()
        .map(|e| e.computed(&context).map_err(failed(e.id)))
        .collect::<Result<Vec<_>, _>>()?;
    let counts = Counts::of(&items);
    let skipped = skipped.iter().map(|i| i.name.to_owned()).collect();
    let outcome = ReproduceOutcome { items, titles, counts, figures, errata, skipped, skipped_errata };
    Ok((outcome, inputs(&run)?))
}

/// Every erratum with its evidence: what `docs/errata.md` holds.
///
/// # Errors
/// Evidence that cannot be computed.
pub fn all_errata() -> Result<Vec<Erratum>, StudyError> {
    let failed = |item: &'static str| {
        move |source| StudyError::Reproduce { item: item.to_owned(), source: Box::new(source) }
    };
    let context = Context::new().map_err(failed("thesis.table-4.1"))?;
    errata::all().into_par_iter().map(|e| e.computed(&context).map_err(failed(e.id))).collect()
}

/// The names that an item may be asked by, with the chapters and sources that hold some.
#[must_use]
pub fn reproducible() -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for item in ITEMS {
        for group in groups(item.name) {
            if !names.contains(&group) {
                names.push(group);
            }
        }
    }
    names.extend(ITEMS.iter().map(|i| i.name.to_owned()));
    names
}

/// `thesis` and `thesis.ch-4` of `thesis.fig-4.3`.
fn groups(name: &str) -> Vec<String> {
    let Some((source, place)) = name.split_once('.') else { return Vec::new() };
    let number = place.split_once('-').map_or("", |(_, n)| n);
    let chapter = number.split_once('.').map(|(chapter, _)| format!("{source}.ch-{chapter}"));
    std::iter::once(source.to_owned()).chain(chapter.filter(|_| source == "thesis")).collect()
}

/// The part of a source that an item or figure is of: `thesis.ch-4`, `paper`.
#[must_use]
pub fn chapter_of(item: &str) -> String {
    groups(item).pop().unwrap_or_default()
}

/// An item, chapter or source that can be asked for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Listed {
    /// `thesis.ch-4`, `thesis.fig-4.3`.
    pub name: String,
    /// An item's title; how many items a chapter or source holds.
    pub what: String,
    /// Whether `--quick` leaves the item out.
    pub slow: bool,
}

/// Sources, chapters and items, in the order of the sources; nothing is computed.
#[must_use]
pub fn reproducible_list() -> Vec<Listed> {
    let one = |name: String| match ITEMS.iter().find(|i| i.name == name) {
        Some(i) => Listed { name, what: i.title.to_owned(), slow: i.slow },
        None => {
            let n = ITEMS.iter().filter(|i| groups(i.name).contains(&name)).count();
            Listed { name, what: format!("{n} items"), slow: false }
        }
    };
    reproducible().into_iter().map(one).collect()
}

/// The name of an item, chapter or source as it is asked for: `ch-4` is the thesis's, and a figure's panel (`thesis.fig-5.5-a`) is its figure.
fn resolved(name: &str) -> Result<String, StudyError> {
    let known = reproducible();
    let figure = |n: &str| match n.rsplit_once('-') {
        Some((figure, panel)) if panel.len() == 1 && panel.chars().all(|c| c.is_ascii_lowercase()) => {
            figure.to_owned()
        }
        _ => n.to_owned(),
    };
    let ways = [name.to_owned(), figure(name), format!("thesis.{name}"), figure(&format!("thesis.{name}"))];
    if let Some(found) = ways.into_iter().find(|n| known.contains(n)) {
        return Ok(found);
    }
    let near = nearest(name, known.iter().map(String::as_str));
    let near = near.map_or_else(String::new, |n| format!(" (did you mean `{n}`?)"));
    let expected = "the name of an item, thesis.ch-N, thesis or paper (reproduce --list has all)".to_owned();
    Err(StudyError::Setting { field: "ITEM", expected, found: format!("`{name}`{near}") })
}

fn choose(asked: &[String]) -> Vec<&'static Item> {
    let wanted = |item: &&Item| {
        asked.is_empty() || asked.iter().any(|a| a == item.name || groups(item.name).contains(a))
    };
    ITEMS.iter().filter(wanted).collect()
}

/// The published vehicle and road that the items start from.
fn inputs(run: &[&Item]) -> Result<Vec<Input>, StudyError> {
    let mut names: Vec<(&str, CaseKind)> = Vec::new();
    for item in run {
        for case in cases_of(item.name) {
            if !names.contains(case) {
                names.push(*case);
            }
        }
    }
    let input = |(name, kind): (&str, CaseKind)| {
        Ok(Input::of(format!("case:{name}"), find(name, kind)?.toml.as_bytes()))
    };
    names.into_iter().map(input).collect()
}

/// Published vehicles and roads of an item's chapter.
fn cases_of(item: &str) -> &'static [(&'static str, CaseKind)] {
    const QUARTER: &[(&str, CaseKind)] =
        &[(context::CAR, CaseKind::Vehicle), (context::ROAD, CaseKind::Road)];
    const HALF: &[(&str, CaseKind)] = &[
        ("turkay-half-car", CaseKind::Vehicle),
        ("turkay-first-order", CaseKind::Road),
        ("turkay-white-velocity-rounded", CaseKind::Road),
    ];
    const FULL: &[(&str, CaseKind)] =
        &[("chalasani-full-car", CaseKind::Vehicle), ("turkay-first-order", CaseKind::Road)];
    const CABIN: &[(&str, CaseKind)] = &[
        (chapter_8_cabin::CABIN, CaseKind::Vehicle),
        (chapter_8_cabin::TRUCK, CaseKind::Vehicle),
        (context::ROAD, CaseKind::Road),
    ];
    match groups(item).last().map(String::as_str) {
        Some("paper") => &[(paper_car::PAPER_CAR, CaseKind::Vehicle)],
        Some("thesis.ch-6") => HALF,
        Some("thesis.ch-7") => FULL,
        Some("thesis.ch-8") => CABIN,
        _ => QUARTER,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_know_their_chapter() {
        let mut names: Vec<&str> = ITEMS.iter().map(|i| i.name).collect();
        names.sort_unstable();
        let all = names.len();
        names.dedup();
        assert_eq!(names.len(), all);
        assert_eq!(groups("thesis.fig-4.3"), ["thesis", "thesis.ch-4"]);
        assert_eq!(groups("paper.table-1"), ["paper"]);
        let mut ids: Vec<&str> = errata::all().iter().map(|e| e.id).collect();
        let all = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), all);
    }

    #[test]
    fn an_item_a_chapter_and_a_wrong_name() {
        let of = |names: &[&str]| choose(&names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>());
        assert_eq!(of(&["thesis.fig-4.3"]).len(), 1);
        assert!(of(&["thesis.ch-3"]).iter().all(|i| i.name.contains("-3.")));
        assert_eq!(of(&[]).len(), ITEMS.len());
        let e = resolved("thesis.fig-43").unwrap_err().to_string();
        assert!(e.contains("`thesis.fig-43` (did you mean `thesis.fig-4.3`?)"), "{e}");
    }

    #[test]
    fn a_chapter_and_a_panel_are_found_by_their_short_names() {
        let of = |name: &str| resolved(name).unwrap();
        assert_eq!(of("ch-4"), "thesis.ch-4");
        assert_eq!([of("thesis.fig-5.5-a"), of("fig-5.5-b")], ["thesis.fig-5.5"; 2]);
        assert_eq!([of("paper.fig-3"), of("paper")], ["paper.fig-3", "paper"]);
        assert!(resolved("thesis.fig-99.1-a").is_err());
    }

    #[test]
    fn counts_say_what_the_headline_says() {
        let mut sheet = Sheet::new("thesis.sec-0.0");
        sheet.printed("mass", "1.0", 1.0).noted(item::INPUT);
        sheet.printed("right", "1.0", 1.0);
        sheet.printed("wrong", "1.0", 2.0);
        let counts = Counts::of(&sheet.checks);
        assert_eq!((counts.checks, counts.agree, counts.inputs), (3, 2, 1));
        assert_eq!((counts.computed_agree, counts.computed), (1, 2));
        assert_eq!(counts.words(), "1 of 2 computed numbers agree, 1 input as printed");
        assert_eq!([chapter_of("thesis.fig-5.5-a"), chapter_of("paper.fig-7-d")], ["thesis.ch-5", "paper"]);
    }

    #[test]
    fn the_list_counts_the_items_of_a_chapter() {
        let list = reproducible_list();
        let find = |name: &str| list.iter().find(|l| l.name == name).unwrap().clone();
        let own = ITEMS.iter().filter(|i| i.name.contains("-3.") && i.name.starts_with("thesis")).count();
        assert_eq!(find("thesis.ch-3").what, format!("{own} items"));
        assert!(find("thesis.fig-2.1").slow && !find("thesis.fig-4.3").slow);
    }
}
