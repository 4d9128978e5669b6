//! Propositions 4.3.1–4.3.12: the derived lists against the printed closed forms, and both directions of "if and only if".

use crate::cars::{car, q, stable};
use rand::SeedableRng;
use washboard::lti::{Polynomial, Rational, RationalFunction};
use washboard::synthesis::achievable::{Constraint, Measurement, NotAchievable, QuarterCar, Response, Youla};

const BOTH: [Measurement; 2] = [Measurement::Acceleration, Measurement::Travel];
const ALONE: [Measurement; 1] = [Measurement::Travel];

struct Numbers {
    ms: Rational,
    mu: Rational,
    cs: Rational,
    kt: Rational,
    ct: Rational,
}

fn numbers(ct: i64) -> Numbers {
    Numbers { ms: q(240, 1), mu: q(36, 1), cs: q(980, 1), kt: q(160_000, 1), ct: q(ct, 1) }
}

/// What the propositions print: coefficients at infinity, derivatives at 0, (ω², value) on the axis.
type Printed = (Vec<Rational>, Vec<Rational>, Option<(Rational, Rational)>);

fn printed(response: Response, both: bool, damped: bool) -> Printed {
    let Numbers { ms, mu, cs, kt, ct } = numbers(if damped { 98 } else { 0 });
    let (zero, one, two) = (|| q(0, 1), q(1, 1), q(2, 1));
    let m = &ms + &mu;
    let (omega1, omega2) = (&kt / &m, &kt / &mu);
    let at_zero = match response {
        // 4.3.1.2, 4.3.4.2, 4.3.7, 4.3.10.2
        Response::Acceleration => vec![zero(), zero(), two.clone(), zero()],
        // 4.3.2.2 and its kin
        Response::Travel => vec![zero(), zero()],
        // 4.3.3.2: also 4.3.6.2 with c_t = 0
        Response::TireDeflection => {
            vec![zero(), zero(), -(&two * &m) / &kt, q(6, 1) * &m * &ct / (&kt * &kt)]
        }
    };
    let mut at_infinity = match (response, damped) {
        (Response::Acceleration, true) => vec![&cs * &ct / (&ms * &mu)],
        (Response::Acceleration, false) => vec![zero(), &kt * &cs / (&ms * &mu)],
        (Response::Travel, true) => {
            vec![zero(), -&ct / &mu, &m / &mu * &cs * &ct / (&ms * &mu) + &ct * &ct / (&mu * &mu) - &kt / &mu]
        }
        (Response::Travel, false) => {
            vec![zero(), zero(), -&kt / &mu, &m * &cs * &kt / (&ms * &mu * &mu)]
        }
        (Response::TireDeflection, true) => {
            vec![-&one, &ct / &mu, &kt / &mu - (&cs + &ct) * &ct / (&mu * &mu)]
        }
        (Response::TireDeflection, false) => vec![-&one, zero(), &kt / &mu, -(&kt * &cs) / (&mu * &mu)],
    };
    if both {
        // one coefficient fewer with y₁: 4.3.7–4.3.12
        at_infinity.pop();
    }
    let on_axis = match (response, damped) {
        (Response::Acceleration, false) => Some((omega2.clone(), omega2 * &mu / &ms)),
        (Response::Travel, false) => Some((omega1, -&m / &ms)),
        _ => None,
    };
    (at_infinity, at_zero, on_axis)
}

fn derived(
    car: &QuarterCar,
    measurements: &[Measurement],
    response: Response,
) -> (Printed, Option<(usize, Rational)>) {
    let constraints = Youla::new(car, measurements).unwrap().constraints(response).unwrap();
    let (mut infinity, mut zero, mut axis, mut not) = (vec![], vec![], None, None);
    for c in constraints.list {
        match c {
            Constraint::AtInfinity { power, value } => {
                assert_eq!(power, infinity.len());
                infinity.push(value);
            }
            Constraint::AtZero { derivative, value } => {
                assert_eq!(derivative, zero.len());
                zero.push(value);
            }
            Constraint::OnAxis { omega_squared, re, im } => {
                assert_eq!(im, q(0, 1));
                assert!(axis.replace((omega_squared, re)).is_none());
            }
            Constraint::NotAtInfinity { power, value } => not = Some((power, value)),
        }
    }
    ((infinity, zero, axis), not)
}

#[test]
fn propositions_1_to_12_come_out_exactly() {
    for damped in [true, false] {
        let car = car(if damped { 98.0 } else { 0.0 });
        for response in Response::ALL {
            for both in [false, true] {
                let measurements: &[Measurement] = if both { &BOTH } else { &ALONE };
                let (found, not) = derived(&car, measurements, response);
                assert_eq!(found, printed(response, both, damped), "{response:?} {both} {damped}");
                assert_eq!(not.is_some(), both, "the condition that K is proper");
            }
        }
    }
}

#[test]
fn a_proper_controller_asks_what_the_propositions_omit() {
    // H₁(∞) = (c_s c_t/(m_s m_u))(1 − q̃(∞)/m_s), and q̃(∞) = m_s makes K improper: H₁(∞) ≠ 0
    let car = car(98.0);
    let youla = Youla::new(&car, &BOTH).unwrap();
    let Numbers { ms, mu, cs, ct, .. } = numbers(98);
    let parameter = stable(&mut rand_chacha::ChaCha8Rng::seed_from_u64(5));
    let at_infinity = |f: &RationalFunction| f.at_infinity(1).unwrap()[0].clone();
    let h1 = youla.response(Response::Acceleration, &parameter);
    assert_eq!(at_infinity(&h1), &cs * &ct / (&ms * &mu) * (q(1, 1) - at_infinity(&parameter) / &ms));
    assert_eq!(derived(&car, &BOTH, Response::Acceleration).1, Some((0, q(0, 1))));
    // without tire damping it is the coefficient of 1/s
    assert_eq!(derived(&crate::cars::car(0.0), &BOTH, Response::Acceleration).1, Some((1, q(0, 1))));
    // and such an H₁ is refused, though every printed condition holds
    let h1 = youla.response(Response::Acceleration, &RationalFunction::constant(ms));
    let constraints = youla.constraints(Response::Acceleration).unwrap();
    let Err(NotAchievable::Violated(broken)) = constraints.check(&h1).unwrap() else { panic!() };
    assert!(matches!(&broken[..], [v] if matches!(v.constraint, Constraint::NotAtInfinity { power: 0, .. })));
}

