//! The page of a made-up identification, to look at: `report_sample FILE.html [failed]`.
//!
//! Spectra are those of a published car on a class C road with the scatter of a twenty-minute drive; the rest is invented.
//! Without an argument the page is built and its size printed.

#![allow(clippy::print_stdout)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;
use washboard::report::identify_page;
use washboard::road::{Coherence, IsoClass, Road, Spectrum};
use washboard::signal::{Repair, RepairKind};
use washboard::study::*;
use washboard::units::{Convention, per_hz_from_two_sided, rad_per_s};
use washboard::vehicle::{Output, Ride, Vehicle};
use washboard::{cases, files};

const SPEED_M_S: f64 = 20.0;
const AVERAGES: f64 = 257.0;
const CORNERS: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut outcome = sample()?;
    if arguments.get(1).is_some_and(|a| a == "failed") {
        fail(&mut outcome);
    }
    let page = identify_page(&outcome, "A published car, twenty minutes on a class C road");
    match arguments.first() {
        Some(file) => files::write_whole(Path::new(&file), page.as_bytes())?,
        None => println!("{} kB", page.len() / 1000),
    }
    Ok(())
}

/// The same drive with a motion that the model does not have, and no truth to compare with.
fn fail(outcome: &mut IdentifyOutcome) {
    outcome.converged = false;
    outcome.truth = None;
    let flag = |name: &str, text: &str| Flag { name: name.into(), text: text.into() };
    outcome.flags = vec![
        flag("not-converged", "The fit stopped after 200 steps with a Newton decrement of 37; 1 is needed."),
        flag("misfit", "The model does not explain the data near 14.9 Hz: χ = 36, 0.6 is the limit."),
    ];
    if let Some(fit) = &mut outcome.fit {
        (fit.chi, fit.decrement, fit.iterations) = (36.0, 37.0, 200);
        for (f, r) in fit.residual_freq_hz.iter().zip(&mut fit.residual) {
            *r += 200.0 / (1.0 + (f - 14.9).powi(2));
        }
    }
}

