//! Time of the H∞ norm on random plants, its values on hard loops, and an LQG sweep of a full car:
//! `cargo run --release --example bench_norms [plants.csv [more.csv]]`.
//!
//! With a file name the plants are written there, for `benches/peers/slycot_norms.py` to run slycot's ab13dd on; plants of a
//! second file of the same form are measured with the others.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::fmt::Write;
use std::path::Path;
use std::time::Instant;
use washboard::cases;
use washboard::linalg::Mat;
use washboard::lti::{Continuous, GeneralizedPlant, HinfNorm, Signals, StateSpace};
use washboard::synthesis::{HinfSettings, LqgWeights, hinf, lqg};
use washboard::vehicle::{Disturbance, Output, PlantSettings};

const ORDERS: [usize; 4] = [8, 14, 36, 100];
/// How far the fastest decaying eigenvalue of a random plant is from the axis.
const MARGIN: f64 = 0.05;
/// Resonances beside feedthrough in the set.
const BESIDE_FEEDTHROUGH: u64 = 300;
/// Points of the sweep of tire damping 0 … 100 N·s/m.
const SWEEP: usize = 21;

/// Numbers in −1 … 1: a linear congruential generator, so that they are the same everywhere.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn matrix(&mut self, rows: usize, cols: usize) -> Mat {
        Mat::from_fn(rows, cols, |_, _| self.next())
    }
}

type Plant = StateSpace<Continuous>;

/// A stable plant of n states, two inputs and two outputs.
fn random(n: usize) -> Plant {
    let mut numbers = Numbers(n as u64);
    let mut a = numbers.matrix(n, n) * faer::Scale(1.7 / (n as f64).sqrt());
    let (b, c) = (numbers.matrix(n, 2), numbers.matrix(2, n));
    let margin = system(a.clone(), &b, &c).least_stable_pole().unwrap().unwrap().1;
    (0..n).for_each(|i| a[(i, i)] += margin - MARGIN);
    system(a, &b, &c)
}

fn system(a: Mat, b: &Mat, c: &Mat) -> Plant {
    StateSpace::continuous(a, b.clone(), c.clone(), Mat::zeros(c.nrows(), b.ncols())).unwrap()
}

/// Oscillators of damping ζ at several frequencies among fast real poles, mixed by a similarity, in states of wild units.
fn hidden(zeta: f64, units: f64) -> Plant {
    let (rates, fast) = ([0.7, 3.1, 40.0], [-2.0, -900.0, -4e4, -3e5]);
    let n = 2 * rates.len() + fast.len();
    let mut a = Mat::zeros(n, n);
    for (k, w) in rates.into_iter().enumerate() {
        let i = 2 * k;
        (a[(i, i + 1)], a[(i + 1, i)], a[(i + 1, i + 1)]) = (w, -w, -2.0 * zeta * w);
    }
    for (k, p) in fast.into_iter().enumerate() {
        a[(6 + k, 6 + k)] = p;
    }
    let mut numbers = Numbers(7);
    let (mut b, mut c) = (numbers.matrix(n, 2), numbers.matrix(2, n));
    // peaks of like height, each above the fast poles' share
    for (i, p) in fast.into_iter().enumerate() {
        (0..2).for_each(|j| b[(6 + i, j)] *= -p);
    }
    (0..6).for_each(|i| (0..2).for_each(|j| b[(i, j)] *= zeta * 30.0));
    // a unit triangular similarity with small entries: its inverse is exact enough
    for i in 0..n {
        for j in 0..i {
            let f = 0.1 * numbers.next();
            // row i += f row j; column j −= f column i
            (0..n).for_each(|k| a[(i, k)] += f * a[(j, k)]);
            (0..n).for_each(|k| a[(k, j)] -= f * a[(k, i)]);
            (0..2).for_each(|k| b[(i, k)] += f * b[(j, k)]);
            (0..2).for_each(|k| c[(k, j)] -= f * c[(k, i)]);
        }
    }
    let scales: Vec<f64> = (0..n).map(|_| units.powf(numbers.next())).collect();
    system(a, &b, &c).with_states_scaled(&scales).unwrap()
}

