//! Orders above that of exact data: no poles of noise.

use std::f64::consts::PI;
use washboard::linalg::{C64, CMat};
use washboard::subspace::{
    Samples, ShapeSettings, ShapeWeights, SpectrumSettings, Unpaired, Weights, fit_shape, fit_spectrum,
};

/// What a higher order may add: the square root of rounding, of spectra that fall to zero at infinite frequency.
const ROUNDING: f64 = 1e-8;

const ALL: [ShapeWeights; 3] = [ShapeWeights::Equal, ShapeWeights::Relative, ShapeWeights::RelativeSquared];

fn log_grid(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| from * (to / from).powf(k as f64 / (count - 1) as f64)).collect()
}

fn fits(value: &dyn Fn(f64) -> f64, exact: usize, weights: &[ShapeWeights], allowed: f64) {
    let omega = log_grid(0.03, 30.0, 90);
    let s: Vec<CMat> = omega.iter().map(|w| CMat::from_fn(1, 1, |_, _| C64::new(value(*w), 0.0))).collect();
    for weights in weights {
        for order in exact..=12 {
            let settings = ShapeSettings { weights: weights.clone(), ..ShapeSettings::new(order) };
            let fit = fit_shape(&omega, &s, &settings).unwrap_or_else(|e| panic!("{weights:?} {order}: {e}"));
            assert_eq!(fit.model.order, exact, "{weights:?}: asked {order}");
            assert!(fit.log10_max_error < allowed, "{weights:?} {order}: {:e}", fit.log10_max_error);
            assert!(fit.filter.is_stable().unwrap());
        }
    }
}

#[test]
fn a_higher_order_is_no_worse_than_the_exact_one() {
    let first = |w: f64| (w * w + 4.0) / (w * w + 0.04);
    fits(&first, 1, &ALL, ROUNDING);
    let third = |w: f64| {
        let square = w * w;
        first(w) * (square + 0.3) * (square + 30.0) / ((square + 0.01) * (square + 9.0))
    };
    fits(&third, 3, &ALL, ROUNDING);
    let resonance = |w: f64| 1.0 + 1.0 / ((4.0 - w * w).powi(2) + (0.2 * w).powi(2));
    fits(&resonance, 2, &ALL, ROUNDING);
}

/// 1 + 1/ω² has no stable filter: its double pole on the axis is put beside it, where samples see 1e-4 of it at most.
#[test]
fn a_pole_on_the_axis_is_put_beside_it() {
    // log₁₀(1 + 1e-4) and as much again for the gain that makes up for it
    fits(&|w| 1.0 + 1.0 / (w * w), 1, &[ShapeWeights::RelativeSquared], 9e-5);
}

/// The least order that meets the samples, on the circle and for callers who refuse folded poles too.
#[test]
fn surplus_is_told_from_weak_states() {
    let theta: Vec<f64> = (0..60).map(|k| PI * (f64::from(k) + 0.5) / 60.0).collect();
    // a second state 1e-4 as strong as the first, with far weaker singular values
    let value = |t: &f64| {
        let z = C64::from_polar(1.0, *t);
        let g = C64::new(1.0, 0.0) + 1.0 / (z - 0.5) + 1e-4 / (z + 0.6);
        g.norm_sqr()
    };
    let s: Vec<f64> = theta.iter().map(value).collect();
    let samples = Samples::scalar(theta, &s, Weights::Equal).unwrap();
    for unpaired in [Unpaired::Refuse, Unpaired::Fold] {
        for order in 2..=8 {
            let settings = SpectrumSettings { unpaired, ..SpectrumSettings::new(order, 24) };
            let model = fit_spectrum(&samples, &settings).unwrap();
            assert_eq!(model.order, 2, "asked {order}");
        }
        let settings = SpectrumSettings { unpaired, ..SpectrumSettings::new(1, 24) };
        assert_eq!(fit_spectrum(&samples, &settings).unwrap().order, 1);
    }
}
