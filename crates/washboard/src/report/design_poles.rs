//! The s-plane of a design: poles of the vehicle and of the loop.

use super::design_tables::poles as table;
use super::html::{Html, classed, note};
use super::numbers::{fixed, significant};
use super::plot::{Axis, Line, Plot, Plots, Role, Series};
use crate::study::DesignOutcome;

/// Poles farther out than so many times the vehicle's fastest one are left to the table: the others would be one point.
const FAR: f64 = 4.0;
/// Dampings whose rays are drawn.
const RAYS: [f64; 3] = [0.1, 0.3, 0.7];
/// Room beyond the outermost pole.
const ROOM: f64 = 1.08;

/// The plot, and the table of all numbers.
pub(super) fn poles(o: &DesignOutcome, plots: &mut Plots) -> Option<Html> {
    let numbers = table(o)?;
    let Some((plot, hidden)) = plane(o) else { return Some(numbers) };
    let mut text =
        "Im λ ≥ 0 alone; left is fast, up is quick to swing, and on a ray all have one damping.".to_owned();
    if hidden > 0 {
        let what = if hidden == 1 { "faster pole is" } else { "faster poles are" };
        text += &format!(" {hidden} {what} in the table alone.");
    }
    Some(classed("div", "grid", plots.add(plot)).and(note(text)).and(numbers))
}

fn plane(o: &DesignOutcome) -> Option<(Plot, usize)> {
    let size = |p: &[f64; 2]| p[0].hypot(p[1]);
    let fastest = |all: &[[f64; 2]]| all.iter().map(size).fold(0.0, f64::max);
    let closed: &[[f64; 2]] = o.verified.as_ref().map_or(&[], |v| &v.poles);
    let own = fastest(&o.passive.poles);
    let most = if own > 0.0 { FAR * own } else { fastest(closed) };
    let upper = |all: &[[f64; 2]]| -> Vec<[f64; 2]> { all.iter().copied().filter(|p| p[1] >= 0.0).collect() };
    let near = |p: &[f64; 2]| size(p) <= most;
    let loops = [("passive", 2, upper(&o.passive.poles)), ("closed loop", 1, upper(closed))];
    let mut points: Vec<(usize, [f64; 2])> = Vec::new();
    let mut hidden = 0;
    for (which, (_, _, poles)) in loops.iter().enumerate() {
        points.extend(poles.iter().filter(|p| near(p)).map(|p| (which, *p)));
        hidden += poles.iter().filter(|p| !near(p)).count();
    }
    if points.is_empty() {
        return None;
    }
    points.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    let x: Vec<f64> = points.iter().map(|(_, p)| p[0]).collect();
    let low = ROOM * x.iter().copied().fold(-1.0, f64::min);
    let right = ROOM * x.iter().copied().fold(-0.03 * low, f64::max);
    let high = ROOM * points.iter().map(|(_, p)| p[1]).fold(1.0, f64::max);
    let mut plot = Plot::new(
        "poles",
        &x,
        Axis::new("Re λ", "1/s", false).within(low, right),
        Axis::new("Im λ", "rad/s", false).within(-0.04 * high, high),
    );
    for (which, (label, sign, _)) in loops.iter().enumerate() {
        let y = points.iter().map(|(of, p)| Some(p[1]).filter(|_| *of == which)).collect();
        plot.push(Series { label: (*label).into(), role: Role::Poles, y, sign: *sign, ..Series::default() });
    }
    plot.hover = points.iter().map(|(which, p)| said(loops[*which].0, *p)).collect();
    for ray in RAYS {
        // λ = ω(−ζ + i√(1 − ζ²)), as far as the frame goes
        let slope = (1.0 - ray * ray).sqrt() / ray;
        let end = (-high / slope).max(low);
        plot.lines.push(Line::new([end, 0.0], [-slope * end, 0.0], format!("{:.0} %", 100.0 * ray)));
    }
    plot.lines.push(Line::new([0.0, 0.0], [-0.04 * high, high], ""));
    Some((plot, hidden))
}

fn said(of: &str, [re, im]: [f64; 2]) -> String {
    let size = re.hypot(im);
    let hz = significant(size / std::f64::consts::TAU, 4);
    let im_text = if im > 0.0 { format!(" ± {}i", significant(im, 4)) } else { String::new() };
    format!("{of}: {}{im_text} 1/s, {hz} Hz, damping {} %", significant(re, 4), fixed(-100.0 * re / size, 1))
}
