//! The second half of `demo`: controllers for what was identified and for the truth, all judged by the true car.

use super::demo_drive::SPEED_M_S;
use super::demo_outcome::{DemoBound, DemoController, DemoMethod, DemoRide};
use super::design::design_on;
use super::design_outcome::{ControllerFile, DesignOutcome};
use super::design_problem::{Norm, Problem};
use super::ground::ground_of;
use super::ride::ride_on;
use super::{DesignSpec, LoadedExcitation, LoadedRoad, LoadedVehicle, Named, RideOutcome, Rms, StudyError};
use crate::files::parse_toml;
use crate::vehicle::Control;
use std::path::Path;

/// One design file a method: its name, a title, its text.
pub(super) const METHODS: [(&str, &str, &str); 2] = [
    ("lmi", "matrix inequalities", include_str!("../../assets/demo/lmi.toml")),
    ("fixed-order", "one state at each wheel", include_str!("../../assets/demo/fixed-order.toml")),
];
/// What both minimise: the stacked accelerations of the body's four corners.
pub(super) const MINIMIZED: &str = "body_acceleration";
/// Whose spectra are shown.
const SHOWN: [&str; 3] =
    ["body_acceleration_front_left", "suspension_travel_front_left", "tire_deflection_front_left"];

/// A car on its road and the road's filter, all at hand.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub vehicle: LoadedVehicle,
    pub filter: LoadedRoad,
}

/// The true car on the true road.
pub(super) struct Judge<'a> {
    pub place: &'a Place,
    pub road: &'a LoadedRoad,
}

/// The design of a method's file at a place; `whole` with all warnings that `design` has.
pub(super) fn design_at(text: &str, place: &Place, whole: bool) -> Result<DesignOutcome, StudyError> {
    let spec: DesignSpec = parse_toml(text, Path::new("design"))?;
    let spec = DesignSpec { vehicle: place.vehicle.name.clone(), road: place.filter.name.clone(), ..spec };
    spec.check()?;
    let road = LoadedExcitation::Road(Box::new(place.filter.clone()));
    Ok(design_on(&spec, place.vehicle.clone(), road, whole)?.0)
}

/// What a design bounds, and what its own car has of it: the norm of its plant, and the rms with exact delays.
fn bounds(outcome: &DesignOutcome) -> Vec<DemoBound> {
    let Some(verified) = &outcome.verified else { return Vec::new() };
    let share = |closed: &Named<Rms>, passive: &Named<Rms>, name: &str| {
        let of = |all: &Named<Rms>| all.get(name).and_then(|r| r.finite());
        of(closed).zip(of(passive)).filter(|(_, p)| *p > 0.0).map(|(c, p)| c / p)
    };
    let one = |(name, bound): (&str, &f64)| DemoBound {
        name: name.to_owned(),
        bound: *bound,
        kept: share(&verified.h2, &outcome.passive.h2, name),
        with_exact_delay: share(&verified.rms, &outcome.passive.rms, name),
    };
    outcome.design.goal.bound_h2.iter().map(one).collect()
}

impl Judge<'_> {
    /// A ride on the true road, with a controller or without.
    pub fn ride(&self, controller: Option<&ControllerFile>) -> Result<RideOutcome, StudyError> {
        let car = &self.place.vehicle;
        let road = LoadedExcitation::Road(Box::new(self.road.clone()));
        let (ground, vehicle, _) = ground_of(car, road, SPEED_M_S)?;
        let control = controller.map(|k| control(car, &vehicle, k)).transpose()?;
        ride_on(&car.name, &vehicle, &ground, SPEED_M_S, control.as_ref(), None)
    }

    /// The same with largest gains, as an outcome keeps it.
    pub fn shown(
        &self,
        controller: Option<&ControllerFile>,
        ride: &RideOutcome,
    ) -> Result<DemoRide, StudyError> {
        let spec: DesignSpec = parse_toml(METHODS[0].2, Path::new("design"))?;
        let car = &self.place.vehicle;
        let spec = DesignSpec { vehicle: car.name.clone(), road: self.place.filter.name.clone(), ..spec };
        // the first method's outputs, and the measurements of this controller
        let spec = match controller {
            Some(k) => DesignSpec { measurements: k.inputs.clone(), ..spec },
            None => spec,
        };
        let road = LoadedExcitation::Road(Box::new(self.place.filter.clone()));
        let problem = Problem::on(&spec, Norm::H2, car.clone(), road)?;
        let k = controller
            .map(ControllerFile::state_space)
            .transpose()
            .map_err(|e| StudyError::Design { name: car.name.clone(), source: Box::new(e.into()) })?;
        let hinf = problem.measure(k.as_ref())?.hinf;
        let psd = ride.spectra.psd.iter().filter(|(name, _)| SHOWN.contains(name));
        let psd = psd.map(|(name, v)| (name.to_owned(), v.clone())).collect();
        Ok(DemoRide { rms: ride.rms.clone(), hinf, psd })
    }

    /// What a design's controller does in the true car.
    pub fn judged(&self, outcome: &DesignOutcome) -> Result<DemoController, StudyError> {
        let rms = |of: &Named<Rms>| of.get(MINIMIZED).and_then(|r| r.finite());
        let expected = outcome.verified.as_ref().and_then(|v| rms(&v.rms)).zip(rms(&outcome.passive.rms));
        // what an actuator would make of it is a note of a design, as it has none of its own
        let of_actuator = outcome.notes.iter().filter(|n| n.name == "actuator");
        let mut judged = DemoController {
            status: outcome.status,
            why: outcome.why.clone(),
            warnings: outcome.warnings.iter().chain(of_actuator).cloned().collect(),
            bounds: bounds(outcome),
            delay_order: outcome.design.delay_order,
            order: outcome.order,
            expected: expected.map(|(with, without)| with / without),
            ride: None,
        };
        let Some(k) = &outcome.controller else { return Ok(judged) };
        match self.ride(Some(k)) {
            Ok(ride) => judged.ride = Some(self.shown(Some(k), &ride)?),
            // a loop that the true car does not hold is the answer, not a fault
            Err(StudyError::Ride { source, .. }) => judged.why = Some(source.to_string()),
            Err(e) => return Err(e),
        }
        Ok(judged)
    }
}

fn control(
    car: &LoadedVehicle,
    vehicle: &crate::vehicle::Vehicle,
    k: &ControllerFile,
) -> Result<Control, StudyError> {
    let fail = |source| StudyError::Controller { name: car.name.clone(), source: Box::new(source) };
    let system = k.state_space().map_err(|e| fail(e.into()))?;
    Control::new(vehicle, system, &k.inputs, &k.outputs).map_err(fail)
}

/// The pair of a method.
pub(super) fn pair(
    (name, title, text): (&str, &str, &str),
    on_identified: DemoController,
    on_true: DemoController,
) -> Result<DemoMethod, StudyError> {
    let spec: DesignSpec = parse_toml(text, Path::new(name))?;
    let rides = on_identified.ride.as_ref().zip(on_true.ride.as_ref());
    let difference = rides.map_or_else(Named::default, |(found, truth)| {
        let both = found.rms.iter().filter_map(|(name, r)| {
            let (a, b) = (r.finite()?, truth.rms.get(name)?.finite()?);
            (b > 0.0).then(|| (name.to_owned(), a / b - 1.0))
        });
        both.collect()
    });
    Ok(DemoMethod {
        name: name.to_owned(),
        title: title.to_owned(),
        method: spec.method.name().to_owned(),
        minimized: MINIMIZED.to_owned(),
        on_identified,
        on_true,
        difference,
    })
}
