//! The errata as a document.

use super::{Erratum, Evidence};
use std::fmt::Write;

/// Significant digits: fewer than two machines may differ in.
const DIGITS: usize = 5;

/// `docs/errata.md`: one heading an erratum, what is printed, what is right, and a table of numbers.
#[must_use]
pub fn errata_markdown(errata: &[Erratum], left_out: &[String]) -> String {
    let mut text = String::from(
        "# Errata of the sources\n\
         E2–E8: Türkay, *Trade-offs in Automotive Active Suspension Design*; EP: De Filippis, Palmieri, Soria and Mangialardi, *System and source \
         identification from operational vehicle responses*. Made by `washboard reproduce -o DIR`, which computes every number below; \
         do not edit. An erratum without a table is one of print.\n",
    );
    if !left_out.is_empty() {
        let _ = write!(
            text,
            "\n**Not all of them**: left out by --quick, as their evidence takes long: {}.\n",
            left_out.join(", ")
        );
    }
    for e in errata {
        let _ = write!(text, "\n## {}: {}\nPrinted: {}. Right: {}.\n", e.id, e.place, e.printed, e.right);
        if e.evidence.is_empty() {
            continue;
        }
        text += "\n| number | as printed | computed |\n|---|---:|---:|\n";
        for Evidence { what, as_printed, right } in &e.evidence {
            let what = what.replace('|', "\\|");
            let _ = writeln!(text, "| {what} | {} | {} |", short(*as_printed), short(*right));
        }
    }
    text
}

/// A number of five digits, without what rounding adds.
fn short(x: f64) -> String {
    let kept: f64 = format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x);
    // −0 is 0
    let kept = kept + 0.0;
    if kept != 0.0 && !(1e-4..1e6).contains(&kept.abs()) { format!("{kept:e}") } else { kept.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_bars_do_not_break_the_table() {
        assert_eq!([short(0.1 + 0.2), short(-0.0), short(1.234567e-7)], ["0.3", "0", "1.2346e-7"]);
        let e = Erratum {
            id: "E0.1".into(),
            place: "p".into(),
            printed: "a".into(),
            right: "b".into(),
            evidence: vec![Evidence { what: "|K|".into(), as_printed: 1.0, right: 2.0 }],
        };
        assert!(
            errata_markdown(&[], &["E0.2".into()])
                .contains("left out by --quick, as their evidence takes long: E0.2.")
        );
        let text = errata_markdown(&[e], &[]);
        assert!(!text.contains("--quick"), "{text}");
        assert!(text.contains("## E0.1: p\nPrinted: a. Right: b.\n\n| number"), "{text}");
        assert!(text.contains("| \\|K\\| | 1 | 2 |"), "{text}");
    }
}
