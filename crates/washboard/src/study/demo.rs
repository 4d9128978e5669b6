//! The job `demo`, from drive to design: a car is driven and identified, controllers are designed for what was found, and the
//! true car judges them beside controllers that were designed with the truth.

use super::demo_designs::{Judge, METHODS, Place, design_at, pair};
use super::demo_drive::{SPEED_M_S, drive, identify};
use super::demo_outcome::{DemoDesigns, DemoOutcome};
use super::demo_road::filter;
use super::{DemoSpec, Files, Input, LoadedRoad, LoadedVehicle, StudyError, load_road, load_vehicle};
use std::time::{Duration, Instant};

const VEHICLE: &str = "case:guiggiani-full-car";
const ROAD: &str = "case:iso8608-c";

/// An outcome, the files to go on with, and how long each part took.
#[derive(Debug, Clone)]
pub struct DemoRun {
    /// What was found.
    pub outcome: DemoOutcome,
    /// vehicle.toml, road.toml, filter.toml, and a design file and a controller a method.
    pub files: Files,
    /// Every case that was read.
    pub inputs: Vec<Input>,
    /// Parts in their order; no part of the outcome, which is the same for the same seed.
    pub times: Vec<(&'static str, Duration)>,
}

/// Twenty minutes of the paper's car on a class C road at 20 m/s, identified from a start off by up to 30 %; the road's filter;
/// controllers by matrix inequalities and of fixed order, on the identified car and on the true one, all in the true car.
///
/// # Errors
/// None that a user's input could cause.
pub fn demo(spec: &DemoSpec) -> Result<DemoRun, StudyError> {
    let (car, road) = (load_vehicle(VEHICLE)?, load_road(ROAD)?);
    let mut clock = Clock { last: Instant::now(), times: Vec::new() };
    let recording = drive(&car, &road, spec)?;
    clock.lap("drive");
    let (identified, mut files) = identify(&recording, &car, &road, spec)?;
    clock.lap("identification");
    let inputs = car.inputs.iter().chain(&road.inputs).cloned().collect();
    let designs = match found(&files, identified.converged)? {
        Some((vehicle, found_road)) => {
            let band = found_road.spec.band_rad_per_m.unwrap_or(road.road.spectrum().band_rad_s(1.0));
            Some(designs(Cars { car, road, vehicle, found_road, band }, &mut files, &mut clock)?)
        }
        None => None,
    };
    Ok(DemoRun { outcome: DemoOutcome { identified, designs }, files, inputs, times: clock.times })
}

struct Clock {
    last: Instant,
    times: Vec<(&'static str, Duration)>,
}

impl Clock {
    fn lap(&mut self, name: &'static str) {
        let now = Instant::now();
        self.times.push((name, now - self.last));
        self.last = now;
    }
}

/// The car and road of an identification that converged, as its files say.
fn found(files: &Files, converged: bool) -> Result<Option<(LoadedVehicle, LoadedRoad)>, StudyError> {
    let text = |name: &str| {
        let file = files.iter().find(|(n, _)| n == name).filter(|_| converged);
        file.map(|(_, bytes)| String::from_utf8_lossy(bytes).into_owned())
    };
    let (Some(vehicle), Some(road)) = (text("vehicle.toml"), text("road.toml")) else { return Ok(None) };
    let vehicle = LoadedVehicle::of_text("vehicle.toml", &vehicle)?;
    Ok(Some((vehicle, LoadedRoad::of_text("road.toml", &road)?)))
}

/// The true ones and those that were found.
struct Cars {
    car: LoadedVehicle,
    road: LoadedRoad,
    vehicle: LoadedVehicle,
    found_road: LoadedRoad,
    band: [f64; 2],
}

fn designs(cars: Cars, files: &mut Files, clock: &mut Clock) -> Result<DemoDesigns, StudyError> {
    let Cars { car, road, vehicle, found_road, band } = cars;
    let (own, text) = filter(&found_road, "filter.toml", band)?;
    files.push(("filter.toml".to_owned(), text.clone().into_bytes()));
    let identified = Place { vehicle, filter: LoadedRoad::of_text("filter.toml", &text)? };
    let (true_filter, text) = filter(&road, "the true road's filter", band)?;
    let truth = Place { vehicle: car, filter: LoadedRoad::of_text("the true road's filter", &text)? };
    clock.lap("road filters");
    let judge = Judge { place: &truth, road: &road };
    let ride = judge.ride(None)?;
    let mut methods = Vec::new();
    for (method, lap) in METHODS.into_iter().zip(["LMI designs", "fixed-order designs"]) {
        let (name, _, text) = method;
        // one a core: neither depends on the other
        let (on_identified, on_true) =
            rayon::join(|| design_at(text, &identified, true), || design_at(text, &truth, false));
        let (on_identified, on_true) = (on_identified?, on_true?);
        clock.lap(lap);
        files.push((format!("{name}.toml"), text.as_bytes().to_vec()));
        if let Some(k) = &on_identified.controller {
            let json = serde_json::to_string_pretty(k).unwrap_or_default() + "\n";
            files.push((format!("{name}-controller.json"), json.into_bytes()));
        }
        let (found, known) = rayon::join(|| judge.judged(&on_identified), || judge.judged(&on_true));
        methods.push(pair(method, found?, known?)?);
        clock.lap("rides of the true car");
    }
    Ok(DemoDesigns {
        speed_m_s: SPEED_M_S,
        filter: own,
        true_filter,
        passive: judge.shown(None, &ride)?,
        methods,
        units: ride.units,
        freq_hz: ride.spectra.freq_hz,
    })
}
