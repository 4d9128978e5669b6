//! The job `ride`: what reaches body, suspension and tires on a road.

use super::beyond_band::{BeyondBand, beyond, continued};
use super::controller_files::other_vehicle;
use super::ground::{Ground, ground};
use super::ride_metrics::{Judged, RideMetrics, check_stroke, long_stroke};
use super::{Flag, Input, MetricsSection, Named, RideSpec, StudyError, load_vehicle};
use crate::units::{hz, per_hz_from_two_sided, rad_per_s};
use crate::vehicle::{Control, Output, Ride, Variance, Vehicle};
use serde::{Deserialize, Serialize};

/// Where spectra are looked at, Hz; cut to the road's band.
const BAND_HZ: [f64; 2] = [0.1, 50.0];
/// Points of a spectrum, evenly spaced in log f.
const POINTS: usize = 200;

/// The responses of a vehicle on a road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RideOutcome {
    /// Forward speed.
    pub speed_m_s: f64,
    /// Every output, and each stacked vector before its components: the 2-norm of their rms.
    pub rms: Named<Rms>,
    /// Why, for each output that is infinite on this road.
    pub infinite: Named<String>,
    /// SI units of the rms.
    pub units: Named<String>,
    /// One-sided per Hz.
    pub spectra: RideSpectra,
    /// How much of each variance is from where a fitted filter has no data; none of other roads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_band: Option<BeyondBand>,
    /// Weighted accelerations, tire loads, bottoming and power.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metrics: Option<RideMetrics>,
    /// What is to be known of the road and the controller.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Flag>,
}

/// Spectra of every output that is no stacked vector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RideSpectra {
    /// Hz.
    pub freq_hz: Vec<f64>,
    /// unit²/Hz, one-sided.
    pub psd: Named<Vec<f64>>,
}

/// An rms: a number, or the string `infinite`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Rms {
    /// In the output's unit.
    Finite(f64),
    /// No finite one on this road.
    Infinite(Infinite),
}

/// The word `infinite`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Infinite {
    /// As it is written.
    Infinite,
}

impl Rms {
    /// The number, where there is one.
    #[must_use]
    pub fn finite(self) -> Option<f64> {
        match self {
            Rms::Finite(v) => Some(v),
            Rms::Infinite(_) => None,
        }
    }
}

/// The ride that a spec names, and the files read.
///
/// # Errors
/// A vehicle or road that cannot be built, a speed that is not positive, a vehicle without wheels or damping, a
/// quadrature that does not reach its accuracy.
pub fn ride(spec: &RideSpec) -> Result<(RideOutcome, Vec<Input>), StudyError> {
    let loaded = load_vehicle(&spec.vehicle)?;
    check_speed(spec.speed_m_s)?;
    check_stroke("stroke_m", spec.stroke_m)?;
    let (ground, vehicle, road_inputs) = ground(&loaded, &spec.road, spec.speed_m_s)?;
    let control = match &spec.controller {
        Some(path) => Some(super::controller_files::control(&vehicle, path)?),
        None => None,
    };
    let metrics = MetricsSection { stroke_m: spec.stroke_m, ..MetricsSection::default() };
    let loop_of = control.as_ref().map(|(c, _)| c);
    let mut outcome = ride_on(&loaded.name, &vehicle, &ground, spec.speed_m_s, loop_of, Some(metrics))?;
    let other = spec.controller.as_ref().and_then(|k| other_vehicle(k, &loaded.spec));
    outcome.notes.extend(other);
    let inputs = loaded.inputs.into_iter().chain(road_inputs).chain(control.map(|(_, input)| input));
    Ok((outcome, inputs.collect()))
}

/// The ride of a vehicle that stands on its road, with a controller or without; judged where metrics are asked for.
pub(super) fn ride_on(
    name: &str,
    vehicle: &Vehicle,
    ground: &Ground,
    speed_m_s: f64,
    control: Option<&Control>,
    metrics: Option<MetricsSection>,
) -> Result<RideOutcome, StudyError> {
    let fail = |source| StudyError::Ride { name: name.to_owned(), source };
    let ride = match control {
        Some(control) => Ride::controlled(vehicle, ground.excitation(), speed_m_s, control),
        None => Ride::new(vehicle, ground.excitation(), speed_m_s),
    }
    .map_err(fail)?;
    let outputs: Vec<&Output> = vehicle.outputs().iter().collect();
    let variances = ride.variances(&outputs).map_err(fail)?;
    let freq_hz = grid_hz(ground.excitation().band_rad_s(speed_m_s));
    let mut psd = vec![Vec::with_capacity(freq_hz.len()); outputs.len()];
    for f in &freq_hz {
        let s = ride.spectrum(&outputs, rad_per_s(*f)).map_err(fail)?;
        for (i, values) in psd.iter_mut().enumerate() {
            values.push(per_hz_from_two_sided(s[(i, i)].re));
        }
    }
    let psd = outputs.iter().map(|o| o.name.clone()).zip(psd).collect();
    let (rms, infinite, units) = by_name(&outputs, &variances);
    let mut notes = ground.notes.clone();
    let beyond_band = match ground.fitted_band_rad_s {
        Some(band) => Some(beyond(&ride, &outputs, &variances, band).map_err(fail)?),
        None => None,
    };
    notes.extend(beyond_band.as_ref().and_then(|b| continued(b, &outputs, "")));
    let metrics = metrics.and_then(|section| {
        let stroke_m = section.stroke_m;
        notes.extend(long_stroke(stroke_m));
        let judged = Judged { vehicle, speed_m_s, stroke_m, controlled: control.is_some() };
        RideMetrics::of(&ride, &judged)
            .map_err(|e| notes.push(Flag { name: "metrics".into(), text: format!("no metrics: {e}") }))
            .ok()
    });
    Ok(RideOutcome {
        metrics,
        speed_m_s,
        rms,
        infinite,
        units,
        spectra: RideSpectra { freq_hz, psd },
        beyond_band,
        notes,
    })
}

