//! Time of SSI-cov and its parts on a record of a car's size: `cargo run --release --example bench_ssi`.

#![allow(clippy::print_stdout)]

use std::time::{Duration, Instant};
use washboard::identify::{SsiSettings, ssi_cov};
use washboard::signal::correlations;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    const CHANNELS: usize = 4;
    const SAMPLES: usize = 76_800;
    const RUNS: usize = 15;
    let (rate_hz, settings) = (128.0, SsiSettings::default());
    let channels = resonances(CHANNELS, SAMPLES, rate_hz);
    let (mut whole, mut lags) = (Vec::new(), Vec::new());
    let mut outcome = None;
    for _ in 0..RUNS {
        let start = Instant::now();
        correlations(&channels, 2 * settings.block_rows - 1)?;
        lags.push(start.elapsed());
        let start = Instant::now();
        outcome = Some(ssi_cov(&channels, rate_hz, &settings)?);
        whole.push(start.elapsed());
    }
    let ms = |times: &mut Vec<Duration>| {
        times.sort();
        (times[0].as_secs_f64() * 1e3, times[times.len() / 2].as_secs_f64() * 1e3)
    };
    let ((best, median), (best_lags, median_lags)) = (ms(&mut whole), ms(&mut lags));
    println!(
        "{CHANNELS} channels × {SAMPLES} samples, {} block rows, orders {} to {}, {RUNS} runs",
        settings.block_rows, settings.min_order, settings.max_order
    );
    println!("ssi_cov       best {best:6.1} ms  median {median:6.1} ms");
    println!("correlations  best {best_lags:6.1} ms  median {median_lags:6.1} ms");
    // twenty minutes of eight channels at 200 Hz, as they are and brought down to 50 Hz
    for (samples, rate_hz) in [(240_000, 200.0), (60_000, 50.0)] {
        let eight = resonances(8, samples, rate_hz);
        let start = Instant::now();
        let found = ssi_cov(&eight, rate_hz, &settings)?;
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "8 channels × {samples} samples: {seconds:.2} s, {} modes with deviations",
            found.modes.len()
        );
    }
    if let Some(outcome) = outcome {
        println!("{} poles, {} modes", outcome.diagram.poles.len(), outcome.modes.len());
    }
    Ok(())
}

/// Four resonances under a pseudo-random force each, mixed into the channels.
fn resonances(channels: usize, samples: usize, rate_hz: f64) -> Vec<Vec<f64>> {
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let mut mixed = vec![vec![0.0; samples]; channels];
    for (k, (f, zeta)) in [(1.2, 0.25), (1.6, 0.3), (10.5, 0.1), (12.0, 0.12)].into_iter().enumerate() {
        let omega: f64 = std::f64::consts::TAU * f / rate_hz;
        let r = (-zeta * omega).exp();
        let (a1, a2) = (2.0 * r * (omega * (1.0f64 - zeta * zeta).sqrt()).cos(), -r * r);
        let (mut y1, mut y2) = (0.0, 0.0);
        for t in 0..samples {
            let y = a1 * y1 + a2 * y2 + random();
            (y1, y2) = (y, y1);
            for (c, channel) in mixed.iter_mut().enumerate() {
                channel[t] += y * (1.0 + ((c * 3 + k * 5) % 7) as f64);
            }
        }
    }
    for channel in &mut mixed {
        channel.iter_mut().for_each(|v| *v += 0.1 * random());
    }
    mixed
}
