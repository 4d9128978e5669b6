//! The job `compare`: what changed between two identifications, and whether that is more than their scatter.

use super::checked_result::read_identification;
use super::compare_modes::{aligned, matched};
use super::compare_outcome::{
    Change, CompareOutcome, ComparedChannel, ComparedResult, ComparedSpectra, ModeChange, NamedChange,
    Unmatched, UnmatchedMode,
};
use super::identify_outcome::{Flag, IdentifiedMode, IdentifyOutcome};
use super::{CompareSpec, Envelope, HeldParameter, Input, StudyError};
use crate::vehicle::of_scale;

/// Standard deviations either side of a 95 % interval.
const FACTOR_95: f64 = 1.96;
/// Speeds that differ by more than this share give different delays.
const SAME_SPEED: f64 = 0.02;

/// Compares two results of `identify` or `demo`, each a directory or its `result.json`.
///
/// # Errors
/// A file that is none, is not of this schema, or whose numbers contradict each other, with the file and the field.
pub fn compare(spec: &CompareSpec) -> Result<(CompareOutcome, Vec<Input>), StudyError> {
    let (before_path, before) = read_identification(&spec.before)?;
    let (after_path, after) = read_identification(&spec.after)?;
    let inputs = [&before_path, &after_path].map(|p| Input::of_file(p));
    let [a, b] = inputs;
    let mut outcome = compare_outcomes(&before.outcome, &after.outcome);
    outcome.before.path = before_path.display().to_string();
    outcome.after.path = after_path.display().to_string();
    if share_data(&before, &after) && !outcome.flags.iter().any(|f| f.name == "same-recording") {
        outcome.flags.push(same_recording());
    }
    Ok((outcome, vec![a?, b?]))
}

/// The comparison of two outcomes.
///
/// A difference d of independent estimates has the standard deviation √(s₁² + s₂²) and is significant at 95 % where
/// |d| > 1.96 √(s₁² + s₂²). Where a standard deviation is missing, or a result has not converged, nothing is judged.
#[must_use]
pub fn compare_outcomes(before: &IdentifyOutcome, after: &IdentifyOutcome) -> CompareOutcome {
    let judge = Judge { converged: [before.converged, after.converged], ..Judge::default() };
    let pairs = matched(&before.modes, &after.modes);
    let modes: Vec<ModeChange> = pairs
        .iter()
        .map(|p| {
            let (a, b) = (&before.modes[p.before], &after.modes[p.after]);
            ModeChange {
                before: p.before + 1,
                after: p.after + 1,
                label_before: a.label.clone(),
                label_after: b.label.clone(),
                matched_by: p.by,
                mac: p.mac,
                freq_hz: judge.change((a.freq_hz, a.freq_sd_hz), (b.freq_hz, b.freq_sd_hz)),
                damping: judge.change((a.damping, a.damping_sd), (b.damping, b.damping_sd)),
                points_before: a.points.clone(),
                points_after: aligned(&a.points, &b.points),
            }
        })
        .collect();
    let mut unmatched = Unmatched {
        modes_before: without(&before.modes, |k| pairs.iter().any(|p| p.before == k)),
        modes_after: without(&after.modes, |k| pairs.iter().any(|p| p.after == k)),
        ..Unmatched::default()
    };
    let named = |o: &IdentifyOutcome| -> Vec<Named> {
        o.parameters.iter().map(|p| (p.name.clone(), (p.value, Some(p.sd)))).collect()
    };
    let of_vehicle = Judge { scales: differing_scales(before, after), ..judge };
    let parameters = of_vehicle.by_name(named(before), named(after), &mut unmatched);
    let of_road = Judge { speeds: differing_speeds(before, after).is_some(), ..judge };
    let quantities = of_road.by_name(quantities(before), quantities(after), &mut unmatched);
    let spectra = spectra(before, after, &mut unmatched);
    let all = || {
        modes
            .iter()
            .flat_map(|m| [&m.freq_hz, &m.damping])
            .chain(parameters.iter().chain(&quantities).map(|n| &n.change))
    };
    let (total, judged) =
        (all().count(), all().filter(|c| c.difference_sd.is_some() && c.not_judged.is_none()).count());
    let significant = all().filter(|c| c.significant).count();
    let mut flags = flags(before, after, &spectra);
    if total == 0 {
        flags.push(flag("nothing-matched", "The two results have no mode, parameter or road in common."));
    } else if judged == 0 && before.converged && after.converged {
        let text =
            "No standard deviations on one side or both: differences are shown, and none can be judged.";
        flags.push(flag("no-deviations", text));
    }
    CompareOutcome {
        comparable: before.converged && after.converged && total > 0,
        before: side(before),
        after: side(after),
        flags,
        judged,
        significant,
        modes,
        parameters,
        quantities,
        unmatched,
        spectra,
    }
}

