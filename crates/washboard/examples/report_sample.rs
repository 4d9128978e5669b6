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
use washboard::linalg::C64;
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
            points: points(&vehicle, &mode.shape),
            mpc: Some(collinearity(&mode.shape)),
            mean_phase_deg: Some(near(0.0, 4.0)),
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
    let singular_values = singular_values(&identified);
    let runs = runs(&identified, &mut near);
    let shapes: Vec<&Vec<C64>> = modes.iter().map(|(m, _)| &m.shape).collect();
    let mac = shapes.iter().map(|a| shapes.iter().map(|b| likeness(a, b)).collect()).collect();
    let spectra = spectra(&vehicle, &road, &channels, freq_hz.clone(), &mut random)?;
    Ok(IdentifyOutcome {
        held: Vec::new(),
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
        singular_values: Some(singular_values),
        mac,
        starts: starts(),
        orders: orders(),
        clocks: vec![ClockOffset { channel: "hub_rear_left".into(), offset_s: 0.0123, sd_s: 0.0004 }],
        runs,
        truth: Some(truth),
    })
}

/// Body corners and hubs: pitch is positive nose down, roll left side up.
fn points(vehicle: &Vehicle, shape: &[C64]) -> Vec<ShapePoint> {
    let at =
        |dof: &str| vehicle.dofs().iter().position(|d| d == dof).map_or(C64::new(0.0, 0.0), |k| shape[k]);
    let body = vehicle
        .wheels()
        .iter()
        .map(|w| ("body", w, at("heave") - at("pitch") * w.at_m[0] + at("roll") * w.at_m[1]));
    let hubs = vehicle.wheels().iter().map(|w| ("hub", w, at(&format!("unsprung_{}", w.name))));
    let all: Vec<_> = body.chain(hubs).collect();
    let largest =
        all.iter().map(|p| p.2).fold(C64::new(1e-9, 0.0), |a, b| if b.norm() > a.norm() { b } else { a });
    let point = |(place, w, z): (&str, &washboard::vehicle::Wheel, C64)| {
        let (name, z) = (format!("{place} {}", w.name.replace('_', "-")), z / largest);
        ShapePoint { name, place: place.into(), at_m: w.at_m, re: z.re, im: z.im }
    };
    all.into_iter().map(point).collect()
}

/// |aᴴb|²/(aᴴa · bᴴb).
fn likeness(a: &[C64], b: &[C64]) -> f64 {
    let product = |u: &[C64], v: &[C64]| u.iter().zip(v).map(|(u, v)| u.conj() * v).sum::<C64>();
    product(a, b).norm_sqr() / (product(a, a).re * product(b, b).re)
}

/// The modal phase collinearity |Σz²|²/(Σ|z|²)².
fn collinearity(shape: &[C64]) -> f64 {
    let square: C64 = shape.iter().map(|z| z * z).sum();
    square.norm_sqr() / shape.iter().map(|z| z.norm_sqr()).sum::<f64>().powi(2)
}

fn starts() -> Vec<StartTried> {
    let start =
        |name: &str, cost, chi, converged| StartTried { name: name.into(), cost, chi, converged, steps: 23 };
    vec![
        start("a small car", -48_213.71, 0.39, true),
        start("a van", -48_213.70, 0.39, true),
        start("a light truck", -47_911.02, 1.4, true),
        start("stiff springs", -40_122.9, 5.3, false),
    ]
}

fn orders() -> Vec<OrderTried> {
    let order = |modes, cost: f64, chi| OrderTried {
        modes,
        parameters: 9 * modes,
        cost,
        bic: 2.0 * cost + 9.0 * modes as f64 * AVERAGES.ln(),
        chi,
        converged: true,
        chosen: modes == 7,
    };
    vec![
        order(5, -44_000.0, 3.1),
        order(6, -47_800.0, 0.88),
        order(7, -48_213.7, 0.39),
        order(8, -48_219.9, 0.39),
    ]
}

/// Five drives at five speeds.
fn runs(modes: &[IdentifiedMode], near: &mut impl FnMut(f64, f64) -> f64) -> Vec<RunSummary> {
    let mut runs = Vec::new();
    for (k, speed) in [12.0, 16.0, 20.0, 24.0, 28.0].into_iter().enumerate() {
        let own = modes.iter().map(|m| {
            let (f_sd, zeta_sd) = (4e-3 * m.freq_hz, 0.006);
            let (freq_hz, damping) = (near(m.freq_hz, f_sd), near(m.damping, zeta_sd));
            let label = m.label.clone();
            IdentifiedMode {
                freq_hz,
                freq_sd_hz: Some(f_sd),
                damping,
                damping_sd: Some(zeta_sd),
                label,
                ..IdentifiedMode::default()
            }
        });
        let misfit = Flag {
            name: "misfit".into(),
            text: "The model does not explain the data near 16.2 Hz: χ = 0.91, 0.6 is the limit.".into(),
        };
        runs.push(RunSummary {
            name: format!("drive-{:02}.toml", k + 3),
            speed_m_s: Some(speed),
            duration_s: 240.0,
            converged: true,
            flags: if k == 4 { vec![misfit] } else { vec![] },
            modes: own.collect(),
            road: Some(IdentifiedRoad {
                roughness_m3: near(16e-6, 0.3e-6),
                roughness_sd_m3: 0.3e-6,
                exponent: near(2.0, 0.02),
                exponent_sd: 0.02,
                correlation: Some(0.4),
                convention: Convention::OneSidedRadPerM,
                class: IsoClass::C,
                band_rad_per_m: [0.126, 6.3],
            }),
            coherence: Some(IdentifiedCoherence { mu: near(3.8, 0.1), mu_sd: 0.1 }),
            delay_s: Some(2.66 / speed),
            chi: Some(if k == 4 { 0.91 } else { 0.41 }),
        });
    }
    runs
}

/// Bumps at the modes.
fn singular_values(modes: &[IdentifiedMode]) -> SingularValues {
    let freq_hz: Vec<f64> = (2..=100).map(|k| 0.2 * f64::from(k)).collect();
    let curve = |level: f64| {
        let bump = |f: f64, m: &IdentifiedMode| {
            let r = f / m.freq_hz;
            r * r / ((1.0 - r * r).powi(2) + (2.0 * m.damping * r).powi(2))
        };
        freq_hz.iter().map(|f| level * modes.iter().map(|m| bump(*f, m)).sum::<f64>()).collect()
    };
    SingularValues { values: [0.3, 0.08, 0.02, 0.004].map(curve).to_vec(), freq_hz }
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
    Ok(SpectraPlot { freq_hz, confidence: Some([0.89, 1.13]), channels: auto, pairs: pairs.to_vec() })
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
