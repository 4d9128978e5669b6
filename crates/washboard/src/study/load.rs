//! A name on the command line becomes a vehicle or a road: a TOML file, or `case:NAME`.

use super::{Input, StudyError};
use crate::cases::{self, CaseKind};
use crate::files::{FileError, parse_toml, read_text};
use crate::road::{MatrixFilter, MatrixFilterSpec, Road, RoadError, RoadSpec};
use crate::vehicle::{Vehicle, VehicleError, VehicleSpec};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// A vehicle with what it was made from.
#[derive(Debug, Clone)]
pub struct LoadedVehicle {
    /// As it was named.
    pub name: String,
    /// As it is written.
    pub spec: VehicleSpec,
    /// A truck cabin's chassis as it is written.
    pub chassis: Option<VehicleSpec>,
    /// Ready to ride.
    pub vehicle: Vehicle,
    /// Every file that was read.
    pub inputs: Vec<Input>,
}

/// A road with what it was made from.
#[derive(Debug, Clone)]
pub struct LoadedRoad {
    /// As it was named.
    pub name: String,
    /// As it is written.
    pub spec: RoadSpec,
    /// Ready to be driven on.
    pub road: Road,
    /// Every file that was read.
    pub inputs: Vec<Input>,
}

/// A filter of all road inputs of a vehicle, with what it was made from.
#[derive(Debug, Clone)]
pub struct LoadedFilter {
    /// As it was named.
    pub name: String,
    /// As it is written.
    pub spec: MatrixFilterSpec,
    /// Ready to drive a vehicle.
    pub filter: MatrixFilter,
    /// Every file that was read.
    pub inputs: Vec<Input>,
}

/// What a ROAD may be where a vehicle stands on it.
#[derive(Debug, Clone)]
pub enum LoadedExcitation {
    /// Tracks under its wheels.
    Road(Box<LoadedRoad>),
    /// All its road inputs at once.
    Points(Box<LoadedFilter>),
}

/// The vehicle of a name; a cabin's `chassis` is a case, or a file relative to the one that names it.
///
/// # Errors
/// A file or case that does not exist, an unknown key, a value that is impossible: each with the file's name.
pub fn load_vehicle(name: &str) -> Result<LoadedVehicle, StudyError> {
    let (spec, input) = read::<VehicleSpec>(name, CaseKind::Vehicle)?;
    let mut inputs = vec![input];
    let mut chassis = None;
    let below = match &spec.truck_cabin {
        Some(cabin) => {
            let (below, input) = read::<VehicleSpec>(&beside(name, &cabin.chassis), CaseKind::Vehicle)?;
            inputs.push(input);
            Some(below)
        }
        None => None,
    };
    let vehicle = spec
        .build(|wanted| {
            chassis.clone_from(&below);
            below.ok_or_else(|| VehicleError::Field {
                field: "chassis".into(),
                expected: "a vehicle file or case",
                found: wanted.to_owned(),
            })
        })
        .map_err(|source| StudyError::Vehicle { name: name.to_owned(), source })?;
    Ok(LoadedVehicle { name: name.to_owned(), spec, chassis, vehicle, inputs })
}

impl LoadedVehicle {
    /// A vehicle of text that is at hand under the name that a file of it would have; a truck cabin needs its files.
    ///
    /// # Errors
    /// An unknown key, a value that is impossible.
    pub(super) fn of_text(name: &str, text: &str) -> Result<Self, StudyError> {
        let spec: VehicleSpec = parse_toml(text, Path::new(name))?;
        let alone = |wanted: &str| {
            let (field, expected) = ("chassis".to_owned(), "a vehicle without another file");
            Err(VehicleError::Field { field, expected, found: wanted.to_owned() })
        };
        let vehicle =
            spec.build(alone).map_err(|source| StudyError::Vehicle { name: name.to_owned(), source })?;
        let inputs = vec![Input::of(name, text.as_bytes())];
        Ok(LoadedVehicle { name: name.to_owned(), spec, chassis: None, vehicle, inputs })
    }
}

impl LoadedRoad {
    /// A road of text that is at hand under the name that a file of it would have; a table needs its file.
    ///
    /// # Errors
    /// An unknown key, a value that is impossible.
    pub(super) fn of_text(name: &str, text: &str) -> Result<Self, StudyError> {
        let spec = RoadSpec::parse(text, Path::new(name))?;
        let road = spec.build().map_err(|source| StudyError::Road { name: name.to_owned(), source })?;
        Ok(LoadedRoad { name: name.to_owned(), spec, road, inputs: vec![Input::of(name, text.as_bytes())] })
    }
}

/// The road of a name; a table's `data` is relative to the file that names it.
///
/// # Errors
/// As [`load_vehicle`].
pub fn load_road(name: &str) -> Result<LoadedRoad, StudyError> {
    match load_excitation(name)? {
        LoadedExcitation::Road(road) => Ok(*road),
        LoadedExcitation::Points(filter) => {
            let expected = "a road of tracks (a matrix-filter is for ride and design)";
            let found = format!("a matrix-filter of {} points", filter.filter.size());
            let source = RoadError::Field { field: "kind", expected, found };
            Err(StudyError::Road { name: name.to_owned(), source })
        }
    }
}

