//! A fixed-order design on its page: goals and bounds with what holds the optimum, and the search.

use super::design::capital;
use super::html::{Html, table};
use super::numbers::significant;
use crate::study::{DesignOutcome, SearchRow, TargetRow};

/// Goals and bounds in the loop.
pub(super) fn targets(o: &DesignOutcome) -> Option<Html> {
    let rows = o.target_rows();
    let many = rows.iter().any(|r| !r.vehicle.is_empty());
    let row = |r: &TargetRow| {
        let vehicle = many.then(|| Html::from(r.vehicle.as_str()));
        let numbers = [significant(r.relative, 6), significant(r.multiplier, 3), r.peaks.clone()];
        std::iter::once(Html::from(r.name.as_str()))
            .chain(vehicle)
            .chain([r.aim.into()])
            .chain(numbers.into_iter().map(Html::from))
            .collect()
    };
    let head: &[&str] = if many {
        &["output", "#vehicle", "", "#value", "#multiplier", "peaks that hold it, Hz"]
    } else {
        &["output", "", "#value", "#multiplier", "peaks that hold it, Hz"]
    };
    let caption = "goals are weighted norms over passive ones, bounds the share of what is allowed; a multiplier of 0 holds nothing";
    (!rows.is_empty()).then(|| table(caption, head, rows.iter().map(row).collect()))
}

/// What was done.
pub(super) fn search(o: &DesignOutcome) -> Option<Html> {
    let rows = o.search_rows();
    let row = |r: &SearchRow| vec![capital(r.words).into(), r.value.as_str().into()];
    let caption = "a local search from many starts: another controller of this order may be better";
    (!rows.is_empty()).then(|| table(caption, &["", "#"], rows.iter().map(row).collect()))
}
