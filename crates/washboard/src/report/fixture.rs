//! A small outcome with something in every field, for the tests of the page.

use crate::road::IsoClass;
use crate::signal::{Repair, RepairKind};
use crate::study::*;
use crate::units::Convention;

/// A name that would break out of markup, attribute or script.
pub(super) const NASTY: &str = "</script><img src=x onerror=alert(1)>";

/// Everything at once, with [`NASTY`] for every name that comes from a file.
pub(super) fn full() -> IdentifyOutcome {
    let name = || NASTY.to_owned();
    let freq_hz: Vec<f64> = (0..40).map(|k| 0.5 * f64::from(k)).collect();
    let wave = |a: f64| freq_hz.iter().map(|f| a * (1.0 + f.sin().abs())).collect::<Vec<_>>();
    let mode = |freq_hz: f64, label: &str| IdentifiedMode {
        freq_hz,
        freq_sd_hz: Some(0.0123),
        damping: 0.28,
        damping_sd: Some(0.0012),
        pole: [-2.0, 6.0],
        shape: vec![
            ShapeValue { dof: "heave".into(), re: 1.0, im: 0.0 },
            ShapeValue { dof: name(), re: 0.1, im: 0.2 },
        ],
        label: label.into(),
        points: vec![
            ShapePoint { name: name(), place: "body".into(), at_m: [1.0, 0.7], re: 1.0, im: 0.0 },
            ShapePoint { name: name(), place: name(), at_m: [1.0, -0.7], re: 0.6, im: 0.8 },
            ShapePoint { name: name(), place: "body".into(), at_m: [-1.5, 0.0], re: 0.5, im: 0.0 },
            ShapePoint { name: name(), place: "hub".into(), at_m: [1.0, 0.7], re: 0.3, im: 0.4 },
        ],
        mpc: Some(0.8768),
        mean_phase_deg: Some(-12.34),
    };
    let road = IdentifiedRoad {
        roughness_m3: 14.91e-6,
        roughness_sd_m3: 0.2e-6,
        exponent: 2.004,
        exponent_sd: 0.005,
        correlation: Some(0.5),
        convention: Convention::OneSidedRadPerM,
        class: IsoClass::C,
        band_rad_per_m: [0.126, 6.3],
    };
    let run = |speed_m_s: f64| RunSummary {
        name: name(),
        speed_m_s: Some(speed_m_s),
        duration_s: 600.0,
        converged: true,
        flags: vec![Flag { name: name(), text: format!("the run’s flag says {NASTY}") }],
        modes: vec![mode(1.0 + 0.01 * speed_m_s, NASTY)],
        road: Some(road.clone()),
        coherence: Some(IdentifiedCoherence { mu: 3.7, mu_sd: 0.1 }),
        delay_s: Some(2.66 / speed_m_s),
        chi: Some(0.43),
    };
    let order = |modes: usize, chosen: bool| OrderTried {
        modes,
        parameters: 7 * modes,
        cost: -1234.5,
        bic: if chosen { -2300.0 } else { -2250.0 },
        chi: if chosen { 0.41 } else { 0.97 },
        converged: true,
        chosen,
    };
    let start = |converged: bool| StartTried { name: name(), cost: -1234.5, chi: 0.41, converged, steps: 17 };
    IdentifyOutcome {
        converged: true,
        method: "physical".into(),
        notes: vec![],
        flags: vec![Flag { name: name(), text: format!("the flag says {NASTY}") }],
        modes: vec![mode(1.064, "heave"), mode(8.044, NASTY)],
        road: Some(road.clone()),
        coherence: Some(IdentifiedCoherence { mu: 3.8, mu_sd: 0.06 }),
        delay_s: Some(0.133),
        delay_sd_s: Some(0.00001),
        noise: vec![ChannelNoise { channel: name(), floor_per_hz: 1e-5, rms: 0.03 }],
        rejected: (0..40)
            .map(|k| RejectedMode { freq_hz: f64::from(k), damping: 0.1, why: format!("{k} {NASTY}") })
            .collect(),
        lines: vec![SpectralLine {
            freq_hz: 25.0,
            over_floor: 40.0,
            fundamental_hz: Some(12.5),
            multiple: Some(2),
            text: name(),
        }],
        held: vec![HeldParameter { name: name(), value: 1000.0 }],
        parameters: vec![FittedParameter { name: name(), value: 15740.0, sd: 38.0, start: 20000.0 }],
        fit: Some(FitQuality {
            cost: -1234.5,
            decrement: 0.3,
            chi: 0.39,
            residual_freq_hz: freq_hz.clone(),
            residual: wave(0.3),
            iterations: 12,
            evaluations: 15,
        }),
        recording: RecordingSummary {
            name: name(),
            duration_s: 1200.0,
            rate_hz: 200.0,
            speed_m_s: Some(20.0),
            speed_spread_m_s: Some(0.1),
            channels: vec![ChannelSummary {
                name: name(),
                quantity: "acceleration".into(),
                unit: "m/s²".into(),
                place: "body".into(),
                wheel: Some(name()),
                rms: 1.2,
            }],
            repairs: vec![Repair {
                channel: Some(name()),
                what: RepairKind::GapFilled,
                text: format!("interpolated {NASTY}"),
                count: 3,
                start_s: Some(1.0),
            }],
            segment_s: 5.0,
            averages: 256.0,
            band_hz: [0.4, 20.0],
        },
        spectra: SpectraPlot {
            freq_hz: freq_hz.clone(),
            confidence: Some([0.84, 1.2]),
            channels: vec![ChannelSpectrum {
                channel: name(),
                unit: "m/s²".into(),
                measured: wave(1.0),
                fitted: wave(1.1),
            }],
            pairs: vec![PairSpectrum {
                first: name(),
                second: "b\u{2028}".into(),
                coherence: wave(0.4),
                fitted_coherence: wave(0.41),
                phase_rad: wave(1.0),
                fitted_phase_rad: wave(1.1),
            }],
        },
        singular_values: Some(SingularValues {
            freq_hz: freq_hz.clone(),
            values: vec![wave(3.0), wave(0.2)],
        }),
        mac: vec![vec![1.0, 0.254], vec![0.254, 1.0]],
        starts: vec![start(true), start(false)],
        orders: vec![order(6, false), order(7, true)],
        clocks: vec![ClockOffset { channel: name(), offset_s: 0.0123, sd_s: 0.0004 }],
        runs: vec![run(15.0), run(25.0)],
        stabilization: vec![StabilizationPole {
            order: 10,
            freq_hz: 1.06,
            damping: 0.28,
            stable: false,
            why: Some(name()),
        }],
        truth: Some(Truth {
            modes: vec![TrueMode { label: name(), freq_hz: 8.04421, damping: 0.26023 }],
            roughness_m3: 16e-6,
            exponent: 2.0,
            mu: Some(3.8),
            delay_s: 0.133,
            parameters: vec![(name(), 15750.0)],
        }),
    }
}

/// What SSI finds in a recording without a speed: neither road nor fit nor truth.
pub(super) fn sparse() -> IdentifyOutcome {
    let mut outcome = IdentifyOutcome {
        method: "ssi".into(),
        notes: vec![],
        flags: vec![Flag { name: "no-speed".into(), text: "no speed is declared".into() }],
        road: None,
        coherence: None,
        delay_s: None,
        delay_sd_s: None,
        noise: Vec::new(),
        rejected: Vec::new(),
        lines: Vec::new(),
        parameters: Vec::new(),
        fit: None,
        truth: None,
        singular_values: None,
        mac: Vec::new(),
        starts: Vec::new(),
        orders: Vec::new(),
        clocks: Vec::new(),
        runs: Vec::new(),
        ..full()
    };
    for mode in &mut outcome.modes {
        mode.points.clear();
        (mode.mpc, mode.mean_phase_deg) = (None, None);
    }
    outcome.spectra.confidence = None;
    outcome.recording.speed_m_s = None;
    outcome.recording.repairs.clear();
    for channel in &mut outcome.spectra.channels {
        channel.fitted.clear();
    }
    outcome
}
