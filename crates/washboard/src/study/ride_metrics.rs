//! What engineers ask of a ride: weighted accelerations, tire loads, bottoming, the work of actuators.

use super::{Flag, Named, ResponseGroup, StudyError};
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::metrics::{ActuatorPower, MetricsError, Weighting, exceedance, reactions};
use crate::units::plain;
use crate::vehicle::{Output, Ride, RideError, Variance, Vehicle};
use serde::{Deserialize, Serialize};

/// Seconds of an hour.
const HOUR_S: f64 = 3600.0;
/// Metres of a kilometre.
const KM_M: f64 = 1000.0;
/// Peaks are told as so many standard deviations of a Gaussian signal: 0.27 % of the time is beyond.
pub const PEAK_SIGMAS: f64 = 3.0;

/// A stroke above this, m, is likely one in millimetres.
const LONG_STROKE_M: f64 = 2.0;
/// Where a seat may be, and its vertical acceleration.
const SEATS: [(&str, &str); 2] =
    [("driver", "driver_heave_acceleration"), ("centre_of_gravity", "heave_acceleration")];
/// k of a seat's rotations, m/rad: ISO 2631-1, 8.2.2.1.
const SEAT_TURNS: [(&str, f64); 2] = [("pitch_acceleration", 0.4), ("roll_acceleration", 0.63)];

/// Metrics of a vehicle on a road at a speed, passive or with a controller. What is infinite on this road is in `infinite` alone.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RideMetrics {
    /// Frequency-weighted accelerations of the body, by output.
    pub weighted: Named<WeightedAcceleration>,
    /// The seat's of several axes together; none of a vehicle that does not turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vibration_total: Option<VibrationTotal>,
    /// Dynamic tire forces over static ones, by output; empty of a vehicle whose weight is not known.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub tire_load: Named<TireLoad>,
    /// Travels and their stroke, by output.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub travel: Named<TravelUse>,
    /// Forces and powers, by actuator; empty without a controller.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub actuator: Named<ActuatorUse>,
    /// Over a bump.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bump: Option<super::BumpMetrics>,
    /// Outputs whose metrics are infinite on this road, and why.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub infinite: Named<String>,
}

/// A weighted rms of ISO 2631-1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WeightedAcceleration {
    /// `W_k` of vertical, `W_e` of rotational accelerations.
    pub weighting: String,
    /// m/s² or rad/s².
    pub rms: f64,
    /// Its unit.
    pub unit: String,
    /// Annex C's words for a vertical one at the driver, the centre of gravity or the one mass that there is (informative): where two hold, both.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reactions: Vec<String>,
}

/// The vibration total value a_v = √(Σ k²a_w²) of a seat, by those axes that a vehicle has: z and rotations, without x, y, seat-back and feet.
///
/// Source: ISO 2631-1:1997, eq. (10), with the factors k of 8.2.2.1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VibrationTotal {
    /// a_v, m/s².
    pub rms: f64,
    /// Where the seat is: `driver` or `centre_of_gravity`.
    pub at: String,
    /// Accelerations that it is made of.
    pub of: Vec<String>,
}

/// A tire's dynamic load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TireLoad {
    /// Under the vehicle's weight, N.
    pub static_n: f64,
    /// rms of the dynamic force, N.
    pub rms_n: f64,
    /// rms over static.
    pub coefficient: f64,
}

/// A suspension's travel, about where it rests.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TravelUse {
    /// rms, m.
    pub rms_m: f64,
    /// Three standard deviations: the stroke to either side that is left 0.27 % of the time.
    pub three_sigma_m: f64,
    /// The share of time beyond the stroke given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_stroke: Option<f64>,
    /// Expected times that the stroke is reached in an hour …
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bottoming_per_hour: Option<f64>,
    /// … and in a kilometre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bottoming_per_km: Option<f64>,
}

/// An actuator's force and power; what it gives the vehicle is positive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ActuatorUse {
    /// rms, N.
    pub force_rms_n: f64,
    /// Three standard deviations.
    pub force_three_sigma_n: f64,
    /// rms of the velocity between its ends, m/s.
    pub velocity_rms_m_s: f64,
    /// Mean power given less taken, W.
    pub net_w: f64,
    /// Mean of the power's magnitude.
    pub absolute_w: f64,
    /// Mean of what is given, where nothing taken comes back.
    pub given_w: f64,
}

