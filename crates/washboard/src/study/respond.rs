//! The job `respond`: a vehicle over a bump in time, or its gains for a pattern of the road over frequency.

use super::bump_metrics::{BumpMetrics, passage_s};
use super::controller_files::other_vehicle;
use super::{Flag, Input, Named, RespondSpec, StudyError, load_vehicle};
use crate::linalg::C64;
use crate::units::rad_per_s;
use crate::vehicle::{Bump, BumpModes, Control, Output, RideError, Vehicle};
use serde::{Deserialize, Serialize};

/// Seconds after the last wheel has left the bump.
const SETTLING_S: f64 = 3.0;
/// Samples that are written, at most: peaks are found among all.
const WRITTEN: usize = 1500;
/// Gains are looked at between these, Hz.
const BAND_HZ: [f64; 2] = [0.1, 50.0];
const POINTS: usize = 300;
/// A sum below this share of its terms has cancelled.
const CANCELLED: f64 = 1e-12;

/// What the road does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// All wheels up.
    Heave,
    /// Rear up, front down, as far as they are from the middle.
    Pitch,
    /// Left up, right down.
    Roll,
    /// Front left and rear right up, the others down.
    Warp,
}

/// Responses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RespondOutcome {
    /// Forward speed, m/s.
    pub speed_m_s: f64,
    /// SI units of the outputs.
    pub units: Named<String>,
    /// Over a bump.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bump: Option<BumpOutcome>,
    /// For a pattern of the road.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gains: Option<GainsOutcome>,
    /// What is to be known of the controller.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Flag>,
}

/// In time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BumpOutcome {
    /// h, m.
    pub height_m: f64,
    /// l, m.
    pub length_m: f64,
    /// Largest magnitudes.
    pub peak: Named<f64>,
    /// When, s after the first wheel touches the bump.
    pub peak_at_s: Named<f64>,
    /// From when on a response stays within 5 % of its peak; null where it had not settled for as long as it was looked at.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub settling_s: Named<Option<f64>>,
    /// With a controller: 1 − its peak over the passive one, (5.22).
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub reduction: Named<f64>,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Responses.
    pub response: Named<Vec<f64>>,
}

/// Over frequency.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GainsOutcome {
    /// The pattern.
    pub direction: Direction,
    /// Hz.
    pub freq_hz: Vec<f64>,
    /// |response| per metre of the pattern at its largest wheel.
    pub magnitude: Named<Vec<f64>>,
    /// Degrees, in (−180, 180].
    pub phase_deg: Named<Vec<f64>>,
}

/// The responses that a spec asks for, and the files read.
///
/// # Errors
/// A vehicle, bump, speed or controller that is wrong; a direction that the vehicle's wheels do not have; a loop that is
/// not stable.
pub fn respond(spec: &RespondSpec) -> Result<(RespondOutcome, Vec<Input>), StudyError> {
    let loaded = load_vehicle(&spec.vehicle)?;
    super::ride::check_speed(spec.speed_m_s)?;
    if !(0.01..=500.0).contains(&spec.speed_m_s) {
        let (field, expected) = ("speed_m_s", "0.01 to 500 m/s".to_owned());
        return Err(StudyError::Setting { field, expected, found: spec.speed_m_s.to_string() });
    }
    let vehicle = &loaded.vehicle;
    let control = match &spec.controller {
        Some(path) => Some(super::controller_files::control(vehicle, path)?),
        None => None,
    };
    let other = spec.controller.as_ref().and_then(|k| other_vehicle(k, &loaded.spec));
    let notes = other.into_iter().collect();
    let mut outcome =
        RespondOutcome { speed_m_s: spec.speed_m_s, units: Named::default(), bump: None, gains: None, notes };
    let law = control.as_ref().map(|(c, _)| c);
    match (spec.bump, spec.direction) {
        (Some([height_m, length_m]), None) => {
            outcome.bump = Some(over_bump(spec, vehicle, law, height_m, length_m, &mut outcome.units)?);
        }
        (None, Some(direction)) => {
            outcome.gains = Some(gains(spec, vehicle, law, direction, &mut outcome.units)?);
        }
        _ => {
            return Err(StudyError::Setting {
                field: "bump",
                expected: "either a bump (--bump H,L) or a direction (--direction heave|pitch|roll|warp)"
                    .into(),
                found: if spec.bump.is_some() { "both".into() } else { "neither".into() },
            });
        }
    }
    let inputs = loaded.inputs.into_iter().chain(control.map(|(_, input)| input));
    Ok((outcome, inputs.collect()))
}

