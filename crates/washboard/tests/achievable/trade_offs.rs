//! What no controller moves: the trade-offs (4.29)–(4.31), one measurement for two, and Bode's integral of the tire.

use crate::cars::{car, q, stable};
use rand::SeedableRng;
use washboard::lti::{Polynomial, RationalFunction};
use washboard::synthesis::achievable::{
    ByTravelAlone, Measurement, Response, Youla, by_travel_alone, log_integral,
};

const BOTH: [Measurement; 2] = [Measurement::Acceleration, Measurement::Travel];

#[test]
fn one_response_gives_the_others_exactly() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(29);
    for ct in [0.0, 98.0, 1960.0] {
        let car = car(ct);
        for measurements in [&BOTH[..], &BOTH[1..]] {
            let youla = Youla::new(&car, measurements).unwrap();
            for parameter in [RationalFunction::zero(), stable(&mut rng), stable(&mut rng)] {
                let [h1, h2, h3] = Response::ALL.map(|r| youla.response(r, &parameter));
                assert_eq!(car.travel_of_acceleration(&h1).unwrap(), h2);
                assert_eq!(car.tire_of_acceleration(&h1).unwrap(), h3);
                assert_eq!(car.tire_of_travel(&h2).unwrap(), h3);
            }
        }
    }
}

#[test]
fn travel_alone_comes_as_near_as_wanted_without_tire_damping() {
    let parameter = stable(&mut rand_chacha::ChaCha8Rng::seed_from_u64(2));
    let car = car(0.0);
    let both = Youla::new(&car, &BOTH).unwrap();
    let alone = Youla::new(&car, &BOTH[1..]).unwrap();
    let mut last = f64::INFINITY;
    for epsilon in [1.0, 0.1, 0.01] {
        let ByTravelAlone::Near { q_hat, controller, tau_s, differences } =
            by_travel_alone(&car, &parameter, epsilon).unwrap()
        else {
            panic!()
        };
        assert!(tau_s < last);
        last = tau_s;
        assert_eq!(alone.q_of(&[controller]).unwrap().0, q_hat);
        // the differences again, by the responses themselves over frequency
        for (response, bound) in Response::ALL.into_iter().zip(differences) {
            let (h, bar) = (alone.response(response, &q_hat), both.response(response, &parameter));
            let mut worst = 0.0f64;
            for k in 0..400 {
                let omega = 10f64.powf(-2.0 + f64::from(k) * 0.02);
                worst = worst.max((h.at_frequency(omega).unwrap() - bar.at_frequency(omega).unwrap()).norm());
            }
            assert!(
                worst <= bound * (1.0 + 1e-6) && worst > 0.9 * bound && bound < epsilon,
                "{worst} {bound}"
            );
        }
    }
}

#[test]
fn travel_alone_is_exact_or_impossible_with_tire_damping() {
    let car = car(98.0);
    let parameter = stable(&mut rand_chacha::ChaCha8Rng::seed_from_u64(2));
    let lag = RationalFunction::new(Polynomial::one(), Polynomial::integers(&[10, 1])).unwrap();
    let strict = &parameter * &lag;
    let ByTravelAlone::Exact { q_hat, .. } = by_travel_alone(&car, &strict, 1e-9).unwrap() else { panic!() };
    let both = Youla::new(&car, &BOTH).unwrap();
    let alone = Youla::new(&car, &BOTH[1..]).unwrap();
    for r in Response::ALL {
        assert_eq!(alone.response(r, &q_hat), both.response(r, &strict));
    }
    // H₁(∞) of every controller of y₂ is c_s c_t/(m_s m_u): the gap is what both measurements change of it
    let ByTravelAlone::Impossible { gap } = by_travel_alone(&car, &parameter, 1.0).unwrap() else { panic!() };
    let bar = both.response(Response::Acceleration, &parameter).at_infinity(1).unwrap()[0].clone();
    let known = washboard::lti::to_f64(&(q(980 * 98, 240 * 36) - bar)).abs();
    assert!((gap - known).abs() < 1e-13 * known && gap > 0.0);
    assert!(by_travel_alone(&car, &parameter, 0.0).is_err());
}

#[test]
fn bodes_integral_of_the_tire_has_a_tire_damping_term() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(17);
    let mut with_zeros = 0;
    for ct in [0.0, 98.0, 1960.0] {
        let car = car(ct);
        let youla = Youla::new(&car, &BOTH[1..]).unwrap();
        for k in 0..4 {
            let parameter = if k == 0 {
                RationalFunction::zero()
            } else {
                stable(&mut rng).scaled(&q(if k == 1 { 20 } else { 20_000 }, 1))
            };
            let found = log_integral(&car, &youla.response(Response::TireDeflection, &parameter)).unwrap();
            with_zeros += usize::from(!found.zeros_rad_s.is_empty());
            assert!(
                (found.tire_damping + std::f64::consts::FRAC_PI_2 * ct / 36.0).abs() < 1e-12 * ct.max(1.0)
            );
            // 1e-7 of the integral's scale, ω₂
            assert!((found.quadrature - found.formula).abs() < 1e-7 * 66.7, "{ct} {k}: {found:?}");
        }
    }
    assert!(with_zeros > 0, "no response with zeros to the right was tried");
    assert!(log_integral(&car(98.0), &RationalFunction::one()).is_err());
}
