//! What a vehicle stands on: a road of tracks under its wheels, or a filter of all its road inputs, matched to them by name.

use super::identify_outcome::Flag;
use super::load::{LoadedExcitation, LoadedVehicle, load_excitation};
use super::{Input, StudyError};
use crate::road::{Excitation, MatrixFilter, Road};
use crate::vehicle::{Model, Vehicle, VehicleError, VehicleSpec};

/// A road that fits its vehicle.
#[derive(Debug, Clone)]
pub(super) struct Ground {
    standing: Standing,
    /// Band of the data that a filter was fitted to, at the speed driven.
    pub fitted_band_rad_s: Option<[f64; 2]>,
    /// Whether a truck cabin is driven at its chassis points, without its chassis.
    pub at_points: bool,
    /// How it is to be read.
    pub notes: Vec<Flag>,
}

#[derive(Debug, Clone)]
enum Standing {
    Road(Road),
    Points(MatrixFilter),
}

impl Ground {
    /// As rides and plants take it.
    pub fn excitation(&self) -> Excitation<'_> {
        match &self.standing {
            Standing::Road(road) => road.into(),
            Standing::Points(filter) => filter.into(),
        }
    }

    /// A vehicle of a file on this ground.
    pub fn vehicle(
        &self,
        spec: &VehicleSpec,
        chassis: Option<&VehicleSpec>,
    ) -> Result<Vehicle, VehicleError> {
        if let (true, Some(cabin)) = (self.at_points, &spec.truck_cabin) {
            return cabin.at_points().map_err(|e| match e {
                VehicleError::Field { field, expected, found } => {
                    VehicleError::Field { field: format!("truck-cabin.{field}"), expected, found }
                }
                other => other,
            });
        }
        spec.build(|wanted| {
            chassis.cloned().ok_or_else(|| VehicleError::Field {
                field: "chassis".into(),
                expected: "a vehicle file or case",
                found: wanted.to_owned(),
            })
        })
    }
}

/// The road of a name under a vehicle, the vehicle as it stands there, and the road's files.
pub(super) fn ground(
    loaded: &LoadedVehicle,
    road: &str,
    speed_m_s: f64,
) -> Result<(Ground, Vehicle, Vec<Input>), StudyError> {
    ground_of(loaded, load_excitation(road)?, speed_m_s)
}

/// The same of a road that is at hand.
pub(super) fn ground_of(
    loaded: &LoadedVehicle,
    road: LoadedExcitation,
    speed_m_s: f64,
) -> Result<(Ground, Vehicle, Vec<Input>), StudyError> {
    let filter = match road {
        LoadedExcitation::Points(filter) => filter,
        LoadedExcitation::Road(road) => {
            let over_time = road.road.spectrum().is_over_time();
            let scale = if over_time { 1.0 } else { speed_m_s };
            let fitted_band_rad_s = road.spec.fitted_band_rad.map(|b| b.map(|w| w * scale));
            let filter = matches!(road.road.spectrum(), crate::road::Spectrum::Filter(_));
            let notes = own_speed(&road.name, filter && over_time, "only the delays between axles follow it");
            let standing = Standing::Road(road.road);
            let ground = Ground { standing, fitted_band_rad_s, at_points: false, notes };
            return Ok((ground, loaded.vehicle.clone(), road.inputs));
        }
    };
    let fail = |source| StudyError::Road { name: filter.name.clone(), source };
    let own: Vec<String> = loaded.vehicle.wheels().iter().map(|w| w.name.clone()).collect();
    let named = filter.filter.points();
    // a cabin's chassis points, unless the names say wheels
    let at_points = loaded.spec.model == Model::TruckCabin && !named.iter().any(|p| own.contains(p));
    let mut ground = Ground {
        standing: Standing::Points(filter.filter.clone()),
        fitted_band_rad_s: None,
        at_points,
        notes: own_speed(
            &filter.name,
            !filter.filter.is_over_distance(),
            "nothing in this result follows it",
        ),
    };
    let vehicle = ground
        .vehicle(&loaded.spec, loaded.chassis.as_ref())
        .map_err(|source| StudyError::Vehicle { name: loaded.name.clone(), source })?;
    let inputs: Vec<String> = vehicle.wheels().iter().map(|w| w.name.clone()).collect();
    let ordered = filter.filter.in_order(&inputs).map_err(fail)?;
    ground.fitted_band_rad_s = ordered.over_time(speed_m_s).map_err(fail)?.band_rad();
    ground.standing = Standing::Points(ordered);
    let list = inputs.join(", ");
    let mut note = |name: &str, text: String| ground.notes.push(Flag { name: name.to_owned(), text });
    if at_points {
        let text = format!(
            "{} moves the cabin's chassis points: the chassis of {} is not used",
            filter.name, loaded.name
        );
        note("chassis-points", text);
    }
    if named.is_empty() {
        note(
            "points-in-order",
            format!("the points of {} have no names: they are taken as {list}", filter.name),
        );
    }
    Ok((ground, vehicle, filter.inputs))
}

/// A filter over time is of one speed.
fn own_speed(name: &str, over_time: bool, rest: &str) -> Vec<Flag> {
    let text = || {
        format!(
            "{name} is over time, of the speed at which its data was taken: speed_m_s does not change it, {rest}"
        )
    };
    over_time.then(|| Flag { name: "own-speed".into(), text: text() }).into_iter().collect()
}
