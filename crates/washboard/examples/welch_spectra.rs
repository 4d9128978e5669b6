//! A recording's auto- and cross-spectra as CSV on standard output: `welch_spectra RUN.toml SEGMENT_S`.
//!
//! Columns: `omega_rad_s`, then `psd_11, psd_12_re, psd_12_im, …` (two-sided, unit²·s/rad). Without arguments a sine of
//! amplitude 1 is taken, whose mean square is printed.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::error::Error;
use std::path::Path;
use std::time::Instant;
use washboard::signal::{
    Channel, CrossSpectra, Direction, Place, Quantity, Recording, Segment, WelchSettings, read_recording,
    welch,
};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, segment_s] = &arguments[..] else { return demonstrate() };
    let start = Instant::now();
    let recording = read_recording(Path::new(path))?;
    eprintln!("read {} samples a channel in {:.3} s", recording.len(), start.elapsed().as_secs_f64());
    for repair in recording.repairs() {
        eprintln!("{}", repair.text);
    }
    let start = Instant::now();
    let spectra = welch(&recording, &WelchSettings::hann(Segment::Seconds(segment_s.parse()?)))?;
    eprintln!("{} segments in {:.3} s", spectra.segments, start.elapsed().as_secs_f64());
    print(&spectra);
    Ok(())
}

fn print(spectra: &CrossSpectra) {
    let n = spectra.channels.len();
    let pairs = || (1..=n).flat_map(|i| (i..=n).map(move |j| (i, j)));
    let heads = pairs()
        .map(|(i, j)| if i == j { format!("psd_{i}{j}") } else { format!("psd_{i}{j}_re,psd_{i}{j}_im") });
    println!("omega_rad_s,{}", heads.collect::<Vec<_>>().join(","));
    for (omega, s) in spectra.omega_rad_s.iter().zip(&spectra.s) {
        let values = pairs().map(|(i, j)| {
            let x = s[(i - 1, j - 1)];
            if i == j { format!("{:e}", x.re) } else { format!("{:e},{:e}", x.re, x.im) }
        });
        println!("{omega:e},{}", values.collect::<Vec<_>>().join(","));
    }
}

fn demonstrate() -> Result<(), Box<dyn Error>> {
    let sine: Vec<f64> = (0..20_000).map(|k| (0.05 * f64::from(k)).sin()).collect();
    let (quantity, direction, place) = (Quantity::Acceleration, Direction::PlusZ, Place::Body);
    let channel = Channel { name: "sine".to_owned(), quantity, direction, place, wheel: None, at_m: None };
    let recording = Recording::new(200.0, None, vec![], vec![channel], vec![sine])?;
    let spectra = welch(&recording, &WelchSettings::hann(Segment::Seconds(5.0)))?;
    // var = (1/π) ∫₀^∞ S dω = 2 ∫₀^∞ S df
    let mean_square = 2.0 * spectra.resolution_hz() * spectra.s.iter().map(|s| s[(0, 0)].re).sum::<f64>();
    assert!((mean_square - 0.5).abs() < 1e-3);
    println!("mean square of a sine of amplitude 1: {mean_square:.4}");
    Ok(())
}
