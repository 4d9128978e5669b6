//! The road on the classes of ISO 8608, and the coherence of its tracks.

use super::Plots;
use super::html::{Html, note, paragraph, table};
use super::numbers::{FACTOR_95, fixed, interval, power_of_ten, significant, with_sd, with_sd_in};
use super::plot::{Axis, Line, Plot, Role};
use crate::road::IsoClass;
use crate::study::{IdentifiedRoad, IdentifyOutcome};
use crate::units::{Convention, rad_per_s};
use std::f64::consts::{LN_2, TAU};

/// The classes' lines reach so far beyond the band, as a factor.
const BEYOND: f64 = 1.25;
/// ISO 8608's reference in cycles/m, at which many write the roughness.
const REFERENCE_CYCLES_PER_M: f64 = 0.1;
/// Points of a smooth curve.
const POINTS: usize = 81;
/// The coherence of the tracks is drawn until it has fallen to this.
const LEAST_COHERENCE: f64 = 0.02;

/// S₀ and its standard deviation as ISO 8608 writes them.
pub(super) fn one_sided(road: &IdentifiedRoad) -> (f64, f64) {
    road.one_sided()
}

/// Numbers of the road, and its spectrum on the class limits.
pub(super) fn spectrum(outcome: &IdentifyOutcome, plots: &mut Plots) -> Option<Html> {
    let road = outcome.road.as_ref()?;
    let (s0, sd) = one_sided(road);
    let mut rows = vec![row("roughness S₀, one-sided per rad/m, at 1 rad/m", (s0, sd), -6, "m³")];
    if road.convention != Convention::OneSidedRadPerM {
        let name = format!("the same as {}", convention_words(road.convention));
        rows.push(row(&name, (road.roughness_m3, road.roughness_sd_m3), -6, "m³"));
    }
    let nu = rad_per_s(REFERENCE_CYCLES_PER_M);
    let at_tenth = TAU * s0 * nu.powf(-road.exponent);
    let name = format!("the same, one-sided per cycle/m, at {REFERENCE_CYCLES_PER_M} cycles/m");
    rows.push(row(&name, (at_tenth, at_tenth * relative_sd(road, nu)), -6, "m³"));
    rows.push(vec![
        "exponent e of G = S₀ Ω⁻ᵉ".into(),
        with_sd(road.exponent, Some(road.exponent_sd)).into(),
        interval(road.exponent, Some(road.exponent_sd)).unwrap_or_default().into(),
    ]);
    let [a, b] = road.band_rad_per_m;
    let band = format!("{} to {} rad/m", significant(a, 3), significant(b, 3));
    let waves = format!("wavelengths of {} to {} m", significant(TAU / b, 3), significant(TAU / a, 3));
    rows.push(vec!["band that the drive excited".into(), band.into(), waves.into()]);
    rows.push(band_row(road));
    let body =
        paragraph(class_words(s0, sd)).and(table("", &["quantity", "# found", "# 95 % interval"], rows));
    Some(body.and(plots.add(plot(outcome, road, s0))).and(note(
        "Limits of the classes are a factor 2 about their geometric means at 1 rad/m, drawn with ISO 8608’s slope of −2. \
         The band about the road is its 95 % interval from the deviations of S₀ and e and their correlation.",
    )))
}

/// How wide the 95 % interval of G(Ω) is where it is narrowest and at the ends of the band.
fn band_row(road: &IdentifiedRoad) -> Vec<Html> {
    let [a, b] = road.band_rad_per_m;
    let half = |nu: f64| 100.0 * ((FACTOR_95 * relative_sd(road, nu)).exp() - 1.0);
    // where the derivative of the variance by ln Ω is zero, if that is in the band
    let balance =
        road.correlation.unwrap_or(0.0) * road.roughness_sd_m3 / road.roughness_m3 / road.exponent_sd;
    let best =
        if balance.is_finite() { balance.exp().clamp(a.min(b), b) } else { 1.0_f64.clamp(a.min(b), b) };
    let narrowest = half(best);
    let width = |v: f64| format!("±{} %", significant(v, 2));
    vec![
        "95 % interval of G(Ω)".into(),
        format!("{} at {} rad/m", width(narrowest), significant(best, 2)).into(),
        format!("{} and {} at the ends", width(half(a)), width(half(b))).into(),
    ]
}

fn row(name: &str, (value, sd): (f64, f64), exponent: i32, unit: &str) -> Vec<Html> {
    let scale = 10f64.powi(-exponent);
    let ends = interval(value * scale, Some(sd * scale));
    let ends = ends.map_or_else(String::new, |i| format!("({i})·{} {unit}", power_of_ten(exponent)));
    vec![name.into(), format!("{} {unit}", with_sd_in(value, sd, exponent)).into(), ends.into()]
}

