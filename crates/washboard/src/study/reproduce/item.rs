//! What is published beside what is computed: checks, figures, and errors of the sources with their evidence.

use crate::lti::{Rational, to_f64};
use serde::{Deserialize, Serialize};

/// Rounding of a decimal that is written in binary: nothing beside one unit of a printed place.
const ROUNDING: f64 = 1e-9;

/// The note of a number that the computation starts from: a source's parameter, read from the published vehicle or road.
pub(super) const INPUT: &str = "an input";

/// How a computed number is to stand to the published one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Relation {
    /// Equal within the tolerance.
    #[default]
    Equal,
    /// Not above it: the text says "less than" or "at most".
    AtMost,
    /// Not below it.
    AtLeast,
}

/// A published number and the one computed here.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Where it is printed: `thesis.sec-4.4`.
    pub item: String,
    /// Which number it is, with its unit.
    pub quantity: String,
    /// As a number.
    pub published: f64,
    /// As it is printed; a formula's value at the numbers of its table.
    pub printed: String,
    /// What washboard gives.
    pub computed: f64,
    /// What may lie between the two: a unit of the last printed place, as the thesis truncates and rounds; 0 of what is exact.
    pub tolerance: f64,
    /// How the two are compared.
    pub relation: Relation,
    /// Whether they agree so.
    pub agrees: bool,
    /// Why not, or under which reading.
    pub reference_note: Option<String>,
    /// The erratum that excuses a disagreement.
    pub erratum: Option<String>,
}

impl Check {
    /// Names the erratum of a number that does not agree; one that does keeps no excuse.
    pub fn excused_by(&mut self, erratum: &str) -> &mut Self {
        if !self.agrees {
            self.erratum = Some(erratum.to_owned());
            self.noted(&format!("erratum {erratum}"));
        }
        self
    }

    /// Says under which reading it is compared.
    pub fn noted(&mut self, text: &str) -> &mut Self {
        self.reference_note = Some(match self.reference_note.take() {
            Some(before) => format!("{before}; {text}"),
            None => text.to_owned(),
        });
        self
    }

    /// Whether it is a number that the computation starts from.
    #[must_use]
    pub fn is_input(&self) -> bool {
        self.reference_note.as_deref().is_some_and(|n| n.split("; ").any(|part| part == INPUT))
    }

    /// Published, computed and tolerance as people read them, in one way of writing; `printed` has what the source has.
    #[must_use]
    pub fn texts(&self) -> [String; 3] {
        let sign = match self.relation {
            Relation::Equal => "",
            Relation::AtMost => "≤ ",
            Relation::AtLeast => "≥ ",
        };
        [format!("{sign}{}", alike(&self.printed)), number_text(self.computed), number_text(self.tolerance)]
    }

    /// Whether it agrees or the sources are at fault.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.agrees || self.erratum.is_some()
    }
}

/// Digits of a computed number: more than any source prints.
const DIGITS: usize = 7;

fn written_plainly(x: f64) -> bool {
    x == 0.0 || (1e-4..1e7).contains(&x.abs())
}

/// A number in seven digits, with an exponent where it is small or large.
#[must_use]
pub fn number_text(x: f64) -> String {
    let kept: f64 = format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x);
    let text = if written_plainly(kept) { (kept + 0.0).to_string() } else { format!("{kept:e}") };
    text.replace('-', "−")
}

/// A printed decimal with its digits, and an exponent where [`number_text`] has one: `0.76e-5` is `7.6e−6`.
fn alike(printed: &str) -> String {
    let (mantissa, exponent) = printed.split_once('e').unwrap_or((printed, "0"));
    let (Ok(value), Ok(exponent)) = (printed.parse::<f64>(), exponent.parse::<i32>()) else {
        return printed.replace('-', "−");
    };
    let text = if written_plainly(value) {
        let places = mantissa.split_once('.').map_or(0, |(_, d)| d.len() as i32);
        format!("{value:.*}", usize::try_from(places - exponent).unwrap_or(0))
    } else {
        let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
        let digits = digits.trim_start_matches('0');
        // zeros at the end of a whole number only give its size
        let digits = if mantissa.contains('.') { digits } else { digits.trim_end_matches('0') };
        format!("{value:.*e}", digits.len().saturating_sub(1))
    };
    text.replace('-', "−")
}

