//! A vehicle over the thesis's bump: peaks (5.22) compares, and how long they last.

use super::{Named, ResponseGroup};
use crate::metrics::{SETTLING_BAND, settling_time};
use crate::vehicle::{Bump, BumpError, BumpModes, Control, Output, Vehicle};
use serde::{Deserialize, Serialize};

/// How long is looked at first after the last wheel has left the bump, s; doubled until all has settled.
const FIRST_S: f64 = 3.0;
/// … so many times at most: 24 s.
const DOUBLINGS: usize = 3;

/// A bump of (5.21): w(t) = ½h(1 − cos(2πvt/l)).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BumpSpec {
    /// h, m.
    pub height_m: f64,
    /// l, m.
    pub length_m: f64,
}

impl Default for BumpSpec {
    /// 0.1 m over 2 m: Türkay, section 5.3.
    fn default() -> Self {
        BumpSpec { height_m: 0.1, length_m: 2.0 }
    }
}

/// Responses to a bump in two numbers each.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct BumpMetrics {
    /// Largest magnitudes by output.
    pub peak: Named<f64>,
    /// From when on, s after the first wheel has touched the bump, a response stays within 5 % of its peak; null where it had not settled for as
    /// long as it was looked at.
    pub settling_s: Named<Option<f64>>,
}

impl BumpMetrics {
    /// Of outputs that say something of a car.
    pub(super) fn of(
        vehicle: &Vehicle,
        control: Option<&Control>,
        bump: BumpSpec,
        speed_m_s: f64,
    ) -> Result<Self, BumpError> {
        let shown = |o: &&Output| {
            let group = ResponseGroup::of(&o.name);
            let passive_force = control.is_none() && group == ResponseGroup::Force;
            let motion = o.base.ends_with("_displacement") || o.base.ends_with("_velocity");
            group != ResponseGroup::Other && !passive_force && !motion && o.r[2].iter().all(|v| *v == 0.0)
        };
        let outputs: Vec<&Output> = vehicle.outputs().iter().filter(shown).collect();
        let bump = Bump::new(bump.height_m, bump.length_m)?;
        Self::of_outputs(vehicle, control, &outputs, bump, speed_m_s)
    }

    /// Of any outputs without derivatives of the road's velocity.
    pub(super) fn of_outputs(
        vehicle: &Vehicle,
        control: Option<&Control>,
        outputs: &[&Output],
        bump: Bump,
        speed_m_s: f64,
    ) -> Result<Self, BumpError> {
        let passage_s = passage_s(vehicle, bump.length_m, speed_m_s);
        let look = |after_s: f64| -> Result<Self, BumpError> {
            let duration_s = passage_s + after_s;
            let modes = BumpModes::Vehicle;
            let found = vehicle.bump_response_for(outputs, bump, speed_m_s, duration_s, control, modes)?;
            let peaks: Vec<f64> = found.peaks().into_iter().map(|p| p.0).collect();
            let mut metrics = BumpMetrics::default();
            for (i, output) in outputs.iter().enumerate() {
                let settled = settling_time(&found.time_s, &found.outputs[i], SETTLING_BAND, passage_s);
                metrics.peak.insert(&output.name, peaks[i]);
                metrics.settling_s.insert(&output.name, settled);
            }
            Ok(metrics)
        };
        let mut after_s = FIRST_S;
        let mut metrics = look(after_s)?;
        for _ in 0..DOUBLINGS {
            if metrics.settling_s.iter().all(|(_, s)| s.is_some()) {
                break;
            }
            after_s *= 2.0;
            match look(after_s) {
                Ok(longer) => metrics = longer,
                // more samples than are computed: what was seen in less time stands
                Err(BumpError::TooManySamples { .. }) => break,
                Err(e) => return Err(e),
            }
        }
        Ok(metrics)
    }
}

/// From the first wheel's touching the bump to the last one's leaving it, s.
pub(super) fn passage_s(vehicle: &Vehicle, length_m: f64, speed_m_s: f64) -> f64 {
    let x = vehicle.wheels().iter().map(|w| w.at_m[0]);
    let extent = x.clone().fold(f64::NEG_INFINITY, f64::max) - x.fold(f64::INFINITY, f64::min);
    (extent + length_m) / speed_m_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passive_peaks_are_the_notes_and_settling_follows_the_slow_mode() {
        // notes on chapter 5: c_t = 50, h = 0.1 m, l = 2 m, 45 km/h
        let spec = crate::study::load_vehicle("case:turkay-quarter-car").unwrap().spec;
        let car = spec
            .with_overrides(&[("tire_damping_n_s_per_m".into(), 50.0)])
            .and_then(|s| s.build(|_| unreachable!("a quarter car has no chassis")))
            .unwrap();
        let found = BumpMetrics::of(&car, None, BumpSpec::default(), 12.5).unwrap();
        for (name, known, digits) in [
            ("sprung_acceleration", 13.158, 5e-4),
            ("suspension_travel", 0.09727, 5e-6),
            ("tire_deflection", 0.02851, 5e-6),
        ] {
            let peak = found.peak.get(name).unwrap();
            assert!((peak - known).abs() <= 1.01 * digits, "{name} {peak}");
        }
        assert!(found.peak.get("actuator_force").is_none() && found.peak.get("unsprung_velocity").is_none());
        // e^{−ζωt} of the body's mode falls to 5 % in 3/(ζω)
        let slowest = car.modes().unwrap().iter().map(|(m, _)| -m.pole.re).fold(f64::INFINITY, f64::min);
        let settled = found.settling_s.get("suspension_travel").unwrap().unwrap();
        assert!(settled > 1.0 / slowest && settled < 4.5 / slowest + 0.2, "{settled} {}", 1.0 / slowest);
    }

    #[test]
    fn a_fast_controllers_modes_need_no_samples_of_their_own() {
        // a damper behind a filter of 3e3 rad/s, twenty times the wheel's mode
        let car = crate::cases::vehicle("turkay-quarter-car").unwrap();
        let one = |v: f64| crate::linalg::Mat::from_fn(1, 1, |_, _| v);
        let k = crate::lti::StateSpace::continuous(one(-3e3), one(3e3), one(500.0), one(0.0)).unwrap();
        let k = Control::new(&car, k, &["sprung_velocity".into()], &["actuator".into()]).unwrap();
        let found = BumpMetrics::of(&car, Some(&k), BumpSpec::default(), 12.5).unwrap();
        let names = ["sprung_acceleration", "suspension_travel", "tire_deflection", "actuator_force"];
        let z = names.map(|n| car.output(n).unwrap());
        let all = car.bump_response(&z, Bump::new(0.1, 2.0).unwrap(), 12.5, 1.5, Some(&k)).unwrap();
        for (name, (peak, _)) in names.iter().zip(all.peaks()) {
            // what samples of the wheel's mode leave of a peak: (π/400)²/2, and as much of the straight lines between the road's
            let coarse = found.peak.get(name).unwrap();
            assert!((coarse / peak - 1.0).abs() < 1e-4, "{name} {coarse} {peak}");
        }
    }

    #[test]
    fn what_a_symmetric_car_cancels_stands_still() {
        let car = crate::cases::vehicle("chalasani-full-car").unwrap();
        let found = BumpMetrics::of(&car, None, BumpSpec { height_m: 0.05, length_m: 1.0 }, 20.0).unwrap();
        assert_eq!(found.peak.get("roll_acceleration"), Some(&0.0));
        assert_eq!(found.settling_s.get("roll_acceleration"), Some(&Some(0.0)));
        assert!(found.settling_s.iter().all(|(_, s)| s.is_some()), "{found:?}");
    }
}
