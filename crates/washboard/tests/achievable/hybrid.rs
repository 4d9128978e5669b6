//! The hybrid design of §4.4, c_t = 0.1 c_s, against the notes' numbers and against the closed loop.

use crate::cars::{ROAD, car, q};
use washboard::lti::RationalFunction;
use washboard::synthesis::achievable::{
    Constraint, HybridSettings, Measurement, NotAchievable, Psi, Response, hybrid, hybrid_over_tire_damping,
};

fn settings(psi: Psi) -> HybridSettings {
    HybridSettings { fictitious_tire_damping: 1960.0, psi, sensor_noise: 1e-8, road_velocity_intensity: ROAD }
}

#[test]
fn the_printed_design_with_what_it_hides() {
    let car = car(98.0);
    let found = hybrid(&car, &settings(Psi::PRINTED)).unwrap().unwrap();
    // (i) of §4.4: an exact match would need α₁ = α₂; that is the only constraint broken
    let Some(NotAchievable::Violated(broken)) = &found.exact_match else { panic!() };
    let [one] = &broken[..] else { panic!("{broken:?}") };
    assert_eq!(one.constraint, Constraint::AtInfinity { power: 0, value: q(980 * 98, 240 * 36) });
    assert_eq!(one.found.0, q(980 * 1960, 240 * 36));
    // degrees: notes on chapter 4
    assert_eq!((found.q_hat.degree(), found.controller.degree()), (13, 9));
    assert!(found.match_error < 1e-9, "{:e}", found.match_error);
    // rms: notes (passive, LQG at both tires, tire deflection of the hybrid design)
    let near = |a: f64, b: f64, digit: f64| assert!((a - b).abs() <= 1.01 * digit, "{a} {b}");
    near(found.rms.passive[2], 0.0016511, 1e-7);
    near(found.rms.lqg[0], 0.48951, 1e-5);
    near(found.rms.copied[0], 0.28343, 1e-5);
    near(found.rms.copied[2], 0.00103, 1e-5);
    near(found.rms.hybrid[2], 0.003793, 1e-6);
    // the wheel's own mode, ζ = c_t/(2√(k_t m_u)) = .0204, in H₂ and H₃ and not in H₁
    let wheel: Vec<_> = found.hidden.iter().filter(|m| m.hidden_in == [Response::Acceleration]).collect();
    assert_eq!(wheel.len(), 1, "{:?}", found.hidden);
    assert!((wheel[0].freq_hz - 10.61033).abs() < 1e-5);
    assert!((wheel[0].damping - 98.0 / (2.0 * (160_000.0f64 * 36.0).sqrt())).abs() < 1e-9);
    // with Ψ near 1 at ω₂ (4.30) makes it α₂/α₁ = 20
    let narrow = Psi::ForBand { omega_rad_s: 200.0, tolerance: 1e-3 };
    let close = hybrid(&car, &settings(narrow)).unwrap().unwrap();
    assert!((close.tire_factor_at_wheel_hop - 20.0).abs() < 0.1, "{}", close.tire_factor_at_wheel_hop);
    assert!(close.match_error < 1e-9 && close.rms.hybrid[2] > close.rms.passive[2]);
    let all = found.warnings.join("\n");
    assert!(all.contains("hides a mode at 10.61 Hz with 2.042 % damping: not in acceleration"), "{all}");
    assert!(all.contains("rms tire deflection: 0.003793 against 0.001651 of the passive car"), "{all}");
}

#[test]
fn the_proof_is_4_53() {
    // Q̂ again, by the printed formula
    let car = car(98.0);
    let found = hybrid(&car, &settings(Psi::PRINTED)).unwrap().unwrap();
    let f = RationalFunction::polynomial;
    let s = f(washboard::lti::Polynomial::power_of_s(1));
    let times = |all: &[&RationalFunction]| all.iter().fold(RationalFunction::one(), |p, x| &p * x);
    let per_velocity = found.target.over(&s).unwrap();
    let (delta, l, p2) = (f(car.delta()), f(car.tire()), f(car.wheel_on_tire()));
    let above = &(&per_velocity * &delta) - &times(&[&s, &l, &f(car.suspension())]);
    let below = times(&[&s, &s, &s, &l, &p2]).scaled(&q(240, 1));
    assert_eq!(found.q_hat, (&above * &delta).over(&below).unwrap());
}

