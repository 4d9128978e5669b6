//! The Youla parametrisation, against the thesis's own equations and against the closed loop itself.

use crate::cars::{TABLE, car, q, stable};
use rand::SeedableRng;
use washboard::linalg::C64;
use washboard::lti::{Polynomial, RationalFunction};
use washboard::synthesis::achievable::{
    AchievableError, Measurement, QuarterCar, QuarterCarNumbers, Response, Youla, unimodular,
};

const BOTH: [Measurement; 2] = [Measurement::Acceleration, Measurement::Travel];

/// T of G and K, each entry by itself: G₁₁ + G₁₂ K(1 − G₂₂K)⁻¹G₂₁.
fn closed(
    car: &QuarterCar,
    measurements: &[Measurement],
    k: &[RationalFunction],
    z: Response,
) -> RationalFunction {
    let mut difference = RationalFunction::one();
    let mut heard = RationalFunction::zero();
    for (k, m) in k.iter().zip(measurements) {
        difference = &difference - &(&car.force_to(*m) * k);
        heard = &heard + &(k * &car.road_to(*m));
    }
    &car.passive(z) + &(&car.forced(z) * &heard.over(&difference).unwrap())
}

#[test]
fn the_transfer_functions_are_the_plants() {
    // (4.6), (4.10), (4.11) against (4.46)–(4.49), states by states
    let all = [
        Measurement::Acceleration,
        Measurement::Travel,
        Measurement::UnsprungAcceleration,
        Measurement::TireDeflection,
    ];
    let car = car(98.0);
    let plant = car.plant(&all).unwrap();
    for omega in [0.3, 8.0, 70.0, 2e3] {
        let s = C64::new(0.0, omega);
        let found = plant.system().at(s).unwrap();
        let near = |f: RationalFunction, known: C64, velocity: bool| {
            let exact = f.at_frequency(omega).unwrap() / if velocity { s } else { C64::new(1.0, 0.0) };
            // springs and feedthrough cancel at low frequencies: rounding of 1/m_u = 0.03
            assert!((exact - known).norm() < 1e-12 * known.norm() + 1e-16, "{omega} {exact} {known}");
        };
        for z in Response::ALL {
            near(car.passive(z), found[(z as usize, 0)], true);
            near(car.forced(z), found[(z as usize, 1)], false);
        }
        for (i, m) in all.iter().enumerate() {
            near(car.road_to(*m), found[(3 + i, 0)], true);
            near(car.force_to(*m), found[(3 + i, 1)], false);
        }
    }
    // (4.7) coefficient by coefficient
    let (ms, mu, ks, cs, kt, ct) = (240, 36, 16_000, 980, 160_000, 98);
    let known =
        [ks * kt, cs * kt + ct * ks, (ms + mu) * ks + ms * kt + cs * ct, (ms + mu) * cs + ms * ct, ms * mu];
    assert_eq!(car.delta(), Polynomial::integers(&known));
}

#[test]
fn every_q_gives_its_response_and_comes_back() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(41);
    for ct in [0.0, 98.0] {
        let car = car(ct);
        for measurements in [
            &BOTH[1..],
            &BOTH[..1],
            &BOTH[..],
            &[Measurement::TireDeflection],
            &[Measurement::UnsprungDisplacement],
        ] {
            let youla = Youla::new(&car, measurements).unwrap();
            let parameter = stable(&mut rng);
            let free = vec![stable(&mut rng); measurements.len() - 1];
            let k = youla.controller(&parameter, &free).unwrap();
            for z in Response::ALL {
                let t = youla.response(z, &parameter);
                assert!(t.is_stable());
                assert_eq!(t, closed(&car, measurements, &k, z), "{ct} {measurements:?} {z:?}");
            }
            assert_eq!(youla.q_of(&k).unwrap(), (parameter, free));
        }
    }
}

