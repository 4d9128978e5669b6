//! What no estimator can use is refused with its place, and nothing panics.

use washboard::identify::{
    Constraint, FddSettings, HalfSpectra, OperationalError, PlscfSettings, SsiSettings, fdd, plscf,
    plscf_poles, ssi_cov,
};
use washboard::linalg::{C64, CMat};

/// What each of the three says.
fn said(channels: &[Vec<f64>], rate_hz: f64) -> [Result<usize, OperationalError>; 3] {
    let small = SsiSettings { max_order: 10, block_rows: 20, ..SsiSettings::default() };
    let orders = PlscfSettings { max_order: 10, lags: 60, ..PlscfSettings::default() };
    [
        ssi_cov(channels, rate_hz, &small).map(|o| o.modes.len()),
        plscf(channels, rate_hz, &orders).map(|o| o.modes.len()),
        fdd(channels, rate_hz, &FddSettings::default()).map(|o| o.modes.len()),
    ]
}

fn noise(samples: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    (0..samples).map(|_| next()).collect()
}

#[test]
fn unusable_channels_are_refused_by_all() {
    let good = noise(4000, 1);
    let mut nan = noise(4000, 2);
    nan[17] = f64::NAN;
    let cases: [(&[Vec<f64>], &str); 5] = [
        (&[], "expected at least one channel, found none"),
        (&[good.clone(), vec![9.81; 4000]], "channel 1 is constant"),
        (&[good.clone(), nan], "channel 1, sample 17"),
        (&[vec![1.0, 2.0]], "samples, found 2"),
        (&[good.clone(), noise(3999, 3)], "channel 1: expected 4000 samples"),
    ];
    for (channels, words) in cases {
        for (k, result) in said(channels, 10.0).into_iter().enumerate() {
            let message = result.unwrap_err().to_string();
            assert!(message.contains(words), "method {k}: {message:?} for {words:?}");
        }
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(said(std::slice::from_ref(&good), rate).iter().all(Result::is_err), "{rate}");
    }
}

#[test]
fn noise_and_copies_are_survived() {
    let one = noise(8000, 1);
    // one channel; two that are the same; one huge and one tiny
    let huge: Vec<f64> = noise(8000, 2).iter().map(|v| v * 1e200).collect();
    let tiny: Vec<f64> = noise(8000, 3).iter().map(|v| v * 1e-200).collect();
    for channels in [vec![one.clone()], vec![one.clone(), one.clone()], vec![huge, tiny]] {
        for (k, result) in said(&channels, 10.0).into_iter().enumerate() {
            let modes = result.unwrap_or_else(|e| panic!("method {k}: {e}"));
            assert_eq!(modes, 0, "method {k} finds modes in white noise");
        }
    }
}

#[test]
fn settings_without_meaning_are_refused() {
    let channels = vec![noise(4000, 1)];
    let refused = |settings: PlscfSettings| plscf(&channels, 10.0, &settings).unwrap_err().to_string();
    let usual = PlscfSettings::default;
    assert!(
        refused(PlscfSettings { max_order: 86, ..usual() }).starts_with("max_order: expected a number up to")
    );
    assert!(refused(PlscfSettings { min_order: 0, ..usual() }).starts_with("min_order"));
    assert!(refused(PlscfSettings { window_end: 0.0, ..usual() }).starts_with("window_end"));
    assert!(refused(PlscfSettings { window_end: f64::NAN, ..usual() }).starts_with("window_end"));
    assert!(refused(PlscfSettings { lags: 4, ..usual() }).starts_with("lags"));
    let refused = |settings: FddSettings| fdd(&channels, 10.0, &settings).unwrap_err().to_string();
    let usual = FddSettings::default;
    assert!(refused(FddSettings { segment: Some(5), ..usual() }).starts_with("segment"));
    assert!(refused(FddSettings { segment: Some(3000), ..usual() }).contains("found 4000"));
    assert!(refused(FddSettings { min_mac: 1.5, ..usual() }).starts_with("min_mac"));
    assert!(refused(FddSettings { band_hz: Some([1.0, 6.0]), ..usual() }).starts_with("band_hz"));
}

#[test]
fn spectra_that_are_none_are_refused() {
    let line = |v: f64| CMat::from_fn(1, 1, |_, _| C64::new(v, 0.0));
    let poles = |freq_hz: Vec<f64>, values: Vec<CMat>, order| {
        plscf_poles(&HalfSpectra { rate_hz: 10.0, freq_hz, values }, order, Constraint::Lowest)
    };
    assert!(poles(vec![], vec![], 1).is_err());
    assert!(poles(vec![1.0], vec![line(1.0), line(2.0)], 1).is_err());
    assert!(poles(vec![1.0], vec![line(f64::NAN)], 1).is_err());
    assert!(poles(vec![6.0], vec![line(1.0)], 1).is_err());
    // one line can't tell order 5
    assert!(poles(vec![1.0], vec![line(1.0)], 5).is_err());
}
