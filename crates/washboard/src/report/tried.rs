//! What a search tried before it chose: numbers of modes, starts, and the clocks that it found to be off.

use super::Plots;
use super::fit::chi_text;
use super::html::{Html, element, note, paragraph, table};
use super::numbers::{fixed, interval, significant, with_sd};
use crate::identify::CHI_LIMIT;
use crate::study::{IdentifyOutcome, OrderTried, StartTried};

/// Starts whose costs differ by less came to the same end: a Whittle cost is a negative log-likelihood.
const SAME_END: f64 = 0.1;

/// Orders, starts, clocks; none where there are none.
pub(super) fn tried(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    let mut body = Html::default();
    if !outcome.orders.is_empty() {
        body.push(orders(&outcome.orders));
    }
    if !outcome.starts.is_empty() {
        body.push(starts(&outcome.starts));
    }
    if !outcome.clocks.is_empty() {
        body.push(clocks(outcome));
    }
    (body != Html::default()).then_some(body)
}

fn yes(converged: bool) -> Html {
    if converged { "yes".into() } else { element("strong", &[], "no") }
}

fn orders(orders: &[OrderTried]) -> Html {
    let chosen = orders.iter().find(|o| o.chosen);
    let words = chosen.map(|c| {
        let fits = if c.chi <= CHI_LIMIT { "they explain" } else { "they do not explain" };
        format!("{} were chosen; {fits} the data (χ = {}).", modes(c.modes), chi_text(c.chi))
    });
    let best = orders.iter().map(|o| o.bic).filter(|b| b.is_finite()).fold(f64::INFINITY, f64::min);
    let rows = orders.iter().map(|o| {
        let verdict = match (o.chosen, o.chi <= CHI_LIMIT) {
            (true, _) => "chosen",
            (false, true) => "explains the data",
            (false, false) => "does not explain the data",
        };
        vec![
            o.modes.to_string().into(),
            o.parameters.to_string().into(),
            chi_text(o.chi).into(),
            fixed(o.bic - best, 1).into(),
            significant(o.cost, 7).into(),
            yes(o.converged),
            verdict.into(),
        ]
    });
    let heads =
        ["# modes", "# parameters", "# χ", "# BIC above the least", "# Whittle cost", "converged", "verdict"];
    element("h3", &[], "Numbers of modes")
        .and(words.map_or_else(Html::default, paragraph))
        .and(table("", &heads, rows.collect()))
        .and(note(
            "Bayes’ criterion BIC is twice the cost and a charge for every parameter: the least explains best for what it \
             uses; ten above it is strong evidence against.",
        ))
}

fn modes(n: usize) -> String {
    if n == 1 { "1 mode".to_owned() } else { format!("{n} modes") }
}

fn starts(starts: &[StartTried]) -> Html {
    let best = starts.iter().filter(|s| s.converged).map(|s| s.cost).fold(f64::INFINITY, f64::min);
    let same = starts.iter().filter(|s| s.converged && s.cost - best < SAME_END).count();
    let words = match (starts.len(), same) {
        (_, 0) => "No start converged.".to_owned(),
        (1, _) => "One start, which converged.".to_owned(),
        (n, same) if n == same => format!("All {n} starts came to the same end."),
        (n, same) => format!("{same} of {n} starts came to the best end."),
    };
    let rows = starts.iter().map(|s| {
        vec![
            s.name.as_str().into(),
            fixed(s.cost - best, 2).into(),
            chi_text(s.chi).into(),
            s.steps.to_string().into(),
            yes(s.converged),
        ]
    });
    let heads = ["start", "# cost above the best", "# χ", "# steps", "converged"];
    element("h3", &[], "Starts").and(paragraph(words)).and(table("", &heads, rows.collect()))
}

fn clocks(outcome: &IdentifyOutcome) -> Html {
    let rows = outcome.clocks.iter().map(|c| {
        let (late, sd) = (1e3 * c.offset_s, 1e3 * c.sd_s);
        vec![
            c.channel.as_str().into(),
            with_sd(late, Some(sd)).into(),
            interval(late, Some(sd)).unwrap_or_else(|| "–".to_owned()).into(),
        ]
    });
    element("h3", &[], "Clocks")
        .and(paragraph("Sensors whose samples are stamped later (or, negative, earlier) than the others’:"))
        .and(table("", &["channel", "# late, ms", "# 95 % interval, ms"], rows.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_are_told_in_words() {
        let start = |cost, converged| StartTried { name: "a".into(), cost, chi: 0.4, converged, steps: 9 };
        let text = |s: &[StartTried]| starts(s).as_str().to_owned();
        assert!(
            text(&[start(-5.0, true), start(-5.01, true)]).contains("All 2 starts came to the same end.")
        );
        let some = text(&[start(-5.0, true), start(7.0, true), start(-9.0, false)]);
        assert!(some.contains("1 of 3 starts came to the best end.") && some.contains(">12.00<"), "{some}");
        assert!(text(&[start(1.0, false)]).contains("No start converged."));
    }

    #[test]
    fn an_order_says_whether_it_suffices() {
        let order = |modes, chi, bic, chosen| OrderTried {
            modes,
            parameters: 20,
            cost: -1.0,
            bic,
            chi,
            converged: true,
            chosen,
        };
        let html = orders(&[order(6, 1.2, 40.0, false), order(7, 0.4, 10.0, true)]);
        assert!(html.as_str().contains("7 modes were chosen; they explain the data (χ = 0.40)."), "{html:?}");
        assert!(html.as_str().contains(">30.0<") && html.as_str().contains("does not explain the data"));
    }
}
