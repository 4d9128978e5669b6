//! Sensors of very little noise: slow filter poles almost on the axis, fast ones at 1e8 rad/s.

use super::other_vehicles::plant_of;
use washboard::cases;
use washboard::lti::GeneralizedPlant;
use washboard::synthesis::{Certificate, HinfSettings, LqgWeights, hinf, lqg, lqg_plant};
use washboard::vehicle::Disturbance;

const Z: [&str; 4] = ["heave_acceleration", "pitch_acceleration", "suspension_travel", "tire_deflection"];

fn half_car(disturbance: Disturbance, y: &[&str]) -> GeneralizedPlant {
    let road = cases::road("turkay-first-order").unwrap();
    plant_of(&cases::vehicle("turkay-half-car").unwrap(), &road, &Z, y, 4, disturbance)
}

fn weights(p: &GeneralizedPlant, noise: f64) -> LqgWeights {
    LqgWeights { sensor_noise: vec![noise; p.ny()], input_weight: vec![0.0; p.nu()], ..LqgWeights::default() }
}

/// White road velocity seen by accelerometers and travels: the filter has poles at √V.
#[test]
fn the_filters_slow_poles_are_found_however_little_noise_there_is() {
    let p = half_car(Disturbance::RoadVelocity, &["body_acceleration", "suspension_travel"]);
    let mut last = f64::INFINITY;
    for noise in [1e-4, 1e-6, 1e-8, 1e-10] {
        let design = lqg(&p, &weights(&p, noise)).unwrap_or_else(|e| panic!("{noise:e}: {e}"));
        let slowest = design
            .filter
            .solution
            .closed_loop_eigenvalues
            .iter()
            .map(|z| -z.re)
            .fold(f64::INFINITY, f64::min);
        assert!((slowest / noise.sqrt() - 1.0).abs() < 0.02, "{noise:e}: {slowest:e}");
        assert!(design.claimed_h2 < last, "{noise:e}: {} after {last}", design.claimed_h2);
        last = design.claimed_h2;
        // the loop's own Gramian
        let loop_h2 = Certificate::of(&lqg_plant(&p, &weights(&p, noise)).unwrap(), &design.controller);
        let loop_h2 = loop_h2.unwrap_or_else(|e| panic!("{noise:e}: {e}")).h2.unwrap();
        assert!(
            (loop_h2 / design.claimed_h2 - 1.0).abs() < 1e-8,
            "{noise:e}: {loop_h2} {}",
            design.claimed_h2
        );
    }
}

#[test]
fn hinf_levels_do_not_rise_as_noise_falls_or_say_that_they_are_undecided() {
    for (disturbance, y) in [
        (Disturbance::RoadVelocity, ["body_acceleration", "suspension_travel"]),
        (Disturbance::RoadDisplacement, ["body_acceleration", "suspension_travel"]),
        (Disturbance::RoadDisplacement, ["heave_acceleration", "pitch_acceleration"]),
    ] {
        let p = half_car(disturbance, &y);
        let mut last = f64::INFINITY;
        for noise in [1e-4, 1e-6, 1e-8] {
            let p = p.with_sensor_noise(&vec![noise; p.ny()]).unwrap();
            let found = hinf(&p, &HinfSettings::default()).unwrap_or_else(|e| panic!("{noise:e}: {e}"));
            // poles from 1e-2 to 1e8 rad/s are past double precision, which must be said
            let at_the_edge = disturbance == Disturbance::RoadDisplacement && noise < 1e-7;
            assert!(found.decided || at_the_edge, "{noise:e}: {}", found.gamma);
            // to the tolerance of the bisection: where noise no longer counts
            assert!(
                !found.decided || found.gamma <= last * (1.0 + 1e-6),
                "{noise:e}: {} after {last}",
                found.gamma
            );
            last = found.gamma;
            let loop_norm = Certificate::of(&p, &found.controller).unwrap().hinf;
            let off = loop_norm / found.gamma - 1.0;
            assert!(off < 1e-4 && (off > -1e-4 || !found.decided), "{noise:e}: {loop_norm} {}", found.gamma);
        }
    }
}
