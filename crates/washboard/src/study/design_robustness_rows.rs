//! A design's robustness as rows of a table, for the printed one and for the page.

use super::design_outcome::DesignOutcome;
use super::design_robustness::{Perturbed, PerturbedKind};
use super::design_words::short;
use std::cmp::Ordering;

/// Numbers of one kind, or one of them.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustnessRow {
    /// What was changed.
    pub what: String,
    /// How many numbers.
    pub count: usize,
    /// For how many of them the loop is not stable.
    pub unstable: usize,
    /// The worst of them, and by what it was changed.
    pub worst: String,
    /// Of a loop that is not stable: how fast the worst one grows.
    pub grows_1_per_s: Option<f64>,
    /// The goal's value over the nominal one at worst, less 1; none where a loop is not stable or nothing is minimised.
    pub goal: Option<f64>,
    /// The norm that grows most, in words, and by which share.
    pub norm: Option<(String, f64)>,
}

impl RobustnessRow {
    /// Whether the loops are stable, in words.
    #[must_use]
    pub fn stable_words(&self) -> String {
        let grows = self.grows_1_per_s.map_or_else(String::new, |g| format!(", grows at {} 1/s", short(g)));
        match (self.unstable, self.count) {
            (0, _) => "stable".into(),
            (1, 1) => format!("not stable{grows}"),
            (k, n) => format!("{k} of {n} not stable{grows}"),
        }
    }
}

const KINDS: [(PerturbedKind, &str); 7] = [
    (PerturbedKind::Vehicle, "one number of the vehicle"),
    (PerturbedKind::Gain, "the whole controller's gain"),
    (PerturbedKind::Sensor, "the gain from one measurement"),
    (PerturbedKind::Actuator, "the gain to one actuator"),
    (PerturbedKind::Pole, "one pole of the controller"),
    (PerturbedKind::Residue, "one residue of the controller"),
    (PerturbedKind::Entry, "one entry of its matrices, as written"),
];

impl DesignOutcome {
    /// One row a kind of number.
    #[must_use]
    pub fn robustness_rows(&self) -> Vec<RobustnessRow> {
        let Some(r) = &self.robustness else { return Vec::new() };
        let row = |(kind, words): &(PerturbedKind, &str)| {
            let own: Vec<&Perturbed> =
                r.vehicle.iter().chain(&r.controller).filter(|p| p.kind == *kind).collect();
            let worst = own.iter().copied().reduce(|a, b| if compared(b, a).is_gt() { b } else { a })?;
            let rows: Vec<RobustnessRow> = own.iter().map(|p| self.robustness_row(p)).collect();
            let most = |a: &RobustnessRow| a.norm.as_ref().map_or(f64::NEG_INFINITY, |n| n.1);
            let norm = rows.iter().max_by(|a, b| most(a).total_cmp(&most(b))).and_then(|r| r.norm.clone());
            Some(RobustnessRow {
                what: (*words).to_owned(),
                count: own.len(),
                unstable: own.iter().filter(|p| !p.stable).count(),
                norm: norm.filter(|_| worst.stable),
                ..self.robustness_row(worst)
            })
        };
        KINDS.iter().filter_map(row).collect()
    }

    /// Every number by itself.
    #[must_use]
    pub fn perturbed_rows(&self) -> Vec<RobustnessRow> {
        let all = self.robustness.iter().flat_map(|r| r.vehicle.iter().chain(&r.controller));
        all.map(|p| self.robustness_row(p)).collect()
    }

    fn robustness_row(&self, p: &Perturbed) -> RobustnessRow {
        let norm = p.norms.iter().max_by(|a, b| a.1.total_cmp(b.1));
        RobustnessRow {
            what: p.named(),
            count: 1,
            unstable: usize::from(!p.stable),
            worst: format!("{} {:+.0} %", p.named(), 100.0 * p.by),
            grows_1_per_s: p.grows_1_per_s,
            goal: p.goal.map(|g| g - 1.0),
            norm: norm.map(|(name, v)| (norm_words(name), v - 1.0)),
        }
    }

    /// The loop with an actuator: what, and the answer in words.
    #[must_use]
    pub fn actuator_rows(&self) -> Vec<(String, String)> {
        let Some(a) = self.robustness.as_ref().and_then(|r| r.actuator.as_ref()) else { return Vec::new() };
        let ms = |s: f64| format!("{} ms", short(1e3 * s));
        let kind = if a.actuator.order == 1 { "first" } else { "second" };
        let (hz, delay) = (short(a.actuator.bandwidth_hz), ms(a.actuator.delay_s));
        let asked = if a.stated { "stated" } else { "what if; [actuator] states another" };
        let mut rows = vec![
            (
                format!("{hz} Hz of {kind} order and {delay} of delay ({asked})"),
                match a.stable {
                    Some(true) => "stable",
                    Some(false) => "not stable",
                    None => "not known: the delay is too long to be approximated",
                }
                .to_owned(),
            ),
            (
                format!("stable bandwidths with {delay} of delay"),
                a.bandwidth_hz.words(|v| format!("{} Hz", short(v))),
            ),
            (format!("stable delays with {hz} Hz"), a.delay_s.words(ms)),
        ];
        if let Some(goal) = a.goal {
            rows.insert(1, ("the goal with it".to_owned(), format!("{:+.1} %", 100.0 * (goal - 1.0))));
        }
        rows
    }
}

/// Any growth is worse than any stable loop.
fn compared(a: &Perturbed, b: &Perturbed) -> Ordering {
    let of = |p: &Perturbed| {
        if p.stable { p.worst().unwrap_or(0.0) } else { p.grows_1_per_s.unwrap_or(f64::INFINITY) }
    };
    b.stable.cmp(&a.stable).then(of(a).total_cmp(&of(b)))
}

/// `h2_heave_acceleration` as "H2 norm of heave_acceleration".
fn norm_words(name: &str) -> String {
    let of = |end: &str, what: &str| name.strip_prefix(end).map(|rest| format!("{what} of {rest}"));
    of("h2_", "H2 norm").or_else(|| of("hinf_", "largest gain")).unwrap_or_else(|| name.to_owned())
}
