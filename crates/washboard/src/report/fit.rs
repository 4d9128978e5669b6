//! How good the fit is, and the parameters that it found.

use super::html::{Html, note, paragraph, table};
use super::numbers::{fixed, interval, significant, with_sd};
use super::plot::{Axis, Line, Plot, Role, pick, shown};
use super::{Plots, modes};
use crate::identify::CHI_LIMIT;
use crate::study::IdentifyOutcome;

/// A residual that reaches this many times [`CHI_LIMIT`] is plotted on a logarithmic scale.
const LOG_FROM: f64 = 10.0;

/// χ to the digits that are worth reading.
pub(super) fn chi_text(chi: f64) -> String {
    fixed(chi, if chi < 10.0 { 2 } else { 0 })
}

/// Whether the model explains the data, with the number.
pub(super) fn chi_words(chi: f64) -> String {
    let word = if chi <= CHI_LIMIT { "explains" } else { "does not explain" };
    format!("the model {word} the data (χ = {}, limit {CHI_LIMIT})", chi_text(chi))
}

/// Residual over frequency and the fit's numbers.
pub(super) fn residual(outcome: &IdentifyOutcome, plots: &mut Plots) -> Option<Html> {
    let fit = outcome.fit.as_ref()?;
    let decrement = if fit.decrement < 1.0 { "below 1: converged" } else { "not below 1: not converged" };
    let words = format!(
        "Overall {}. {} steps with {} evaluations; Whittle cost {}; Newton decrement {} ({decrement}).",
        chi_words(fit.chi),
        fit.iterations,
        fit.evaluations,
        significant(fit.cost, 7),
        significant(fit.decrement, 2)
    );
    let mut body = paragraph(words);
    let keep = shown(&fit.residual_freq_hz, true);
    let x: Vec<f64> = keep.iter().map(|k| fit.residual_freq_hz[*k]).collect();
    if let (Some(first), Some(last)) = (x.first(), x.last()) {
        let largest = fit.residual.iter().copied().filter(|r| r.is_finite()).fold(0.0, f64::max);
        let log = largest > LOG_FROM * CHI_LIMIT;
        let y_axis = Axis::new("misfit χ(f)", "", log);
        let smallest = fit.residual.iter().copied().filter(|r| *r > 0.0).fold(CHI_LIMIT, f64::min);
        let y_axis = if log {
            y_axis.within(smallest / 2.0, 2.0 * largest)
        } else {
            y_axis.within(0.0, 1.1 * largest.max(CHI_LIMIT))
        };
        let mut plot = Plot::new(
            "Misfit over frequency",
            &x,
            Axis::new("frequency", "Hz", true).within(*first, *last),
            y_axis,
        )
        .curve("misfit", Role::Measured, pick(&fit.residual, &keep));
        plot.lines.push(Line::new([*first, *last], [CHI_LIMIT; 2], format!("limit {CHI_LIMIT}")));
        plot.marks = modes::marks(&outcome.modes);
        plot.wide = true;
        if !plot.series.is_empty() {
            body.push(plots.add(plot));
            body.push(note(
                "A single bin scatters about the mean; a hump over many neighbouring bins is a motion \
                 that the model does not have.",
            ));
        }
    }
    Some(body)
}

/// Parameters with their deviations and where the fit began.
pub(super) fn parameters(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    if outcome.parameters.is_empty() {
        return None;
    }
    let rows = outcome.parameters.iter().map(|p| {
        let held = p.sd == 0.0;
        vec![
            p.name.as_str().into(),
            with_sd(p.value, Some(p.sd)).into(),
            interval(p.value, Some(p.sd))
                .unwrap_or_else(|| if held { "held" } else { "–" }.to_owned())
                .into(),
            significant(p.start, 4).into(),
        ]
    });
    let heads = ["parameter (unit in its name)", "# found", "# 95 % interval", "# start"];
    let notes: Html = outcome.notes.iter().map(|n| note(n.text.as_str())).collect();
    Some(table("Fitted parameters", &heads, rows.collect()).and(notes))
}
