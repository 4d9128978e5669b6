//! A fixed-order design on its page: goals and bounds with what holds the optimum, and the search.

use super::design::capital;
use super::html::{Html, table};
use super::numbers::significant;
use crate::study::{DesignOutcome, SearchRow, TargetRow};

/// Goals and bounds in the loop.
pub(super) fn targets(o: &DesignOutcome) -> Option<Html> {
    let rows = o.target_rows();
    let many = rows.iter().any(|r| !r.vehicle.is_empty());
    // multipliers are of an optimum: of bounds that are not kept they are sizes of a penalty
    let kept = o.controller.is_some();
    let row = |r: &TargetRow| {
        let vehicle = many.then(|| Html::from(r.vehicle.as_str()));
        let multiplier = kept.then(|| Html::from(significant(r.multiplier, 3)));
        std::iter::once(Html::from(r.name.as_str()))
            .chain(vehicle)
            .chain([r.aim.into(), significant(r.relative, 4).into()])
            .chain(multiplier)
            .chain([r.peaks.as_str().into()])
            .collect()
    };
    let vehicle = many.then_some("#vehicle");
    let numbers: &[&str] = if kept { &["#value", "#multiplier"] } else { &["#at the least violation found"] };
    let head: Vec<&str> = std::iter::once("output")
        .chain(vehicle)
        .chain([""])
        .chain(numbers.iter().copied())
        .chain(["peaks that hold it, Hz"])
        .collect();
    let shares = "goals are weighted norms over passive ones, bounds the share of what is allowed";
    let caption = if kept {
        format!(
            "{shares}; a multiplier says how much a goal or bound holds the optimum, and 0 that it holds nothing"
        )
    } else {
        format!("{shares}; of the controller nearest to the bounds, which is not written as it exceeds them")
    };
    (!rows.is_empty()).then(|| table(&caption, &head, rows.iter().map(row).collect()))
}

/// What was done.
pub(super) fn search(o: &DesignOutcome) -> Option<Html> {
    let rows = o.search_rows();
    let row = |r: &SearchRow| vec![capital(r.words).into(), r.value.as_str().into()];
    let caption = "a local search from many starts: another controller of this order may be better";
    (!rows.is_empty()).then(|| table(caption, &["", "#"], rows.iter().map(row).collect()))
}