/// One resonance of damping 1e-7 to 1e-4 whose peak is about as high as the feedthrough beside it, with up to two slow or fast
/// real poles, all numbers to three digits: nothing is ill-conditioned but the peak's width.
fn beside_feedthrough(seed: u64) -> Plant {
    let mut numbers = Numbers(seed);
    // the first numbers of near seeds are near
    let _ = numbers.matrix(8, 1);
    let mut within = |low: f64, high: f64| low + (high - low) * 0.5 * (numbers.next() + 1.0);
    let (zeta, w) = (10f64.powf(within(-7.0, -4.0)), 10f64.powf(within(0.0, 5.0)));
    let (real, ports) = (within(0.0, 3.0) as usize, 1 + within(0.0, 2.0) as usize);
    let n = 2 + real;
    let mut sizes = vec![(2.0 * zeta * w).sqrt(); 2];
    let mut a = Mat::zeros(n, n);
    (a[(0, 1)], a[(1, 0)], a[(1, 1)]) = (w, -w, -2.0 * zeta * w);
    for i in 2..n {
        let rate = 10f64.powf(within(-2.0, 5.0));
        a[(i, i)] = -rate;
        sizes.push(rate.sqrt());
    }
    let b = Mat::from_fn(n, ports, |i, _| sizes[i] * within(-1.5, 1.5));
    let c = Mat::from_fn(ports, n, |_, j| sizes[j] * within(-1.5, 1.5));
    let d = Mat::from_fn(ports, ports, |_, _| within(-1.5, 1.5));
    let digits = |m: &Mat| {
        Mat::from_fn(m.nrows(), m.ncols(), |i, j| format!("{:.2e}", m[(i, j)]).parse::<f64>().unwrap())
    };
    StateSpace::continuous(digits(&a), digits(&b), digits(&c), digits(&d)).unwrap()
}

/// Plants of a file in the form that `main` writes.
fn of_file(path: &str) -> Vec<(String, Plant)> {
    let text = std::fs::read_to_string(path).unwrap();
    let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
    let matrix = |line: &[&str]| {
        let (rows, cols): (usize, usize) = (line[2].parse().unwrap(), line[3].parse().unwrap());
        Mat::from_fn(rows, cols, |i, j| line[4 + i * cols + j].parse().unwrap())
    };
    let of = |four: &[Vec<&str>]| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| matrix(&four[k]));
        (four[0][0].to_owned(), StateSpace::continuous(a, b, c, d).unwrap())
    };
    lines.chunks(4).map(of).collect()
}

/// The quarter car without tire damping under LQG with little noise and cheap control: a lightly damped wheel.
fn quarter_car_loop(noise: f64) -> Plant {
    let car = cases::vehicle("turkay-quarter-car").unwrap();
    let road = cases::road("turkay-white-velocity").unwrap();
    let output = |name: &str| car.output(name).unwrap();
    let z = ["sprung_acceleration", "suspension_travel", "tire_deflection"].map(output);
    let y = ["suspension_travel"].map(output);
    let settings = PlantSettings {
        road: (&road).into(),
        speed_m_s: 20.0,
        disturbance: Disturbance::RoadVelocity,
        delay_order: 4,
    };
    let plant = car.plant(&z, &y, &settings).unwrap();
    let passive = plant.passive().h2_of_outputs().unwrap();
    let weights: Vec<f64> = passive.iter().map(|r| 1.0 / r).collect();
    let design = LqgWeights { sensor_noise: vec![noise], input_weight: vec![0.0], ..LqgWeights::default() };
    let found = lqg(&plant.with_weights(&weights).unwrap(), &design).unwrap();
    plant.close(&found.controller).unwrap()
}

/// The published eight-state example under its H∞ controller; none where its data is not at hand.
fn published_loop(tolerance: f64) -> Option<Plant> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/mathworks_susp/quarter_car_beta_0_5.json");
    let v: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).unwrap();
    let m = |name: &str| {
        let rows: Vec<Vec<f64>> = serde_json::from_value(v[name].clone()).unwrap();
        Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
    };
    let system = StateSpace::continuous(m("A"), m("B"), m("C"), m("D")).unwrap();
    let names = |text: &[&str]| text.iter().map(|t| (*t).to_owned()).collect();
    let signals = Signals {
        disturbances: names(&["d1", "d2", "d3"]),
        controls: names(&["u"]),
        performances: names(&["e1", "e2", "e3"]),
        measurements: names(&["y1", "y2"]),
    };
    let plant = GeneralizedPlant::new(system, signals).unwrap();
    let found = hinf(&plant, &HinfSettings { tolerance, ..HinfSettings::default() }).unwrap();
    Some(plant.close(&found.controller).unwrap())
}