/// The class, its limits, and whether the interval reaches into another one.
fn class_words(s0: f64, sd: f64) -> String {
    let class = IsoClass::of(s0);
    let mean = 1e6 * class.roughness_m3();
    let limits = match class {
        IsoClass::A => "up to 2".to_owned(),
        IsoClass::H => format!("from {}", fixed(mean / 2.0, 0)),
        _ => format!("{} to {}", fixed(mean / 2.0, 0), fixed(mean * 2.0, 0)),
    };
    let (low, high) = (IsoClass::of(s0 - FACTOR_95 * sd), IsoClass::of(s0 + FACTOR_95 * sd));
    let sure = if low == high {
        "The 95 % interval lies within the class.".to_owned()
    } else {
        format!("The 95 % interval reaches from class {low:?} to class {high:?}.")
    };
    format!("Class {class:?} ({limits}·10⁻⁶ m³ at 1 rad/m). {sure}")
}

fn convention_words(convention: Convention) -> &'static str {
    match convention {
        Convention::OneSidedRadPerM => "one-sided per rad/m",
        Convention::TwoSidedRadPerM => "two-sided per rad/m",
        Convention::OneSidedCyclesPerM => "one-sided per cycle/m (at 1 rad/m)",
        Convention::TwoSidedCyclesPerM => "two-sided per cycle/m (at 1 rad/m)",
        Convention::Paper => "written by De Filippis et al., eq. (60)",
    }
}

/// Of ln G(Ω) = ln S₀ − e ln Ω, whose two errors are correlated.
fn relative_sd(road: &IdentifiedRoad, nu: f64) -> f64 {
    let (level, slope) = (road.roughness_sd_m3 / road.roughness_m3, nu.ln() * road.exponent_sd);
    let both = level * level + slope * slope - 2.0 * road.correlation.unwrap_or(0.0) * level * slope;
    both.max(0.0).sqrt()
}

fn plot(outcome: &IdentifyOutcome, road: &IdentifiedRoad, s0: f64) -> Plot {
    let [a, b] = road.band_rad_per_m;
    let ends = [a / BEYOND, b * BEYOND];
    let x = log_grid(ends, [a, b]);
    let inside = |nu: f64, g: f64| (nu >= a && nu <= b).then_some(g);
    let found = |nu: f64| s0 * nu.powf(-road.exponent);
    let edge = |sign: f64| {
        let at = move |nu: &f64| inside(*nu, found(*nu) * (sign * FACTOR_95 * relative_sd(road, *nu)).exp());
        x.iter().map(at).collect::<Vec<_>>()
    };
    let y_ends = [0.5e-6 * ends[1].powi(-2), 2.0 * IsoClass::H.roughness_m3() * ends[0].powi(-2)];
    let mut plot = Plot::new(
        "Road height on the classes of ISO 8608",
        &x,
        Axis::new("spatial frequency Ω", "rad/m", true).within(ends[0], ends[1]),
        Axis::new("G_d(Ω)", "m³", true).within(y_ends[0], y_ends[1]),
    )
    .curve("95 %, high", Role::High, edge(1.0))
    .curve("95 %, low", Role::Low, edge(-1.0))
    .curve("found", Role::Found, x.iter().map(|nu| inside(*nu, found(*nu))));
    if let Some(t) = &outcome.truth {
        let truth = |nu: &f64| Some(t.roughness_m3 * nu.powf(-t.exponent));
        plot = plot.curve("truth", Role::Truth, x.iter().map(truth));
    }
    for class in IsoClass::ALL {
        let mean = |nu: f64| class.roughness_m3() * nu.powi(-2);
        plot.lines.push(Line::new([ends[1]; 2], [mean(ends[1]); 2], format!("{class:?}")));
        // the last class has no upper limit
        if class != IsoClass::H {
            plot.lines.push(Line::new(ends, ends.map(|nu| 2.0 * mean(nu)), ""));
        }
    }
    plot.wide = true;
    plot
}

/// Points even in logarithm over `ends`, those of `through` among them.
fn log_grid(ends: [f64; 2], through: [f64; 2]) -> Vec<f64> {
    let step = (ends[1] / ends[0]).ln() / (POINTS - 1) as f64;
    let mut x: Vec<f64> = (0..POINTS).map(|k| ends[0] * (step * k as f64).exp()).chain(through).collect();
    x.retain(|v| v.is_finite() && *v > 0.0);
    x.sort_by(f64::total_cmp);
    x
}

