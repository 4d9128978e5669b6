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
pub use item::{Check, Curve, Erratum, Evidence, Figure, Relation};
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
    /// In all.
    pub checks: usize,
    /// That agree.
    pub agree: usize,
    /// That do not, because of an error of the source that is shown.
    pub excused: usize,
    /// That do not, without an excuse.
    pub open: usize,
}

/// Computes the items that a spec names, and says what was read.
///
/// # Errors
/// A name that is none (with the nearest one); an item that cannot be computed.
pub fn reproduce(spec: &ReproduceSpec) -> Result<(ReproduceOutcome, Vec<Input>), StudyError> {
    let chosen = choose(&spec.items)?;
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
        spec.items.is_empty() || spec.items.iter().any(|g| g == source || Some(g) == chapter.as_ref())
    };
    let errata = errata::all()
        .into_par_iter()
        .filter(|e| (named(e.id) || whole(e.id)) && (named(e.id) || !(spec.quick && e.slow)))
        .map(|e| e.computed(&context).map_err(failed(e.id)))
        .collect::<Result<Vec<_>, _>>()?;
    let counts = Counts {
        checks: items.len(),
        agree: items.iter().filter(|c| c.agrees).count(),
        excused: items.iter().filter(|c| !c.agrees && c.erratum.is_some()).count(),
        open: items.iter().filter(|c| !c.is_settled()).count(),
    };
    let skipped = skipped.iter().map(|i| i.name.to_owned()).collect();
    Ok((ReproduceOutcome { items, titles, counts, figures, errata, skipped }, inputs(&run)?))
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

fn choose(asked: &[String]) -> Result<Vec<&'static Item>, StudyError> {
    let known = reproducible();
    for name in asked {
        if !known.contains(name) {
            let near = nearest(name, known.iter().map(String::as_str));
            let near = near.map_or_else(String::new, |n| format!(" (did you mean `{n}`?)"));
            let expected = "the name of an item, thesis.ch-N, thesis or paper".to_owned();
            return Err(StudyError::Setting { field: "ITEM", expected, found: format!("`{name}`{near}") });
        }
    }
    let wanted = |item: &&Item| {
        asked.is_empty() || asked.iter().any(|a| a == item.name || groups(item.name).contains(a))
    };
    Ok(ITEMS.iter().filter(wanted).collect())
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
        assert_eq!(of(&["thesis.fig-4.3"]).unwrap().len(), 1);
        assert!(of(&["thesis.ch-3"]).unwrap().iter().all(|i| i.name.contains("-3.")));
        assert_eq!(of(&[]).unwrap().len(), ITEMS.len());
        let e = of(&["thesis.fig-43"]).unwrap_err().to_string();
        assert!(e.contains("`thesis.fig-43` (did you mean `thesis.fig-4.3`?)"), "{e}");
    }
}
