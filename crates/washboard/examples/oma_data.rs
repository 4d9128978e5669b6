//! Data for `benches/peers/oma_pyoma2.py`: `oma_data DIR` writes a simulated record as DIR/data.csv and what the three
//! classical estimators find in it, with their times, as DIR/washboard.json.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "common/structure.rs"]
mod structure;

use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;
use structure::Structure;
use washboard::identify::{FddSettings, PlscfSettings, SsiSettings, fdd, plscf, ssi_cov};

fn main() {
    const SAMPLES: usize = 76_800;
    let folder = PathBuf::from(std::env::args().nth(1).unwrap());
    let structure = Structure::mixed();
    let channels = structure.simulate(1, SAMPLES, 0.05);
    let mut csv = String::new();
    for t in 0..SAMPLES {
        let row: Vec<String> = channels.iter().map(|c| format!("{:e}", c[t])).collect();
        writeln!(csv, "{}", row.join(",")).unwrap();
    }
    std::fs::write(folder.join("data.csv"), csv).unwrap();
    let rate = structure.rate_hz;
    let start = Instant::now();
    let ssi = ssi_cov(&channels, rate, &SsiSettings::default()).unwrap();
    let ssi_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let polymax = plscf(&channels, rate, &PlscfSettings::default()).unwrap();
    let plscf_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let bells = fdd(&channels, rate, &FddSettings::default()).unwrap();
    let fdd_s = start.elapsed().as_secs_f64();
    let of = |modes: &[washboard::identify::Mode]| -> Vec<[f64; 2]> {
        modes.iter().map(|m| [m.freq_hz, m.damping]).collect()
    };
    let fdd_modes: Vec<[Option<f64>; 2]> = bells.modes.iter().map(|m| [Some(m.freq_hz), m.damping]).collect();
    let all = json!({
        "rate_hz": rate,
        "truth": structure.modes,
        "ssi": {"modes": of(&ssi.modes), "seconds": ssi_s},
        "plscf": {"modes": of(&polymax.modes), "seconds": plscf_s},
        "fdd": {"modes": fdd_modes, "seconds": fdd_s, "segment": bells.segment},
    });
    std::fs::write(folder.join("washboard.json"), all.to_string()).unwrap();
    println!("{all}");
}