#[test]
fn the_printed_forms_are_these() {
    // (4.20)–(4.22) and (4.37)–(4.39)
    let (car, mut rng) = (car(98.0), rand_chacha::ChaCha8Rng::seed_from_u64(7));
    let f = RationalFunction::polynomial;
    let (delta, s2) = (f(car.delta()), f(Polynomial::power_of_s(2)));
    let (l, s, p2, p1) = (f(car.tire()), f(car.suspension()), f(car.wheel_on_tire()), f(car.whole_on_tire()));
    let (ms, parameter) = (q(240, 1), stable(&mut rng));
    let times = |all: &[&RationalFunction]| all.iter().fold(RationalFunction::one(), |p, x| &p * x);
    let inner = &s + &times(&[&parameter, &s2, &p2]).over(&delta).unwrap().scaled(&ms);
    let alone = Youla::new(&car, &BOTH[1..]).unwrap();
    assert_eq!(
        alone.response(Response::Acceleration, &parameter),
        times(&[&s2, &l, &inner]).over(&delta).unwrap()
    );
    let both = Youla::new(&car, &BOTH).unwrap();
    let inner = &RationalFunction::one() - &times(&[&parameter, &s2, &p2]).over(&delta).unwrap();
    assert_eq!(
        both.response(Response::Acceleration, &parameter),
        times(&[&s2, &l, &s, &inner]).over(&delta).unwrap()
    );
    let inner = &RationalFunction::constant(ms) + &times(&[&parameter, &p1, &s]).over(&delta).unwrap();
    assert_eq!(
        both.response(Response::Travel, &parameter),
        -&times(&[&s2, &l, &inner]).over(&delta).unwrap()
    );
}

#[test]
fn a_car_that_is_not_stable_is_parametrised_by_what_sees_it() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
    let undamped = QuarterCarNumbers { cs: 0.0, ..TABLE };
    let bare = QuarterCarNumbers { ks: 0.0, ..undamped };
    let only_damper = QuarterCarNumbers { ks: 0.0, ..TABLE };
    for (numbers, measurement) in [
        (undamped, Measurement::Travel),
        (undamped, Measurement::Acceleration),
        (bare, Measurement::Travel),
        (only_damper, Measurement::Travel),
    ] {
        let car = QuarterCar::new(&numbers).unwrap();
        assert!(!car.is_stable());
        let youla = Youla::new(&car, &[measurement]).unwrap();
        for parameter in [RationalFunction::zero(), stable(&mut rng)] {
            let k = youla.controller(&parameter, &[]).unwrap();
            assert!(k[0].is_proper());
            for z in Response::ALL {
                let t = youla.response(z, &parameter);
                assert!(t.is_stable(), "{numbers:?} {measurement:?} {z:?}: {t}");
                assert_eq!(t, closed(&car, &[measurement], &k, z));
            }
            assert_eq!(youla.q_of(&k).unwrap().0, parameter);
        }
    }
}