fn over_bump(
    spec: &RespondSpec,
    vehicle: &Vehicle,
    control: Option<&Control>,
    height_m: f64,
    length_m: f64,
    units: &mut Named<String>,
) -> Result<BumpOutcome, StudyError> {
    let fail = |source| StudyError::Bump { name: spec.vehicle.clone(), source: Box::new(source) };
    let bump = Bump::new(height_m, length_m).map_err(fail)?;
    let duration_s = passage_s(vehicle, length_m, spec.speed_m_s) + SETTLING_S;
    // outputs with derivatives of the road's velocity have no response to show
    let outputs: Vec<&Output> =
        vehicle.outputs().iter().filter(|o| o.r[2].iter().all(|v| *v == 0.0)).collect();
    let modes = BumpModes::Vehicle;
    let run =
        |c| vehicle.bump_response_for(&outputs, bump, spec.speed_m_s, duration_s, c, modes).map_err(fail);
    let found = run(control)?;
    let peaks = found.peaks();
    let name = |i: usize| outputs[i].name.clone();
    let reduction = match control {
        Some(_) => {
            let passive = run(None)?.peaks();
            let both = peaks.iter().zip(&passive).enumerate();
            both.filter(|(_, (_, p))| p.0 > 0.0).map(|(i, (a, p))| (name(i), 1.0 - a.0 / p.0)).collect()
        }
        None => Named::default(),
    };
    let every = found.time_s.len().div_ceil(WRITTEN).max(1);
    let thin = |y: &[f64]| y.iter().step_by(every).copied().collect::<Vec<f64>>();
    outputs.iter().for_each(|o| units.insert(&o.name, o.unit.to_owned()));
    Ok(BumpOutcome {
        height_m,
        length_m,
        peak: peaks.iter().enumerate().map(|(i, p)| (name(i), p.0)).collect(),
        peak_at_s: peaks.iter().enumerate().map(|(i, p)| (name(i), p.1)).collect(),
        settling_s: BumpMetrics::of_outputs(vehicle, control, &outputs, bump, spec.speed_m_s)
            .map_err(fail)?
            .settling_s,
        reduction,
        time_s: thin(&found.time_s),
        response: found.outputs.iter().enumerate().map(|(i, y)| (name(i), thin(y))).collect(),
    })
}

fn gains(
    spec: &RespondSpec,
    vehicle: &Vehicle,
    control: Option<&Control>,
    direction: Direction,
    units: &mut Named<String>,
) -> Result<GainsOutcome, StudyError> {
    let pattern = pattern(vehicle, direction)?;
    if let Some(p) = control.and_then(|c| c.poles().iter().find(|p| p.re >= 0.0)) {
        return Err(StudyError::Ride {
            name: spec.controller.as_ref().map_or_else(String::new, |c| c.display().to_string()),
            source: RideError::LoopNotDamped { re: p.re, im: p.im },
        });
    }
    let outputs: Vec<&Output> = vehicle.outputs().iter().collect();
    let step = (BAND_HZ[1] / BAND_HZ[0]).ln() / (POINTS - 1) as f64;
    let freq_hz: Vec<f64> = (0..POINTS).map(|i| BAND_HZ[0] * (step * i as f64).exp()).collect();
    let mut response = vec![Vec::with_capacity(POINTS); outputs.len()];
    for f in &freq_hz {
        let omega = rad_per_s(*f);
        let h = match control {
            Some(c) => c.output_response(vehicle, &outputs, omega),
            None => vehicle.output_response(&outputs, omega),
        }
        .map_err(|e| StudyError::Ride { name: spec.vehicle.clone(), source: e.into() })?;
        for (i, row) in response.iter_mut().enumerate() {
            let terms: Vec<C64> = pattern.iter().enumerate().map(|(j, p)| h[(i, j)] * *p).collect();
            let (sum, size) = (terms.iter().sum::<C64>(), terms.iter().map(|t| t.norm()).sum::<f64>());
            // what a symmetric vehicle cancels is zero but for rounding
            row.push(if sum.norm() <= CANCELLED * size { C64::new(0.0, 0.0) } else { sum });
        }
    }
    outputs.iter().for_each(|o| units.insert(&o.name, o.unit.to_owned()));
    let by_name = |of: &dyn Fn(&C64) -> f64| -> Named<Vec<f64>> {
        let all = outputs.iter().zip(&response);
        all.map(|(o, r)| (o.name.clone(), r.iter().map(of).collect())).collect()
    };
    Ok(GainsOutcome {
        direction,
        freq_hz,
        magnitude: by_name(&|z| z.norm()),
        phase_deg: by_name(&|z| z.arg().to_degrees()),
    })
}

