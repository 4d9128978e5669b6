//! The tables of a design's page: responses by groups, the goal, the certificate, poles and matrices.

use super::design::capital;
use super::html::{Html, element, note, paragraph, table};
use super::numbers::{fixed, signed, significant};
use crate::study::{
    ClaimRow, DesignMethod, DesignOutcome, ResponseGroup, ResponseRow, Rms, TruncatedRow, VertexRow,
    VertexTable,
};

/// More poles than these are shown on demand.
const MANY_POLES: usize = 16;
/// The caption of the table that has a limit.
const RMS: &str = "rms on the road";
/// An imaginary part below this share of a pole is rounding.
const REAL: f64 = 1e-12;

/// What a table shows of a row: unit, passive, then closed and its change, the limit and its.
type Cells = fn(&DesignOutcome, &ResponseRow<'_>) -> [Html; 6];

/// rms and largest gains by groups; corners on demand. Without a loop, the passive vehicle's alone.
pub(super) fn ride(o: &DesignOutcome) -> Option<Html> {
    let rows = o.rows();
    if rows.is_empty() {
        return None;
    }
    let (whole, corners): (Vec<_>, Vec<_>) = rows.into_iter().partition(|r| r.corner_of.is_none());
    let gain = format!("largest gain, per {} of the disturbance", o.per());
    let both = |rows: &[ResponseRow<'_>]| {
        responses(o, RMS, rows, rms_cells).and(responses(o, &gain, rows, peak_cells))
    };
    let mut body = both(&whole).and(limit_note(o)).and(note(
        "rms are of the road's part alone, at the speed given; largest gains are H∞ norms from the design's disturbance. A \
         name that has corners stands for all of them: the root of the sum of their squares, and their joint gain.",
    ));
    if !corners.is_empty() {
        let summary = element("summary", &[], "Every corner");
        body.push(element("details", &[], summary.and(both(&corners))));
    }
    Some(body)
}

fn responses(o: &DesignOutcome, caption: &str, rows: &[ResponseRow<'_>], cells: Cells) -> Html {
    let head = ["output", "unit", "#passive", "#closed", "#change", "#limit", "#its change"];
    let limited = caption == RMS && rows.iter().any(|r| r.limit.is_some());
    let shown: Vec<usize> = (0..head.len())
        .filter(|k| match k {
            0..=2 => true,
            3..=4 => o.verified.is_some(),
            _ => limited,
        })
        .collect();
    let mut body: Vec<Vec<Html>> = Vec::new();
    for group in ResponseGroup::ALL {
        let own: Vec<&ResponseRow<'_>> = rows.iter().filter(|r| r.group == group).collect();
        if !own.is_empty() {
            let mut heading = vec![Html::default(); shown.len()];
            heading[0] = element("strong", &[], capital(group.heading()));
            body.push(heading);
        }
        for r in own {
            let all: Vec<Html> = std::iter::once(r.name.into()).chain(cells(o, r)).collect();
            body.push(shown.iter().filter_map(|k| all.get(*k).cloned()).collect());
        }
    }
    table(caption, &shown.iter().map(|k| head[*k]).collect::<Vec<_>>(), body)
}

fn rms_cells(_: &DesignOutcome, r: &ResponseRow<'_>) -> [Html; 6] {
    let shown = |r: Option<Rms>| match r {
        Some(Rms::Finite(v)) => significant(v, 4).into(),
        Some(Rms::Infinite(_)) => "infinite".into(),
        None => "–".into(),
    };
    let (passive, closed) = (shown(r.rms[0]), shown(r.rms[1]));
    [r.unit.into(), passive, closed, percent(r.rms_change()), shown(r.limit), percent(r.limit_change())]
}

fn peak_cells(o: &DesignOutcome, r: &ResponseRow<'_>) -> [Html; 6] {
    let shown = |v: Option<f64>| v.map_or_else(|| "–".into(), |v| Html::from(significant(v, 4)));
    let unit = format!("{} per {}", r.unit, o.per());
    let (passive, closed) = (shown(r.peak[0]), shown(r.peak[1]));
    [unit.into(), passive, closed, percent(r.peak_change()), Html::default(), Html::default()]
}

fn percent(change: Option<f64>) -> Html {
    change.map_or_else(|| "–".into(), |c| format!("{} %", signed(100.0 * c, 1)).into())
}

/// What the column of the limit is.
fn limit_note(o: &DesignOutcome) -> Html {
    let Some(limit) = o.limit.as_ref().filter(|l| !l.rms.is_empty()) else { return Html::default() };
    let weights: Vec<String> =
        limit.weights.iter().map(|(name, w)| format!("{name} {}", significant(*w, 3))).collect();
    note(format!(
        "The limit is the regulator that sees every state, for the H2 norms of {}: their weighted sum of squares is {} there, and no \
         controller brings that sum lower. A single output may be smaller than its limit, where another one pays for it.",
        weights.join(", "),
        significant(limit.value, 4)
    ))
}

/// The goal's value: passive, closed, limit, as far as they are known.
pub(super) fn goal(o: &DesignOutcome) -> Option<Html> {
    let named = [
        ("passive", "passive vehicle"),
        ("verified", "closed loop"),
        ("worst_passive", "the vehicle that is the worst then, passive"),
        ("worst", "worst of all vehicles"),
        ("limit", "what no controller beats"),
    ];
    let passive = o.objective.get("passive").copied();
    let row = |(key, words): (&str, &str)| {
        let value = *o.objective.get(key)?;
        let passive = if key == "worst" { o.objective.get("worst_passive").copied() } else { passive };
        let change = passive.filter(|p| *p > 0.0 && !key.ends_with("passive")).map(|p| value / p - 1.0);
        Some(vec![words.into(), significant(value, 4).into(), percent(change)])
    };
    let rows: Vec<Vec<Html>> = named.into_iter().filter_map(row).collect();
    let columns = if rows.len() > 1 { 3 } else { 2 };
    let rows: Vec<Vec<Html>> = rows.into_iter().map(|r| r.into_iter().take(columns).collect()).collect();
    let caption =
        format!("{}, each over its passive norm (a pure number, smaller is better)", o.goal_words());
    (!rows.is_empty()).then(|| table(&capital(&caption), &["", "#value", "#change"][..columns], rows))
}

/// What the synthesis claims and what the loop shows.
pub(super) fn certificate(o: &DesignOutcome) -> Option<Html> {
    let rows = o.claim_rows();
    let both = rows.iter().any(|r| r.recomputed.is_some());
    let row = |r: &ClaimRow| {
        let shown = |v: f64| if r.is_count { format!("{v:.0}") } else { significant(v, 6) };
        let mut cells: Vec<Html> =
            vec![capital(&r.words).into(), r.unit.as_str().into(), shown(r.claimed).into()];
        if both {
            cells.push(r.recomputed.map_or_else(Html::default, |v| shown(v).into()));
        }
        cells
    };
    let head = ["number", "unit", "#claimed", "#from vehicle and controller alone"];
    let mut body: Vec<Vec<Html>> = rows.iter().map(row).collect();
    if let Some(gain) = o.endless_gain() {
        let mut cells = vec![Html::from("The controller's largest gain"), "N per unit".into(), gain.into()];
        cells.extend(both.then(Html::default));
        body.push(cells);
    }
    let caption = if o.vertices.is_empty() {
        "what is claimed, and what the loop itself shows"
    } else if o.design.method == DesignMethod::FixedOrder {
        "what is claimed of all vehicles, and what the worst loop shows"
    } else {
        "what is claimed of the whole range, and what the loop of its worst corner shows"
    };
    (!rows.is_empty()).then(|| table(caption, &head[..if both { 4 } else { 3 }], body))
}

/// Each vehicle of a range, passive, with the gain of the one as stated, with the robust one.
pub(super) fn vertices(o: &DesignOutcome) -> Option<Html> {
    let shown = |v: Option<f64>| v.map_or_else(|| "–".into(), |v| Html::from(significant(v, 4)));
    let one = |t: &VertexTable| {
        // only a gain for a range has a nominal one beside it
        let range = o.design.method == DesignMethod::RobustStateFeedback;
        let row = |r: &VertexRow| {
            let nominal = range.then(|| shown(r.nominal));
            [r.place.as_str().into(), shown(r.passive)]
                .into_iter()
                .chain(nominal)
                .chain([shown(r.robust)])
                .collect()
        };
        let unit = if t.unit.is_empty() { String::new() } else { format!(", {}", t.unit) };
        let head: &[&str] = if range {
            &["vehicle", "#passive", "#gain for the vehicle as stated", "#robust gain"]
        } else {
            &["vehicle", "#passive", "#closed"]
        };
        table(&format!("{}{unit}", t.quantity), head, t.rows.iter().map(row).collect())
    };
    let tables = o.vertex_tables();
    (!tables.is_empty()).then(|| tables.iter().map(one).collect())
}

/// The controller with fewer states.
pub(super) fn truncated(o: &DesignOutcome) -> Option<Html> {
    let rows = o.truncated_rows();
    let shown = |v: Option<f64>| v.map_or_else(|| "–".into(), |v| Html::from(significant(v, 4)));
    let row = |r: &TruncatedRow| {
        let stable = if r.stable { "stable" } else { "not stable" };
        vec![r.order.to_string().into(), stable.into(), shown(r.objective), shown(r.over_bound)]
    };
    let head = ["#states", "its loop", "#goal", "#largest gain over its bound"];
    let body: Vec<Vec<Html>> = rows.iter().map(row).collect();
    (!body.is_empty()).then(|| table("balanced truncations, each in a loop of its own", &head, body))
}

/// Poles with Im ≥ 0.
pub(super) fn poles(o: &DesignOutcome) -> Option<Html> {
    let of = |poles: &[[f64; 2]], which: &str| -> Vec<Vec<Html>> {
        let upper = poles.iter().filter(|p| p[1] >= 0.0);
        let row = |p: &[f64; 2]| {
            let size = p[0].hypot(p[1]);
            let im = if p[1] <= REAL * size { 0.0 } else { p[1] };
            let damping = if size > 0.0 { fixed(-100.0 * p[0] / size, 1) } else { "–".to_owned() };
            let hz = significant(size / std::f64::consts::TAU, 4);
            let numbers = [significant(p[0], 4), significant(im, 4), hz, damping];
            std::iter::once(which.into()).chain(numbers.map(Html::from)).collect()
        };
        upper.map(row).collect()
    };
    let mut rows = of(&o.passive.poles, "passive");
    if let Some(closed) = &o.verified {
        rows.extend(of(&closed.poles, "closed"));
    }
    let own = o.controller.as_ref().and_then(|k| k.state_space().ok()?.poles().ok()).unwrap_or_default();
    rows.extend(of(&own.iter().map(|p| [p.re, p.im]).collect::<Vec<_>>(), "controller itself"));
    let head = ["loop", "#Re λ, 1/s", "#Im λ, rad/s", "#|λ|/2π, Hz", "#damping, %"];
    let count = rows.len();
    let table = (count > 0).then(|| table("poles λ with Im λ ≥ 0", &head, rows))?;
    if count <= MANY_POLES {
        return Some(table);
    }
    let summary = element("summary", &[], format!("All {count} poles with Im λ ≥ 0"));
    let slowest = o.verified.as_ref().map(|c| c.poles.iter().map(|p| -p[0]).fold(f64::INFINITY, f64::min));
    let words = slowest
        .map(|s| paragraph(format!("The slowest pole of the loop decays at {} 1/s.", significant(s, 4))));
    Some(words.unwrap_or_default().and(element("details", &[], summary.and(table))))
}

/// Its matrices.
pub(super) fn controller(o: &DesignOutcome) -> Option<Html> {
    let k = o.controller.as_ref()?;
    let matrix = |name: &str, rows: &[Vec<f64>]| {
        let text: Vec<String> = rows
            .iter()
            .map(|r| r.iter().map(|v| format!("{v:.9e}")).collect::<Vec<_>>().join("  "))
            .collect();
        element("h3", &[], name).and(element("pre", &[], text.join("\n")))
    };
    let with_unit = |name: &String| {
        let unit = o.units.get(name).map_or_else(String::new, |u| format!(" in {u}"));
        format!("{name}{unit}")
    };
    let measures: Vec<String> = k.inputs.iter().map(with_unit).collect();
    let names = format!("Measures {}; drives {}, in N.", measures.join(", "), k.outputs.join(", "));
    let gains = o.gain_rows();
    if !gains.is_empty() {
        let row = |r: &crate::study::GainRow<'_>| {
            let values = r.values.iter().map(|v| significant(*v, 6).into());
            [Html::from(r.name), r.unit.as_str().into()].into_iter().chain(values).collect()
        };
        let actuators: Vec<String> = k.outputs.iter().map(|u| format!("#{u}")).collect();
        let of = if o.design.method == DesignMethod::FixedOrder { "measurement" } else { "state" };
        let head: Vec<&str> = [of, "unit"].into_iter().chain(actuators.iter().map(String::as_str)).collect();
        return Some(paragraph(names).and(table(
            "the gain K of u = K y",
            &head,
            gains.iter().map(row).collect(),
        )));
    }
    let matrices = matrix("A", &k.a).and(matrix("B", &k.b)).and(matrix("C", &k.c)).and(matrix("D", &k.d));
    let summary = element("summary", &[], "Its matrices: K = C(sI − A)⁻¹B + D");
    Some(paragraph(names).and(element("details", &[], summary.and(matrices))))
}
