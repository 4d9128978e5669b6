//! Published vehicles and roads for the tests of this layer: it may not import the cases that stand above it.

use super::{Vehicle, VehicleSpec};
use crate::road::{Road, RoadSpec};

pub fn spec(name: &str) -> VehicleSpec {
    let text = match name {
        "turkay-quarter-car" => include_str!("../cases/vehicles/turkay-quarter-car.toml"),
        "turkay-half-car" => include_str!("../cases/vehicles/turkay-half-car.toml"),
        "chalasani-full-car" => include_str!("../cases/vehicles/chalasani-full-car.toml"),
        "guiggiani-full-car" => include_str!("../cases/vehicles/guiggiani-full-car.toml"),
        other => panic!("{other}"),
    };
    toml::from_str(text).unwrap()
}

pub fn vehicle(name: &str) -> Result<Vehicle, super::VehicleError> {
    spec(name).build_alone()
}

pub fn road(name: &str) -> Result<Road, crate::road::RoadError> {
    let text = match name {
        "turkay-white-velocity" => include_str!("../cases/roads/turkay-white-velocity.toml"),
        "turkay-first-order" => include_str!("../cases/roads/turkay-first-order.toml"),
        "iso8608-c" => {
            "kind = \"iso8608\"\nclass = \"C\"\nband_rad_per_m = [0.063, 17.77]\n[coherence]\nkind = \"bogsjo\"\nmu = 3.8\n"
        }
        other => panic!("{other}"),
    };
    toml::from_str::<RoadSpec>(text).unwrap().build()
}