/// A curve of a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// For the legend.
    pub label: String,
    /// One an abscissa.
    pub y: Vec<f64>,
}

/// A published figure, computed again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// `thesis.fig-4.3`, with `-a`, `-b` … where it has several panels; the name of its SVG file.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// Name and unit of the abscissa.
    pub x_label: String,
    /// Logarithmic abscissa.
    pub x_log: bool,
    /// Name and unit of the ordinate.
    pub y_label: String,
    /// Logarithmic ordinate.
    pub y_log: bool,
    /// Abscissas, ascending.
    pub x: Vec<f64>,
    /// What is drawn.
    pub curves: Vec<Curve>,
}

/// A number by what is printed and by what is right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Which number.
    pub what: String,
    /// By what is printed.
    pub as_printed: f64,
    /// By what is right.
    pub right: f64,
}

/// What is wrong in a source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Erratum {
    /// `E4.1`.
    pub id: String,
    /// Where it is printed.
    pub place: String,
    /// What is printed there.
    pub printed: String,
    /// What is right.
    pub right: String,
    /// Computed by washboard; empty where only the print is at fault.
    pub evidence: Vec<Evidence>,
}

/// What an item computes: filled by its function.
#[derive(Debug)]
pub(super) struct Sheet {
    item: &'static str,
    pub checks: Vec<Check>,
    pub figures: Vec<Figure>,
}

impl Sheet {
    pub fn new(item: &'static str) -> Self {
        Sheet { item, checks: Vec::new(), figures: Vec::new() }
    }

    /// A printed decimal, to one unit of its last place.
    pub fn printed(&mut self, quantity: impl Into<String>, digits: &str, computed: f64) -> &mut Check {
        let (value, unit) = decimal_and_unit(digits);
        self.push(quantity.into(), (value, digits.to_owned()), computed, unit, Relation::Equal)
    }

    /// A printed decimal with another tolerance, whose reason is said: scatter of a simulation, rounding.
    pub fn within(
        &mut self,
        quantity: impl Into<String>,
        digits: &str,
        computed: f64,
        (tolerance, reason): (f64, &str),
    ) -> &mut Check {
        let value = decimal_and_unit(digits).0;
        self.push(quantity.into(), (value, digits.to_owned()), computed, tolerance, Relation::Equal)
            .noted(reason)
    }

    /// The value of a printed formula, equal to the last bit of exact fractions.
    pub fn exact(
        &mut self,
        quantity: impl Into<String>,
        formula: &Rational,
        computed: &Rational,
    ) -> &mut Check {
        let value = to_f64(formula);
        let check =
            self.push(quantity.into(), (value, formula.to_string()), to_f64(computed), 0.0, Relation::Equal);
        check.agrees = formula == computed;
        check
    }

    /// A count.
    pub fn count(&mut self, quantity: impl Into<String>, published: usize, computed: usize) -> &mut Check {
        let value = published as f64;
        self.push(quantity.into(), (value, published.to_string()), computed as f64, 0.0, Relation::Equal)
    }

    /// An inequality of the text.
    pub fn bound(
        &mut self,
        quantity: impl Into<String>,
        relation: Relation,
        digits: &str,
        computed: f64,
    ) -> &mut Check {
        let value = decimal_and_unit(digits).0;
        self.push(quantity.into(), (value, digits.to_owned()), computed, 0.0, relation)
    }

