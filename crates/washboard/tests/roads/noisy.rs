//! Spectra of few averages, and matrices that fall as 1/ω²: level, order and low-pass.

use super::folder::{Folder, fit, grid, source};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Gamma, StandardNormal};
use std::fmt::Write;
use washboard::linalg::{C64, CMat};
use washboard::study::{FitWeight, RoadFitOutcome, RoadFitSpec};

const SEEDS: u64 = 12;
/// Mean of a level (rms) over the seeds: the noise of 12 seeds of 300 samples of 5 averages is .004, weights from the densities are .25 low there.
const LEVEL: f64 = 0.01;
/// The same where large densities count: measured .011 and .013 low at 5 and 10 averages of other seeds (.27 and .19 by weights lifted as variances).
const RELATIVE_LEVEL: f64 = 0.03;
/// How the four wheels are mixed of independent noises.
const MIX: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.5, 0.866, 0.0, 0.0], [0.3, 0.058, 0.952, 0.0], [0.2, 0.230, 0.133, 0.943]];

fn density(found: &RoadFitOutcome, k: usize) -> f64 {
    found.spectrum.fitted[k]
}

/// A first-order road under noise of N averages is one of order 1 or 2 and of its own level.
#[test]
fn noise_draws_neither_level_nor_order() {
    noise(FitWeight::Relative2, LEVEL, SEEDS / 2 + 1);
}

/// Nor does it draw the level where large densities count; orders are harder to tell then (1 or 2 in 5 of 12 at 5 averages).
#[test]
fn noise_draws_no_level_of_relative_weights() {
    noise(FitWeight::Relative, RELATIVE_LEVEL, 1);
}

fn noise(weight: FitWeight, tolerance: f64, least_low: u64) {
    let folder = Folder::new(&format!("noise-{weight:?}"));
    let omega = grid(0.06, 19.0, 300);
    let law = |w: f64| 1e-6 / (w * w + 0.0158);
    for averages in [5.0, 10.0, 20.0, 30.0] {
        let (mut level, mut low) = (0.0, 0);
        for seed in 0..SEEDS {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let noise = Gamma::new(averages, 1.0 / averages).unwrap();
            let mut text = "nu_rad_per_m,psd".to_owned();
            omega.iter().for_each(|w| write!(text, "\n{w},{}", law(*w) * noise.sample(&mut rng)).unwrap());
            let spec = RoadFitSpec { weight: Some(weight), ..source(folder.file("S.csv", &text)) };
            let found = fit(spec).unwrap();
            // as the file's densities are read: one-sided
            let factor = found.spectrum.given[0]
                / text.lines().nth(1).unwrap().split_once(',').unwrap().1.parse::<f64>().unwrap();
            let ln = |k: usize| 0.5 * (density(&found, k) / (factor * law(omega[k]))).ln();
            level += (0..omega.len()).map(ln).sum::<f64>() / (omega.len() as f64 * SEEDS as f64);
            low += u64::from(found.order <= 2);
            let note = found.notes.iter().find(|n| n.name == "averages").unwrap();
            assert!(note.text.contains("local means"), "{note:?}");
        }
        println!(
            "{weight:?}, {averages} averages: level {:.4}, order 1 or 2 in {low} of {SEEDS}",
            level.exp()
        );
        assert!(level.abs() < tolerance && low >= least_low, "{averages}: {level} {low}");
    }
}

fn file(omega: &[f64], spectrum: impl Fn(f64) -> CMat) -> String {
    let mut text = "omega_rad_s".to_owned();
    for i in 1..=4 {
        for j in i..=4 {
            text += &if i == j { format!(",psd_{i}{i}") } else { format!(",psd_{i}{j}_re,psd_{i}{j}_im") };
        }
    }
    for w in omega {
        let s = spectrum(*w);
        write!(text, "\n{w}").unwrap();
        for i in 0..4 {
            for j in i..4 {
                write!(text, ",{}", s[(i, j)].re).unwrap();
                if i != j {
                    write!(text, ",{}", -s[(i, j)].im).unwrap();
                }
            }
        }
    }
    text
}

