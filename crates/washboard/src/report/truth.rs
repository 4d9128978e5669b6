//! What we knew of a simulated drive beside what was found.

use super::Plots;
use super::html::{Html, classed, note, paragraph, table};
use super::numbers::{signed, significant, to_digit_of, with_sd};
use super::road::one_sided;
use crate::study::{IdentifiedMode, IdentifyOutcome, TrueMode, Truth};

/// A deviation of more standard deviations than these stands out.
const FAR: f64 = 3.0;

/// Modes, road and parameters, each with its deviation.
pub(super) fn comparison(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    let truth = outcome.truth.as_ref()?;
    let pairs = matched(&truth.modes, &outcome.modes);
    let mut body = summary(&pairs).map_or_else(Html::default, paragraph);
    body.push(modes_table(outcome, &pairs));
    body.push(road_table(outcome, truth));
    body.push(parameter_table(outcome, truth));
    Some(body.and(note(format!(
        "The identification never saw the left columns. Deviations in sd count the standard deviations that the method \
         itself gave; beyond {FAR} they are bold."
    ))))
}

/// A true mode and the one found for it; a mode that was not there has no truth.
type Pair<'a> = (Option<&'a TrueMode>, Option<&'a IdentifiedMode>);

/// Equal labels first, then the nearest pole.
fn matched<'a>(truth: &'a [TrueMode], found: &'a [IdentifiedMode]) -> Vec<Pair<'a>> {
    let mut partner: Vec<Option<usize>> = vec![None; truth.len()];
    let mut free: Vec<bool> = vec![true; found.len()];
    for (t, mode) in truth.iter().enumerate() {
        if let Some(k) = (0..found.len()).find(|k| free[*k] && found[*k].label == mode.label) {
            (partner[t], free[k]) = (Some(k), false);
        }
    }
    for (t, mode) in truth.iter().enumerate().filter(|(t, _)| partner[*t].is_none()).collect::<Vec<_>>() {
        let far =
            |k: &usize| (found[*k].freq_hz / mode.freq_hz - 1.0).hypot(found[*k].damping - mode.damping);
        let nearest = (0..found.len()).filter(|k| free[*k]).min_by(|a, b| far(a).total_cmp(&far(b)));
        if let Some(k) = nearest {
            (partner[t], free[k]) = (Some(k), false);
        }
    }
    let known = truth.iter().zip(&partner).map(|(t, k)| (Some(t), k.map(|k| &found[k])));
    known.chain((0..found.len()).filter(|k| free[*k]).map(|k| (None, Some(&found[k])))).collect()
}

/// The worst of the modes in a sentence.
fn summary(pairs: &[Pair]) -> Option<String> {
    let both: Vec<_> = pairs.iter().filter_map(|(t, m)| t.zip(*m)).collect();
    let worst = |of: &dyn Fn(&TrueMode, &IdentifiedMode) -> f64| {
        both.iter().map(|(t, m)| of(t, m).abs()).filter(|d| d.is_finite()).fold(0.0, f64::max)
    };
    let f = worst(&|t, m| 100.0 * (m.freq_hz / t.freq_hz - 1.0));
    let zeta = worst(&|t, m| 100.0 * (m.damping - t.damping));
    (!both.is_empty()).then(|| {
        format!(
            "{} of {} modes found; at worst {} % off in frequency and {} points in damping ratio.",
            both.len(),
            pairs.iter().filter(|(t, _)| t.is_some()).count(),
            significant(f, 2),
            significant(zeta, 2)
        )
    })
}

fn modes_table(outcome: &IdentifyOutcome, pairs: &[Pair]) -> Html {
    if outcome.modes.is_empty() && pairs.is_empty() {
        return Html::default();
    }
    let rows = pairs.iter().map(|(truth, found)| {
        let label = truth.map_or_else(|| found.map_or("", |m| m.label.as_str()), |t| t.label.as_str());
        let mut row: Vec<Html> = vec![label.into()];
        let f = (truth.map(|t| t.freq_hz), found.map(|m| (m.freq_hz, m.freq_sd_hz)));
        row.extend(cells(f.0, f.1, Scale::Percent));
        let zeta = found.map(|m| (100.0 * m.damping, m.damping_sd.map(|s| 100.0 * s)));
        row.extend(cells(truth.map(|t| 100.0 * t.damping), zeta, Scale::Points));
        row
    });
    let heads = [
        "mode",
        "# f known, Hz",
        "# f found, Hz",
        "# off, %",
        "# off, sd",
        "# ζ known, %",
        "# ζ found, %",
        "# off, points",
        "# off, sd",
    ];
    table("Modes", &heads, rows.collect())
}