/// Bogsjö's curve with the μ that was found.
pub(super) fn tracks(outcome: &IdentifyOutcome, plots: &mut Plots) -> Option<Html> {
    let c = outcome.coherence.as_ref()?;
    let end = (-LEAST_COHERENCE.ln() / c.mu.max(0.1)).min(10.0);
    let x: Vec<f64> = (0..POINTS).map(|k| end * k as f64 / (POINTS - 1) as f64).collect();
    let gamma = |mu: f64| x.iter().map(move |w| Some((-mu.max(0.0) * w).exp())).collect::<Vec<_>>();
    let mut plot = Plot::new(
        "Coherence of left and right track",
        &x,
        Axis::new("track width over wavelength, WΩ/2π", "", false).within(0.0, end),
        Axis::new("Γ", "", false).within(0.0, 1.0),
    )
    .curve("95 %, high", Role::High, gamma(c.mu - FACTOR_95 * c.mu_sd))
    .curve("95 %, low", Role::Low, gamma(c.mu + FACTOR_95 * c.mu_sd))
    .curve("found", Role::Found, gamma(c.mu));
    if let Some(mu) = outcome.truth.as_ref().and_then(|t| t.mu) {
        plot = plot.curve("truth", Role::Truth, gamma(mu));
    }
    plot.wide = true;
    let half = if c.mu > 0.0 {
        format!(" It is one half for waves of {} track widths.", significant(c.mu / LN_2, 3))
    } else {
        String::new()
    };
    let words = format!("Γ = exp(−μWΩ/2π) with μ = {}.{half}", with_sd(c.mu, Some(c.mu_sd)));
    let remark = "Γ multiplies the roughness; the magnitude-squared coherence of the tracks is Γ².";
    Some(paragraph(words).and(plots.add(plot)).and(note(remark)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn road(convention: Convention, roughness_m3: f64) -> IdentifiedRoad {
        IdentifiedRoad {
            roughness_m3,
            roughness_sd_m3: 0.01 * roughness_m3,
            exponent: 2.0,
            exponent_sd: 0.01,
            correlation: Some(0.5),
            convention,
            class: IsoClass::C,
            band_rad_per_m: [0.1, 10.0],
        }
    }

    #[test]
    fn classes_are_judged_one_sided_whatever_the_convention() {
        let (s0, sd) = one_sided(&road(Convention::Paper, 16e-6 * std::f64::consts::PI));
        assert!((s0 / 16e-6 - 1.0).abs() < 1e-14 && (sd / 0.16e-6 - 1.0).abs() < 1e-14);
        let (s0, _) = one_sided(&road(Convention::TwoSidedRadPerM, 8e-6));
        assert!((s0 / 16e-6 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn class_c_is_256_at_a_tenth_of_a_cycle() {
        // ISO 8608 prints 256e-6 m³ at 0.1 cycles/m for the 16e-6 m³ at 1 rad/m
        let nu = rad_per_s(REFERENCE_CYCLES_PER_M);
        assert!((TAU * 16e-6 * nu.powf(-2.0) / 256e-6 - 1.0).abs() < 0.01);
    }

    #[test]
    fn the_interval_of_the_density_is_narrowest_where_its_two_errors_balance() {
        // Var ln G = s² + (d ln Ω)² − 2 r s d ln Ω with s = d = .01 and r = .5 is least, .75 s², at ln Ω = .5
        let row = band_row(&road(Convention::OneSidedRadPerM, 16e-6));
        assert_eq!(row[1].as_str(), "±1.7 % at 1.6 rad/m");
        let end = 1.96 * 0.01 * (1.0_f64 + 10f64.ln().powi(2) + 10f64.ln()).sqrt(); // at 0.1 rad/m
        assert!(row[2].as_str().starts_with(&format!("±{:.1} % and", 100.0 * (end.exp() - 1.0))), "{row:?}");
    }

    #[test]
    fn an_interval_over_a_limit_is_said() {
        assert!(class_words(14.9e-6, 0.2e-6).ends_with("lies within the class."));
        let words = class_words(31e-6, 1e-6);
        assert!(
            words.starts_with("Class C (8 to 32") && words.ends_with("from class C to class D."),
            "{words}"
        );
    }

    #[test]
    fn the_grid_meets_both_ends_of_the_band() {
        let x = log_grid([0.05, 20.0], [0.123, 7.89]);
        assert!(x.contains(&0.123) && x.contains(&7.89) && x.windows(2).all(|w| w[0] <= w[1]));
    }
}