fn side(o: &IdentifyOutcome) -> ComparedResult {
    let (recording, method) = (o.recording.name.clone(), o.method.clone());
    ComparedResult { path: String::new(), recording, method, converged: o.converged }
}

fn flag(name: &str, text: impl Into<String>) -> Flag {
    Flag { name: name.to_owned(), text: text.into() }
}

/// The name of the delay among the quantities.
const DELAY: &str = "delay_s";

/// Whether the values that set the scale of masses, stiffnesses and dampers are not the same ones.
fn differing_scales(before: &IdentifyOutcome, after: &IdentifyOutcome) -> bool {
    let scale = |o: &IdentifyOutcome| -> Vec<HeldParameter> {
        let mut held: Vec<_> = o.held.iter().filter(|h| of_scale(&h.name)).cloned().collect();
        held.sort_by(|a, b| a.name.cmp(&b.name));
        held
    };
    scale(before) != scale(after)
}

/// Two speeds that are not the same.
fn differing_speeds(before: &IdentifyOutcome, after: &IdentifyOutcome) -> Option<(f64, f64)> {
    let speeds = before.recording.speed_m_s.zip(after.recording.speed_m_s)?;
    ((speeds.0 - speeds.1).abs() > SAME_SPEED * speeds.0.abs().max(speeds.1.abs())).then_some(speeds)
}

/// A number with its standard deviation.
type Value = (f64, Option<f64>);
type Named = (String, Value);

/// What may be judged.
#[derive(Clone, Copy, Default)]
struct Judge {
    converged: [bool; 2],
    /// Masses, stiffnesses and dampings are relative to different values.
    scales: bool,
    /// Delays are of different speeds.
    speeds: bool,
}

impl Judge {
    fn change(&self, (before, before_sd): Value, (after, after_sd): Value) -> Change {
        // a parameter that was held has no scatter, and is no estimate
        let usable = |sd: Option<f64>| sd.filter(|s| s.is_finite() && *s > 0.0);
        let (s1, s2) = (usable(before_sd), usable(after_sd));
        let difference = after - before;
        let difference_sd = s1.zip(s2).map(|(a, b)| a.hypot(b));
        let not_judged = match (self.converged, s1, s2) {
            ([false, _], ..) => Some("the earlier result has not converged"),
            ([_, false], ..) => Some("the later result has not converged"),
            (_, None, None) => Some("no standard deviation before nor after"),
            (_, None, _) => Some("no standard deviation before"),
            (_, _, None) => Some("no standard deviation after"),
            _ => None,
        };
        let beyond = difference_sd.is_some_and(|sd| difference.abs() > FACTOR_95 * sd);
        Change {
            before,
            before_sd,
            after,
            after_sd,
            difference,
            difference_sd,
            significant: not_judged.is_none() && beyond,
            not_judged: not_judged.map(str::to_owned),
        }
    }

    /// Values of the same names, in the order of the earlier ones; the others are noted as unmatched.
    fn by_name(&self, before: Vec<Named>, after: Vec<Named>, unmatched: &mut Unmatched) -> Vec<NamedChange> {
        let missing = |of: &[Named], name: &str| !of.iter().any(|(n, _)| n == name);
        unmatched
            .names_before
            .extend(before.iter().filter(|(n, _)| missing(&after, n)).map(|(n, _)| n.clone()));
        unmatched
            .names_after
            .extend(after.iter().filter(|(n, _)| missing(&before, n)).map(|(n, _)| n.clone()));
        let pair = |(name, value): Named| {
            let (_, other) = after.iter().find(|(n, _)| *n == name)?;
            let mut change = self.change(value, *other);
            let reason = if self.scales && of_scale(&name) {
                Some("the scales differ")
            } else if self.speeds && name == DELAY {
                Some("the speeds differ")
            } else {
                None
            };
            if let Some(reason) = reason {
                change.significant = false;
                change.not_judged.get_or_insert_with(|| reason.to_owned());
            }
            Some(NamedChange { change, name })
        };
        before.into_iter().filter_map(pair).collect()
    }
}

