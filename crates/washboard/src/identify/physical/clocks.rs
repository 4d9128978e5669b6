//! Sensors whose clocks are off: found by the phase that they leave, fitted where that explains the data.

use super::joint::{Joint, Search};
use super::layout::Kind;
use crate::identify::likelihood::{CHI_LIMIT, FitError, Whitening, mean, newton};

/// A clock is suspected where one step of the information moves it by so many standard deviations …
const SUSPICION: f64 = 6.0;
/// … and by at least this, s.
const LEAST_OFFSET_S: f64 = 5e-4;

/// The problem with clock offsets among its parameters, and where it starts.
pub(super) struct Suspicion<'a> {
    joint: Joint<'a>,
    start: Vec<f64>,
}

/// A fit with clock offsets.
pub(super) struct Refit<'a> {
    pub joint: Joint<'a>,
    pub start: Vec<f64>,
    pub found: Search,
}

/// Whether clocks look off at the end of a fit that trusted them: the score test, by one step of the information.
pub(super) fn suspicion<'a>(
    trusted: &Joint<'a>,
    theta: &[f64],
    with_clocks: impl Fn() -> Result<Joint<'a>, FitError>,
) -> Option<Suspicion<'a>> {
    let joint = with_clocks().ok()?;
    let mut start = vec![0.0; joint.len()];
    for r in 0..joint.models.len() {
        let local = trusted.local(theta, r);
        let (old, new) = (&trusted.models[r].layout, &joint.models[r].layout);
        for i in 0..new.len() {
            start[joint.place(r, i)] = match new.kind(i) {
                Kind::Clock(_) => 0.0,
                Kind::Noise(c) => local[old.noise + c],
                _ => local[i],
            };
        }
    }
    let measured: Vec<_> = joint.models.iter().map(|m| m.data.measured.clone()).collect();
    let score = joint.score(&start, &measured)?;
    let free: Vec<usize> = (0..joint.len()).filter(|i| joint.kind(*i).1 != Kind::Clock(0)).collect();
    let step = newton(&score.fisher, &score.gradient, &free, 1e-9, &None)?;
    // the information of a clock alone bounds its standard deviation from below; the full one is dearer and no more telling
    let off = free.iter().any(|i| {
        let sd = 1.0 / score.fisher[(*i, *i)].max(f64::MIN_POSITIVE).sqrt();
        matches!(joint.kind(*i).1, Kind::Clock(_))
            && step[*i].abs() > SUSPICION * sd
            && step[*i].abs() > LEAST_OFFSET_S
    });
    off.then_some(Suspicion { joint, start })
}

/// The fit with clock offsets, where it converges, explains the data and finds a clock that is off.
pub(super) fn refit<'a>(suspicion: Suspicion<'a>, annealing: &[f64]) -> Option<Refit<'a>> {
    let Suspicion { joint, start } = suspicion;
    let found = joint.search(&start, annealing, false).ok()?;
    let explained = joint.models.iter().enumerate().all(|(r, model)| {
        let residual = model
            .spectra(&joint.local(&found.theta, r))
            .ok()
            .and_then(|s| Some(Whitening::new(&s)?.residuals(&model.data.measured, model.data.averages)));
        residual.is_some_and(|x| mean(&x) <= CHI_LIMIT)
    });
    let off = (0..joint.len())
        .any(|i| matches!(joint.kind(i).1, Kind::Clock(_)) && found.theta[i].abs() > LEAST_OFFSET_S);
    (found.converged && explained && off).then_some(Refit { joint, start, found })
}