/// Four wheels on a first-order road fall as 1/ω²: one pass of the low-pass, the exact order, and no pole far beyond the band.
#[test]
fn wheels_on_a_first_order_road_are_of_its_order() {
    let folder = Folder::new("wheels");
    let omega = grid(0.5, 150.0, 120);
    let exact = |w: f64| {
        let product = |i: usize, j: usize| (0..4).map(|k| MIX[i][k] * MIX[j][k]).sum::<f64>();
        CMat::from_fn(4, 4, |i, j| C64::new(4e-4 * product(i, j) / (w * w + 9.0), 0.0))
    };
    let text = file(&omega, exact);
    let found = fit(source(folder.file("S.csv", &text))).unwrap();
    assert_eq!((found.order, found.states, found.roll_off_order), (4, 4, 1));
    assert!(found.log10_max_error < 1e-9, "{}", found.log10_max_error);
    assert!(found.poles.iter().all(|p| (p[0] / -3.0 - 1.0).abs() < 1e-6), "{:?}", found.poles);
    let row = found.orders.iter().find(|o| o.chosen).unwrap();
    assert_eq!((row.order, row.lowered_to, row.roll_off_order), (4, None, Some(1)));
    // head and table are one number
    assert_eq!(row.log10_rms_error, Some(found.log10_rms_error));
    assert!(
        found.notes.iter().any(|n| n.name == "once") && found.notes.iter().all(|n| n.name != "far-poles")
    );
    // two passes leave a rest that poles beyond the band chase, and the note says so
    let spec = RoadFitSpec { roll_off_order: Some(2), order: Some(8), ..source(folder.file("S.csv", &text)) };
    let twice = fit(spec).unwrap();
    let far = twice.poles.iter().any(|p| p[0].hypot(p[1]) > 30.0 * 150.0);
    assert_eq!(far, twice.notes.iter().any(|n| n.name == "far-poles"), "{:?} {:?}", twice.poles, twice.notes);
    assert!(far, "{:?}", twice.poles);
}

/// Twenty averages of the same: measured order 6, where weights from the densities took 15.
#[test]
fn a_noisy_matrix_keeps_a_low_order() {
    let folder = Folder::new("noisy-wheels");
    let omega = grid(0.5, 150.0, 120);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut noisy = Vec::new();
    for w in &omega {
        let mut sum = CMat::zeros(4, 4);
        for _ in 0..20 {
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let x: Vec<C64> = (0..4).map(|_| C64::new(normal(), normal()) * 0.5f64.sqrt()).collect();
            let y = CMat::from_fn(4, 1, |i, _| {
                (0..4).map(|j| x[j] * MIX[i][j] * 0.02).sum::<C64>() / C64::new(3.0, *w)
            });
            sum += &y * y.adjoint() * faer::Scale(C64::new(0.05, 0.0));
        }
        noisy.push(sum);
    }
    let at = |w: f64| noisy[omega.iter().position(|v| *v == w).unwrap()].clone();
    let found = fit(source(folder.file("S.csv", &file(&omega, at)))).unwrap();
    println!("order {} of 4, log10 error {:.3}", found.order, found.log10_rms_error);
    assert!(found.order <= 8, "{}", found.order);
    let level = |k: usize| (density(&found, k) / (16e-4 / (omega[k] * omega[k] + 9.0))).ln();
    let mean = (0..omega.len()).map(level).sum::<f64>() / omega.len() as f64;
    let factor = found.spectrum.given[0] / (0..4).map(|i| noisy[0][(i, i)].re).sum::<f64>();
    // of twenty averages: the local means' own noise and the poles'
    assert!((mean - factor.ln()).abs() < 0.05, "{mean}");
}
