//! Cars and functions that several tests share.

use rand::Rng;
use washboard::lti::{Polynomial, Rational, RationalFunction};
use washboard::synthesis::achievable::{QuarterCar, QuarterCarNumbers};

/// (2πn₀)²κv of the thesis, m²/s.
pub const ROAD: f64 = 1.480625e-4;

/// Table 4.1.
pub const TABLE: QuarterCarNumbers =
    QuarterCarNumbers { ms: 240.0, mu: 36.0, ks: 16_000.0, cs: 980.0, kt: 160_000.0, ct: 0.0 };

/// Table 4.1 on a tire of this damping.
pub fn car(ct: f64) -> QuarterCar {
    QuarterCar::new(&QuarterCarNumbers { ct, ..TABLE }).unwrap()
}

pub fn q(n: i64, d: i64) -> Rational {
    Rational::new(n.into(), d.into())
}

/// A random element of RH∞ of degree 3 with poles between 1 and 60 rad/s.
pub fn stable(rng: &mut impl Rng) -> RationalFunction {
    let mut whole = |low: i64, high: i64| rng.random_range(low..=high);
    let d =
        &Polynomial::integers(&[whole(1, 60), 1]) * &Polynomial::integers(&[whole(1, 900), whole(1, 60), 1]);
    let n = Polynomial::integers(&[whole(-9000, 9000), whole(-900, 900), whole(-90, 90), whole(1, 9)]);
    RationalFunction::new(n, d).unwrap()
}