/// The road of a name, or the filter of all road inputs that its file holds.
///
/// # Errors
/// As [`load_vehicle`].
pub fn load_excitation(name: &str) -> Result<LoadedExcitation, StudyError> {
    let path = Path::new(name);
    let (text, input) = text(name, CaseKind::Road)?;
    let mut inputs = vec![input];
    if MatrixFilterSpec::is_meant(&text) {
        let (spec, filter) = MatrixFilterSpec::parse(&text, path)?;
        let loaded = LoadedFilter { name: name.to_owned(), spec, filter, inputs };
        return Ok(LoadedExcitation::Points(Box::new(loaded)));
    }
    let mut spec = RoadSpec::parse(&text, path)?;
    if let Some(data) = &mut spec.data {
        *data = PathBuf::from(beside(name, &data.to_string_lossy()));
        inputs.push(Input::of_file(data)?);
    }
    let road = spec.build_in(path)?;
    Ok(LoadedExcitation::Road(Box::new(LoadedRoad { name: name.to_owned(), spec, road, inputs })))
}

fn read<T: DeserializeOwned>(name: &str, kind: CaseKind) -> Result<(T, Input), StudyError> {
    let (text, input) = text(name, kind)?;
    Ok((parse_toml(&text, Path::new(name))?, input))
}

fn text(name: &str, kind: CaseKind) -> Result<(String, Input), StudyError> {
    let text = match name.strip_prefix("case:") {
        Some(case) => cases::find(case, kind)?.toml,
        None => read_text(Path::new(name)).map_err(|e| did_you_mean_a_case(e, name, kind))?,
    };
    let input = Input::of(name, text.as_bytes());
    Ok((text, input))
}

/// A file that does not exist, but whose name a case has.
fn did_you_mean_a_case(error: FileError, name: &str, kind: CaseKind) -> FileError {
    match (&error, cases::find(name, kind)) {
        (FileError::Read { .. }, Ok(case)) => {
            let message = format!("no such file (did you mean `case:{}`?)", case.name);
            FileError::content(Path::new(name), None, message)
        }
        _ => error,
    }
}

/// A name inside a file: of a case, or of a file relative to it.
fn beside(file: &str, name: &str) -> String {
    match Path::new(file).parent() {
        Some(dir) if !name.starts_with("case:") && !file.starts_with("case:") => {
            dir.join(name).display().to_string()
        }
        _ => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_chassis_and_a_table_are_found_beside_the_file_that_names_them() {
        let dir = std::env::temp_dir().join(format!("washboard-load-{}", std::process::id()));
        fs::create_dir_all(dir.join("sub")).unwrap();
        let cabin = cases::find("turkay-truck-cabin", CaseKind::Vehicle).unwrap().toml;
        fs::write(dir.join("cabin.toml"), cabin.replace("case:turkay-bounce-truck", "sub/below.toml"))
            .unwrap();
        let below = cases::find("turkay-bounce-truck", CaseKind::Vehicle).unwrap().toml;
        fs::write(dir.join("sub/below.toml"), below).unwrap();
        let loaded = load_vehicle(&dir.join("cabin.toml").display().to_string()).unwrap();
        assert_eq!(loaded.vehicle.dofs().len(), 15);
        assert_eq!(loaded.inputs.len(), 2);
        assert!(loaded.chassis.is_some());

        fs::write(dir.join("road.toml"), "kind = \"table\"\ndata = \"sub/psd.csv\"\n").unwrap();
        fs::write(dir.join("sub/psd.csv"), "nu_rad_per_m,psd\n0.1,1e-3\n1,1e-5\n10,1e-7\n").unwrap();
        let road = load_road(&dir.join("road.toml").display().to_string()).unwrap();
        assert_eq!(road.inputs.len(), 2);
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn a_case_without_its_prefix_is_answered_with_it() {
        let e = load_vehicle("turkay-half-car").unwrap_err().to_string();
        assert_eq!(e, "turkay-half-car: no such file (did you mean `case:turkay-half-car`?)");
        let e = load_road("case:iso8608-k").unwrap_err().to_string();
        assert!(e.contains("did you mean `case:iso8608-"), "{e}");
    }

    #[test]
    fn errors_name_file_and_field() {
        let path = std::env::temp_dir().join(format!("washboard-car-{}.toml", std::process::id()));
        let car = cases::find("turkay-quarter-car", CaseKind::Vehicle).unwrap().toml;
        fs::write(&path, car.replace("= 36.0", "= -36.0")).unwrap();
        let name = path.display().to_string();
        let e = load_vehicle(&name).unwrap_err().to_string();
        let expected = "quarter-car.unsprung_mass_kg: expected a positive number, found -36";
        assert_eq!(e, format!("{name}: {expected}"));
        fs::remove_file(&path).unwrap();
    }
}
