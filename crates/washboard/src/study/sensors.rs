//! Which sensors a simulated drive has: accelerometers at every corner, or those of a sensors file.

use super::{LoadedVehicle, StudyError};
use crate::files::{FileError, nearest, parse_toml};
use crate::signal::{Channel, Direction, Place, Quantity, WheelPlace};
use crate::vehicle::Flaws;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A sensors file: one `[[sensor]]` a channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorsFile {
    /// The sensors, in the order of the columns.
    #[serde(rename = "sensor")]
    pub sensors: Vec<SensorRow>,
}

/// One sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorRow {
    /// The column's header: letters, digits, `_`, `-`, `.`.
    pub name: String,
    /// On which body.
    pub place: Place,
    /// At which wheel, by name …
    pub wheel: Option<String>,
    /// … or where: forward, left of the c.g., m.
    pub at_m: Option<[f64; 2]>,
    /// What it measures.
    pub quantity: Quantity,
    /// Along which axis; up where left out (to be given for an angular velocity).
    pub direction: Option<Direction>,
    /// White noise as a multiple of the channel's rms, in place of `--noise`.
    pub noise: Option<f64>,
    /// A constant that it adds, SI.
    #[serde(default)]
    pub bias: f64,
    /// Values beyond ± this are held there, SI.
    pub clip: Option<f64>,
    /// Values are rounded to multiples of this, SI.
    pub quantum: Option<f64>,
    /// It shows what was this many s ago.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub delay_s: f64,
    /// Its clock is this many millionths fast.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub clock_ppm: f64,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde's signature
fn is_zero(v: &f64) -> bool {
    *v == 0.0
}

/// A sensor ready to be simulated. The simulated channel points along a positive axis; `declared` may be its opposite.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sensor {
    pub channel: Channel,
    pub flaws: Flaws,
    pub declared: Direction,
}

/// Vertical accelerometers at every body corner and hub that the model has: `body_fl`, …, `hub_fl`, ….
pub(super) fn default_sensors(loaded: &LoadedVehicle, noise: f64) -> Result<Vec<Sensor>, StudyError> {
    let wheels = wheel_places(loaded);
    let mut sensors = Vec::new();
    for (place, prefix) in [(Place::Body, "body"), (Place::Hub, "hub")] {
        for (index, wheel) in wheels.iter().enumerate() {
            let initials = initials(&wheel.name);
            let name = if initials.is_empty() { prefix.to_owned() } else { format!("{prefix}_{initials}") };
            let channel = Channel {
                name,
                quantity: Quantity::Acceleration,
                direction: Direction::PlusZ,
                place,
                wheel: Some(index),
                at_m: None,
            };
            if loaded.vehicle.sensor_row(&channel, &wheels).is_ok() {
                let flaws = Flaws { noise_ratio: noise, ..Flaws::default() };
                sensors.push(Sensor { channel, flaws, declared: Direction::PlusZ });
            }
        }
    }
    if sensors.is_empty() {
        let found = match wheels.first() {
            None => "a vehicle without wheels".to_owned(),
            Some(w) => {
                let w = w.name.replace('-', "_");
                format!(
                    "none of them; give it a [[output]] such as name = \"body_displacement_{w}\" or \
                     \"unsprung_displacement_{w}\" (at a wheel), or \"heave_displacement\", \"pitch_displacement\" \
                     and \"roll_displacement\" (for --sensors with at_m)"
                )
            }
        };
        let expected = "outputs that say where the body's corners and the hubs are".to_owned();
        let message = format!("sensors: expected {expected}, found {found}");
        return Err(FileError::content(Path::new(&loaded.name), None, message).into());
    }
    Ok(sensors)
}

/// `front-left` → `fl`; the only wheel of a quarter car has none.
fn initials(wheel: &str) -> String {
    match wheel {
        "wheel" => String::new(),
        name if name.split('-').all(|w| matches!(w, "front" | "rear" | "left" | "right" | "middle")) => {
            name.split('-').filter_map(|w| w.chars().next()).collect()
        }
        name => name.replace('-', "_"),
    }
}

/// The vehicle's wheels as a recording names them.
pub(super) fn wheel_places(loaded: &LoadedVehicle) -> Vec<WheelPlace> {
    let wheels = loaded.vehicle.wheels().iter();
    wheels.map(|w| WheelPlace { name: w.name.replace('_', "-"), at_m: w.at_m }).collect()
}

/// The sensors of a file's text.
pub(super) fn read_sensors(
    path: &Path,
    text: &str,
    loaded: &LoadedVehicle,
    noise: f64,
) -> Result<Vec<Sensor>, StudyError> {
    let file: SensorsFile = parse_toml(text, path)?;
    if file.sensors.is_empty() {
        return Err(
            FileError::content(path, None, "sensor: expected at least one [[sensor]], found none").into()
        );
    }
    let names: Vec<&str> = file.sensors.iter().map(|s| s.name.as_str()).collect();
    if let Some(i) = (0..names.len()).find(|i| names[..*i].contains(&names[*i])) {
        let message = format!("sensor `{}`: name: expected each name once, found it twice", names[i]);
        return Err(FileError::content(path, None, message).into());
    }
    let wheels = wheel_places(loaded);
    file.sensors
        .into_iter()
        .map(|row| {
            let name = row.name.clone();
            let sensor = row.build(&wheels, noise).and_then(|s| {
                loaded.vehicle.sensor_row(&s.channel, &wheels).map_err(|e| e.to_string())?;
                Ok(s)
            });
            sensor.map_err(|e| {
                let place = format!("channel `{name}`: ");
                let why = e.strip_prefix(&place).unwrap_or(&e);
                FileError::content(path, None, format!("sensor `{name}`: {why}")).into()
            })
        })
        .collect()
}