fn sample() -> Result<IdentifyOutcome, Box<dyn Error>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let vehicle = cases::vehicle("guiggiani-full-car")?;
    let spectrum = Spectrum::power_law(16e-6, 1.0, 2.0, [0.063, 17.77], Convention::OneSidedRadPerM)?;
    let road = Road::new(spectrum, Coherence::bogsjo(3.8)?);
    let modes = vehicle.modes()?;
    let channels: Vec<(String, &str, &str)> = ["body", "hub"]
        .iter()
        .flat_map(|place| CORNERS.map(|c| (format!("{place}_{c}"), *place, c)))
        .collect();
    let freq_hz: Vec<f64> = (2..=100).map(|k| 0.2 * f64::from(k)).collect();
    let mut near =
        |value: f64, sd: f64| value + sd * Distribution::<f64>::sample(&StandardNormal, &mut random);
    let identified = modes.iter().map(|(mode, label)| {
        let (f_sd, zeta_sd) = (1e-3 * mode.freq_hz, 0.0012);
        let values = vehicle.dofs().iter().zip(&mode.shape);
        IdentifiedMode {
            freq_hz: near(mode.freq_hz, f_sd),
            freq_sd_hz: Some(f_sd),
            damping: near(mode.damping, zeta_sd),
            damping_sd: Some(zeta_sd),
            pole: [mode.pole.re, mode.pole.im],
            shape: values.map(|(dof, z)| ShapeValue { dof: dof.clone(), re: z.re, im: z.im }).collect(),
            label: label.clone(),
            ..IdentifiedMode::default()
        }
    });
    let mut identified: Vec<_> = identified.collect();
    identified.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    let parameters = [
        ("front.suspension_stiffness_n_per_m", 15750.0),
        ("rear.suspension_stiffness_n_per_m", 14000.0),
        ("front.suspension_damping_n_s_per_m", 1475.0),
        ("rear.suspension_damping_n_s_per_m", 1310.0),
        ("front.tire_stiffness_n_per_m", 140_000.0),
        ("front.tire_damping_n_s_per_m", 150.0),
        ("pitch_inertia_kg_m2", 1630.0),
    ];
    let fitted = parameters.map(|(name, value)| {
        let sd = if name.contains("tire_damping") { 0.12 * value } else { 0.002 * value };
        FittedParameter { name: name.into(), value: near(value, sd), sd, start: 1.2 * value }
    });
    let residual: Vec<f64> = freq_hz.iter().map(|_| near(0.39, 0.05)).collect();
    let stabilization = stabilization(&identified, &mut near);
    let truth = modes.iter().map(|(m, label)| TrueMode {
        label: label.clone(),
        freq_hz: m.freq_hz,
        damping: m.damping,
    });
    let truth = Truth {
        modes: truth.collect(),
        roughness_m3: 16e-6,
        exponent: 2.0,
        mu: Some(3.8),
        delay_s: 2.66 / SPEED_M_S,
        parameters: parameters.map(|(n, v)| (n.to_owned(), v)).to_vec(),
    };
    let spectra = spectra(&vehicle, &road, &channels, freq_hz.clone(), &mut random)?;
    Ok(IdentifyOutcome {
        converged: true,
        method: "physical".into(),
        notes: vec![],
        flags: vec![Flag {
            name: "weak-parameter".into(),
            text: "The tyre damping is known to 12 % only: it hardly shows in this drive.".into(),
        }],
        modes: identified,
        road: Some(IdentifiedRoad {
            roughness_m3: 15.9e-6,
            roughness_sd_m3: 0.13e-6,
            exponent: 2.003,
            exponent_sd: 0.006,
            correlation: Some(0.5),
            convention: Convention::OneSidedRadPerM,
            class: IsoClass::C,
            band_rad_per_m: [0.126, 6.3],
        }),
        coherence: Some(IdentifiedCoherence { mu: 3.85, mu_sd: 0.07 }),
        delay_s: Some(0.132_99),
        delay_sd_s: Some(6e-6),
        noise: channels
            .iter()
            .map(|(name, place, _)| {
                let rms = if *place == "hub" { 0.21 } else { 0.017 };
                ChannelNoise { channel: name.clone(), floor_per_hz: rms * rms / 100.0, rms }
            })
            .collect(),
        rejected: rejected(),
        lines: [(12.5, 1), (25.0, 2), (37.5, 3)]
            .map(|(freq_hz, multiple)| SpectralLine {
                freq_hz,
                over_floor: 60.0 / f64::from(multiple),
                fundamental_hz: Some(12.5),
                multiple: Some(multiple),
                text: "in hub_front_left and three more".into(),
            })
            .to_vec(),
        parameters: fitted.to_vec(),
        fit: Some(FitQuality {
            cost: -48_213.71,
            decrement: 0.004,
            chi: 0.39,
            residual_freq_hz: freq_hz,
            residual,
            iterations: 17,
            evaluations: 21,
        }),
        recording: recording(&channels),
        spectra,
        stabilization,
        truth: Some(truth),
        ..IdentifyOutcome::default()
    })
}

