//! What a physical fit says beside its numbers (what was held, what was decided), and the files to go on with.

use super::fit_generic::Sides;
use super::identify::Files;
use super::identify_outcome::{Flag, HeldParameter, IdentifyOutcome};
use super::identify_physical::Fitted;
use crate::road::{CoherenceSpec, RoadSpec};
use crate::vehicle::{SPRUNG_MASS, VehicleSpec, of_scale};

/// What was given, and the sprung mass where nothing else sets the scale.
pub(super) fn held(vehicle: &VehicleSpec, known: &[(String, f64)]) -> Vec<HeldParameter> {
    let mut held: Vec<HeldParameter> =
        known.iter().map(|(name, value)| HeldParameter { name: name.clone(), value: *value }).collect();
    if !known.iter().any(|(name, _)| of_scale(name)) {
        let file = serde_json::to_value(vehicle).unwrap_or_default();
        if let Some(value) = file[vehicle.model.name()][SPRUNG_MASS].as_f64() {
            held.push(HeldParameter { name: SPRUNG_MASS.to_owned(), value });
        }
    }
    held
}

/// What holds for every such fit, and what was decided in this one.
pub(super) fn notes(fitted: &Fitted<'_>, from_file: bool, known: &[(String, f64)]) -> Vec<Flag> {
    let mut notes = Vec::new();
    let mut note = |name: &str, text: String| notes.push(Flag { name: name.to_owned(), text });
    let scale = "responses do not show the common scale of masses, stiffnesses and dampers";
    let rest = "modes, road and delay do not depend on it";
    if !known.is_empty() {
        let held: Vec<String> = known.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        note("scale-known", format!("{scale}: it comes from {}, held as given; {rest}", held.join(", ")));
    } else if from_file {
        note(
            "scale-held",
            format!(
                "{scale}: the sprung mass is the vehicle file's, and the others are relative to it; {rest}"
            ),
        );
    } else {
        note(
            "scale-unidentifiable",
            format!(
                "{scale}: the sprung mass stands at 1000 kg, and the others are relative to it, until one is given (--known sprung_mass_kg=1150); {rest}"
            ),
        );
    }
    if let Some((_, Some(sides))) = &fitted.generic {
        let Sides { gain, needed, differ } = sides;
        let text = if *gain < 0.0 {
            "left and right are taken as alike: the search with sides that differ found nothing as good"
                .to_owned()
        } else if *differ {
            format!(
                "left and right differ: the likelihood gains {gain:.0} by it, where chance gives {needed:.0} at most"
            )
        } else {
            format!(
                "left and right are taken as alike: the likelihood would gain {gain:.0} by a difference, where chance gives up to {needed:.0}"
            )
        };
        note(if *differ { "asymmetric" } else { "symmetric" }, text);
    }
    if fitted.drives.len() > 1 {
        let text = format!(
            "one vehicle for all {} recordings, a road for each (runs): the road above is the first recording's",
            fitted.drives.len()
        );
        note("shared-vehicle", text);
    }
    notes
}

/// vehicle.toml and road.toml to go on with.
pub(super) fn files(vehicle: &VehicleSpec, outcome: &IdentifyOutcome) -> Files {
    let mut files = Vec::new();
    if let Ok(text) = toml::to_string(vehicle) {
        let text = format!("# identified from {}\n{text}", outcome.recording.name);
        files.push(("vehicle.toml".to_owned(), text.into_bytes()));
    }
    files.extend(road_file(outcome));
    files
}

/// road.toml.
pub(super) fn road_file(outcome: &IdentifyOutcome) -> Option<(String, Vec<u8>)> {
    let road = outcome.road.as_ref()?;
    let spec = RoadSpec {
        roughness_m3: Some(road.roughness_m3),
        exponent: Some(road.exponent),
        band_rad_per_m: Some(road.band_rad_per_m),
        convention: Some(road.convention),
        coherence: outcome.coherence.as_ref().map(|c| CoherenceSpec::bogsjo(c.mu)),
        ..RoadSpec::default()
    };
    let text = toml::to_string(&spec).ok()?;
    let text = format!("# identified from {}\n{text}", outcome.recording.name);
    Some(("road.toml".to_owned(), text.into_bytes()))
}
