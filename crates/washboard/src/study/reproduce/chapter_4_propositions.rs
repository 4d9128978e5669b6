//! Propositions 4.3.1–4.3.12: their printed formulas at table 4.1 against the constraints that the library derives, in exact fractions.

use super::ReproduceError;
use super::context::{BOTH, Context, DAMPED, TRAVEL};
use super::item::Sheet;
use crate::lti::{Rational, decimal};
use crate::synthesis::achievable::{Constraint, Response, Youla};
use num_traits::Zero;

/// A constraint, by its place.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Place {
    Infinity(usize),
    Zero(usize),
    Axis,
}

/// A printed formula and where it holds.
type Printed = (Place, &'static str, Rational);

/// What the propositions of a response print at this tire damping.
fn printed(
    context: &Context,
    response: Response,
    ct: f64,
    both: bool,
) -> Result<Vec<Printed>, ReproduceError> {
    let n = &context.numbers;
    let [ms, mu, cs, kt] = [n.ms, n.mu, n.cs, n.kt].map(decimal);
    let (ms, mu, cs, kt, ct) = (ms?, mu?, cs?, kt?, decimal(ct)?);
    let whole = |k: i64| Rational::from_integer(k.into());
    let zero = Rational::zero;
    let m = &ms + &mu;
    let damped = !ct.is_zero();
    let mut list: Vec<Printed> = match (response, damped) {
        (Response::Acceleration, true) => {
            vec![(Place::Infinity(0), "c_s c_t/(m_s m_u)", &cs * &ct / (&ms * &mu))]
        }
        (Response::Acceleration, false) => {
            vec![
                (Place::Infinity(0), "0", zero()),
                (Place::Infinity(1), "k_t c_s/(m_s m_u)", &kt * &cs / (&ms * &mu)),
            ]
        }
        (Response::Travel, true) => vec![
            (Place::Infinity(0), "0", zero()),
            (Place::Infinity(1), "−c_t/m_u", -(&ct / &mu)),
            (
                Place::Infinity(2),
                "(m_s + m_u)c_s c_t/(m_s m_u²) + c_t²/m_u² − k_t/m_u",
                &m * &cs * &ct / (&ms * &mu * &mu) + &ct * &ct / (&mu * &mu) - &kt / &mu,
            ),
        ],
        (Response::Travel, false) => vec![
            (Place::Infinity(0), "0", zero()),
            (Place::Infinity(1), "0", zero()),
            (Place::Infinity(2), "−k_t/m_u", -(&kt / &mu)),
            (Place::Infinity(3), "(m_s + m_u)c_s k_t/(m_s m_u²)", &m * &cs * &kt / (&ms * &mu * &mu)),
        ],
        (Response::TireDeflection, true) => vec![
            (Place::Infinity(0), "−1", whole(-1)),
            (Place::Infinity(1), "c_t/m_u", &ct / &mu),
            (
                Place::Infinity(2),
                "k_t/m_u − (c_s + c_t)c_t/m_u²",
                &kt / &mu - (&cs + &ct) * &ct / (&mu * &mu),
            ),
        ],
        (Response::TireDeflection, false) => vec![
            (Place::Infinity(0), "−1", whole(-1)),
            (Place::Infinity(1), "0", zero()),
            (Place::Infinity(2), "k_t/m_u", &kt / &mu),
            (Place::Infinity(3), "−k_t c_s/m_u²", -(&kt * &cs / (&mu * &mu))),
        ],
    };
    if both {
        // with y₁ the last coefficient is free
        list.pop();
    }
    let at_zero = match response {
        Response::Acceleration => vec![("0", zero()), ("0", zero()), ("2", whole(2)), ("0", zero())],
        Response::Travel => vec![("0", zero()), ("0", zero())],
        Response::TireDeflection => vec![
            ("0", zero()),
            ("0", zero()),
            ("−2(m_s + m_u)/k_t", whole(-2) * &m / &kt),
            ("6(m_s + m_u)c_t/k_t²", whole(6) * &m * &ct / (&kt * &kt)),
        ],
    };
    list.extend(at_zero.into_iter().enumerate().map(|(k, (text, value))| (Place::Zero(k), text, value)));
    if !damped && response == Response::Acceleration {
        list.push((Place::Axis, "ω₂² m_u/m_s", &kt / &ms));
    } else if !damped && response == Response::Travel {
        list.push((Place::Axis, "−(m_s + m_u)/m_s", -(&m / &ms)));
    }
    Ok(list)
}

/// What the library derives, in the same terms; what keeps K proper is no part of the printed lists (erratum E4.3).
fn derived(
    context: &Context,
    response: Response,
    ct: f64,
    both: bool,
) -> Result<Vec<(Place, Rational)>, ReproduceError> {
    let measured = if both { &BOTH[..] } else { &TRAVEL[..] };
    let constraints = Youla::new(&context.car(ct)?, measured)?.constraints(response)?;
    Ok(constraints
        .list
        .into_iter()
        .filter_map(|c| match c {
            Constraint::AtInfinity { power, value } => Some((Place::Infinity(power), value)),
            Constraint::AtZero { derivative, value } => Some((Place::Zero(derivative), value)),
            Constraint::OnAxis { re, .. } => Some((Place::Axis, re)),
            Constraint::NotAtInfinity { .. } => None,
        })
        .collect())
}

fn words(response: Response, place: &Place) -> String {
    let h = response.symbol();
    match place {
        Place::Infinity(0) => format!("{h}(∞)"),
        Place::Infinity(k) => format!("{h}: coefficient of s^−{k} at ∞"),
        Place::Zero(k) => format!("{h}{}(0)", "′".repeat(*k)),
        Place::Axis if response == Response::Acceleration => format!("{h}(jω₂)"),
        Place::Axis => format!("{h}(jω₁)"),
    }
}

fn proposition(
    context: &Context,
    sheet: &mut Sheet,
    response: Response,
    ct: f64,
    both: bool,
) -> Result<(), ReproduceError> {
    let (printed, derived) = (printed(context, response, ct, both)?, derived(context, response, ct, both)?);
    sheet.count("number of conditions", printed.len(), derived.len());
    for (place, text, value) in &printed {
        let Some((_, found)) = derived.iter().find(|(p, _)| p == place) else {
            return Err(ReproduceError::unexpected("constraint", "one at the printed place", place));
        };
        sheet.exact(format!("{} = {text}", words(response, place)), value, found);
    }
    Ok(())
}

macro_rules! propositions {
    ($($name:ident: $response:ident, $ct:expr, $both:expr;)*) => {
        $(pub(super) fn $name(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
            proposition(context, sheet, Response::$response, $ct, $both)
        })*
    };
}

propositions! {
    p1: Acceleration, DAMPED, false;
    p2: Travel, DAMPED, false;
    p3: TireDeflection, DAMPED, false;
    p4: Acceleration, 0.0, false;
    p5: Travel, 0.0, false;
    p6: TireDeflection, 0.0, false;
    p7: Acceleration, DAMPED, true;
    p8: Travel, DAMPED, true;
    p9: TireDeflection, DAMPED, true;
    p10: Acceleration, 0.0, true;
    p11: Travel, 0.0, true;
    p12: TireDeflection, 0.0, true;
}
