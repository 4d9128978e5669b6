//! Türkay's quarter car (chapters 4 and 5) and a published H∞ example.

use crate::plants::{ROAD, mathworks, quarter_car};
use washboard::synthesis::{Certificate, HinfSettings, LqgWeights, full_information, h2_limit, hinf, lqg};

/// rms of the three outputs on the thesis's road.
fn rms(h2: &Certificate) -> Vec<f64> {
    h2.channels.iter().map(|c| ROAD.sqrt() * c.h2.unwrap()).collect()
}

#[test]
fn passive_norms_are_the_notes() {
    // notes on chapter 4: ours, c_t = 0 and 98
    for (ct, expected) in [(0.0, [0.542397, 0.0045661, 0.0017232]), (98.0, [0.525866, 0.0045362, 0.0016511])]
    {
        let passive = Certificate::passive(&quarter_car(ct, &["y2"])).unwrap();
        for (found, known) in rms(&passive).iter().zip(expected) {
            assert!((found / known - 1.0).abs() < 2e-5, "{found} {known}");
        }
    }
}

#[test]
fn lqg_comes_out_as_published() {
    // (4.51): weights 1/passive rms at the same c_t, process noise 1, sensor noise 1e-8; rms of the road's part
    let design = |ct: f64, y: &[&str]| {
        let plant = quarter_car(ct, y);
        let passive = rms(&Certificate::passive(&plant).unwrap());
        let weights: Vec<f64> = passive.iter().map(|r| 1.0 / r).collect();
        let weighted = plant.with_weights(&weights).unwrap();
        let lqg_weights = LqgWeights {
            sensor_noise: vec![1e-8; y.len()],
            input_weight: vec![0.0],
            ..LqgWeights::default()
        };
        let found = lqg(&weighted, &lqg_weights).unwrap();
        rms(&Certificate::of(&plant, &found.controller).unwrap())
    };
    let near = |found: &[f64], known: &[f64]| {
        for (a, b) in found.iter().zip(known) {
            assert!((a - b).abs() <= 1.01e-5, "{found:?} {known:?}");
        }
    };
    near(&design(98.0, &["y2"])[..1], &[0.48951]);
    near(&design(98.0, &["y1", "y2"])[..1], &[0.49001]);
    near(&design(1960.0, &["y2"]), &[0.28343, 0.00365, 0.00103]);
    near(&design(1960.0, &["y1", "y2"]), &[0.27241, 0.00370, 0.00102]);
    // the thesis's labels of the two sets are swapped at c_t = 0
    near(&design(0.0, &["y2"])[..1], &[0.52339]);
    near(&design(0.0, &["y1", "y2"])[..1], &[0.52399]);
}

#[test]
fn the_h2_limit_comes_out_by_both_routes() {
    let published = [
        ([1.0, 1.0, 1.0], [0.088357, 0.033275, 0.030863]),
        ([1.0, 10.0, 100.0], [0.686764, 0.653072, 0.622661]),
    ];
    for (lambda, mu) in published {
        for (ct, known) in [0.0, 50.0, 98.0].into_iter().zip(mu) {
            let plant = quarter_car(ct, &["y2"]).with_weights(&lambda).unwrap();
            // Q = 0 is the passive car of the same tire damping
            let passive = plant.passive().h2_norm().unwrap();
            let (riccati, _) = full_information(&plant).unwrap();
            let closed = h2_limit(&plant).unwrap();
            assert!((closed.h2 / riccati - 1.0).abs() < 1e-9, "{closed:?} {riccati}");
            assert!((riccati / passive - known).abs() < 1e-6, "{ct}: {} {known}", riccati / passive);
        }
    }
}

#[test]
fn hinf_comes_out_as_published_and_its_loop_confirms_it() {
    let Some(plant) = mathworks() else { return };
    let found = hinf(&plant, &HinfSettings::default()).unwrap();
    assert!((found.gamma - 0.672_223_7).abs() < 1e-5, "{found:?}");
    let certificate = Certificate::of(&plant, &found.controller).unwrap();
    assert!((certificate.hinf / found.gamma - 1.0).abs() < 1e-3, "{} {}", certificate.hinf, found.gamma);
}
