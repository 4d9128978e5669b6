//! Free modes against the car that was fitted to the same spectra.

use super::identify_outcome::{Flag, IdentifiedCoherence, IdentifiedMode, IdentifiedRoad};

/// Free modes and a physical car that differ by more than this many standard deviations of the free modes …
const DEVIATIONS: f64 = 3.0;
/// … and this share of the value (as points, of damping ratios), are not both right.
const SHARE: f64 = 0.01;

/// What a car fitted to the same spectra has.
pub(super) struct CarFit<'a> {
    pub modes: &'a [IdentifiedMode],
    pub roughness_m3: f64,
    pub exponent: f64,
    pub mu: Option<f64>,
}

/// What free modes, and what they say of the road, do not agree on with a car that explains the same spectra.
///
/// Both are estimates from one record, and the car's, with a fifth of the parameters, is the sharper one where vehicles
/// are cars: the difference scatters by no more than the free modes do (Hausman, *Econometrica* 46, 1978). Where few
/// sensors see a mode, the likelihood of free modes may have its maximum at a chance bump of the spectra, with a small
/// standard deviation; nothing in the free fit itself tells. `free_modes` is their number, reported or not: with more than
/// the car's, some may be none of the car's.
pub(super) fn differences(
    modes: &[IdentifiedMode],
    road: Option<&IdentifiedRoad>,
    coherence: Option<&IdentifiedCoherence>,
    free_modes: usize,
    car: &CarFit<'_>,
) -> Option<Flag> {
    let mut off = Vec::new();
    let mut check = |what: &str, unit: &str, [free, sd, car]: [f64; 3], slack: f64| {
        if !((free - car).abs() <= DEVIATIONS * sd + slack) {
            off.push(format!("{what} {} ± {}{unit} against {}", short(free), short(sd), short(car)));
        }
    };
    for mode in modes {
        let (f_sd, zeta_sd) = (mode.freq_sd_hz.unwrap_or(0.0), mode.damping_sd.unwrap_or(0.0));
        let near = |m: &IdentifiedMode| {
            (mode.freq_hz - m.freq_hz).abs() <= DEVIATIONS * f_sd + SHARE * m.freq_hz
                && (mode.damping - m.damping).abs() <= DEVIATIONS * zeta_sd + SHARE
        };
        // shapes of wheel hops mix, and labels with them: any mode of the car will do
        if car.modes.iter().any(near) {
            continue;
        }
        match car.modes.iter().find(|m| m.label == mode.label) {
            Some(m) => {
                check(&mode.label, " Hz", [mode.freq_hz, f_sd, m.freq_hz], SHARE * m.freq_hz);
                let percent = [mode.damping, zeta_sd, m.damping].map(|v| 100.0 * v);
                check(&format!("damping of {}", mode.label), " %", percent, 100.0 * SHARE);
            }
            None if free_modes <= car.modes.len() => {
                check("the mode at", " Hz", [mode.freq_hz, f_sd, f64::NAN], 0.0)
            }
            None => {}
        }
    }
    if let Some(r) = road {
        let (s0, e) = (car.roughness_m3, car.exponent);
        check("roughness", " m³", [r.roughness_m3, r.roughness_sd_m3, s0], SHARE * s0);
        check("exponent", "", [r.exponent, r.exponent_sd, e], SHARE * e);
    }
    if let (Some(c), Some(mu)) = (coherence, car.mu) {
        check("μ", "", [c.mu, c.mu_sd, mu], SHARE * mu);
    }
    (!off.is_empty()).then(|| Flag {
        name: "differs-from-car".into(),
        text: format!(
            "free modes and a car fitted to the same spectra, which explains them, differ by more than {DEVIATIONS} standard deviations: {}; one of them is wrong (see --method physical): more sensors or a longer recording",
            off.join(", ")
        ),
    })
}

/// Three digits.
fn short(v: f64) -> String {
    if v == 0.0 {
        return "0".into();
    }
    if v.is_nan() {
        return "none of the car's".into();
    }
    let digits = (2.0 - v.abs().max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 12.0) as usize;
    if v.abs() < 1e-3 || v.abs() >= 1e5 { format!("{v:.2e}") } else { format!("{v:.digits$}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(label: &str, freq_hz: f64, damping: f64) -> IdentifiedMode {
        IdentifiedMode {
            label: label.into(),
            freq_hz,
            freq_sd_hz: Some(0.1),
            damping,
            damping_sd: Some(0.02),
            ..IdentifiedMode::default()
        }
    }

    /// Pitch is 3 standard deviations and a hundredth away at 1.1 + .311 Hz and .3 + .07, μ with .4 at 7 + 1.27.
    #[test]
    fn what_differs_by_more_than_both_can_is_named() {
        let own = [mode("heave", 1.0, 0.3), mode("pitch", 1.1, 0.3)];
        let car = CarFit { modes: &own, roughness_m3: 1e-5, exponent: 2.0, mu: Some(7.0) };
        let find = |pitch: f64, damping: f64, mu: f64| {
            let modes = [mode("heave", 1.0, 0.3), mode("pitch", pitch, damping)];
            let coherence = IdentifiedCoherence { mu, mu_sd: 0.4 };
            differences(&modes, None, Some(&coherence), 2, &car).map(|f| f.text)
        };
        assert_eq!(find(1.1 + 0.31, 0.3 + 0.069, 7.0 + 1.26), None);
        let text = find(1.1 + 0.312, 0.3, 7.0).unwrap();
        assert!(text.contains("pitch 1.41 ± 0.100 Hz against 1.10;"), "{text}");
        let text = find(1.1, 0.3 + 0.071, 7.0).unwrap();
        assert!(text.contains("damping of pitch 37.1 ± 2.00 % against 30.0;"), "{text}");
        let text = find(1.1, 0.3, 5.7).unwrap();
        assert!(text.contains("μ 5.70 ± 0.400 against 7.00;"), "{text}");
        assert!(find(f64::NAN, 0.3, 7.0).is_some());
        // at heave's place, whatever its name
        assert_eq!(find(1.0, 0.3, 7.0), None);
    }

    #[test]
    fn a_mode_that_no_car_has_is_named_unless_there_is_one_more() {
        let own = [mode("heave", 1.0, 0.3), mode("pitch", 1.1, 0.3)];
        let car = CarFit { modes: &own, roughness_m3: 1e-5, exponent: 2.0, mu: None };
        let modes = [mode("heave", 1.0, 0.3), mode("extra mode at 2.5 Hz", 2.5, 0.05)];
        let text = differences(&modes, None, None, 2, &car).unwrap().text;
        assert!(text.contains("the mode at 2.50 ± 0.100 Hz against none of the car's"), "{text}");
        assert_eq!(differences(&modes, None, None, 3, &car), None);
    }

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            [2.50439, 0.10351, 11.234, 4.0e-6, 0.0].map(short),
            ["2.50", "0.104", "11.2", "4.00e-6", "0"]
        );
    }
}