    fn push(
        &mut self,
        quantity: String,
        (published, printed): (f64, String),
        computed: f64,
        tolerance: f64,
        relation: Relation,
    ) -> &mut Check {
        let agrees = match relation {
            Relation::Equal => (computed - published).abs() <= tolerance * (1.0 + ROUNDING),
            Relation::AtMost => computed <= published,
            Relation::AtLeast => computed >= published,
        };
        self.checks.push(Check {
            item: self.item.to_owned(),
            quantity,
            published,
            printed,
            computed,
            tolerance,
            relation,
            agrees,
            reference_note: None,
            erratum: None,
        });
        let last = self.checks.len() - 1;
        &mut self.checks[last]
    }

    /// A figure of this item; `panel` is empty where it has only one.
    pub fn figure(&mut self, panel: &str, title: &str, x: Axis<'_>, y: Axis<'_>, curves: Vec<Curve>) {
        let name = if panel.is_empty() { self.item.to_owned() } else { format!("{}-{panel}", self.item) };
        self.figures.push(Figure {
            name,
            title: title.to_owned(),
            x_label: x.label.to_owned(),
            x_log: x.log,
            y_label: y.label.to_owned(),
            y_log: y.log,
            x: x.values.to_vec(),
            curves,
        });
    }
}

/// An axis and, of the abscissa, its values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis<'a> {
    pub label: &'a str,
    pub log: bool,
    pub values: &'a [f64],
}

impl<'a> Axis<'a> {
    pub fn linear(label: &'a str) -> Self {
        Axis { label, log: false, values: &[] }
    }

    pub fn log(label: &'a str) -> Self {
        Axis { label, log: true, values: &[] }
    }

    pub fn at(self, values: &'a [f64]) -> Self {
        Axis { values, ..self }
    }
}

/// A decimal as it is printed, and a unit of its last place. What is no decimal is NaN and agrees with nothing.
fn decimal_and_unit(digits: &str) -> (f64, f64) {
    let (mantissa, exponent) = digits.split_once('e').unwrap_or((digits, "0"));
    let places = mantissa.split_once('.').map_or(0, |(_, d)| d.len() as i32);
    let exponent: i32 = exponent.parse().unwrap_or(0);
    (digits.parse().unwrap_or(f64::NAN), 10f64.powi(exponent - places))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_of_the_last_printed_place_is_allowed_and_no_more() {
        let mut sheet = Sheet::new("thesis.sec-0.0");
        assert!(sheet.printed("truncated", "44.57", 44.5799).agrees);
        assert!(sheet.printed("one unit", "44.57", 44.58).agrees);
        assert!(!sheet.printed("above", "44.57", 44.581).agrees);
        assert!((sheet.printed("small", "4.33e-13", 4.0e-13).tolerance / 1e-15 - 1.0).abs() < 1e-12);
        assert!(!sheet.printed("no number", "44.57", f64::NAN).agrees);
        assert!(sheet.bound("less", Relation::AtMost, "30", 29.9).agrees);
        assert!(!sheet.bound("less", Relation::AtMost, "30", f64::NAN).agrees);
    }

    #[test]
    fn printed_and_computed_numbers_are_written_alike() {
        for (printed, written) in [
            ("2560000000", "2.56e9"),
            ("0.76e-5", "7.6e−6"),
            ("-0.5", "−0.5"),
            ("44.570", "44.570"),
            ("1.0e3", "1000"),
            ("2.50e-2", "0.0250"),
            ("0", "0"),
            ("1/3", "1/3"),
        ] {
            assert_eq!(alike(printed), written);
        }
        assert_eq!([number_text(2.56e9), number_text(7.6e-6), number_text(-0.0)], ["2.56e9", "7.6e−6", "0"]);
    }

    #[test]
    fn only_what_disagrees_has_an_excuse() {
        let mut sheet = Sheet::new("thesis.sec-0.0");
        assert_eq!(sheet.printed("right", "1.0", 1.0).excused_by("E0").erratum, None);
        let wrong = sheet.printed("wrong", "1.0", 2.0);
        assert!(!wrong.is_settled());
        assert!(wrong.excused_by("E0").noted("why").is_settled());
        assert_eq!(wrong.reference_note.as_deref(), Some("erratum E0; why"));
    }
}
