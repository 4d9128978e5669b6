//! What `simulate` writes is what `read_recording` reads, and nothing is written where something is wrong.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};
use washboard::cases;
use washboard::files::write_files;
use washboard::signal::{Direction, Quantity, read_recording};
use washboard::study::{DriveTruth, SimulateSpec, read_result, simulate};
use washboard::vehicle::{DriveSettings, drive};

/// Nine digits are written.
const WRITTEN: f64 = 1e-8;

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("washboard-simulate-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        Folder(dir)
    }

    fn spec(&self) -> SimulateSpec {
        SimulateSpec {
            vehicle: "case:guiggiani-full-car".to_owned(),
            road: "case:iso8608-c".to_owned(),
            speed_m_s: 20.0,
            duration_s: 10.0,
            rate_hz: 200.0,
            noise: 0.02,
            sensors: None,
            seed: 3,
            output: self.0.join("RUN.csv"),
        }
    }

    fn sensors(&self, text: &str) -> SimulateSpec {
        fs::write(self.0.join("sensors.toml"), text).unwrap();
        SimulateSpec { sensors: Some(self.0.join("sensors.toml")), ..self.spec() }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_written_drive_is_read_back() {
    let folder = Folder::new("back");
    let run = simulate(&folder.spec()).unwrap();
    write_files(&run.files).unwrap();
    let read = read_recording(&folder.0.join("RUN.toml")).unwrap();
    assert_eq!((read.channels().len(), read.len(), read.rate_hz()), (8, 2000, 200.0));
    assert_eq!(read.speed_m_s(), Some(20.0));
    assert_eq!(read.wheels()[3].at_m, [-1.596, -0.745]);
    assert!(read.repairs().is_empty(), "{:?}", read.repairs());
    // the other way to the same drive
    let sensors: Vec<_> = read
        .channels()
        .iter()
        .map(|c| (c.clone(), washboard::vehicle::Flaws { noise_ratio: 0.02, ..Default::default() }))
        .collect();
    let settings = DriveSettings { speed_m_s: 20.0, duration_s: 10.0, rate_hz: 200.0, seed: 3 };
    let (vehicle, road) = (cases::vehicle("guiggiani-full-car").unwrap(), cases::road("iso8608-c").unwrap());
    let direct = drive(&vehicle, &road, &sensors, &settings).unwrap();
    for (a, b) in read.samples().iter().flatten().zip(direct.recording.samples().iter().flatten()) {
        assert!((a - b).abs() <= WRITTEN * b.abs(), "{a} {b}");
    }
    let truth = read_result::<DriveTruth>(&folder.0.join("RUN.truth.json")).unwrap();
    assert_eq!((truth.command.as_str(), truth.inputs.len()), ("simulate", 2));
    let truth = truth.outcome;
    assert_eq!(truth.modes.len(), 7);
    assert!((truth.delay_s.unwrap() - 2.66 / 20.0).abs() < 1e-15);
    for (noise, rms) in truth.noise.iter().zip(&direct.noise_rms) {
        assert!((noise.rms / rms - 1.0).abs() < 1e-12);
    }
}

#[test]
fn sensors_of_a_file_measure_what_they_say() {
    let folder = Folder::new("sensors");
    let text = "[[sensor]]\nname = \"up\"\nplace = \"hub\"\nwheel = \"front-left\"\nquantity = \"acceleration\"\n\
                noise = 0.0\nclip = 9.0\nquantum = 0.5\nbias = 1.0\n\
                [[sensor]]\nname = \"down\"\nplace = \"hub\"\nwheel = \"front-left\"\nquantity = \"acceleration\"\n\
                direction = \"-z\"\nnoise = 0.0\n\
                [[sensor]]\nname = \"pitch\"\nplace = \"body\"\nquantity = \"angular-velocity\"\ndirection = \"+y\"\n\
                [[sensor]]\nname = \"seat\"\nplace = \"body\"\nat_m = [0.32, 0.38]\nquantity = \"velocity\"\n";
    let run = simulate(&folder.sensors(text)).unwrap();
    write_files(&run.files).unwrap();
    let toml = fs::read_to_string(folder.0.join("RUN.toml")).unwrap();
    assert!(toml.contains("direction = \"-z\""), "{toml}");
    let csv = fs::read_to_string(folder.0.join("RUN.csv")).unwrap();
    let row: Vec<f64> = csv.lines().nth(5).unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    let expected = ((-row[2] + 1.0).clamp(-9.0, 9.0) / 0.5).round() * 0.5;
    assert!((row[1] - expected).abs() < 1e-7, "{row:?}");
    let read = read_recording(&folder.0.join("RUN.toml")).unwrap();
    // clipped at both ends, as the reader tells
    assert!(read.samples()[0].iter().all(|x| x.abs() <= 9.0));
    assert_eq!(read.channels()[1].direction, Direction::PlusZ);
    assert_eq!((read.samples()[1][4] + row[2]).abs(), 0.0, "-z is turned when it is read");
    assert_eq!(read.channels()[2].quantity, Quantity::AngularVelocity);
    assert_eq!(read.channels()[3].at_m, Some([0.32, 0.38]));
}

#[test]
fn a_recording_of_someone_else_is_not_replaced() {
    let folder = Folder::new("other");
    let csv = folder.0.join("RUN.csv");
    fs::write(&csv, "t,a\n0,1\n").unwrap();
    let e = simulate(&folder.spec()).unwrap_err().to_string();
    assert!(e.contains("RUN.csv: output: the file or its description exists"), "{e}");
    assert_eq!(fs::read_to_string(&csv).unwrap(), "t,a\n0,1\n");
    fs::remove_file(&csv).unwrap();
    for _ in 0..2 {
        write_files(&simulate(&folder.spec()).unwrap().files).unwrap();
    }
}

#[test]
fn a_vehicle_without_sensor_places_says_what_would_give_them() {
    let folder = Folder::new("matrices");
    let car = "model = \"matrices\"\n[matrices]\nm = [[1.0]]\nc = [[1.0]]\nk = [[100.0]]\nwheel_stiffness = [[100.0]]\n\
               [[matrices.wheel]]\nname = \"front_left\"\nat_m = [0.0, 0.0]\n";
    let file = folder.0.join("car.toml");
    fs::write(&file, car).unwrap();
    let spec = |file: &Path| SimulateSpec { vehicle: file.display().to_string(), ..folder.spec() };
    let e = simulate(&spec(&file)).unwrap_err().to_string();
    assert!(e.contains("car.toml: sensors: expected") && e.contains("body_displacement_front_left"), "{e}");
    // and doing what it says helps
    let output = "[[matrices.output]]\nname = \"body_displacement_front_left\"\ndisplacement = [1.0]\n";
    fs::write(&file, format!("{car}{output}")).unwrap();
    assert_eq!(simulate(&spec(&file)).unwrap().outcome.channels[0].name, "body_fl");
}

#[test]
fn an_output_that_is_no_csv_is_refused() {
    let folder = Folder::new("names");
    let refused =
        |output: PathBuf| simulate(&SimulateSpec { output, ..folder.spec() }).unwrap_err().to_string();
    assert!(refused(folder.0.join("RUN.toml")).contains("ends in .csv"));
    assert!(refused(folder.0.join("none/RUN.csv")).contains("a directory that exists"));
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 0);
}
