//! Plants that break an assumption are answered in words; nothing panics.

use crate::plants::quarter_car;
use washboard::synthesis::{
    Assumption, HinfSettings, LqgWeights, SynthesisError, broken_assumptions, h2, hinf, lqg,
};

#[test]
fn a_noise_free_measurement_is_named() {
    let plant = quarter_car(98.0, &["y2"]);
    let error = h2(&plant).unwrap_err();
    let SynthesisError::Assumptions(broken) = &error else { panic!("{error}") };
    assert_eq!(broken[0].assumption, Assumption::MeasurementsNoisy);
    assert!(error.to_string().contains("`y2` is free of noise"), "{error}");
    assert!(matches!(hinf(&plant, &HinfSettings::default()), Err(SynthesisError::Assumptions(_))));
}

#[test]
fn an_unweighted_control_is_named() {
    let plant = quarter_car(98.0, &["y2"]).select(&["travel", "tire"], &["y2"]).unwrap();
    let weights = LqgWeights { sensor_noise: vec![1e-8], input_weight: vec![0.0], ..LqgWeights::default() };
    let error = lqg(&plant, &weights).unwrap_err();
    assert!(error.to_string().contains("`force` costs nothing"), "{error}");
    let weighted = LqgWeights { input_weight: vec![1e-6], ..weights };
    assert!(lqg(&plant, &weighted).is_ok());
    assert!(
        broken_assumptions(&quarter_car(98.0, &["y2"]).with_sensor_noise(&[1e-8]).unwrap())
            .unwrap()
            .is_empty()
    );
}

#[test]
fn wrong_weights_are_refused_by_name() {
    let plant = quarter_car(98.0, &["y2"]);
    let weights = LqgWeights { sensor_noise: vec![1e-8], input_weight: vec![0.0], ..LqgWeights::default() };
    let refused = |w: LqgWeights| lqg(&plant, &w).unwrap_err().to_string();
    assert!(refused(LqgWeights { sensor_noise: vec![-1.0], ..weights.clone() }).contains("sensor noise"));
    assert!(refused(LqgWeights { input_weight: vec![f64::NAN], ..weights.clone() }).contains("input weight"));
    assert!(refused(LqgWeights { process_noise: -1.0, ..weights.clone() }).contains("process noise"));
    assert!(
        refused(LqgWeights { sensor_noise: vec![], ..weights })
            .contains("sensor noise: expected shape (1, 1)")
    );
}
