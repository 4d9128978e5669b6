//! Bode plots of a design's controller: one actuator at first, the others on demand.

use super::html::{Html, classed, element, note};
use super::plot::{Axis, Plot, Plots, Role, Series};
use crate::study::{BodeCurve, DesignOutcome};

/// Where a wrapped phase jumps from one end to the other.
const JUMP_DEG: f64 = 180.0;

/// Magnitude and phase of every entry, by actuators.
pub(super) fn bode(o: &DesignOutcome, plots: &mut Plots) -> Option<Html> {
    let all = o.bode();
    let actuators = &o.controller.as_ref()?.outputs;
    let of = |u: &String| all.iter().filter(|c| c.output == *u).collect::<Vec<_>>();
    let mut drawn = actuators.iter().map(|u| (u, of(u))).filter(|(_, curves)| !curves.is_empty());
    let (_, first) = drawn.next()?;
    let shown = pair(o, &first, plots);
    let text = "From each measurement to the force, N per unit of the measurement; u = +K y. The controller alone, without the vehicle.";
    let mut body = shown.and(note(text));
    let rest: Vec<Html> = drawn.map(|(_, curves)| pair(o, &curves, plots)).collect();
    if !rest.is_empty() {
        let summary = element("summary", &[], format!("The other {} actuators", rest.len()));
        body.push(element("details", &[], summary.and(rest.into_iter().collect::<Html>())));
    }
    Some(body)
}

fn pair(o: &DesignOutcome, curves: &[&BodeCurve], plots: &mut Plots) -> Html {
    let to = curves.first().map_or("", |c| c.output.as_str());
    let freq = &o.gains.freq_hz;
    let (Some(low), Some(high)) = (freq.first(), freq.last()) else { return Html::default() };
    let units: Vec<&str> = curves.iter().map(|c| o.units.get(&c.input).map_or("", String::as_str)).collect();
    let alike = units.windows(2).all(|w| w[0] == w[1]);
    let unit =
        units.first().filter(|_| alike).map_or_else(|| "N per unit".to_owned(), |u| format!("N per {u}"));
    let one = |title: String, y: Axis, values: &dyn Fn(&BodeCurve) -> Vec<Option<f64>>| {
        let mut plot = Plot::new(title, freq, Axis::new("frequency", "Hz", true).within(*low, *high), y);
        for (sign, c) in curves.iter().enumerate() {
            let label = format!("from {}", c.input);
            plot.push(Series { label, role: Role::Line, y: values(c), sign, ..Series::default() });
        }
        plot.group = "frequency".to_owned();
        plot
    };
    let magnitude = one(format!("|K| to {to}"), Axis::new("gain", &unit, true), &|c| {
        c.magnitude.iter().map(|v| Some(*v)).collect()
    });
    let phase = one(
        format!("phase of K to {to}"),
        Axis::new("phase", "°", false).within(-JUMP_DEG, JUMP_DEG),
        &|c| broken(&c.phase_deg),
    );
    let drawn: Html =
        [magnitude, phase].into_iter().filter(|p| !p.series.is_empty()).map(|p| plots.add(p)).collect();
    classed("div", "grid", drawn)
}

/// A gap where the phase jumps.
fn broken(phase: &[f64]) -> Vec<Option<f64>> {
    let jumps = |k: usize| k > 0 && (phase[k] - phase[k - 1]).abs() > JUMP_DEG;
    (0..phase.len()).map(|k| Some(phase[k]).filter(|_| !jumps(k))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phase_that_jumps_has_a_gap() {
        assert_eq!(broken(&[170.0, 179.0, -178.0, -170.0]), [Some(170.0), Some(179.0), None, Some(-170.0)]);
    }
}
