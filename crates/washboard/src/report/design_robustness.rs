//! Robustness on a design's page: by kinds of numbers at first, every number on demand; the loop with an actuator.

use super::design::capital;
use super::html::{Html, element, note, table};
use super::numbers::signed;
use crate::study::{DesignOutcome, RobustnessRow};

/// Tables of what was changed, and of the actuator.
pub(super) fn robustness(o: &DesignOutcome) -> Option<Html> {
    let r = o.robustness.as_ref()?;
    let percent = format!("{:.0} %", 100.0 * r.share);
    let minimised = r.vehicle.iter().chain(&r.controller).any(|p| p.goal.is_some());
    let tabled = |caption: &str, rows: &[RobustnessRow], kinds: bool| {
        let mut head = vec!["changed"];
        head.extend(kinds.then_some("#numbers"));
        head.push("its loop");
        head.extend(kinds.then_some("worst"));
        head.extend(minimised.then_some("#goal"));
        head.extend(["norm that grows most", "#by"]);
        let row = |r: &RobustnessRow| {
            let mut cells: Vec<Html> = vec![capital(&r.what).into()];
            cells.extend(kinds.then(|| Html::from(r.count.to_string())));
            cells.push(r.stable_words().into());
            cells.extend(kinds.then(|| Html::from(r.worst.replace(" -", " −"))));
            cells.extend(minimised.then(|| share(r.goal)));
            cells.push(r.norm.as_ref().map_or_else(|| "–".into(), |(name, _)| name.as_str().into()));
            cells.push(share(r.norm.as_ref().map(|n| n.1)));
            cells
        };
        table(caption, &head, rows.iter().map(row).collect())
    };
    let kinds = tabled(
        &format!("one number changed by ±{percent}, all others as they are; against the loop as designed"),
        &o.robustness_rows(),
        true,
    );
    let mut words = format!(
        "Each number alone, down and up; the worse of both counts. Goal and norms are compared with those of the loop as designed. Poles move \
         with their conjugates by ±{percent} of themselves, residues as they are, and the other way round: no other choice of \
         states changes these."
    );
    if r.entries_left_out > 0 {
        words += &format!(
            " The {} entries of the controller's matrices are too many to be changed one by one.",
            r.entries_left_out
        );
    }
    if r.repeated_poles > 0 {
        words +=
            &format!(" {} poles of the controller are repeated ones and were left out.", r.repeated_poles);
    }
    if !r.left_out.is_empty() {
        words += &format!(" Left out, as they make no vehicle: {}.", r.left_out.join(", "));
    }
    let all = o.perturbed_rows();
    let summary = element("summary", &[], format!("Each of the {} numbers", all.len()));
    let each = element("details", &[], summary.and(tabled("", &all, false)));
    Some(kinds.and(note(words)).and(each).and(actuator(o).unwrap_or_default()))
}

fn actuator(o: &DesignOutcome) -> Option<Html> {
    let a = o.robustness.as_ref()?.actuator.as_ref()?;
    let rows: Vec<Vec<Html>> = o
        .actuator_rows()
        .into_iter()
        .map(|(what, answer)| vec![capital(&what).into(), answer.replace('-', "−").into()])
        .collect();
    let approximated = if a.stable.is_some() {
        format!(
            "the delay by Padé's approximation of order {}, whose error times the loop's gain is at most {:.0e} wherever that gain is a tenth or more",
            a.delay_order, a.delay_error
        )
    } else {
        format!(
            "the delay by Padé's approximation, whose error times the loop's gain is {:.0e} at order {}: too much for an answer",
            a.delay_error, a.delay_order
        )
    };
    let words = format!(
        "Stability of controller, actuators and vehicle together; {approximated}. Bandwidths are looked at from 0.1 Hz to 10 kHz and delays from \
         none to 1 s in steps of 25 %, as far as the delay can be approximated, and ends of what is stable are refined. A slow actuator \
         may be stable where a faster one is not: it does less."
    );
    Some(element("h3", &[], "With an actuator").and(table("", &["loop", "answer"], rows)).and(note(words)))
}

fn share(v: Option<f64>) -> Html {
    v.filter(|v| v.is_finite()).map_or_else(|| "–".into(), |v| format!("{} %", signed(100.0 * v, 1)).into())
}