/// Refuses a speed that is none, before it is blamed on a vehicle.
pub(super) fn check_speed(speed_m_s: f64) -> Result<(), StudyError> {
    if speed_m_s.is_finite() && speed_m_s > 0.0 {
        return Ok(());
    }
    let (expected, found) = ("a positive number".to_owned(), speed_m_s.to_string());
    Err(StudyError::Setting { field: "speed_m_s", expected, found })
}

type Tables = (Named<Rms>, Named<String>, Named<String>);

/// Outputs in the vehicle's order, those of one base together and the stacked vector before them.
fn by_name(outputs: &[&Output], variances: &[Variance]) -> Tables {
    let (mut rms, mut infinite, mut units) = Tables::default();
    let mut put = |name: &str, unit: &str, variance: Variance| {
        units.insert(name, unit.to_owned());
        rms.insert(
            name,
            match variance {
                Variance::Finite(v) => Rms::Finite(v.max(0.0).sqrt()),
                Variance::Infinite(why) => {
                    infinite.insert(name, why.to_owned());
                    Rms::Infinite(Infinite::Infinite)
                }
            },
        );
    };
    let mut bases: Vec<&str> = Vec::new();
    for output in outputs {
        if !bases.contains(&output.base.as_str()) {
            bases.push(&output.base);
        }
    }
    for base in bases {
        let members: Vec<usize> = (0..outputs.len()).filter(|i| outputs[*i].base == base).collect();
        let stacked = members.iter().map(|i| variances[*i]).reduce(|a, b| match (a, b) {
            (Variance::Finite(a), Variance::Finite(b)) => Variance::Finite(a + b),
            (Variance::Infinite(why), _) | (_, Variance::Infinite(why)) => Variance::Infinite(why),
        });
        let alone = members.iter().any(|i| outputs[*i].name == base);
        if let Some(stacked) = stacked.filter(|_| !alone) {
            put(base, outputs[members[0]].unit, stacked);
        }
        for i in members {
            put(&outputs[i].name, outputs[i].unit, variances[i]);
        }
    }
    (rms, infinite, units)
}

/// [`BAND_HZ`] cut to a road's band; the road's own where the two have nothing in common.
fn grid_hz([low, high]: [f64; 2]) -> Vec<f64> {
    let (low, high) = (hz(low), hz(high));
    let cut = [low.max(BAND_HZ[0]), high.min(BAND_HZ[1])];
    let [from, to] = if cut[0] < cut[1] { cut } else { [low, high] };
    let step = (to / from).ln() / (POINTS - 1) as f64;
    // the ends themselves, not a rounding beyond the band
    (0..POINTS).map(|i| (from * (step * i as f64).exp()).clamp(from, to)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(vehicle: &str, road: &str) -> RideSpec {
        RideSpec {
            vehicle: format!("case:{vehicle}"),
            road: format!("case:{road}"),
            speed_m_s: 20.0,
            controller: None,
            stroke_m: None,
        }
    }

    #[test]
    fn a_stacked_name_is_the_two_norm_of_its_components() {
        let (outcome, inputs) = ride(&spec("turkay-half-car", "iso8608-b")).unwrap();
        let get = |name: &str| outcome.rms.get(name).unwrap().finite().unwrap();
        let both = get("suspension_travel_front").hypot(get("suspension_travel_rear"));
        assert!((get("suspension_travel") / both - 1.0).abs() < 1e-14);
        assert_eq!(inputs.len(), 2);
        assert!(outcome.infinite.is_empty());
        assert_eq!(outcome.units.get("tire_force").map(String::as_str), Some("N"));
    }

    #[test]
    fn the_area_under_a_spectrum_is_the_variance() {
        let (outcome, _) = ride(&spec("turkay-quarter-car", "iso8608-c")).unwrap();
        let f = &outcome.spectra.freq_hz;
        // 0.063 to 17.77 rad/m at 20 m/s is 0.2 to 56 Hz, cut at 50
        assert!((f[0] - 1.26 / std::f64::consts::TAU).abs() < 1e-9 && (f[199] - 50.0).abs() < 1e-9);
        let g = outcome.spectra.psd.get("sprung_acceleration").unwrap();
        let area: f64 = (1..f.len()).map(|i| 0.5 * (g[i] + g[i - 1]) * (f[i] - f[i - 1])).sum();
        let rms = outcome.rms.get("sprung_acceleration").unwrap().finite().unwrap();
        // 200 points and the last 6 Hz
        assert!((area.sqrt() / rms - 1.0).abs() < 0.01, "{} {rms}", area.sqrt());
    }

    #[test]
    fn what_is_infinite_says_why() {
        let (outcome, _) = ride(&spec("chalasani-full-car", "turkay-white-velocity")).unwrap();
        let text = serde_json::to_string(&outcome).unwrap();
        assert_eq!(outcome.rms.get("heave_displacement").unwrap().finite(), None);
        assert!(text.contains("\"heave_displacement\":\"infinite\""), "{text}");
        assert!(outcome.infinite.get("heave_displacement").unwrap().contains("wanders"));
        let back: RideOutcome = serde_json::from_str(&text).unwrap();
        assert_eq!(back.rms, outcome.rms);
    }
}