/// Heights of the wheels, the largest 1.
fn pattern(vehicle: &Vehicle, direction: Direction) -> Result<Vec<f64>, StudyError> {
    let wheels = vehicle.wheels();
    let middle = |axis: usize| {
        let at = wheels.iter().map(|w| w.at_m[axis]);
        0.5 * (at.clone().fold(f64::NEG_INFINITY, f64::max) + at.fold(f64::INFINITY, f64::min))
    };
    let (mx, my) = (middle(0), middle(1));
    let heights_of = |direction: Direction| -> (Vec<f64>, f64) {
        let heights: Vec<f64> = wheels
            .iter()
            .map(|w| {
                let (x, y) = (w.at_m[0] - mx, w.at_m[1] - my);
                match direction {
                    Direction::Heave => 1.0,
                    Direction::Pitch => -x,
                    Direction::Roll => y,
                    Direction::Warp => (x * y).signum() * f64::from(u8::from(x * y != 0.0)),
                }
            })
            .collect();
        let largest = heights.iter().map(|h| h.abs()).fold(0.0, f64::max);
        (heights, largest)
    };
    let (heights, largest) = heights_of(direction);
    if !(largest > 0.0) {
        let name = |d: Direction| format!("{d:?}").to_lowercase();
        let all = [Direction::Heave, Direction::Pitch, Direction::Roll, Direction::Warp];
        let own: Vec<String> = all.into_iter().filter(|d| heights_of(*d).1 > 0.0).map(name).collect();
        return Err(StudyError::Setting {
            field: "direction",
            expected: format!("a direction that the vehicle's wheels have ({})", own.join(", ")),
            found: name(direction),
        });
    }
    Ok(heights.into_iter().map(|h| h / largest).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(vehicle: &str) -> RespondSpec {
        RespondSpec {
            vehicle: format!("case:{vehicle}"),
            speed_m_s: 20.0,
            bump: None,
            direction: None,
            controller: None,
        }
    }

    #[test]
    fn patterns_are_their_names() {
        let car = crate::cases::vehicle("chalasani-full-car").unwrap();
        assert_eq!(pattern(&car, Direction::Heave).unwrap(), [1.0; 4]);
        assert_eq!(pattern(&car, Direction::Warp).unwrap(), [1.0, -1.0, -1.0, 1.0]);
        assert_eq!(pattern(&car, Direction::Roll).unwrap().iter().sum::<f64>(), 0.0);
        let pitch = pattern(&car, Direction::Pitch).unwrap();
        assert!(pitch[0] < 0.0 && pitch[2] > 0.0);
        let quarter = crate::cases::vehicle("turkay-quarter-car").unwrap();
        assert!(pattern(&quarter, Direction::Roll).is_err());
    }

    #[test]
    fn a_static_road_lifts_the_whole_vehicle() {
        let asked = RespondSpec { direction: Some(Direction::Heave), ..spec("chalasani-full-car") };
        let (found, _) = respond(&asked).unwrap();
        let gains = found.gains.unwrap();
        let heave = gains.magnitude.get("heave_displacement").unwrap();
        assert!((heave[0] - 1.0).abs() < 0.03 && heave[299] < 0.01, "{} {}", heave[0], heave[299]);
        assert!(gains.magnitude.get("roll_displacement").unwrap().iter().all(|v| *v < 1e-9));
        assert!(respond(&spec("turkay-half-car")).unwrap_err().to_string().contains("found neither"));
    }
}
