//! What was recorded, what was repaired, and how the spectra were made.

use super::Plots;
use super::html::{Html, classed, element, table};
use super::numbers::{fixed, plain, significant};
use crate::signal::Repair;
use crate::study::IdentifyOutcome;

/// Facts, channels and repairs.
pub(super) fn recording(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    let r = &outcome.recording;
    let mut facts = vec![
        ("description", r.name.clone()),
        ("duration", format!("{} s ({} min)", plain(r.duration_s), fixed(r.duration_s / 60.0, 1))),
        ("sampling", format!("{} Hz", plain(r.rate_hz))),
    ];
    if let Some(v) = r.speed_m_s {
        let spread = r
            .speed_spread_m_s
            .map_or_else(String::new, |s| format!(", standard deviation {} m/s", significant(s, 2)));
        facts.push(("speed", format!("{} m/s ({} km/h){spread}", plain(v), fixed(3.6 * v, 1))));
    }
    facts.push(("segments of the spectra", format!("{} s", plain(r.segment_s))));
    facts.push(("independent averages", fixed(r.averages, 0)));
    let [low, high] = r.band_hz;
    facts.push(("band used", format!("{} to {} Hz", plain(low), plain(high))));
    let facts = facts
        .into_iter()
        .map(|(name, value)| element("div", &[], element("dt", &[], name).and(element("dd", &[], value))));
    let mut body = classed("dl", "facts", facts.collect::<Html>());
    body.push(channels(outcome));
    if !r.repairs.is_empty() {
        body.push(element("h3", &[], "Repairs and faults of the data"));
        body.push(element("ul", &[], r.repairs.iter().map(repair).collect::<Html>()));
    }
    Some(body)
}

fn repair(repair: &Repair) -> Html {
    let channel = repair.channel.as_ref().map_or_else(String::new, |c| format!("{c}: "));
    let start = repair.start_s.map_or_else(String::new, |s| format!(", first at {} s", fixed(s, 2)));
    let count = if repair.count == 1 { "1 sample".to_owned() } else { format!("{} samples", repair.count) };
    element("li", &[], format!("{channel}{} ({count}{start})", repair.text))
}

fn channels(outcome: &IdentifyOutcome) -> Html {
    let noisy = !outcome.noise.is_empty();
    let rows = outcome.recording.channels.iter().map(|c| {
        let mut row: Vec<Html> = vec![
            c.name.as_str().into(),
            c.quantity.as_str().into(),
            c.place.as_str().into(),
            c.wheel.as_deref().unwrap_or("–").into(),
            c.unit.as_str().into(),
            significant(c.rms, 3).into(),
        ];
        if noisy {
            let floor = outcome.noise.iter().find(|n| n.channel == c.name);
            let cell = |v: Option<f64>| v.map_or_else(|| "–".to_owned(), |v| significant(v, 3));
            row.push(cell(floor.map(|n| n.floor_per_hz)).into());
            row.push(cell(floor.map(|n| n.rms)).into());
        }
        row
    });
    let mut heads = vec!["channel", "quantity", "place", "wheel", "unit", "# rms, unit"];
    if noisy {
        heads.extend(["# noise floor, unit²/Hz", "# noise rms, unit"]);
    }
    table("Channels", &heads, rows.collect())
}
