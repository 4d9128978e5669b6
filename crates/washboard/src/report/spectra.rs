//! Measured and fitted spectra, and the cross-spectra of a few pairs.

use super::html::{Html, classed, element, note};
use super::plot::{Axis, Plot, Role, pick, shown};
use super::{Plots, modes};
use crate::study::{IdentifyOutcome, PairSpectrum};

/// One small plot a channel.
pub(super) fn auto(outcome: &IdentifyOutcome, plots: &mut Plots) -> Option<Html> {
    let (keep, x, x_axis) = abscissa(outcome)?;
    let marks = modes::marks(&outcome.modes);
    let mut grid = Html::default();
    for channel in &outcome.spectra.channels {
        let unit = density_unit(&channel.unit);
        let measured = pick(&channel.measured, &keep);
        let mut plot = Plot::new(channel.channel.as_str(), &x, x_axis.clone(), Axis::new("", &unit, true));
        if let Some([low, high]) = outcome.spectra.confidence {
            let times = |factor: f64| measured.iter().map(|v| v.map(|v| v * factor)).collect::<Vec<_>>();
            plot = plot.curve("95 %, high", Role::MeasuredHigh, times(high)).curve(
                "95 %, low",
                Role::MeasuredLow,
                times(low),
            );
        }
        let mut plot = plot.curve("fitted", Role::Fitted, pick(&channel.fitted, &keep)).curve(
            "measured",
            Role::Measured,
            measured,
        );
        plot.marks.clone_from(&marks);
        plot.group = "frequency".to_owned();
        if !plot.series.is_empty() {
            grid.push(plots.add(plot));
        }
    }
    (grid != Html::default()).then(|| {
        let fitted = outcome.spectra.channels.iter().any(|c| !c.fitted.is_empty());
        let curves = if fitted { "Thin and dark: measured; thick and light: the model, noise floor included." } else { "Thin: measured." };
        let band = if outcome.spectra.confidence.is_some() { " Shaded: the 95 % interval of a measured value." } else { "" };
        classed("div", "grid", grid).and(note(format!(
            "{curves}{band} One-sided densities per Hz. Point to read values at one frequency in all channels; drag to \
             zoom, double-click to go back.{}",
            modes::key(outcome)
        )))
    })
}

/// Coherence and phase of each pair.
pub(super) fn cross(outcome: &IdentifyOutcome, plots: &mut Plots) -> Option<Html> {
    let (keep, x, x_axis) = abscissa(outcome)?;
    let marks = modes::marks(&outcome.modes);
    let mut body = Html::default();
    for pair in &outcome.spectra.pairs {
        let drawn = [coherence(pair, &keep, &x, &x_axis), phase(pair, &keep, &x, &x_axis)];
        let mut grid = Html::default();
        for mut plot in drawn {
            plot.marks.clone_from(&marks);
            plot.group = "frequency".to_owned();
            if !plot.series.is_empty() {
                grid.push(plots.add(plot));
            }
        }
        if grid != Html::default() {
            body.push(element("h3", &[], format!("{} → {}", pair.first, pair.second)));
            body.push(classed("div", "grid", grid));
        }
    }
    (body != Html::default()).then(|| {
        body.and(note(
            "Coherence is the magnitude squared, |S₁₂|²/(S₁₁S₂₂). A falling phase is a second channel that comes later. \
             Where the coherence is near zero the measured phase is chance. Numbers on top are the modes’.",
        ))
    })
}

fn coherence(pair: &PairSpectrum, keep: &[usize], x: &[f64], x_axis: &Axis) -> Plot {
    let y_axis = Axis::new("coherence", "", false).within(0.0, 1.0);
    Plot::new("Coherence", x, x_axis.clone(), y_axis)
        .curve("fitted", Role::Fitted, pick(&pair.fitted_coherence, keep))
        .curve("measured", Role::Measured, pick(&pair.coherence, keep))
}

fn phase(pair: &PairSpectrum, keep: &[usize], x: &[f64], x_axis: &Axis) -> Plot {
    let degrees = |values: &[f64]| -> Vec<Option<f64>> {
        pick(values, keep).into_iter().map(|v| v.map(|v| (100.0 * v.to_degrees()).round() / 100.0)).collect()
    };
    let y_axis = Axis::new("phase", "°", false).within(-180.0, 180.0);
    Plot::new("Phase", x, x_axis.clone(), y_axis)
        .curve("fitted", Role::FittedPoints, degrees(&pair.fitted_phase_rad))
        .curve("measured", Role::MeasuredPoints, degrees(&pair.phase_rad))
}

/// Which bins can be shown, where, and their scale.
fn abscissa(outcome: &IdentifyOutcome) -> Option<(Vec<usize>, Vec<f64>, Axis)> {
    let f = &outcome.spectra.freq_hz;
    let keep = shown(f, true);
    let x: Vec<f64> = keep.iter().map(|k| f[*k]).collect();
    let axis = Axis::new("frequency", "Hz", true).within(*x.first()?, *x.last()?);
    Some((keep, x, axis))
}

/// unit²/Hz of the channel's unit, or the density's unit where that is what the outcome has.
pub(super) fn density_unit(unit: &str) -> String {
    if unit.contains("/Hz") {
        unit.to_owned()
    } else if unit.contains(['/', '·', '*', ' ']) {
        format!("({unit})²/Hz")
    } else {
        format!("{unit}²/Hz")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_densities() {
        assert_eq!(density_unit("m/s²"), "(m/s²)²/Hz");
        assert_eq!(density_unit("m"), "m²/Hz");
        assert_eq!(density_unit("(m/s^2)^2/Hz"), "(m/s^2)^2/Hz");
    }
}