#[test]
fn a_psi_that_can_not_be_is_answered_with_its_constraint() {
    let wrong = Psi::GivenWithSigma { a: 500.0, b: 10.0, sigma: 0.1 };
    let Err(NotAchievable::Violated(broken)) = hybrid(&car(98.0), &settings(wrong)).unwrap() else {
        panic!()
    };
    assert!(matches!(&broken[..], [v] if matches!(v.constraint, Constraint::AtInfinity { power: 0, .. })));
    assert!(hybrid(&car(98.0), &settings(Psi::Given { a: -1.0, b: 10.0 })).is_err());
    let good = settings(Psi::PRINTED);
    let refused = |s: HybridSettings| hybrid(&car(98.0), &s).unwrap_err().to_string();
    assert!(
        refused(HybridSettings { fictitious_tire_damping: 0.0, ..good.clone() })
            .contains("fictitious tire damping")
    );
    assert!(
        refused(HybridSettings { road_velocity_intensity: -1.0, ..good.clone() }).contains("road velocity")
    );
    // without tire damping ω₂ stays where it is: no Ψ helps
    let Err(NotAchievable::Violated(broken)) = hybrid(&car(0.0), &good).unwrap() else { panic!() };
    assert!(broken.iter().any(|v| matches!(v.constraint, Constraint::OnAxis { .. })));
}

#[test]
fn over_tire_damping_the_controllers_hardly_change() {
    // figure 4.12: 101 dampings of which three here; all 101 in examples
    let dampings = [0.98, 49.49, 98.0];
    let curve =
        hybrid_over_tire_damping(&car(98.0), &settings(Psi::PRINTED), &dampings, (0.1, 100.0, 61)).unwrap();
    assert_eq!((curve.freq_hz.len(), curve.at.len()), (61, 3));
    let whole = hybrid(&car(98.0), &settings(Psi::PRINTED)).unwrap().unwrap();
    for (k, freq) in curve.freq_hz.iter().enumerate() {
        let exact = whole.controller.at_frequency(std::f64::consts::TAU * freq).unwrap().norm();
        assert!((curve.at[2].hybrid.gain[k] / exact - 1.0).abs() < 1e-12);
        // the force again, by Q̂ G₂₁
        let omega = std::f64::consts::TAU * freq;
        let heard = car(98.0).road_to(Measurement::Travel).at_frequency(omega).unwrap();
        let force = (whole.q_hat.at_frequency(omega).unwrap() * heard).norm() / omega;
        assert!((curve.at[2].hybrid.force[k] / force - 1.0).abs() < 1e-9);
    }
    // H₁ is the same on each tire, and the less it is damped the more it is z₂ and z₃ that pay
    for pair in curve.at.windows(2) {
        assert!((pair[0].hybrid.rms[0] / pair[1].hybrid.rms[0] - 1.0).abs() < 1e-3);
        assert!(pair[0].hybrid.rms[2] > 1.3 * pair[1].hybrid.rms[2]);
    }
    let refused = |dampings: &[f64], over| {
        hybrid_over_tire_damping(&car(98.0), &settings(Psi::PRINTED), dampings, over).is_err()
    };
    assert!(refused(&[0.0], (0.1, 100.0, 2)) && refused(&[98.0], (1.0, 0.5, 2)));
}

#[test]
fn a_design_is_held_by_double_precision_or_says_that_it_is_not() {
    // c_t = 0.001 c_s and less: a zero of the road at 1.6e5 rad/s and beyond, and a pole of Ψ at 0.02 rad/s in one loop
    for ct in [98.0, 0.98, 0.0098, 9.8e-5] {
        let asked = settings(Psi::PRINTED);
        let found = hybrid(&car(ct), &asked).unwrap().unwrap();
        assert!(ct != 0.98 || (found.rms.hybrid[0] - 0.273701).abs() < 1e-6, "{}", found.rms.hybrid[0]);
        let warned = found.warnings.iter().any(|w| w.contains("the design is too sensitive"));
        let off = (0..3).map(|i| {
            let h2 = found.certificate.channels[i].h2.unwrap_or(f64::INFINITY);
            (h2 * asked.road_velocity_intensity.sqrt() / found.rms.hybrid[i] - 1.0).abs()
        });
        let off = off.fold(0.0, f64::max);
        assert!(warned || off < 0.01, "{ct}: {off:e}, {:?}", found.warnings);
        assert!(ct < 98.0 || !warned);
    }
}
