//! Shaping filters of roads: (2.96) from its own samples, the split power law, several channels.

use std::f64::consts::TAU;
use washboard::linalg::{C64, CMat, Mat};
use washboard::lti::StateSpace;
use washboard::road::Spectrum;
use washboard::subspace::{Order, ShapeSettings, ShapeWeights, Unpaired, fit_shape};
use washboard::units::Convention;

fn log_grid(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| from * (to / from).powf(k as f64 / (count - 1) as f64)).collect()
}

fn one(v: f64) -> CMat {
    CMat::from_fn(1, 1, |_, _| C64::new(v, 0.0))
}

/// G(s) = 0.0122 (s + 1.1154)/(s + 0.0404), n = 1, p = 32, λ = 0.2, 63 samples.
#[test]
fn the_first_order_road_filter_is_recovered() {
    let (k, zero, pole) = (0.0122, 1.1154, 0.0404);
    let omega = log_grid(0.01, 10.0, 63);
    let s: Vec<CMat> =
        omega.iter().map(|w| one(k * k * (w * w + zero * zero) / (w * w + pole * pole))).collect();
    for weights in [ShapeWeights::Equal, ShapeWeights::Relative, ShapeWeights::RelativeSquared] {
        let settings = ShapeSettings {
            block_rows: Some(32),
            lambda_rad: Some(0.2),
            weights,
            unpaired: Unpaired::Refuse,
            ..ShapeSettings::new(1)
        };
        let fit = fit_shape(&omega, &s, &settings).unwrap();
        let off = [
            fit.gain.abs() / k - 1.0,
            -fit.poles[0].re / pole - 1.0,
            -fit.zeros[0].re / zero - 1.0,
            fit.log10_max_error,
        ];
        assert!(off.iter().all(|e| e.abs() < 1e-9), "{off:?}");
    }
}

/// The notes: the log error of order 7 falls from R = I to R = S to R = S².
#[test]
fn weights_order_the_fits_of_the_split_power_law() {
    let road = Spectrum::split_power_law(
        0.76e-5,
        TAU * 0.15708,
        [3.2, 2.2],
        [1e-3, 100.0],
        Convention::OneSidedCyclesPerM,
    )
    .unwrap();
    let omega = log_grid(TAU * 0.005, TAU * 3.0, 63);
    // per rad/m: at 1 m/s time and distance are one
    let s: Vec<CMat> = omega.iter().map(|w| one(road.psd(*w, 1.0))).collect();
    let mut errors = Vec::new();
    for weights in [ShapeWeights::Equal, ShapeWeights::Relative, ShapeWeights::RelativeSquared] {
        let settings =
            ShapeSettings { block_rows: Some(32), lambda_rad: Some(0.2), weights, ..ShapeSettings::new(7) };
        let fit = fit_shape(&omega, &s, &settings).unwrap();
        println!(
            "{:?}: log10 rms {:.4}, repaired {:?}",
            settings.weights, fit.log10_rms_error, fit.model.repair
        );
        errors.push(fit.log10_rms_error);
    }
    assert!(errors[2] < errors[1] && errors[1] < errors[0], "{errors:?}");
    let own = fit_shape(&omega, &s, &ShapeSettings::new(7)).unwrap();
    println!("by itself: {:.4}, λ {:.3}, p {}", own.log10_rms_error, own.lambda_rad, own.block_rows);
}

/// Two coherent channels: G Gᴴ of the fit is S between the samples too, and a roll-off makes it integrable.
#[test]
fn matrices_and_roll_offs() {
    let a = Mat::from_fn(3, 3, |i, j| [[-0.3, 0.0, 0.0], [0.0, -2.0, 5.0], [0.0, -5.0, -2.0]][i][j]);
    let b = Mat::from_fn(3, 2, |i, j| [[1.0, 0.2], [0.3, 1.0], [0.5, -0.4]][i][j]);
    let c = Mat::from_fn(2, 3, |i, j| [[1.0, 0.5, 0.2], [0.3, -1.0, 0.6]][i][j]);
    let g = StateSpace::continuous(a, b, c, Mat::identity(2, 2) * faer::Scale(0.1)).unwrap();
    let spectrum = |w: f64| {
        let h = g.at(C64::new(0.0, w)).unwrap();
        &h * h.adjoint()
    };
    let omega = log_grid(0.02, 60.0, 40);
    let s: Vec<CMat> = omega.iter().map(|w| spectrum(*w)).collect();
    let settings = ShapeSettings { unpaired: Unpaired::Refuse, ..ShapeSettings::new(3) };
    let fit = fit_shape(&omega, &s, &settings).unwrap();
    for w in log_grid(0.03, 50.0, 33) {
        let h = fit.filter.at(C64::new(0.0, w)).unwrap();
        let (found, known) = (&h * h.adjoint(), spectrum(w));
        assert!((found - &known).norm_max() < 1e-8 * known.norm_max(), "{w}");
    }
    assert!(fit.filter.is_stable().unwrap());
    assert!(fit.filter.h2_norm().is_err());
    let rolled = fit_shape(&omega, &s, &ShapeSettings { roll_off_rad: Some(500.0), ..settings }).unwrap();
    assert!(rolled.filter.h2_norm().unwrap().is_finite());
    // the factor is 1 in the band: √(1 + (60/500)²) at its end
    assert!(rolled.log10_max_error < 0.01);
}

/// The order that explains exact samples is found, and shown beside the others.
#[test]
fn the_order_is_chosen_and_shown() {
    let (pole, zero) = ([0.05, 0.6, 7.0], [0.2, 2.0]);
    let value = |w: f64| {
        let up: f64 = zero.iter().map(|z| w * w + z * z).product();
        up / pole.iter().map(|p| w * w + p * p).product::<f64>()
    };
    let omega = log_grid(0.01, 50.0, 80);
    let s: Vec<CMat> = omega.iter().map(|w| one(value(*w))).collect();
    let settings = ShapeSettings { order: Order::AtMost(6), ..ShapeSettings::new(1) };
    let fit = fit_shape(&omega, &s, &settings).unwrap();
    assert_eq!(fit.model.order, 3, "{:?}", fit.model.orders);
    assert_eq!(fit.model.orders.len(), 6);
    assert!(fit.log10_max_error < 1e-9, "{}", fit.log10_max_error);
    let sv = &fit.model.singular_values;
    assert!(sv[6] < 1e-9 * sv[5], "{sv:?}");
}
