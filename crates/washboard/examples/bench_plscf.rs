//! Time of p-LSCF and its parts on a record of a car's size: `cargo run --release --example bench_plscf`.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "common/structure.rs"]
mod structure;

use std::time::Instant;
use structure::Structure;
use washboard::identify::{PlscfSettings, plscf};
use washboard::signal::correlations;

fn main() {
    const SAMPLES: usize = 76_800;
    const RUNS: usize = 15;
    let (structure, settings) = (Structure::mixed(), PlscfSettings::default());
    let channels = structure.simulate(1, SAMPLES, 0.05);
    let timed = |work: &dyn Fn()| {
        let mut times: Vec<f64> = (0..RUNS)
            .map(|_| {
                let start = Instant::now();
                work();
                1e3 * start.elapsed().as_secs_f64()
            })
            .collect();
        times.sort_by(f64::total_cmp);
        (times[0], times[RUNS / 2])
    };
    let whole = timed(&|| drop(plscf(&channels, structure.rate_hz, &settings).unwrap()));
    let lags = timed(&|| drop(correlations(&channels, settings.lags).unwrap()));
    let found = plscf(&channels, structure.rate_hz, &settings).unwrap();
    println!(
        "{} channels × {SAMPLES} samples, {} lags, orders {} to {}, {RUNS} runs",
        channels.len(),
        settings.lags,
        settings.min_order,
        settings.max_order
    );
    println!("plscf         best {:6.1} ms  median {:6.1} ms", whole.0, whole.1);
    println!("correlations  best {:6.1} ms  median {:6.1} ms", lags.0, lags.1);
    println!(
        "{} factorisations, {} poles, {} modes",
        found.factorisations,
        found.diagram.poles.len(),
        found.modes.len()
    );
    for m in &found.modes {
        println!(
            "{:.4} Hz ± {:?}, {:.4} ± {:?}, {} orders, {:.0} sigma",
            m.freq_hz, m.freq_sd_hz, m.damping, m.damping_sd, m.orders, m.significance
        );
    }
    for r in found.rejected.iter().filter(|r| r.poles > 0 && r.freq_hz < 20.0) {
        println!("  left out {:.3} Hz {:.3} {} poles: {}", r.freq_hz, r.damping, r.poles, r.why);
    }
}