/// Exact spectra of the ride, and an estimate of each from so many averages.
fn spectra(
    vehicle: &Vehicle,
    road: &Road,
    channels: &[(String, &str, &str)],
    freq_hz: Vec<f64>,
    random: &mut impl Rng,
) -> Result<SpectraPlot, Box<dyn Error>> {
    let ride = Ride::new(vehicle, road, SPEED_M_S)?;
    let names = channels.iter().map(|(_, place, corner)| match *place {
        "body" => format!("body_acceleration_{corner}"),
        _ => format!("unsprung_acceleration_{corner}"),
    });
    let outputs: Vec<&Output> = names.map(|n| vehicle.output(&n)).collect::<Result<_, _>>()?;
    let exact =
        freq_hz.iter().map(|f| ride.spectrum(&outputs, rad_per_s(*f))).collect::<Result<Vec<_>, _>>()?;
    let mut gauss = |sd: f64| sd * Distribution::<f64>::sample(&StandardNormal, random);
    let auto = channels.iter().enumerate().map(|(k, (name, ..))| {
        let floor = if k < 4 { 3e-6 } else { 4e-4 };
        let fitted: Vec<f64> = exact.iter().map(|s| per_hz_from_two_sided(s[(k, k)].re) + floor).collect();
        let measured = fitted.iter().map(|g| g * (1.0 + gauss(AVERAGES.powf(-0.5)))).collect();
        ChannelSpectrum { channel: name.clone(), unit: "m/s²".into(), measured, fitted }
    });
    let auto = auto.collect();
    let pairs = [(4, 6), (4, 5), (0, 4)].map(|(i, j)| {
        let fitted_coherence: Vec<f64> = exact
            .iter()
            .map(|s| s[(i, j)].norm_sqr() / (s[(i, i)].re * s[(j, j)].re * 1.002).max(f64::MIN_POSITIVE))
            .collect();
        let fitted_phase_rad: Vec<f64> = exact.iter().map(|s| s[(i, j)].arg()).collect();
        let scatter = |c: f64| ((1.0 - c).max(0.0) / (2.0 * AVERAGES * c.max(1e-3))).sqrt();
        let coherence = fitted_coherence
            .iter()
            .map(|c| (c.sqrt() + gauss(0.7 * (1.0 - c) / AVERAGES.sqrt())).powi(2).clamp(0.0, 1.0))
            .collect();
        let turn = |p: f64| (p + PI).rem_euclid(2.0 * PI) - PI;
        let phase_rad = fitted_phase_rad
            .iter()
            .zip(&fitted_coherence)
            .map(|(p, c)| turn(p + gauss(scatter(*c))))
            .collect();
        let (first, second) = (channels[i].0.clone(), channels[j].0.clone());
        PairSpectrum { first, second, coherence, fitted_coherence, phase_rad, fitted_phase_rad }
    });
    Ok(SpectraPlot { freq_hz, channels: auto, pairs: pairs.to_vec(), ..SpectraPlot::default() })
}

fn stabilization(modes: &[IdentifiedMode], near: &mut impl FnMut(f64, f64) -> f64) -> Vec<StabilizationPole> {
    let mut poles = Vec::new();
    for order in (4..=60).step_by(2) {
        for (k, mode) in modes.iter().enumerate().filter(|(k, _)| 2 * k + 6 < order) {
            let (freq_hz, damping) = (near(mode.freq_hz, 0.02), near(mode.damping, 0.01));
            let why = (order < 2 * k + 12).then(|| "damping changes by 9 % from the order before".to_owned());
            poles.push(StabilizationPole { order, freq_hz, damping, stable: why.is_none(), why });
        }
        for _ in 0..order / 8 {
            let freq_hz = near(11.0, 5.0).clamp(0.3, 24.0);
            let why = Some("no pole of the order before is near it".to_owned());
            poles.push(StabilizationPole { order, freq_hz, damping: 0.05, stable: false, why });
        }
    }
    poles
}

fn rejected() -> Vec<RejectedMode> {
    (0..48)
        .map(|k| {
            let why = match k % 3 {
                0 => format!("stable at {} orders, 12 are needed", 2 + k % 7),
                1 => "the mode at 8.1288 Hz, seen at other orders".to_owned(),
                _ => format!("1.{k} standard deviations of the spectrum's sampling error, 3 are needed"),
            };
            RejectedMode { freq_hz: 0.5 + 0.4 * f64::from(k), damping: 0.02 + 0.003 * f64::from(k), why }
        })
        .collect()
}

fn recording(channels: &[(String, &str, &str)]) -> RecordingSummary {
    let summary = |(name, place, corner): &(String, &str, &str)| ChannelSummary {
        name: name.clone(),
        quantity: "acceleration".into(),
        unit: "m/s²".into(),
        place: (*place).to_owned(),
        wheel: Some(corner.replace('_', "-")),
        rms: if *place == "hub" { 10.4 } else { 0.86 },
    };
    RecordingSummary {
        name: "drive-07.toml".into(),
        duration_s: 1200.0,
        rate_hz: 200.0,
        speed_m_s: Some(SPEED_M_S),
        speed_spread_m_s: Some(0.14),
        channels: channels.iter().map(summary).collect(),
        repairs: vec![Repair {
            channel: Some("hub_rear_left".into()),
            what: RepairKind::GapFilled,
            text: "missing samples were interpolated, the longest gap 0.02 s".into(),
            count: 7,
            start_s: Some(412.3),
        }],
        segment_s: 5.12,
        averages: AVERAGES,
        band_hz: [0.4, 20.0],
    }
}