/// Road, coherence and delay.
fn quantities(o: &IdentifyOutcome) -> Vec<Named> {
    let road = o.road.iter().flat_map(|r| {
        let (roughness, sd) = r.one_sided();
        [("road.roughness_m3", (roughness, Some(sd))), ("road.exponent", (r.exponent, Some(r.exponent_sd)))]
    });
    let mu = o.coherence.iter().map(|c| ("coherence.mu", (c.mu, Some(c.mu_sd))));
    let delay = o.delay_s.iter().map(|d| (DELAY, (*d, o.delay_sd_s)));
    road.chain(mu).chain(delay).map(|(name, value)| (name.to_owned(), value)).collect()
}

fn without(modes: &[IdentifiedMode], is_matched: impl Fn(usize) -> bool) -> Vec<UnmatchedMode> {
    let free = modes.iter().enumerate().filter(|(k, _)| !is_matched(*k));
    free.map(|(k, m)| UnmatchedMode {
        number: k + 1,
        label: m.label.clone(),
        freq_hz: m.freq_hz,
        damping: m.damping,
    })
    .collect()
}

/// Channels of the same name and unit.
fn spectra(before: &IdentifyOutcome, after: &IdentifyOutcome, unmatched: &mut Unmatched) -> ComparedSpectra {
    let (a, b) = (&before.spectra, &after.spectra);
    let mut channels = Vec::new();
    for one in &a.channels {
        match b.channels.iter().find(|c| c.channel == one.channel && c.unit == one.unit) {
            Some(other) => channels.push(ComparedChannel {
                channel: one.channel.clone(),
                unit: one.unit.clone(),
                before: one.measured.clone(),
                after: other.measured.clone(),
            }),
            None => unmatched.names_before.push(format!("channel {}", one.channel)),
        }
    }
    for other in &b.channels {
        if !channels.iter().any(|c| c.channel == other.channel) {
            unmatched.names_after.push(format!("channel {}", other.channel));
        }
    }
    if channels.is_empty() {
        return ComparedSpectra::default();
    }
    ComparedSpectra { freq_before_hz: a.freq_hz.clone(), freq_after_hz: b.freq_hz.clone(), channels }
}

fn flags(before: &IdentifyOutcome, after: &IdentifyOutcome, spectra: &ComparedSpectra) -> Vec<Flag> {
    let mut flags = Vec::new();
    for (o, which) in [(before, "earlier"), (after, "later")] {
        if !o.converged {
            let text = format!(
                "The {which} result has not converged: its numbers are no result, and no difference is judged."
            );
            flags.push(flag("not-converged", text));
        }
    }
    if before.method != after.method {
        let text = format!(
            "The methods differ ({} and {}): what one of them gets wrong is no change of the vehicle, and is not in the \
             standard deviations.",
            before.method, after.method
        );
        flags.push(flag("methods-differ", text));
    }
    if let Some((a, b)) = differing_speeds(before, after) {
        let text = format!(
            "The speeds differ ({a:.2} and {b:.2} m/s): so does the delay on the same vehicle, and it is not judged."
        );
        flags.push(flag("speeds-differ", text));
    }
    if differing_scales(before, after) && before.method == after.method {
        let held = |o: &IdentifyOutcome| {
            let all: Vec<String> = o.held.iter().map(|h| format!("{} = {}", h.name, h.value)).collect();
            if all.is_empty() { "nothing".to_owned() } else { all.join(", ") }
        };
        let text = format!(
            "The scales differ ({} and {} are held): masses, stiffnesses and dampings are shown and not judged. Give both \
             the same --known.",
            held(before),
            held(after)
        );
        flags.push(flag("scales-differ", text));
    }
    let same = |c: &ComparedChannel| c.before == c.after && !c.before.is_empty();
    if spectra.freq_before_hz == spectra.freq_after_hz && spectra.channels.iter().any(same) {
        flags.push(same_recording());
    }
    flags
}

fn same_recording() -> Flag {
    let text = "Both results are of the same data: the estimates are not independent, and the standard deviations of \
                their differences do not hold.";
    flag("same-recording", text)
}

