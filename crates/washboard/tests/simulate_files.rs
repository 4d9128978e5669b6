//! What `simulate` writes is what `read_recording` reads, and nothing is written where something is wrong.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};
use washboard::cases;
use washboard::files::write_files;
use washboard::signal::{Direction, Quantity, read_recording};
use washboard::study::{DriveTruth, SimulateSpec, Stretch, read_result, simulate};
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
            speed_m_s: Some(20.0),
            duration_s: Some(10.0),
            speeds: vec![],
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

/// Stretches of several speeds: the speed is a column that is read back, the truth has each part.
#[test]
fn a_drive_of_two_speeds_is_read_back_with_its_speed() {
    let folder = Folder::new("speeds");
    let stretch = |speed_m_s, duration_s| Stretch { speed_m_s, duration_s };
    let of_speeds = |speeds: Vec<Stretch>| SimulateSpec {
        speed_m_s: None,
        duration_s: None,
        speeds,
        rate_hz: 100.0,
        ..folder.spec()
    };
    let run = simulate(&of_speeds(vec![stretch(10.0, 20.0), stretch(25.0, 30.0)])).unwrap();
    write_files(&run.files).unwrap();
    let read = read_recording(&folder.0.join("RUN.toml")).unwrap();
    assert_eq!((read.channels().len(), read.len()), (8, 5000));
    assert!((read.speed_m_s().unwrap() - 19.0).abs() < 1e-6, "{:?}", read.speed_m_s());
    let speed = read.speed_series().unwrap();
    assert_eq!((speed[0], speed[1799], speed[2200], speed[4999]), (10.0, 10.0, 25.0, 25.0));
    let truth = read_result::<DriveTruth>(&folder.0.join("RUN.truth.json")).unwrap().outcome;
    assert_eq!((truth.delay_s, truth.stretches.len()), (None, 2));
    assert!((truth.stretches[1].delay_s.unwrap() - 2.66 / 25.0).abs() < 1e-15);
    assert!((truth.speed_m_s - 19.0).abs() < 1e-12);
    assert_eq!(run.outcome.stretches, truth.stretches);
    let refused = |spec: &SimulateSpec| simulate(spec).unwrap_err().to_string();
    let both = SimulateSpec { speed_m_s: Some(5.0), ..of_speeds(vec![stretch(10.0, 20.0)]) };
    assert!(refused(&both).contains("found speed_m_s, speeds"), "{}", refused(&both));
    assert!(refused(&of_speeds(vec![])).contains("none of them"));
    assert!(
        refused(&of_speeds(vec![stretch(10.0, 2.0)])).contains("speeds: expected stretches of at least 8 s")
    );
}