impl SensorRow {
    fn build(self, wheels: &[WheelPlace], noise: f64) -> Result<Sensor, String> {
        let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
        if self.name.is_empty() || self.name == "t" || !self.name.chars().all(plain) {
            let expected = "letters, digits, `_`, `-` and `.`, and not `t`, the time";
            return Err(format!("name: expected {expected}, found {:?}", self.name));
        }
        let direction = match (self.direction, self.quantity) {
            (Some(direction), _) => direction,
            (None, Quantity::AngularVelocity) => {
                return Err("direction: expected \"+x\" (roll) or \"+y\" (pitch), found none".to_owned());
            }
            (None, _) => Direction::PlusZ,
        };
        let wheel = match &self.wheel {
            None => None,
            Some(wanted) => Some(wheels.iter().position(|w| w.name == *wanted).ok_or_else(|| {
                let names: Vec<&str> = wheels.iter().map(|w| w.name.as_str()).collect();
                let near = nearest(wanted, names.iter().copied())
                    .map_or_else(String::new, |n| format!(" (did you mean `{n}`?)"));
                format!("wheel: expected one of {}, found `{wanted}`{near}", names.join(", "))
            })?),
        };
        if wheel.is_some() && self.at_m.is_some() {
            return Err("at_m: expected either wheel or at_m, found both".to_owned());
        }
        let noise_ratio = self.noise.unwrap_or(noise);
        let (clip, quantum) = (self.clip, self.quantum);
        let finite = |v: f64, least: f64| v.is_finite() && v >= least;
        for (field, good, expected, found) in [
            ("noise", finite(noise_ratio, 0.0), "a number ≥ 0", noise_ratio),
            ("bias", self.bias.is_finite(), "a finite number", self.bias),
            ("delay_s", self.delay_s.is_finite(), "a finite number", self.delay_s),
            ("clock_ppm", self.clock_ppm.is_finite(), "a finite number", self.clock_ppm),
            ("clip", clip.is_none_or(|v| v > 0.0), "a positive number", clip.unwrap_or(0.0)),
            (
                "quantum",
                quantum.is_none_or(|v| finite(v, f64::MIN_POSITIVE)),
                "a positive number",
                quantum.unwrap_or(0.0),
            ),
        ] {
            if !good {
                return Err(format!("{field}: expected {expected}, found {found}"));
            }
        }
        let flaws = Flaws {
            noise_ratio,
            bias: direction.sign() * self.bias,
            clip,
            quantum,
            delay_s: self.delay_s,
            clock_ppm: self.clock_ppm,
        };
        let channel = Channel {
            name: self.name,
            quantity: self.quantity,
            direction: direction.positive(),
            place: self.place,
            wheel,
            at_m: self.at_m,
        };
        Ok(Sensor { channel, flaws, declared: direction })
    }
}

#[cfg(test)]
mod tests {
    use super::super::load_vehicle;
    use super::*;

    fn names(vehicle: &str) -> Vec<String> {
        let loaded = load_vehicle(&format!("case:{vehicle}")).unwrap();
        default_sensors(&loaded, 0.0).unwrap().into_iter().map(|s| s.channel.name).collect()
    }

    #[test]
    fn default_sensors_are_named_by_their_corners() {
        let full = ["body_fl", "body_fr", "body_rl", "body_rr", "hub_fl", "hub_fr", "hub_rl", "hub_rr"];
        assert_eq!(names("guiggiani-full-car"), full);
        assert_eq!(names("turkay-half-car"), ["body_f", "body_r", "hub_f", "hub_r"]);
        assert_eq!(names("turkay-quarter-car"), ["body", "hub"]);
        assert_eq!(names("turkay-truck-cabin"), full[..4]);
    }

    #[test]
    fn a_wrong_sensor_is_named_with_its_field() {
        let loaded = load_vehicle("case:guiggiani-full-car").unwrap();
        let good = "[[sensor]]\nname = \"a\"\nplace = \"body\"\nwheel = \"front-left\"\nquantity = \"acceleration\"\n";
        let read =
            |text: &str| read_sensors(Path::new("s.toml"), text, &loaded, 0.0).map_err(|e| e.to_string());
        assert_eq!(read(good).unwrap().len(), 1);
        for (from, to, expected) in [
            ("front-left", "front-lefd", "s.toml: sensor `a`: wheel: expected one of front-left"),
            ("\"a\"", "\"t\"", "sensor `t`: name: expected letters"),
            ("quantity", "noise = -1.0\nquantity", "noise: expected a number ≥ 0, found -1"),
            ("quantity", "clip = 0.0\nquantity", "clip: expected a positive number, found 0"),
            ("quantity", "nois = 0.0\nquantity", "s.toml:5: unknown field `nois`"),
            ("\"acceleration\"", "\"angular-velocity\"", "direction: expected \"+x\" (roll)"),
            ("quantity", "direction = \"+x\"\nquantity", "a channel along z"),
        ] {
            let e = read(&good.replace(from, to)).unwrap_err();
            assert!(e.contains(expected), "{e}");
        }
        let e = read(&format!("{good}{good}")).unwrap_err();
        assert!(e.contains("s.toml: sensor `a`: name: expected each name once"), "{e}");
    }
}