/// Plant, LQG and the closed loop's H2 norm at each tire damping: seconds in all, and the last norm.
fn sweep() -> (f64, f64) {
    let spec = cases::vehicle_spec("chalasani-full-car").unwrap();
    let road = cases::road("turkay-first-order").unwrap();
    let start = Instant::now();
    let mut last = 0.0;
    for k in 0..SWEEP {
        let damping = 100.0 * k as f64 / (SWEEP - 1) as f64;
        let car = spec.with_overrides(&[("tire_damping_n_s_per_m".to_owned(), damping)]).unwrap();
        let car = car.build_alone().unwrap();
        let bases = ["suspension_travel", "tire_deflection"];
        let body = ["heave_acceleration", "pitch_acceleration", "roll_acceleration"];
        let wanted = |o: &&Output| bases.contains(&o.base.as_str()) || body.contains(&o.name.as_str());
        let z: Vec<&Output> = car.outputs().iter().filter(wanted).collect();
        let y: Vec<&Output> = car.outputs().iter().filter(|o| o.base == bases[0]).collect();
        assert_eq!((z.len(), y.len()), (11, 4));
        let disturbance = Disturbance::RoadNoise;
        let settings = PlantSettings { road: (&road).into(), speed_m_s: 20.0, disturbance, delay_order: 4 };
        let plant = car.plant(&z, &y, &settings).unwrap();
        let passive = plant.passive().h2_of_outputs().unwrap();
        let weights: Vec<f64> = passive.iter().map(|r| 1.0 / r).collect();
        let weighted = plant.with_weights(&weights).unwrap();
        let design =
            LqgWeights { sensor_noise: vec![1e-8; 4], input_weight: vec![1e-6; 4], ..LqgWeights::default() };
        let found = lqg(&weighted, &design).unwrap();
        last = weighted.close(&found.controller).unwrap().h2_norm().unwrap();
    }
    (start.elapsed().as_secs_f64(), last)
}

fn median_us(plant: &Plant) -> (f64, HinfNorm) {
    let found = plant.hinf_norm().unwrap();
    let runs = (100_000 / (plant.order() * plant.order())).clamp(30, 1500);
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            std::hint::black_box(plant.hinf_norm().unwrap());
            1e6 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    (times[runs / 2], found)
}

fn main() {
    let mut plants: Vec<(String, Plant)> =
        ORDERS.iter().map(|n| (format!("random {n}"), random(*n))).collect();
    for zeta in [1e-2, 1e-4, 1e-5, 1e-6] {
        for units in [1.0, 1e6] {
            plants.push((format!("hidden {zeta:e} units {units:e}"), hidden(zeta, units)));
        }
    }
    for noise in [1e-4, 1e-8, 1e-10] {
        plants.push((format!("quarter car lqg noise {noise:e}"), quarter_car_loop(noise)));
    }
    for tolerance in [1e-2, 1e-7] {
        if let Some(closed) = published_loop(tolerance) {
            plants.push((format!("published hinf loop {tolerance:e}"), closed));
        }
    }
    if let Some(more) = std::env::args().nth(2) {
        plants.extend(of_file(&more));
    }
    let alone = plants.len();
    plants
        .extend((0..BESIDE_FEEDTHROUGH).map(|k| (format!("beside feedthrough {k}"), beside_feedthrough(k))));
    let mut file = String::new();
    println!("{:<34} {:>4} {:>11} {:>20} {:>14}  work", "plant", "n", "median µs", "norm", "rad/s");
    for (k, (name, plant)) in plants.iter().enumerate() {
        // the set is judged, not timed
        let (us, found) = if k < alone { median_us(plant) } else { (f64::NAN, plant.hinf_norm().unwrap()) };
        let (n, norm, omega) = (plant.order(), found.norm, found.omega_rad_s);
        if k < alone {
            println!("{name:<34} {n:>4} {us:>11.1} {norm:>20.12e} {omega:>14.6e}  {found:?}");
        }
        for (matrix, m) in [("A", plant.a()), ("B", plant.b()), ("C", plant.c()), ("D", plant.d())] {
            let values: Vec<String> =
                (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)].to_string())).collect();
            writeln!(file, "{name},{matrix},{},{},{}", m.nrows(), m.ncols(), values.join(",")).unwrap();
        }
        writeln!(file, "{name},found,1,3,{us},{norm},{omega}").unwrap();
    }
    let (seconds, last) = (0..5).map(|_| sweep()).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    println!("full car, LQG at {SWEEP} tire dampings: {:.1} ms, last H2 norm {last:.6}", 1e3 * seconds);
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, file).unwrap();
    }
}
