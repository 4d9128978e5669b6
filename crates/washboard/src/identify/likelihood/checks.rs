//! What the tests of both fits share: a band without a recording, and the information by dense differences.

use super::{BandData, Spectra};
use crate::linalg::{CMat, solve_complex};

/// Averages of the band.
pub(crate) const AVERAGES: f64 = 20.0;
/// A window so wide that it reaches beyond ω = 0 from the band's first bins.
pub(crate) const WIDE: [f64; 15] =
    [0.001, 0.004, 0.01, 0.03, 0.06, 0.1, 0.16, 0.27, 0.16, 0.1, 0.06, 0.03, 0.01, 0.004, 0.001];

/// 36 bins from the second one on, 2 rad/s apart, of channels that nothing was measured at yet.
pub(crate) fn band(kernel: &[f64], channels: usize) -> BandData {
    let (first, step) = (2, 2.0);
    BandData {
        first,
        omega: (0..36).map(|k| step * (first + k) as f64).collect(),
        step,
        measured: Spectra::new(channels, vec![0.0; 36 * channels * channels]),
        scale: (0..channels).map(|i| 1.0 + 0.5 * i as f64).collect(),
        averages: AVERAGES,
        kernel: kernel.to_vec(),
        noise: vec![1e-3; channels],
    }
}

/// Asserts a gradient to be the central differences of a cost, to 1e-5.
///
/// Parameters that hardly matter are compared on the scale of the others: a cost of 10³ leaves 10⁻⁷ at this step.
pub(crate) fn assert_gradient(gradient: &[f64], cost: &dyn Fn(usize, f64) -> f64) {
    const STEP: f64 = 1e-5;
    let by_differences: Vec<f64> =
        (0..gradient.len()).map(|i| (cost(i, STEP) - cost(i, -STEP)) / (2.0 * STEP)).collect();
    let scale = by_differences.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    assert!(scale > 1.0, "nothing to see: {by_differences:?}");
    for (i, (g, d)) in gradient.iter().zip(&by_differences).enumerate() {
        assert!(
            (g - d).abs() < 1e-5 * (d.abs() + 1e-2 * scale),
            "parameter {i}: {g} by formula, {d} by differences"
        );
    }
}

/// n_avg Σ_k Re tr(S⁻¹ ∂_aS S⁻¹ ∂_bS), the derivatives by central differences.
pub(crate) fn dense_information(s: &dyn Fn(usize, f64) -> Spectra, a: usize, b: usize) -> f64 {
    const STEP: f64 = 1e-5;
    let matrices = |s: Spectra| s.matrices(&vec![1.0; s.order()]);
    let slopes = |i: usize| -> Vec<CMat> {
        let pairs = matrices(s(i, STEP)).into_iter().zip(matrices(s(i, -STEP)));
        pairs.map(|(up, down)| (up - down) * faer::Scale(crate::linalg::C64::new(0.5 / STEP, 0.0))).collect()
    };
    let middle = matrices(s(a, 0.0));
    let share = |(s, (by_a, by_b)): (&CMat, (CMat, CMat))| {
        let v = solve_complex(s, &by_a).unwrap() * solve_complex(s, &by_b).unwrap();
        (0..v.nrows()).map(|i| v[(i, i)].re).sum::<f64>()
    };
    AVERAGES * middle.iter().zip(slopes(a).into_iter().zip(slopes(b))).map(share).sum::<f64>()
}
