//! What identification finds on a car whose dampers have curves: identified damping beside the equivalent linear one, on
//! ISO classes A to E. `cargo run --release --example study_damper -- [SECONDS]`

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{sensors, settings};
use washboard::cases;
use washboard::road::Coherence;
use washboard::study::{IdentifyMethod, identify_recording};
use washboard::vehicle::{DamperCurve, DriveSettings, drive, linearise};

fn main() {
    let duration_s = std::env::args().nth(1).map_or(600.0, |s| s.parse().unwrap());
    let speed_m_s = 20.0;
    let mut spec = cases::vehicle_spec("guiggiani-full-car").unwrap();
    let car = spec.full_car.as_mut().unwrap();
    // two knees, rebound twice compression
    let curve = |scale: f64| {
        let points = [[-0.6, -1100.0], [-0.15, -400.0], [0.0, 0.0], [0.15, 220.0], [0.6, 550.0]];
        Some(DamperCurve::new(points.map(|[v, f]| [v, scale * f]).to_vec()).unwrap())
    };
    (car.front.damper_curve, car.rear.damper_curve) = (curve(1.0), curve(0.9));
    let vehicle = spec.build_alone().unwrap();
    println!(
        "{duration_s} s at {speed_m_s} m/s, 200 Hz, eight accelerometers with 2 % noise; start: the file's linear dampers"
    );
    println!("class  axle   c_eq  identified     sd  off by %   converged  misfit chi   step error");
    for class in ["a", "b", "c", "d", "e"] {
        let road =
            cases::road(&format!("iso8608-{class}")).unwrap().with_coherence(Coherence::bogsjo(3.8).unwrap());
        let linear = linearise(&vehicle, &road, speed_m_s).unwrap();
        let run = DriveSettings { speed_m_s, duration_s, rate_hz: 200.0, seed: 1 };
        let found = drive(&vehicle, &road, &sensors("all", 0.02), &run).unwrap();
        let step_error = found.step_error.unwrap();
        let outcome = identify_recording(
            &found.recording,
            "",
            Some(("car", &spec)),
            &settings(IdentifyMethod::Physical),
        )
        .unwrap()
        .0;
        for (axle, damper) in [("front", 0), ("rear", 2)] {
            let c = linear.damping_n_s_per_m[damper];
            let name = format!("{axle}.suspension_damping_n_s_per_m");
            let Some(p) = outcome.parameters.iter().find(|p| p.name == name) else { continue };
            println!(
                "{class:>5}  {axle:<5}  {c:>5.0}  {:>10.0}  {:>5.0}  {:>+8.1}  {:>10}  {:>10.2}   {step_error:.0e}",
                p.value,
                p.sd,
                100.0 * (p.value / c - 1.0),
                outcome.converged,
                outcome.fit.as_ref().map_or(f64::NAN, |f| f.chi),
            );
        }
        let truth = linear.vehicle.modes().unwrap();
        let pairs: Vec<String> = truth
            .iter()
            .zip(&outcome.modes)
            .map(|((t, label), m)| {
                format!(
                    "{label} {:.2}/{:.2} Hz {:.0}/{:.0} %",
                    m.freq_hz,
                    t.freq_hz,
                    100.0 * m.damping,
                    100.0 * t.damping
                )
            })
            .collect();
        println!("       identified/c_eq: {}", pairs.join(", "));
    }
}