/// Why metrics could not be computed.
#[derive(Debug, thiserror::Error)]
pub(super) enum RideMetricsError {
    #[error(transparent)]
    Ride(#[from] RideError),
    #[error(transparent)]
    Metrics(#[from] MetricsError),
    #[error(transparent)]
    Lti(#[from] LtiError),
}

/// What a ride is judged with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Judged<'a> {
    pub vehicle: &'a Vehicle,
    pub speed_m_s: f64,
    /// To either side of where the suspension rests.
    pub stroke_m: Option<f64>,
    /// Whether actuators work.
    pub controlled: bool,
}

/// Refuses a stroke that none has.
pub(super) fn check_stroke(field: &'static str, stroke_m: Option<f64>) -> Result<(), StudyError> {
    match stroke_m.filter(|s| !(1e-6..=100.0).contains(s)) {
        None => Ok(()),
        Some(s) => Err(StudyError::Setting {
            field,
            expected: "a stroke to either side of where the suspension rests, 1e-6 to 100 m".into(),
            found: plain(s),
        }),
    }
}

/// A note of a stroke that no suspension has.
pub(super) fn long_stroke(stroke_m: Option<f64>) -> Option<Flag> {
    let stroke = stroke_m.filter(|s| *s > LONG_STROKE_M)?;
    let text =
        format!("a stroke of {stroke} m is asked for, to either side: metres are meant, not millimetres");
    Some(Flag { name: "stroke".into(), text })
}

impl RideMetrics {
    /// Of a ride; the bump is another matter.
    pub(super) fn of(ride: &Ride<'_>, judged: &Judged<'_>) -> Result<Self, RideMetricsError> {
        let mut infinite = Named::default();
        let weighted = weighted(ride, judged.vehicle, &mut infinite)?;
        Ok(RideMetrics {
            vibration_total: vibration_total(&weighted, &infinite),
            weighted,
            tire_load: tire_load(ride, judged.vehicle, &mut infinite)?,
            travel: travel(ride, judged, &mut infinite)?,
            actuator: if judged.controlled { actuators(ride, judged.vehicle)? } else { Named::default() },
            bump: None,
            infinite,
        })
    }
}

/// The rms of an output; why it is infinite goes to the list of those.
fn finite(variance: Variance, output: &Output, infinite: &mut Named<String>) -> Option<f64> {
    if let Variance::Infinite(why) = variance {
        infinite.insert(&output.name, why.to_owned());
    }
    variance.rms()
}

/// W_k of every vertical acceleration of the body, W_e of pitch and roll.
fn weighted(
    ride: &Ride<'_>,
    vehicle: &Vehicle,
    infinite: &mut Named<String>,
) -> Result<Named<WeightedAcceleration>, RideMetricsError> {
    let weighting = |o: &Output| match o.unit {
        _ if ResponseGroup::of(&o.name) != ResponseGroup::Comfort || o.name.starts_with("chassis") => None,
        "m/s²" => Some(Weighting::Wk),
        "rad/s²" => Some(Weighting::We),
        _ => None,
    };
    let own = vehicle.outputs().iter().filter_map(|o| Some((o, weighting(o)?)));
    let (outputs, weightings): (Vec<&Output>, Vec<Weighting>) = own.unzip();
    let filters = weightings.iter().map(|w| w.filter()).collect::<Result<Vec<_>, _>>()?;
    let behind: Vec<&StateSpace<Continuous>> = filters.iter().collect();
    let variances = ride.filtered_variances(&outputs, &behind)?;
    let each = outputs.iter().zip(&weightings).zip(variances);
    let one = |((o, w), v): ((&&Output, &Weighting), Variance)| {
        let rms = finite(v, o, infinite)?;
        // of a wheel's corner there is no seat
        let seat = *w == Weighting::Wk && o.base == o.name;
        let words = if seat { reactions(rms) } else { vec![] };
        let reactions = words.into_iter().map(str::to_owned).collect();
        let found = WeightedAcceleration { weighting: w.name().into(), rms, unit: o.unit.into(), reactions };
        Some((o.name.clone(), found))
    };
    Ok(each.filter_map(one).collect())
}

/// Of the driver's seat where there is one, else of the centre of gravity.
fn vibration_total(
    weighted: &Named<WeightedAcceleration>,
    infinite: &Named<String>,
) -> Option<VibrationTotal> {
    let (at, vertical) = SEATS.into_iter().find(|(_, name)| weighted.get(name).is_some())?;
    let axes = std::iter::once((vertical, 1.0)).chain(SEAT_TURNS);
    if axes.clone().any(|(name, _)| infinite.get(name).is_some()) {
        return None;
    }
    let found: Vec<(&str, f64)> =
        axes.filter_map(|(name, k)| Some((name, k * weighted.get(name)?.rms))).collect();
    let rms = found.iter().map(|(_, v)| v * v).sum::<f64>().sqrt();
    let of: Vec<String> = found.into_iter().map(|(name, _)| name.to_owned()).collect();
    (of.len() > 1).then(|| VibrationTotal { rms, at: at.into(), of })
}

/// Dynamic over static force of every tire that has both.
fn tire_load(
    ride: &Ride<'_>,
    vehicle: &Vehicle,
    infinite: &mut Named<String>,
) -> Result<Named<TireLoad>, RideMetricsError> {
    let forces: Vec<&Output> = vehicle.outputs().iter().filter(|o| o.base == "tire_force").collect();
    // without forces, or a stiffness that holds the vehicle, there is no static load
    let Some(rest) = (!forces.is_empty()).then(|| vehicle.at_rest(&forces).ok()).flatten() else {
        return Ok(Named::default());
    };
    let variances = ride.variances(&forces)?;
    let one = |((o, rest), v): ((&&Output, f64), Variance)| {
        // force on the wheel counts upwards as the deflection that makes it: a load is negative
        let (static_n, rms_n) = (-rest, finite(v, o, infinite)?);
        let load = TireLoad { static_n, rms_n, coefficient: rms_n / static_n };
        (static_n > 0.0).then(|| (o.name.clone(), load))
    };
    Ok(forces.iter().zip(rest).zip(variances).filter_map(one).collect())
}

fn travel(
    ride: &Ride<'_>,
    judged: &Judged<'_>,
    infinite: &mut Named<String>,
) -> Result<Named<TravelUse>, RideMetricsError> {
    let travels = judged
        .vehicle
        .outputs()
        .iter()
        .filter(|o| ResponseGroup::of(&o.name) == ResponseGroup::RattleSpace && o.unit == "m");
    let travels: Vec<(&Output, Output)> = travels.filter_map(|o| Some((o, o.rate()?))).collect();
    // rates are for how often a stroke is reached
    let rates = travels.iter().map(|(_, rate)| rate).filter(|_| judged.stroke_m.is_some());
    let both: Vec<&Output> = travels.iter().map(|(o, _)| *o).chain(rates).collect();
    let variances = ride.variances(&both)?;
    let mut found = Named::default();
    for (i, (output, _)) in travels.iter().enumerate() {
        let Some(rms_m) = finite(variances[i], output, infinite) else { continue };
        let mut used = TravelUse {
            rms_m,
            three_sigma_m: PEAK_SIGMAS * rms_m,
            beyond_stroke: None,
            bottoming_per_hour: None,
            bottoming_per_km: None,
        };
        if let Some(stroke) = judged.stroke_m {
            let rate = variances[i + travels.len()].rms();
            let at = exceedance(rms_m, rate.unwrap_or(0.0), stroke)?;
            used.beyond_stroke = Some(at.probability);
            // a travel whose rate is infinite crosses any level infinitely often
            let per_s = rate.map(|_| at.per_s);
            used.bottoming_per_hour = per_s.map(|v| v * HOUR_S);
            used.bottoming_per_km = per_s.map(|v| v * KM_M / judged.speed_m_s);
        }
        found.insert(&output.name, used);
    }
    Ok(found)
}

fn actuators(ride: &Ride<'_>, vehicle: &Vehicle) -> Result<Named<ActuatorUse>, RideMetricsError> {
    let mut found = Named::default();
    for (i, actuator) in vehicle.actuators().iter().enumerate() {
        let Some([force, velocity]) = vehicle.port(i) else { continue };
        let c = ride.covariance(&[&force, &velocity], 0.0)?;
        if !(c[(0, 0)].is_finite() && c[(1, 1)].is_finite()) {
            continue;
        }
        let [force_rms_n, velocity_rms_m_s] = [0, 1].map(|k| c[(k, k)].max(0.0).sqrt());
        let power = ActuatorPower::gaussian(force_rms_n, velocity_rms_m_s, c[(0, 1)])?;
        let used = ActuatorUse {
            force_rms_n,
            force_three_sigma_n: PEAK_SIGMAS * force_rms_n,
            velocity_rms_m_s,
            net_w: power.net_w,
            absolute_w: power.absolute_w,
            given_w: power.given_w,
        };
        found.insert(&actuator.name, used);
    }
    Ok(found)
}

#[cfg(test)]
mod tests;
