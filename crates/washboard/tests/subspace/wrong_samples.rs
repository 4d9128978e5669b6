//! Samples and settings that are refused, with the numbers.

use std::f64::consts::PI;
use washboard::linalg::{C64, CMat};
use washboard::subspace::{Samples, SpectrumSettings, SubspaceError, Weights, fit_spectrum};

#[test]
fn wrong_samples_are_refused_by_number() {
    let new = |theta: Vec<f64>, s: &[f64], w: Weights| Samples::scalar(theta, s, w);
    let ok = || vec![0.1, 0.2, 0.3];
    let s = [1.0, 2.0, 3.0];
    assert!(matches!(
        new(vec![0.1, 0.2, 0.2], &s, Weights::Equal),
        Err(SubspaceError::Order { index: 2, before, value }) if before == 0.2 && value == 0.2
    ));
    assert!(matches!(
        new(vec![0.1, 0.3, 0.2], &s, Weights::Equal),
        Err(SubspaceError::Order { index: 2, .. })
    ));
    assert!(matches!(
        new(vec![0.1, 0.3, 3.2], &s, Weights::Equal),
        Err(SubspaceError::Angle { index: 2, .. })
    ));
    assert!(matches!(
        new(vec![0.1, f64::NAN, 3.0], &s, Weights::Equal),
        Err(SubspaceError::Angle { index: 1, .. })
    ));
    assert!(matches!(
        new(ok(), &[1.0, -2.0, 3.0], Weights::Equal),
        Err(SubspaceError::Negative { index: 1, value }) if value == -2.0
    ));
    assert!(matches!(
        new(ok(), &[1.0, f64::INFINITY, 3.0], Weights::Equal),
        Err(SubspaceError::Sample { index: 1, .. })
    ));
    assert!(matches!(
        new(ok(), &s[..2], Weights::Equal),
        Err(SubspaceError::Count { expected: 3, found: 2, .. })
    ));
    assert!(matches!(
        new(ok(), &s, Weights::Variances(vec![1.0, 0.0, 1.0])),
        Err(SubspaceError::Sample { what: "variance", index: 1, .. })
    ));
    let one = |v: C64| CMat::from_fn(1, 1, |_, _| v);
    let complex = vec![one(C64::new(1.0, 0.0)), one(C64::new(1.0, 0.5)), one(C64::new(1.0, 0.0))];
    assert!(matches!(
        Samples::new(ok(), complex, Weights::Equal),
        Err(SubspaceError::Sample { index: 1, .. })
    ));
    let skew = CMat::from_fn(2, 2, |i, j| C64::new(if i == j { 1.0 } else { 0.1 * (1.0 + j as f64) }, 0.0));
    let refused = Samples::new(ok(), vec![skew; 3], Weights::Equal);
    assert!(matches!(refused, Err(SubspaceError::Sample { index: 0, .. })), "{refused:?}");
    let flat = CMat::from_fn(2, 2, |_, _| C64::new(1.0, 0.0));
    let eye = CMat::from_fn(2, 2, |i, j| C64::new(f64::from(u8::from(i == j)), 0.0));
    let refused = Samples::new(ok(), vec![eye; 3], Weights::Covariances(vec![flat; 3]));
    assert!(matches!(refused, Err(SubspaceError::Sample { what: "covariance", index: 0, .. })));
    assert!(Samples::new(Vec::new(), Vec::new(), Weights::Equal).is_err());
}

#[test]
fn wrong_settings_are_refused_by_number() {
    let theta: Vec<f64> = (0..20).map(|k| PI * f64::from(k) / 19.0).collect();
    let s: Vec<f64> = theta.iter().map(|t| 2.0 + t.cos()).collect();
    let samples = Samples::scalar(theta, &s, Weights::Equal).unwrap();
    let fit = |n, p| fit_spectrum(&samples, &SpectrumSettings::new(n, p));
    assert!(matches!(fit(0, 5), Err(SubspaceError::Field { field: "order", .. })));
    assert!(matches!(fit(3, 6), Err(SubspaceError::OrderTooHigh { order: 3, block_rows: 6, most: 2, .. })));
    // 2·20 − 2 = 38 independent samples: p + 2n = 39 is one too many
    assert!(matches!(fit(1, 37), Err(SubspaceError::TooFew { needed: 39, found: 38, .. })));
    assert!(fit(1, 36).is_ok());
}