#[test]
fn what_can_not_parametrise_is_told_so() {
    let bare = QuarterCar::new(&QuarterCarNumbers { ks: 0.0, cs: 0.0, ..TABLE }).unwrap();
    let error = Youla::new(&bare, &BOTH[..1]).unwrap_err();
    let AchievableError::NotParametrisable { omega_rad_s, .. } = &error else { panic!("{error}") };
    // s² and the wheel's own undamped mode: 0, 0, ω₂, ω₂
    let (_, omega2) = bare.invariant_omegas_rad_s();
    assert_eq!(omega_rad_s.len(), 4);
    assert!(omega_rad_s.iter().filter(|w| (**w - omega2).abs() < 1e-9).count() == 2, "{error}");
    assert!(error.to_string().contains("`sprung acceleration` can not parametrise"), "{error}");
    let damper = QuarterCar::new(&QuarterCarNumbers { ks: 0.0, ..TABLE }).unwrap();
    assert!(matches!(Youla::new(&damper, &BOTH[..1]), Err(AchievableError::NotParametrisable { .. })));
    assert!(matches!(Youla::new(&bare, &BOTH), Err(AchievableError::NotHurwitz { .. })));
    let refused = |m: &[Measurement]| Youla::new(&car(98.0), m).unwrap_err();
    assert!(matches!(
        refused(&[Measurement::UnsprungAcceleration]),
        AchievableError::ImproperMeasurement { .. }
    ));
    assert!(matches!(refused(&[]), AchievableError::Measurements { .. }));
    assert!(matches!(refused(&[BOTH[0], BOTH[0]]), AchievableError::Measurements { .. }));
    assert!(matches!(
        refused(&[Measurement::Acceleration, Measurement::UnsprungDisplacement]),
        AchievableError::NoLeadingMeasurement { .. }
    ));
    let wrong = |n: QuarterCarNumbers| QuarterCar::new(&n).unwrap_err().to_string();
    assert!(wrong(QuarterCarNumbers { ms: 0.0, ..TABLE }).contains("ms: expected a positive"));
    assert!(wrong(QuarterCarNumbers { ct: f64::NAN, ..TABLE }).contains("ct"));
}

#[test]
fn an_improper_controller_is_refused() {
    // Q̂ = m_s with y₁ measured: 1 + G₂₂Q̂ = 0 at infinity
    let youla = Youla::new(&car(98.0), &BOTH).unwrap();
    let bad = RationalFunction::constant(q(240, 1));
    let free = [RationalFunction::zero()];
    assert_eq!(youla.controller(&bad, &free).unwrap_err(), AchievableError::ImproperController);
    assert_eq!(youla.ill_posed_q().unwrap(), Some(q(240, 1)));
    assert!(youla.controller(&RationalFunction::constant(q(239, 1)), &free).is_ok());
    assert_eq!(Youla::new(&car(98.0), &BOTH[1..]).unwrap().ill_posed_q().unwrap(), None);
}

#[test]
fn the_unimodular_matrix_is_the_thesiss() {
    // (4.34)–(4.35)
    let car = car(98.0);
    let numerator =
        |m: Measurement| (&car.road_to(m) * &RationalFunction::polynomial(car.delta())).numerator().clone();
    let found = unimodular(&BOTH.map(numerator));
    assert_eq!(found.g, numerator(Measurement::Travel));
    assert_eq!(found.pi[1][0], car.suspension().scaled(&q(1, 240)));
    assert_eq!(
        (&found.pi[0][0], &found.pi[0][1], &found.pi[1][1]),
        (&Polynomial::one(), &Polynomial::zero(), &Polynomial::one())
    );
    // [y₁ y₂ ẍ₂ x₂], the thesis's example of more
    let row = [
        Measurement::Acceleration,
        Measurement::Travel,
        Measurement::UnsprungAcceleration,
        Measurement::UnsprungDisplacement,
    ]
    .map(numerator);
    let found = unimodular(&row);
    for j in 0..4 {
        let entry = (0..4).fold(Polynomial::zero(), |sum, i| &sum + &(&row[i] * &found.pi[i][j]));
        assert_eq!(entry, if j == 3 { found.g.clone() } else { Polynomial::zero() });
    }
    assert_eq!(determinant(&found.pi).degree(), 0);
    assert!(!determinant(&found.pi).is_zero());
}

fn determinant(m: &[Vec<Polynomial>]) -> Polynomial {
    if m.is_empty() {
        return Polynomial::one();
    }
    (0..m.len()).fold(Polynomial::zero(), |sum, j| {
        let minor: Vec<Vec<Polynomial>> = m[1..]
            .iter()
            .map(|row| row.iter().enumerate().filter(|(k, _)| *k != j).map(|(_, p)| p.clone()).collect())
            .collect();
        let term = &m[0][j] * &determinant(&minor);
        if j % 2 == 0 { &sum + &term } else { &sum - &term }
    })
}