#[test]
fn what_is_achievable_is_proved_and_what_is_not_is_told() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(11);
    for ct in [0.0, 98.0] {
        let car = car(ct);
        for measurements in [&BOTH[..], &ALONE[..], &BOTH[..1]] {
            let youla = Youla::new(&car, measurements).unwrap();
            let parameter = stable(&mut rng);
            for response in Response::ALL {
                let constraints = youla.constraints(response).unwrap();
                let h = youla.response(response, &parameter);
                let proof = constraints.check(&h).unwrap().unwrap();
                assert_eq!(proof.q, parameter);
                assert_eq!(proof.responses[response as usize], h);
                // each constraint, broken alone by a stable function that keeps the others
                for (k, constraint) in constraints.list.iter().enumerate() {
                    let Some(bump) = bump(constraint, &constraints.list) else { continue };
                    let Err(NotAchievable::Violated(broken)) = constraints.check(&(&h + &bump)).unwrap()
                    else {
                        panic!("{constraint:?} is not seen")
                    };
                    assert!(matches!(&broken[..], [v] if v.constraint == constraints.list[k]), "{broken:?}");
                }
            }
        }
    }
}

/// A function in RH∞ that is 1 (or so) at one constraint and vanishes at all others: sᵃ∏(s² + ω²)/(s + 1)ᵇ, less what
/// it adds to the constraints after it.
fn bump(at: &Constraint, all: &[Constraint]) -> Option<RationalFunction> {
    let zeros = all.iter().filter(|c| matches!(c, Constraint::AtZero { .. })).count();
    let infinity = all.iter().filter(|c| matches!(c, Constraint::AtInfinity { .. })).count();
    let axis = all.iter().find_map(|c| match c {
        Constraint::OnAxis { omega_squared, .. } => Some(omega_squared.clone()),
        _ => None,
    });
    let factor = |with: bool| match &axis {
        Some(w) if with => Polynomial::new(&[w.clone(), q(0, 1), q(1, 1)]),
        _ => Polynomial::one(),
    };
    let over = |numerator: Polynomial, relative: usize| {
        let shift = Polynomial::integers(&[1, 1]);
        let d = (0..numerator.degree() + relative).fold(Polynomial::one(), |d, _| &d * &shift);
        RationalFunction::new(numerator, d).unwrap()
    };
    Some(match at {
        // only the last one of a place leaves the others alone
        Constraint::AtZero { derivative, .. } if derivative + 1 == zeros => {
            over(&Polynomial::power_of_s(*derivative) * &factor(true), infinity + 1)
        }
        Constraint::AtInfinity { power, .. } if power + 1 == infinity => {
            over(&Polynomial::power_of_s(zeros) * &factor(true), *power)
        }
        Constraint::OnAxis { .. } => over(Polynomial::power_of_s(zeros), infinity + 1),
        _ => return None,
    })
}

#[test]
fn functions_that_are_not_stable_are_told_so() {
    let constraints = Youla::new(&car(98.0), &ALONE).unwrap().constraints(Response::Acceleration).unwrap();
    let r = |n: &[i64], d: &[i64]| {
        RationalFunction::new(Polynomial::integers(n), Polynomial::integers(d)).unwrap()
    };
    let why = |h: RationalFunction| constraints.check(&h).unwrap().unwrap_err().to_string();
    assert_eq!(why(r(&[0, 0, 1], &[1])), "the response is not proper");
    assert!(why(r(&[1], &[-1, 1])).contains("s − 1 is not Hurwitz"));
    // H₁ = 0, perfect comfort: told with numbers
    let text = why(RationalFunction::zero());
    assert!(
        text.contains("H''(0) = 2, but found 0") && text.contains("H(∞) = 11.11574, but found 0"),
        "{text}"
    );
}

#[test]
fn the_invariant_frequencies_are_the_printed_ones() {
    let (omega1, omega2) = car(0.0).invariant_omegas_rad_s();
    let hz = |w: f64| w / std::f64::consts::TAU;
    assert!((hz(omega1) - 3.83200).abs() < 5e-6 && (hz(omega2) - 10.61033).abs() < 5e-6);
}

#[test]
fn the_list_reads_well() {
    let lines = |ct: f64, m: &[Measurement], r: Response| {
        Youla::new(&car(ct), m).unwrap().constraints(r).unwrap().lines()
    };
    assert_eq!(
        lines(0.0, &BOTH, Response::Acceleration),
        [
            "H1(s) = O(1/s) as s → ∞",
            "H1(0) = 0, H1'(0) = 0, H1''(0) = 2, H1'''(0) = 0",
            "H1(±j66.66667) = 666.6667 (10.61033 Hz)",
            "the coefficient of s^−1 of H1 at infinity ≠ 0 (a proper controller)",
        ]
    );
    assert_eq!(
        lines(98.0, &ALONE, Response::Travel),
        ["H2(s) = −2.722222/s − 4351.813/s^2 + O(1/s^3) as s → ∞", "H2(0) = 0, H2'(0) = 0"]
    );
}