fn road_table(outcome: &IdentifyOutcome, truth: &Truth) -> Html {
    let mut rows: Vec<Vec<Html>> = Vec::new();
    let mut add = |name: &str, known: f64, found: Option<(f64, Option<f64>)>| {
        if let Some(found) = found {
            let mut row: Vec<Html> = vec![name.into()];
            row.extend(cells(Some(known), Some(found), Scale::Percent));
            rows.push(row);
        }
    };
    if let Some(road) = &outcome.road {
        let (s0, sd) = one_sided(road);
        let name = "roughness S₀, 10⁻⁶ m³, one-sided per rad/m";
        add(name, 1e6 * truth.roughness_m3, Some((1e6 * s0, Some(1e6 * sd))));
        add("exponent e", truth.exponent, Some((road.exponent, Some(road.exponent_sd))));
    }
    if let Some(mu) = truth.mu {
        add("coherence of tracks μ", mu, outcome.coherence.as_ref().map(|c| (c.mu, Some(c.mu_sd))));
    }
    let delay = outcome.delay_s.map(|d| (1e3 * d, outcome.delay_sd_s.map(|s| 1e3 * s)));
    add("delay of the rear axle, ms", 1e3 * truth.delay_s, delay);
    if rows.is_empty() {
        return Html::default();
    }
    table("Road and delay", &["quantity", "# known", "# found", "# off, %", "# off, sd"], rows)
}

fn parameter_table(outcome: &IdentifyOutcome, truth: &Truth) -> Html {
    let rows: Vec<Vec<Html>> = truth
        .parameters
        .iter()
        .filter_map(|(name, known)| {
            let found = outcome.parameters.iter().find(|p| p.name == *name)?;
            let mut row: Vec<Html> = vec![name.as_str().into()];
            row.extend(cells(Some(*known), Some((found.value, Some(found.sd))), Scale::Percent));
            Some(row)
        })
        .collect();
    if rows.is_empty() {
        return Html::default();
    }
    table("Parameters", &["parameter", "# known", "# found", "# off, %", "# off, sd"], rows)
}

/// How a deviation is told.
#[derive(Clone, Copy)]
enum Scale {
    /// In per cent of the truth.
    Percent,
    /// As a difference: of a ratio in per cent that is points.
    Points,
}

/// Known, found, deviation, deviation in standard deviations.
fn cells(known: Option<f64>, found: Option<(f64, Option<f64>)>, scale: Scale) -> [Html; 4] {
    let sd = found.and_then(|(_, sd)| sd);
    let known_text = known.map_or_else(|| "none".to_owned(), |k| to_digit_of(k, sd));
    let Some((value, sd)) = found else {
        return [known_text.into(), "not found".into(), "".into(), "".into()];
    };
    let Some(known) = known else {
        return [known_text.into(), with_sd(value, sd).into(), "".into(), "".into()];
    };
    let off = match scale {
        Scale::Percent if known != 0.0 => signed(100.0 * (value / known - 1.0), 2),
        Scale::Percent => "–".to_owned(),
        Scale::Points => signed(value - known, 2),
    };
    let in_sd = sd.filter(|s| *s > 0.0).map_or_else(Html::default, |s| {
        let count = (value - known) / s;
        let text = signed(count, 1);
        if count.abs() > FAR { classed("strong", "far", text) } else { text.into() }
    });
    [known_text.into(), with_sd(value, sd).into(), off.into(), in_sd]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(label: &str, freq_hz: f64) -> IdentifiedMode {
        IdentifiedMode {
            freq_hz,
            freq_sd_hz: Some(0.01),
            damping: 0.3,
            damping_sd: None,
            pole: [0.0, 0.0],
            shape: Vec::new(),
            label: label.into(),
            ..IdentifiedMode::default()
        }
    }

    fn known(label: &str, freq_hz: f64) -> TrueMode {
        TrueMode { label: label.into(), freq_hz, damping: 0.3 }
    }

    #[test]
    fn labels_decide_before_distances_and_nothing_is_lost() {
        let truth = [known("hop", 8.0), known("heave", 1.0), known("gone", 30.0)];
        let modes = [found("mode 1", 1.1), found("hop", 9.0)];
        let pairs = matched(&truth, &modes);
        let freq: Vec<_> = pairs.iter().map(|(_, m)| m.map(|m| m.freq_hz)).collect();
        assert_eq!(freq, [Some(9.0), Some(1.1), None]);
        let more = [found("hop", 8.1), found("extra", 3.0)];
        let pairs = matched(&truth[..1], &more);
        assert!(pairs.len() == 2 && pairs[1].0.is_none());
    }

    #[test]
    fn deviations_are_from_the_truth_and_far_ones_stand_out() {
        let [k, f, off, sd] = cells(Some(8.0), Some((8.08, Some(0.02))), Scale::Percent);
        assert_eq!([k.as_str(), f.as_str(), off.as_str()], ["8.00", "8.08 ± 0.02", "+1.00"]);
        assert_eq!(sd.as_str(), "<strong class=\"far\">+4.0</strong>");
        let [.., off, sd] = cells(Some(28.0), Some((27.5, None)), Scale::Points);
        assert!(off.as_str() == "−0.50" && sd == Html::default());
    }
}