/// Whether both read a file of data with the same bytes: descriptions and vehicles are TOML, published ones `case:`.
fn share_data(before: &Envelope<IdentifyOutcome>, after: &Envelope<IdentifyOutcome>) -> bool {
    let data = |i: &&Input| !i.path.starts_with("case:") && !i.path.to_lowercase().ends_with(".toml");
    before.inputs.iter().filter(data).any(|a| after.inputs.iter().any(|b| a.sha256 == b.sha256))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{FittedParameter, IdentifiedCoherence, RecordingSummary};

    const BOTH: Judge = Judge { converged: [true, true], scales: false, speeds: false };

    #[test]
    fn a_difference_is_judged_by_both_deviations() {
        // 3, 4, 5: the difference is significant beyond 9.8
        let c = BOTH.change((10.0, Some(3.0)), (19.7, Some(4.0)));
        assert_eq!((c.difference_sd, c.significant), (Some(5.0), false));
        assert!(BOTH.change((10.0, Some(3.0)), (19.9, Some(4.0))).significant);
        assert!(BOTH.change((10.0, Some(3.0)), (0.1, Some(4.0))).significant);
    }

    #[test]
    fn what_has_no_deviation_is_never_significant_and_says_so() {
        for (a, b, words) in [
            (None, Some(1.0), "no standard deviation before"),
            (Some(1.0), None, "no standard deviation after"),
            (Some(0.0), Some(1e-9), "no standard deviation before"),
            (None, None, "no standard deviation before nor after"),
        ] {
            let c = BOTH.change((1.0, a), (1e9, b));
            assert_eq!((c.significant, c.difference_sd, c.not_judged.as_deref()), (false, None, Some(words)));
        }
        let failed = Judge { converged: [true, false], ..BOTH }.change((1.0, Some(1e-9)), (2.0, Some(1e-9)));
        assert_eq!(
            (failed.significant, failed.not_judged.as_deref()),
            (false, Some("the later result has not converged"))
        );
    }

    #[test]
    fn parameters_of_another_scale_and_delays_at_another_speed_are_not_judged() {
        let outcome = |mass: f64, speed_m_s: f64| IdentifyOutcome {
            converged: true,
            parameters: ["front.tire_stiffness_n_per_m", "front_axle_m"]
                .map(|n| FittedParameter { name: n.into(), value: mass, sd: 1.0, start: 0.0 })
                .to_vec(),
            held: vec![HeldParameter { name: "sprung_mass_kg".into(), value: mass }],
            delay_s: Some(2.66 / speed_m_s),
            delay_sd_s: Some(1e-4),
            recording: RecordingSummary { speed_m_s: Some(speed_m_s), ..RecordingSummary::default() },
            ..IdentifyOutcome::default()
        };
        let why = |mass: f64, speed_m_s: f64| -> Vec<Option<String>> {
            let found = compare_outcomes(&outcome(1000.0, 20.0), &outcome(mass, speed_m_s));
            let all = found.parameters.iter().chain(&found.quantities);
            all.map(|n| n.change.not_judged.clone()).collect()
        };
        assert_eq!(why(1000.0, 20.1), [None, None, None]);
        let (scales, speeds) = (Some("the scales differ".to_owned()), Some("the speeds differ".to_owned()));
        assert_eq!(why(1150.0, 20.0), [scales, None, None]);
        assert_eq!(why(1000.0, 30.0), [None, None, speeds]);
    }

    #[test]
    fn names_are_matched_and_the_others_listed() {
        let parameter = |name: &str, value| FittedParameter { name: name.into(), value, sd: 1.0, start: 0.0 };
        let outcome = |parameters, mu: Option<f64>| IdentifyOutcome {
            converged: true,
            parameters,
            coherence: mu.map(|mu| IdentifiedCoherence { mu, mu_sd: 0.1 }),
            ..IdentifyOutcome::default()
        };
        let a = outcome(vec![parameter("a", 1.0), parameter("b", 10.0)], Some(3.8));
        let b = outcome(vec![parameter("c", 1.0), parameter("b", 20.0)], None);
        let found = compare_outcomes(&a, &b);
        assert_eq!(found.parameters.len(), 1);
        assert_eq!((found.parameters[0].name.as_str(), found.parameters[0].change.difference), ("b", 10.0));
        assert_eq!((found.judged, found.significant, found.comparable), (1, 1, true));
        assert_eq!(found.unmatched.names_before, ["a", "coherence.mu"]);
        assert_eq!(found.unmatched.names_after, ["c"]);
        let nothing = compare_outcomes(&outcome(vec![], None), &b);
        assert!(!nothing.comparable && nothing.flags.iter().any(|f| f.name == "nothing-matched"));
    }
}
