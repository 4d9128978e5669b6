//! Published vehicles and roads, each with its citation, as the files that a user would write.

use crate::files::{FileError, nearest, parse_toml};
use crate::road::{IsoClass, Road, RoadSpec};
use crate::vehicle::{Vehicle, VehicleError, VehicleSpec};
use std::path::Path;
use thiserror::Error;

/// What a case is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaseKind {
    /// A vehicle file.
    Vehicle,
    /// A road file.
    Road,
}

impl CaseKind {
    /// As it is listed.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            CaseKind::Vehicle => "vehicle",
            CaseKind::Road => "road",
        }
    }
}

/// A published vehicle or road.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its name, used as `case:NAME`.
    pub name: String,
    /// Vehicle or road.
    pub kind: CaseKind,
    /// The file, citation first.
    pub toml: String,
}

impl Case {
    /// The comment that the file starts with: what it is, and where it is published.
    #[must_use]
    pub fn citation(&self) -> String {
        let lines = self.toml.lines().take_while(|l| l.starts_with('#'));
        lines.map(|l| l.trim_start_matches('#').trim()).collect::<Vec<_>>().join(" ")
    }
}

/// What is refused of a case's name.
#[derive(Debug, Error)]
pub enum CaseError {
    /// No case has this name.
    #[error("case:{name}: no such {what}{}; `washboard cases` lists them", suggestion.as_ref().map(|s| format!(" (did you mean `case:{s}`?)")).unwrap_or_default())]
    Unknown {
        /// The name.
        name: String,
        /// Vehicle or road.
        what: &'static str,
        /// The nearest name.
        suggestion: Option<String>,
    },
    /// A case's file is wrong.
    #[error(transparent)]
    File(#[from] FileError),
    /// A case's vehicle is wrong.
    #[error("case:{name}: {source}")]
    Vehicle {
        /// The name.
        name: String,
        /// Why.
        source: VehicleError,
    },
}

const VEHICLES: [(&str, &str); 7] = [
    ("guiggiani-full-car", include_str!("vehicles/guiggiani-full-car.toml")),
    ("turkay-quarter-car", include_str!("vehicles/turkay-quarter-car.toml")),
    ("turkay-half-car", include_str!("vehicles/turkay-half-car.toml")),
    ("chalasani-full-car", include_str!("vehicles/chalasani-full-car.toml")),
    ("turkay-truck-cabin", include_str!("vehicles/turkay-truck-cabin.toml")),
    ("turkay-bounce-truck", include_str!("vehicles/turkay-bounce-truck.toml")),
    ("mathworks-quarter-car", include_str!("vehicles/mathworks-quarter-car.toml")),
];

const ROADS: [(&str, &str); 4] = [
    ("turkay-white-velocity", include_str!("roads/turkay-white-velocity.toml")),
    ("turkay-white-velocity-rounded", include_str!("roads/turkay-white-velocity-rounded.toml")),
    ("turkay-first-order", include_str!("roads/turkay-first-order.toml")),
    ("turkay-split-power-law", include_str!("roads/turkay-split-power-law.toml")),
];

/// All cases, vehicles first.
#[must_use]
pub fn all() -> Vec<Case> {
    let file = |kind| {
        move |(name, toml): &(&str, &str)| Case { name: (*name).to_owned(), kind, toml: (*toml).to_owned() }
    };
    let iso = IsoClass::ALL.into_iter().map(|class| Case {
        name: format!("iso8608-{}", format!("{class:?}").to_lowercase()),
        kind: CaseKind::Road,
        toml: format!(
            "# Road of class {class:?} of ISO 8608:1995 (geometric mean), wavelengths of 0.35 to 100 m, with Bogsjö's coherence\n\
             # of left and right tracks (Vehicle System Dynamics 46, 2008, 599–609) at μ = 3.8 as De Filippis et al. take it.\n\
             kind = \"iso8608\"\nclass = \"{class:?}\"\nexponent = 2.0\nband_rad_per_m = [0.063, 17.77]\n\n\
             [coherence]\nkind = \"bogsjo\"\nmu = 3.8\n"
        ),
    });
    VEHICLES
        .iter()
        .map(file(CaseKind::Vehicle))
        .chain(ROADS.iter().map(file(CaseKind::Road)))
        .chain(iso)
        .collect()
}

/// A case by name and kind.
///
/// # Errors
/// A name that is none, with the nearest that is.
pub fn find(name: &str, kind: CaseKind) -> Result<Case, CaseError> {
    pick(name, all().into_iter().filter(|c| c.kind == kind).collect(), kind.name())
}

/// A case by name, vehicle or road.
///
/// # Errors
/// A name that is none, with the nearest that is.
pub fn named(name: &str) -> Result<Case, CaseError> {
    pick(name, all(), "vehicle or road")
}

fn pick(name: &str, cases: Vec<Case>, what: &'static str) -> Result<Case, CaseError> {
    let suggestion = nearest(name, cases.iter().map(|c| c.name.as_str())).map(str::to_owned);
    let found = cases.into_iter().find(|c| c.name == name);
    found.ok_or_else(|| CaseError::Unknown { name: name.to_owned(), what, suggestion })
}

/// The file of a published vehicle.
///
/// # Errors
/// A name that is none.
pub fn vehicle_spec(name: &str) -> Result<VehicleSpec, CaseError> {
    let case = find(name, CaseKind::Vehicle)?;
    Ok(parse_toml(&case.toml, Path::new(&format!("case:{name}")))?)
}

/// A published vehicle.
///
/// # Errors
/// A name that is none.
pub fn vehicle(name: &str) -> Result<Vehicle, CaseError> {
    vehicle_spec(name)?
        .build(|chassis| {
            let below = chassis.strip_prefix("case:").unwrap_or(chassis);
            vehicle_spec(below).map_err(|e| VehicleError::Field {
                field: "chassis".into(),
                expected: "a published bounce truck",
                found: e.to_string(),
            })
        })
        .map_err(|source| CaseError::Vehicle { name: name.to_owned(), source })
}

/// The file of a published road.
///
/// # Errors
/// A name that is none.
pub fn road_spec(name: &str) -> Result<RoadSpec, CaseError> {
    let case = find(name, CaseKind::Road)?;
    Ok(parse_toml(&case.toml, Path::new(&format!("case:{name}")))?)
}

/// A published road.
///
/// # Errors
/// A name that is none.
pub fn road(name: &str) -> Result<Road, CaseError> {
    Ok(road_spec(name)?.build_in(Path::new(&format!("case:{name}")))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_builds_and_cites() {
        for case in all() {
            assert!(case.citation().len() > 40, "{}", case.name);
            match case.kind {
                CaseKind::Vehicle => drop(vehicle(&case.name).unwrap()),
                CaseKind::Road => drop(road(&case.name).unwrap()),
            }
        }
        assert_eq!(all().len(), 19);
    }

    #[test]
    fn a_misspelt_case_is_answered_with_its_neighbour() {
        let e = vehicle("turkay-half-cra").unwrap_err().to_string();
        assert!(e.contains("did you mean `case:turkay-half-car`"), "{e}");
        assert!(road("turkay-half-car").is_err());
    }
}
