//! Controllers near the H2 limit: cost from above, to the limit.

use crate::cars::car;
use washboard::synthesis::achievable::{Measurement, Regularisation, Youla, near_optimal};

#[test]
fn the_cost_falls_to_the_limit_and_never_below() {
    for ct in [0.0, 98.0] {
        for weights in [[1.0, 1.0, 1.0], [1.0, 10.0, 100.0]] {
            let mut last = f64::INFINITY;
            for k in 0..6 {
                let tau = 10f64.powi(-2 - k);
                let regularisation = Regularisation { epsilon_rad_s: tau, tau_s: tau };
                let found = near_optimal(&car(ct), weights, regularisation).unwrap();
                let excess = found.h2 / found.limit - 1.0;
                // what double precision holds: rigid weights to 10⁻⁴, weights that leave the body nearly free to 10⁻³
                if k <= if weights[2] > 1.0 { 2 } else { 1 } {
                    let certificate = found.certificate.as_ref().unwrap();
                    assert!((certificate.h2.unwrap() / found.h2 - 1.0).abs() < 1e-6);
                }
                // 1e-8: rounding of the two norms
                assert!(excess > -1e-8, "below the limit");
                assert!(found.h2 < last);
                last = found.h2;
                let youla = Youla::new(&car(ct), &[Measurement::Travel]).unwrap();
                assert_eq!(youla.q_of(std::slice::from_ref(&found.controller)).unwrap().0, found.q_hat);
                if k == 5 {
                    assert!(excess < 1e-4, "{excess:e}");
                }
            }
        }
    }
}

#[test]
fn wrong_calls_are_refused() {
    let good = Regularisation { epsilon_rad_s: 1e-3, tau_s: 1e-3 };
    let refused = |w, r| near_optimal(&car(98.0), w, r).unwrap_err().to_string();
    assert!(refused([0.0, 1.0, 1.0], good).contains("weight of the acceleration"));
    assert!(refused([1.0; 3], Regularisation { tau_s: 0.0, ..good }).contains("tau_s"));
}
