//! A stretch of random road under a vehicle, in time: exact for a road that is straight from one sample to the next.

use super::bump::{BumpError, OwnRoads, clear_cancelled};
use super::driven::sources;
use super::{Control, Output, Vehicle};
use crate::lti::Hold;
use crate::road::{Coherence, ProfileSettings, Road, RoadError, random_profile};
use thiserror::Error;

/// Driven before the first sample that is shown, s: vehicles forget in a few seconds.
const RUN_IN_S: f64 = 5.0;

/// A drive: how fast, how long, how fine, which throw of the dice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadRun {
    /// Forward speed.
    pub speed_m_s: f64,
    /// What is shown.
    pub duration_s: f64,
    /// The road is straight between samples this far apart.
    pub dt_s: f64,
    /// Same seed, same road, with and without a controller.
    pub seed: u64,
}

/// What is refused.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum RoadRunError {
    /// The loop, or what it is made of.
    #[error(transparent)]
    Loop(#[from] BumpError),
    /// The road has no profile.
    #[error(transparent)]
    Road(#[from] RoadError),
    /// More tracks than a profile has.
    #[error("a random road has one track or two, and the vehicle stands on {0}")]
    Tracks(usize),
}

impl Vehicle {
    /// Outputs (one series each) on a random road of some spectrum and coherence, rear wheels after the front ones.
    ///
    /// # Errors
    /// Settings that are not positive; wheels on more than two tracks; else as [`Vehicle::bump_response`].
    pub fn run_on_road(
        &self,
        outputs: &[&Output],
        road: &Road,
        run: RoadRun,
        control: Option<&Control>,
    ) -> Result<Vec<Vec<f64>>, RoadRunError> {
        let OwnRoads { closed, .. } = self.on_own_roads(outputs, run.speed_m_s, control)?;
        let heights = self.heights(road, run)?;
        let rows: Vec<Vec<f64>> = (0..heights.first().map_or(0, |h| h.len().saturating_sub(1)))
            .map(|k| heights.iter().map(|h| (h[k + 1] - h[k]) / run.dt_s).collect())
            .collect();
        // a velocity that is constant between samples is a road that is straight
        let y = closed
            .respond(&rows, run.dt_s, Hold::Zero)
            .map_err(|e| BumpError::Plant(super::PlantError::Lti(e)))?;
        let first = (RUN_IN_S / run.dt_s).ceil() as usize;
        let mut series: Vec<Vec<f64>> =
            (0..outputs.len()).map(|i| y.iter().skip(first).map(|row| row[i]).collect()).collect();
        clear_cancelled(outputs, &mut series);
        Ok(series)
    }

    /// Heights under the wheels at the samples, the run-in with them.
    fn heights(&self, road: &Road, run: RoadRun) -> Result<Vec<Vec<f64>>, RoadRunError> {
        let at = self.wheel_places();
        let groups = sources(road.coherence(), &at);
        let independent = *road.coherence() == Coherence::Independent;
        let front = at.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let behind: Vec<f64> = at.iter().map(|p| if independent { 0.0 } else { front - p[0] }).collect();
        let longest = behind.iter().copied().fold(0.0, f64::max);
        let (step_m, samples) =
            (run.speed_m_s * run.dt_s, ((RUN_IN_S + run.duration_s) / run.dt_s).ceil() as usize + 2);
        let settings = ProfileSettings {
            length_m: step_m * samples as f64 + longest + step_m,
            step_m,
            apart_m: None,
            speed_m_s: run.speed_m_s,
            seed: run.seed,
        };
        let tracks: Vec<Vec<f64>> = match groups.len() {
            _ if independent => {
                let one = |k: usize| ProfileSettings { seed: run.seed.wrapping_add(k as u64), ..settings };
                let all = (0..groups.len()).map(|k| random_profile(road, &one(k)));
                all.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect()
            }
            1 => random_profile(road, &settings)?,
            2 => {
                let apart = (at[groups[0][0]][1] - at[groups[1][0]][1]).abs();
                random_profile(road, &ProfileSettings { apart_m: Some(apart), ..settings })?
            }
            n => return Err(RoadRunError::Tracks(n)),
        };
        let mut heights = vec![Vec::new(); at.len()];
        for (track, group) in tracks.iter().zip(&groups) {
            for wheel in group {
                let back = (longest - behind[*wheel]) / step_m;
                heights[*wheel] = (0..samples).map(|k| between(track, k as f64 + back)).collect();
            }
        }
        Ok(heights)
    }
}

/// Straight between two points of a profile.
fn between(profile: &[f64], at: f64) -> f64 {
    let k = at.floor().max(0.0) as usize;
    let share = at - k as f64;
    let height = |k: usize| profile.get(k).or(profile.last()).copied().unwrap_or(0.0);
    height(k) * (1.0 - share) + height(k + 1) * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::{Ride, test_cases as cases};

    /// 400 s of 1.25 Hz and 11 Hz motions with 20 % of damping: some 600 independent periods, so that rms is uncertain by about 3 %.
    const SCATTER: f64 = 0.08;

    #[test]
    fn the_rms_of_a_long_run_is_the_rides() {
        for (case, road, coherence) in [
            ("turkay-quarter-car", "turkay-white-velocity", Coherence::Full),
            ("turkay-half-car", "iso8608-c", Coherence::Full),
            ("chalasani-full-car", "iso8608-c", Coherence::None),
            ("turkay-half-car", "turkay-white-velocity", Coherence::Independent),
        ] {
            let car = cases::vehicle(case).unwrap();
            let road = cases::road(road).unwrap().with_coherence(coherence);
            let all =
                car.outputs().iter().filter(|o| o.base == "suspension_travel" || o.base == "tire_deflection");
            let z: Vec<&Output> = all.collect();
            let run = RoadRun { speed_m_s: 20.0, duration_s: 400.0, dt_s: 2e-3, seed: 7 };
            let found = car.run_on_road(&z, &road, run, None).unwrap();
            let known = Ride::new(&car, &road, 20.0).unwrap().variances(&z).unwrap();
            for ((o, y), v) in z.iter().zip(&found).zip(known) {
                let rms = (y.iter().map(|v| v * v).sum::<f64>() / y.len() as f64).sqrt();
                let ratio = rms / v.rms().unwrap();
                assert!((ratio - 1.0).abs() < SCATTER, "{case} {}: {ratio}", o.name);
            }
        }
    }

    #[test]
    fn rear_wheels_meet_what_front_ones_met() {
        let car = cases::vehicle("turkay-half-car").unwrap();
        let road = cases::road("iso8608-c").unwrap().with_coherence(Coherence::Full);
        let x: Vec<f64> = car.wheels().iter().map(|w| w.at_m[0]).collect();
        // a delay of whole samples
        let dt_s = (x[0] - x[1]) / 20.0 / 100.0;
        let run = RoadRun { speed_m_s: 20.0, duration_s: 2.0, dt_s, seed: 3 };
        let heights = car.heights(&road, run).unwrap();
        for k in 100..heights[0].len() {
            assert!((heights[1][k] - heights[0][k - 100]).abs() < 1e-12);
        }
        assert!(heights[0].iter().any(|h| h.abs() > 1e-3));
    }
}
