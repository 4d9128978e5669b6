//! Static output feedback with the least H∞ norm for every COMPleib plant at hand, and dynamic controllers for ten.
//!
//! `study_compleib [ORDER] [NAME...]`; without a name all plants. Beside each norm stands the best that is known of static
//! controllers, and the norm again by the library's own on refined frequencies, which shares nothing with the search.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::expect_used,
    reason = "a program for a terminal"
)]

use serde::Deserialize;
use std::collections::BTreeMap;
use std::io::{IsTerminal, Write};
use std::time::Instant;
use washboard::linalg::Mat;
use washboard::lti::{GeneralizedPlant, Signals, StateSpace};
use washboard::synthesis::{
    Aim, Channel, FixedOrder, FixedOrderEnd, FixedOrderSettings, FixedOrderWork, Measure, Structure, Target,
    fixed_order,
};

/// A result above the best known one by more than this share is not as good.
const AS_GOOD: f64 = 1.005;

#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Plant {
    a: Vec<Vec<f64>>,
    b1: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    c1: Vec<Vec<f64>>,
    c: Vec<Vec<f64>>,
    d11: Vec<Vec<f64>>,
    d12: Vec<Vec<f64>>,
    d21: Vec<Vec<f64>>,
    #[serde(rename = "best_known_static_hinf_upper_bound")]
    best: Option<f64>,
}

impl Plant {
    fn generalized(&self) -> GeneralizedPlant {
        let (n, nw, nu) = (self.a.len(), self.b1[0].len(), self.b[0].len());
        let (nz, ny) = (self.c1.len(), self.c.len());
        let b = Mat::from_fn(n, nw + nu, |i, j| if j < nw { self.b1[i][j] } else { self.b[i][j - nw] });
        let c = Mat::from_fn(nz + ny, n, |i, j| if i < nz { self.c1[i][j] } else { self.c[i - nz][j] });
        let d = Mat::from_fn(nz + ny, nw + nu, |i, j| match (i < nz, j < nw) {
            (true, true) => self.d11[i][j],
            (true, false) => self.d12[i][j - nw],
            (false, true) => self.d21[i - nz][j],
            (false, false) => 0.0,
        });
        let a = Mat::from_fn(n, n, |i, j| self.a[i][j]);
        let names = |letter: &str, n: usize| (1..=n).map(|k| format!("{letter}{k}")).collect();
        let signals = Signals {
            disturbances: names("w", nw),
            controls: names("u", nu),
            performances: names("z", nz),
            measurements: names("y", ny),
        };
        let system = StateSpace::continuous(a, b, c, d).expect("a plant's matrices fit");
        GeneralizedPlant::new(system, signals).expect("as many names as signals")
    }
}

fn main() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/compleib/compleib_part.json");
    let path = std::env::var("COMPLEIB").unwrap_or_else(|_| path.to_owned());
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    // the facts beside the matrices hold infinities, which are no JSON
    let plants: BTreeMap<String, Plant> =
        serde_json::from_str(&text.replace("Infinity", "null")).expect("the collection's form");
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let order = match words.first().and_then(|w| w.parse().ok()) {
        Some(order) => {
            words.remove(0);
            order
        }
        None => 0,
    };
    let tries: usize = std::env::var("TRIES").ok().and_then(|t| t.parse().ok()).unwrap_or(30);
    let rounds: u64 = std::env::var("ROUNDS").ok().and_then(|t| t.parse().ok()).unwrap_or(4);
    let names: Vec<&String> = plants.keys().filter(|n| words.is_empty() || words.contains(n)).collect();
    let (begun, bar) = (Instant::now(), std::io::stderr().is_terminal());
    let (mut known, mut as_good, mut records, mut stabilised) = (0, 0, Vec::new(), 0);
    println!(
        "plant      n  u  y   norm          best known    ratio    distance   time     loops  factorisations"
    );
    for (k, name) in names.iter().enumerate() {
        if bar {
            eprint!("\r[{:<40}] {}/{} {name}        ", "#".repeat(40 * k / names.len()), k, names.len());
            let _ = std::io::stderr().flush();
        }
        let plant = &plants[*name];
        let p = plant.generalized();
        let start = Instant::now();
        let outputs = (0..p.nz()).map(|i| (i, 1.0)).collect();
        let channel = Channel { outputs, disturbances: Vec::new() };
        let asked = FixedOrder {
            structure: Structure::full(order, p.nu(), p.ny()),
            targets: vec![Target {
                plant: 0,
                measure: Measure::Hinf(channel),
                aim: Aim::Goal(1.0),
                name: "‖T‖∞".into(),
            }],
            plants: vec![p.clone()],
            max_pole_rad_s: None,
            max_gain: None,
            margin_rad_s: 0.0,
            starts: Vec::new(),
            frequencies_rad_s: Vec::new(),
        };
        // other random numbers in each round, begun from the best so far as well
        let mut end =
            FixedOrderEnd::NotStabilised { abscissa: f64::INFINITY, work: FixedOrderWork::default() };
        for seed in 1..=rounds {
            let mut of = asked.clone();
            if let FixedOrderEnd::Designed(d) = &end {
                of.starts.push(d.controller.clone());
            }
            let settings = FixedOrderSettings { tries, seed, ..FixedOrderSettings::default() };
            let new = fixed_order(&of, &settings).expect("a sound plant");
            let goal = |e: &FixedOrderEnd| match e {
                FixedOrderEnd::Designed(d) => d.verified_goal.unwrap_or(f64::INFINITY),
                _ => f64::INFINITY,
            };
            if seed == 1 || goal(&new) < goal(&end) {
                end = new;
            }
        }
        let time = start.elapsed().as_secs_f64();
        let sizes = format!("{:>2} {:>2} {:>2}", p.order(), p.nu(), p.ny());
        if bar {
            eprint!("\r\x1b[K");
        }
        match end {
            FixedOrderEnd::NotStabilised { abscissa, .. } => {
                println!("{name:<9} {sizes}   not stabilised: least abscissa {abscissa:.3e}   {time:.2} s");
            }
            FixedOrderEnd::Designed(d) | FixedOrderEnd::BoundsNotMet(d) => {
                stabilised += 1;
                let norm = d.verified_goal.expect("a goal");
                let ratio = plant.best.map(|b| norm / b);
                if let Some(r) = ratio {
                    known += 1;
                    as_good += usize::from(r <= AS_GOOD);
                    if r < 0.995 {
                        records.push(format!("{name} {norm:.5} ({:.5})", norm / r));
                    }
                }
                println!(
                    "{name:<9} {sizes}   {norm:<13.7} {:<13} {:<8} {:<9.1e} {time:>6.2} s {:>8} {:>10} {}",
                    plant.best.map_or_else(|| "-".into(), |b| format!("{b:.7}")),
                    ratio.map_or_else(|| "-".into(), |r| format!("{r:.5}")),
                    d.stationarity.map_or(f64::NAN, |s| s.distance),
                    d.work.loops,
                    d.work.factorisations,
                    if d.converged { "" } else { "not converged" },
                );
            }
        }
    }
    println!(
        "{stabilised} of {} stabilised; {as_good} of {known} within {AS_GOOD} of the best known; below .995 of it: {}; {:.1} s",
        names.len(),
        if records.is_empty() { "none".into() } else { records.join(", ") },
        begun.elapsed().as_secs_f64()
    );
}
