//! Mode shapes by least squares in the frequency domain (LSFD): poles and participations held, residuals below and above.

use super::spectra::{LagWindow, Lines, Spectrum};
use super::{PlscfSettings, StabilizationDiagram};
use crate::identify::operational::{
    Cluster, ModelPole, OrderModel, Record, largest_one, mean_phase_deg, mean_phase_deviation_deg,
    phase_collinearity,
};
use crate::linalg::{C64, Mat};
use faer::linalg::solvers::SolveLstsq;

/// Columns of the residuals of each reference: 1/(iω), 1 and iω, modes below the lines, at zero lag, and above.
const RESIDUALS: usize = 3;

/// Gives the modes the shapes that explain the half spectra best together:
///
/// S⁺_ob(ω) = Σ_r (φ_ro g_rb h_r(ω) + conjugate pole) + D_ob/(iω) + E_ob + F_ob iω, h = Σ_{k=1}^{L} μ'^{k−1} e^{−iωk}
///
/// with real D, E, F. A mode whose shape is not determined (participations that are dependent) keeps the shape of its
/// middle pole.
///
/// Source: Peeters and Van der Auweraer (2005), equation (9).
pub(super) fn reshape(
    clusters: &mut [Cluster],
    models: &[OrderModel],
    diagram: &StabilizationDiagram,
    record: &Record,
    window: &LagWindow,
    settings: &PlscfSettings,
) {
    let Some(participations) = clusters
        .iter()
        .map(|c| participation(models, diagram, c.middle, record.rate_hz))
        .collect::<Option<Vec<_>>>()
    else {
        return;
    };
    if clusters.is_empty() {
        return;
    }
    let lines = Lines::around(&record.lambda, window, Spectrum::Half, 0);
    let (n, modes) = (lines.references, clusters.len());
    let hz = |z: &C64| z.arg() / std::f64::consts::TAU * record.rate_hz;
    let [low, high] = settings.stability.band_hz.unwrap_or([0.0, record.rate_hz / 2.0]);
    let last = lines.z.len() - 1;
    let used: Vec<usize> = (1..last).filter(|k| (low..=high).contains(&hz(&lines.z[*k]))).collect();
    let columns = 2 * modes + RESIDUALS * n;
    if 2 * used.len() * n < 2 * columns {
        return;
    }
    let i = C64::new(0.0, 1.0);
    let (mut left, mut right) = (Mat::zeros(2 * used.len() * n, columns), Mat::zeros(2 * used.len() * n, n));
    for (line, &k) in used.iter().enumerate() {
        let z = lines.z[k];
        let omega = z.arg();
        for b in 0..n {
            let row = 2 * (line * n + b);
            let mut put = |column: usize, value: C64| {
                left[(row, column)] = value.re;
                left[(row + 1, column)] = value.im;
            };
            for (r, (cluster, g)) in clusters.iter().zip(&participations).enumerate() {
                let lambda = C64::new(cluster.mode.pole[0], cluster.mode.pole[1]) / record.rate_hz;
                let mu = (lambda - window.beta).exp();
                let (one, other) =
                    (g[b] * seen(mu, z, window.lags), g[b].conj() * seen(mu.conj(), z, window.lags));
                put(2 * r, one + other);
                put(2 * r + 1, i * (one - other));
            }
            let residual = 2 * modes + RESIDUALS * b;
            put(residual, (i * omega).inv());
            put(residual + 1, C64::new(1.0, 0.0));
            put(residual + 2, i * omega);
            for o in 0..n {
                let s = lines.values[k][o * n + b];
                right[(row, o)] = s.re;
                right[(row + 1, o)] = s.im;
            }
        }
    }
    // columns of one length, so that the pivots tell rank and not units
    let lengths: Vec<f64> = (0..columns).map(|c| left.col(c).norm_l2().max(f64::MIN_POSITIVE)).collect();
    let scaled = Mat::from_fn(left.nrows(), columns, |r, c| left[(r, c)] / lengths[c]);
    let solution = scaled.col_piv_qr().solve_lstsq(&right);
    for (r, cluster) in clusters.iter_mut().enumerate() {
        let at =
            |o: usize| [solution[(2 * r, o)] / lengths[2 * r], solution[(2 * r + 1, o)] / lengths[2 * r + 1]];
        let mut shape: Vec<[f64; 2]> = (0..n).map(at).collect();
        let size = shape.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
        if !(size > 0.0 && size.is_finite() && shape.iter().flatten().all(|v| v.is_finite())) {
            continue;
        }
        shape.iter_mut().flatten().for_each(|v| *v /= size);
        let (components, turned) = largest_one(&shape, &record.rms);
        cluster.mode.shape = components;
        cluster.mode.phase_collinearity = phase_collinearity(&turned);
        cluster.mode.mean_phase_deg = mean_phase_deg(&turned);
        cluster.mode.mean_phase_deviation_deg = mean_phase_deviation_deg(&turned);
    }
}

/// Σ_{k=1}^{L} μ^{k−1} z^{−k}.
fn seen(mu: C64, z: C64, lags: usize) -> C64 {
    let one = C64::new(1.0, 0.0);
    (one - (mu / z).powu(lags as u32)) / (z - mu)
}

/// The participation of the pole of the diagram, of largest component 1.
fn participation(
    models: &[OrderModel],
    diagram: &StabilizationDiagram,
    pole: usize,
    rate_hz: f64,
) -> Option<Vec<C64>> {
    let pole = &diagram.poles[pole];
    let lambda = C64::new(pole.pole[0], pole.pole[1]);
    let away = |p: &ModelPole| (p.lambda(rate_hz) - lambda).norm();
    let model = models.iter().find(|m| m.order == pole.order)?;
    let found = model.poles.iter().min_by(|a, b| away(a).total_cmp(&away(b)))?;
    let input = found.input.as_ref()?;
    let size = input.iter().map(|g| g.norm()).fold(0.0, f64::max);
    (size > 0.0 && size.is_finite()).then(|| input.iter().map(|g| g / size).collect())
}
