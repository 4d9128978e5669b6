//! Lists of numbers in a design's file, refused by their field: a list of three is not one of two with something behind it.

use super::Named;
use super::design_fixed_spec::{MOST_ITERATIONS, MOST_SEED, MOST_TRIES};
use super::design_goal::plain;
use serde::de::{Error, IgnoredAny};
use serde::{Deserialize, Deserializer};

/// States of a controller that is searched entry by entry.
pub(super) const MOST_ORDER: usize = 60;

/// What may stand where two numbers are to.
#[derive(Deserialize)]
#[serde(untagged)]
enum Written {
    List(Vec<f64>),
    Table(Named<IgnoredAny>),
    Other(IgnoredAny),
}

fn two(place: &str, written: Written) -> Result<[f64; 2], String> {
    let expected = format!("{place}: expected a list of two numbers");
    match written {
        Written::List(list) => match list[..] {
            [low, high] => Ok([low, high]),
            _ => {
                let all: Vec<String> = list.iter().map(|v| plain(*v)).collect();
                Err(format!("{expected}, found {}: [{}]", list.len(), all.join(", ")))
            }
        },
        Written::Table(table) => {
            let (own, inner) = (place.rsplit('.').next().unwrap_or(place), table.iter().next());
            let name = inner.map_or_else(|| own.to_owned(), |(n, _)| format!("{own}.{n}"));
            Err(format!(
                "{expected}, found a table: a name with a dot stands in quotes, \"{name}\" = [low, high]"
            ))
        }
        Written::Other(_) => Err(format!("{expected}, found something else")),
    }
}

/// `range`: two numbers by name.
pub(super) fn ranges<'de, D: Deserializer<'de>>(d: D) -> Result<Named<[f64; 2]>, D::Error> {
    let written: Named<Written> = Named::deserialize(d)?;
    let each = written.into_iter().map(|(name, w)| {
        let pair = two(&format!("range.{name}"), w)?;
        Ok((name, pair))
    });
    each.collect::<Result<Vec<_>, String>>().map(|all| all.into_iter().collect()).map_err(D::Error::custom)
}

/// `interpolation.psi`.
pub(super) fn psi<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[f64; 2]>, D::Error> {
    let written: Option<Written> = Option::deserialize(d)?;
    written.map(|w| two("interpolation.psi", w)).transpose().map_err(D::Error::custom)
}

/// `goal.order`: a whole number.
pub(super) fn order<'de, D: Deserializer<'de>>(d: D) -> Result<Option<usize>, D::Error> {
    let expected = format!("goal.order: expected a whole number from 0 to {MOST_ORDER}");
    whole(d, MOST_ORDER, &expected).map(Some)
}

/// `order` of a part of a decentralised controller.
pub(super) fn local_order<'de, D: Deserializer<'de>>(d: D) -> Result<usize, D::Error> {
    whole(d, MOST_ORDER, &format!("local.order: expected a whole number from 0 to {MOST_ORDER}"))
}

/// `fixed-order.tries`, `seed` and `iterations`.
pub(super) fn tries<'de, D: Deserializer<'de>>(d: D) -> Result<usize, D::Error> {
    whole(d, MOST_TRIES, &format!("fixed-order.tries: expected a whole number from 0 to {MOST_TRIES}"))
}

/// See [`tries`].
pub(super) fn seed<'de, D: Deserializer<'de>>(d: D) -> Result<u64, D::Error> {
    // as many as a usize of any machine this is built for holds
    whole(d, MOST_SEED as usize, &format!("fixed-order.seed: expected a whole number from 0 to {MOST_SEED}"))
        .map(|v| v as u64)
}

/// See [`tries`].
pub(super) fn iterations<'de, D: Deserializer<'de>>(d: D) -> Result<usize, D::Error> {
    let expected = format!("fixed-order.iterations: expected a whole number from 1 to {MOST_ITERATIONS}");
    whole(d, MOST_ITERATIONS, &expected)
}

/// What stands where a number is to.
#[derive(Deserialize)]
#[serde(untagged)]
enum Kind {
    // to its last digit: as a double 2⁶³ is another number
    Whole(u64),
    Number(f64),
    Bool(bool),
    Text(String),
    List(Vec<IgnoredAny>),
    Table(Named<IgnoredAny>),
    Other(IgnoredAny),
}

impl Kind {
    fn words(&self) -> String {
        match self {
            Kind::Whole(v) => v.to_string(),
            Kind::Number(v) => plain(*v),
            Kind::Bool(b) => b.to_string(),
            Kind::Text(t) => format!("the text {t:?}"),
            Kind::List(all) => format!("a list of {}", all.len()),
            Kind::Table(table) => table
                .iter()
                .next()
                .map_or("an empty table".into(), |(name, _)| format!("a table with {name}")),
            Kind::Other(_) => "something else".to_owned(),
        }
    }
}

fn whole<'de, D: Deserializer<'de>>(d: D, most: usize, expected: &str) -> Result<usize, D::Error> {
    match Kind::deserialize(d)? {
        Kind::Whole(v) if v <= most as u64 => Ok(v as usize),
        Kind::Number(v) if v.fract() == 0.0 && v >= 0.0 && v <= most as f64 => Ok(v as usize),
        other => Err(D::Error::custom(format!("{expected}, found {}", other.words()))),
    }
}

/// `truncate_to`: whole numbers above 0.
pub(super) fn orders<'de, D: Deserializer<'de>>(d: D) -> Result<Vec<usize>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Orders {
        Numbers(Vec<f64>),
        Other(IgnoredAny),
    }
    /// More states than any controller has.
    const MOST: f64 = 1e6;
    let wrong = |found: String| {
        D::Error::custom(format!("truncate_to: expected a list of whole numbers from 1, found {found}"))
    };
    match Orders::deserialize(d)? {
        Orders::Numbers(all) => match all.iter().find(|v| !(v.fract() == 0.0 && (1.0..=MOST).contains(*v))) {
            Some(v) => Err(wrong(plain(*v))),
            None => Ok(all.into_iter().map(|v| v as usize).collect()),
        },
        Orders::Other(_) => Err(wrong("something else".to_owned())),
    }
}
