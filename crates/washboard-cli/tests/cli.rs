//! The program as a user meets it: output, exit status, and one clear message for everything that can be wrong.

#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// An empty folder to run in, gone at the end.
struct Folder(PathBuf);

struct Ran {
    status: i32,
    stdout: String,
    stderr: String,
}

impl Folder {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("washboard-cli-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        Folder(dir)
    }

    fn file(&self, name: &str, text: &str) -> &Self {
        fs::write(self.0.join(name), text).unwrap();
        self
    }

    /// Runs `washboard` with words.
    fn run(&self, line: &str) -> Ran {
        let out = Command::new(env!("CARGO_BIN_EXE_washboard"))
            .args(line.split_whitespace())
            .current_dir(&self.0)
            .output()
            .unwrap();
        Ran {
            status: out.status.code().unwrap(),
            stdout: String::from_utf8(out.stdout).unwrap(),
            stderr: String::from_utf8(out.stderr).unwrap(),
        }
    }

    fn ok(&self, line: &str) -> String {
        let ran = self.run(line);
        assert_eq!((ran.status, ran.stderr.as_str()), (0, ""), "{line}");
        ran.stdout
    }

    fn json(&self, line: &str) -> Value {
        let value: Value = serde_json::from_str(&self.ok(&format!("{line} --json"))).unwrap();
        assert_eq!(value["schema_version"], 1);
        assert_eq!(value["command"], line.split_whitespace().next().unwrap());
        value
    }

    /// Exit status 2, nothing on standard output, one line on standard error that has all parts; no file appears.
    fn wrong(&self, line: &str, parts: &[&str]) {
        let files = || {
            let mut names: Vec<_> = fs::read_dir(&self.0).unwrap().map(|e| e.unwrap().file_name()).collect();
            names.sort();
            names
        };
        let before = files();
        let ran = self.run(line);
        assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{line}: {}", ran.stderr);
        assert_eq!(ran.stderr.lines().count(), 1, "{line}: {}", ran.stderr);
        assert!(!ran.stderr.contains("panicked"));
        for part in parts {
            assert!(ran.stderr.contains(part), "{line}: {} should have {part:?}", ran.stderr);
        }
        assert_eq!(files(), before, "{line}");
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const SIMULATE: &str = "simulate case:guiggiani-full-car --road case:iso8608-c --speed-m-s 20 --duration-s 20 \
                        --rate-hz 100 --noise 0.02 -o RUN.csv";

#[test]
fn cases_are_listed_and_printed() {
    let folder = Folder::new("cases");
    let list = folder.ok("cases");
    assert!(list.contains("case:guiggiani-full-car") && list.contains("De Filippis"), "{list}");
    assert_eq!(folder.json("cases")["cases"].as_array().unwrap().len(), 19);
    // what is printed is a file to start from
    folder.file("car.toml", &folder.ok("cases turkay-half-car"));
    assert_eq!(folder.ok("modes car.toml"), folder.ok("modes case:turkay-half-car"));
    assert!(folder.json("cases iso8608-c")["toml"].as_str().unwrap().contains("class = \"C\""));
}

#[test]
fn modes_and_ride_print_tables_and_json() {
    let folder = Folder::new("modes");
    let table = folder.ok("modes case:guiggiani-full-car --shapes");
    assert!(table.contains("mode                  (Hz)") && table.contains("rear axle hop"), "{table}");
    let modes = folder.json("modes case:guiggiani-full-car");
    assert_eq!(modes["modes"].as_array().unwrap().len(), 7);
    assert_eq!(modes["inputs"][0]["path"], "case:guiggiani-full-car");

    let line = "ride case:turkay-quarter-car --road case:turkay-white-velocity --speed-m-s 20";
    let ride = folder.json(line);
    assert_eq!(ride["rms"]["sprung_displacement"], "infinite");
    assert!(ride["rms"]["sprung_acceleration"].as_f64().unwrap() > 0.0);
    let table = folder.ok(line);
    assert!(table.contains("infinite: sprung_displacement"), "{table}");
    let table = folder.ok("ride case:chalasani-full-car --road case:iso8608-b --speed-m-s 20");
    assert!(table.contains("front     front") && !table.contains("suspension_travel_front"), "{table}");
    assert!(table.contains("weighted heave_acceleration") && !table.contains("bottoming"), "{table}");
    let table = folder.ok(&format!("{line} --stroke-m 0.02"));
    assert!(table.contains("bottoming, suspension_travel"), "{table}");
    let metrics = &folder.json(&format!("{line} --stroke-m 0.02"))["metrics"];
    assert_eq!(metrics["weighted"]["sprung_acceleration"]["weighting"], "W_k");
    assert!(metrics["tire_load"]["tire_force"]["coefficient"].as_f64().is_some_and(|v| v > 0.0 && v < 1.0));
}

/// A car with a damper curve: rougher roads soften a digressive one, in the table and in JSON; without one it is refused.
#[test]
fn damping_against_roughness() {
    let folder = Folder::new("damping");
    let car = folder.ok("cases turkay-quarter-car");
    folder.file(
        "car.toml",
        &format!("{car}\ndamper_curve = [[-0.3, -500.0], [0.0, 0.0], [0.1, 150.0], [1.0, 600.0]]\n"),
    );
    let found = folder.json("damping car.toml --speed-m-s 20");
    let roads = found["roads"].as_array().unwrap();
    let c: Vec<f64> = roads.iter().map(|r| r["dampers"][0]["damping_n_s_per_m"].as_f64().unwrap()).collect();
    assert!(c.len() == 5 && c.windows(2).all(|w| w[1] < w[0]), "{c:?}");
    assert_eq!(roads[0]["modes"].as_array().unwrap().len(), 2);
    let table = folder.ok("damping car.toml --speed-m-s 20 --road case:iso8608-b --road case:iso8608-d");
    assert!(table.contains("iso8608-d") && table.contains("N·s/m") && table.contains("% damping"), "{table}");
    folder.wrong("damping case:turkay-quarter-car --speed-m-s 20", &["turkay-quarter-car", "damper_curve"]);
    folder.wrong("damping car.toml --speed-m-s 0", &["speed_m_s", "found 0"]);
}

#[test]
fn simulate_writes_three_files_and_the_same_ones_again() {
    let folder = Folder::new("simulate");
    let drive = folder.json(SIMULATE);
    assert_eq!((drive["samples"].as_u64(), drive["channels"].as_array().unwrap().len()), (Some(2000), 8));
    let read = |name: &str| fs::read(folder.0.join(name)).unwrap();
    let first = ["RUN.csv", "RUN.toml", "RUN.truth.json"].map(read);
    assert!(first[0].starts_with(b"t,body_fl,body_fr,body_rl,body_rr,hub_fl,hub_fr,hub_rl,hub_rr\n0,"));
    assert!(folder.ok(&format!("{SIMULATE} --quiet")).contains("wrote RUN.csv"));
    assert!(first == ["RUN.csv", "RUN.toml", "RUN.truth.json"].map(read));
    folder.ok(&format!("{SIMULATE} --seed 1"));
    assert!(first[0] != read("RUN.csv"));
}

/// Two speeds: cut with `--method ssi` too (60 s a part), told; three speeds in too short stretches are not.
#[test]
fn a_drive_of_several_speeds_is_cut_and_told() {
    let folder = Folder::new("speeds");
    let simulate = |speeds: &str| {
        format!(
            "simulate case:turkay-half-car --road case:iso8608-c --speeds {speeds} --rate-hz 100 --noise 0.02 -o RUN.csv"
        )
    };
    let table = folder.ok(&simulate("10:90,25:70"));
    assert!(
        table.contains("16000 samples at 100 Hz (160 s) at 10 m/s for 90 s, then at 25 m/s for 70 s"),
        "{table}"
    );
    assert_eq!(folder.json(&simulate("10:90,25:70"))["stretches"][1]["speed_m_s"], 25.0);
    let found = |line: &str| -> Value { serde_json::from_str(&folder.run(line).stdout).unwrap() };
    let names = |of: &Value| -> Vec<String> {
        of.as_array().unwrap().iter().map(|f| f["name"].as_str().unwrap().to_owned()).collect()
    };
    let text = |of: &Value, name: &str| -> String {
        let flag = of.as_array().unwrap().iter().find(|f| f["name"] == name).unwrap();
        flag["text"].as_str().unwrap().to_owned()
    };
    let cut = found("identify RUN.toml --method ssi --json");
    assert_eq!(names(&cut["runs"]), ["RUN.toml at 10.0 m/s", "RUN.toml at 25.0 m/s"]);
    assert_eq!(cut["recording"]["name"], "RUN.toml at 10.0 m/s");
    assert!(!names(&cut["flags"]).contains(&"speed-varies".to_owned()));
    let note = text(&cut["notes"], "cut-by-speed");
    for part in
        ["cut into parts of steady speed", "10.0 m/s for 8", "25.0 m/s for 6", "left out are", "s of 160.0 s"]
    {
        assert!(note.contains(part), "{note}");
    }
    folder.ok(&simulate("10:40,20:40,30:40"));
    let whole = found("identify RUN.toml --method ssi --json");
    assert_eq!(whole["recording"]["name"], "RUN.toml");
    let flag = text(&whole["flags"], "speed-varies");
    for part in ["varies by", "cannot be cut into parts of steady speed", "lasts 3", "60.0 s are needed"] {
        assert!(flag.contains(part), "{flag}");
    }
    folder.wrong(&simulate("10:5"), &["speeds: expected stretches of at least 8 s, found 5 s"]);
    folder.wrong(&simulate("10:50,10.5:50"), &["differ by a tenth", "10 m/s, then 10.5 m/s"]);
    for line in [simulate("10"), simulate("10:x"), simulate("10:50 --speed-m-s 5")] {
        let ran = folder.run(&line);
        assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{line}");
        assert!(ran.stderr.contains("--speeds"), "{}", ran.stderr);
    }
    let ran = folder.run("simulate case:turkay-half-car --road case:iso8608-c --rate-hz 100 -o X.csv");
    assert_eq!((ran.status, ran.stdout.as_str()), (2, ""));
    assert!(ran.stderr.contains("--speed-m-s") && ran.stderr.contains("--duration-s"), "{}", ran.stderr);
}

#[test]
fn report_writes_the_page_again_from_the_result() {
    let folder = Folder::new("report");
    let result = include_str!("../../washboard/tests/golden/outcome-identify.json");
    fs::create_dir(folder.0.join("found")).unwrap();
    folder.file("found/result.json", result);
    assert_eq!(folder.ok("report found"), "wrote found/report.html\n");
    assert_eq!(folder.json("report found")["report"], "found/report.html");
    let page = fs::read_to_string(folder.0.join("found/report.html")).unwrap();
    assert!(page.to_lowercase().starts_with("<!doctype html>"), "{page}");
    folder.file("found/result.json", &result.replace("\"converged\"", "\"konverged\""));
    folder.wrong("report found", &["found/result.json:", "missing field `converged`"]);
    folder.ok(SIMULATE);
    fs::copy(folder.0.join("RUN.truth.json"), folder.0.join("found/result.json")).unwrap();
    folder.wrong(
        "report found",
        &[
            "found/result.json:",
            "command: expected one of `identify`, `demo`, `compare`, `design`,",
            "found `simulate`",
        ],
    );
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_washboard"))
        .args(["ride", "case:chalasani-full-car", "--road", "case:iso8608-b", "--speed-m-s", "20", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let out = child.wait_with_output().unwrap();
    assert_eq!(
        (out.status.code(), out.stderr.len()),
        (Some(0), 0),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
}

#[test]
fn usage_errors_leave_standard_output_empty() {
    let folder = Folder::new("usage");
    for line in ["", "mods case:x", "modes", "ride case:turkay-half-car", "modes case:turkay-half-car --jsn"]
    {
        let ran = folder.run(line);
        assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{line}");
        assert!(!ran.stderr.is_empty());
    }
    assert!(folder.ok("--help").contains("identify"));
}

#[test]
fn the_classical_methods_answer_and_say_what_they_are() {
    let folder = Folder::new("classical");
    let drive = "--road case:iso8608-c --speed-m-s 20 --duration-s 120 --rate-hz 100 --noise 0.02";
    folder.ok(&format!("simulate case:guiggiani-full-car {drive} -o RUN.csv"));
    for method in ["ssi", "plscf", "fdd"] {
        let ran = folder.run(&format!("identify RUN.toml --method {method} --json"));
        assert!(ran.status <= 1, "{method}: {}", ran.stderr);
        let found: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
        assert_eq!(found["method"], method);
        assert_eq!(ran.status == 0, found["converged"] == true);
        let flags = found["flags"].as_array().unwrap();
        assert!(flags.iter().any(|f| f["name"] == "classical"), "{method}");
        assert!(found["rejected"].as_array().is_some_and(|r| !r.is_empty()), "{method}");
        assert!(found["singular_values"]["values"].is_array(), "{method}");
    }
    // segments that the drive has not four of: the longest that it takes, in seconds, and that one is taken
    let fdd = |s: &str| folder.run(&format!("identify RUN.toml --method fdd --segment-s {s} --json"));
    let refused = fdd("240");
    assert!(refused.status == 2 && refused.stderr.contains("to 30 s (a quarter"), "{}", refused.stderr);
    let refused = fdd("60").stderr;
    let longest = refused.split("segment_s: expected at most ").nth(1).and_then(|s| s.split(' ').next());
    let longest: f64 = longest.unwrap_or_else(|| panic!("{refused}")).parse().unwrap();
    assert!(longest > 29.0 && longest <= 30.0 && fdd(&longest.to_string()).status <= 1, "{refused}");
}

#[test]
fn names_that_are_none() {
    let folder = Folder::new("names");
    folder.file("empty.toml", "").file("latin1.toml", "x").file("text.toml", "hello");
    fs::write(folder.0.join("latin1.toml"), b"model = \"\xe9\"").unwrap();
    for (line, parts) in [
        ("modes none.toml", &["none.toml: cannot read"][..]),
        ("modes .", &[".: expected a file, found a directory"]),
        ("modes empty.toml", &["empty.toml", "missing field `model`"]),
        ("modes text.toml", &["text.toml:1"]),
        ("modes latin1.toml", &["latin1.toml: expected UTF-8"]),
        ("modes case:guigiani-full-car", &["no such vehicle", "did you mean `case:guiggiani-full-car`"]),
        ("modes guiggiani-full-car", &["did you mean `case:guiggiani-full-car`"]),
        ("cases guigiani-full-car", &["did you mean `case:guiggiani-full-car`"]),
        ("ride case:turkay-half-car --road case:iso8608 --speed-m-s 20", &["no such road", "did you mean"]),
        ("ride case:turkay-half-car --road none.toml --speed-m-s 20", &["none.toml: cannot read"]),
        ("identify none.toml", &["none.toml: cannot read"]),
        ("identify empty.toml", &["empty.toml", "missing field"]),
        ("report none", &["result.json: cannot read"]),
    ] {
        folder.wrong(line, parts);
    }
    folder.file("result.json", "{\"schema_version\": 99}");
    folder.wrong("report .", &["result.json: schema_version: expected 1, found 99"]);
}

#[test]
fn numbers_that_cannot_be() {
    let folder = Folder::new("numbers");
    let ride = "ride case:turkay-half-car --road case:iso8608-c --speed-m-s";
    for speed in ["0", "-20", "nan", "inf"] {
        folder.wrong(&format!("{ride} {speed}"), &["speed_m_s: expected a positive number, found "]);
    }
    for (from, to, parts) in [
        ("-s 20 ", "-s 0 ", ["speed_m_s: expected a positive", "found 0"]),
        ("-s 20 -", "-s -3 -", ["speed_m_s: expected a positive", "found -3"]),
        ("--duration-s 20", "--duration-s -1", ["duration_s: expected a positive", "found -1"]),
        ("--rate-hz 100", "--rate-hz 0", ["rate_hz: expected a positive", "found 0"]),
        ("--rate-hz 100", "--rate-hz 1e9", ["duration_s: expected", "samples"]),
        ("--noise 0.02", "--noise -0.02", ["noise: expected a number ≥ 0", "found -0.02"]),
        ("RUN.csv", "RUN.txt", ["RUN.txt: output", ".csv"]),
        ("RUN.csv", "none/RUN.csv", ["none/RUN.csv: output", "directory"]),
    ] {
        assert!(SIMULATE.contains(from), "{from}");
        folder.wrong(&SIMULATE.replace(from, to), &parts);
    }
}

#[test]
fn vehicles_that_cannot_be() {
    let folder = Folder::new("vehicles");
    let full = folder.ok("cases chalasani-full-car");
    let edit = |key: &str, value: &str| {
        let mut done = false;
        let lines = full.lines().map(|l| {
            if !done && l.starts_with(key) {
                done = true;
                return format!("{key} = {value}");
            }
            l.to_owned()
        });
        let text = lines.collect::<Vec<_>>().join("\n");
        assert!(done, "{key}");
        text
    };
    for (key, value, part) in [
        ("sprung_mass_kg", "0.0", "full-car.sprung_mass_kg: expected a positive number, found 0"),
        ("sprung_mass_kg", "-1.0", "full-car.sprung_mass_kg: expected a positive number, found -1"),
        ("sprung_mass_kg", "nan", "full-car.sprung_mass_kg: expected a positive number, found NaN"),
        ("sprung_mass_kg", "\"heavy\"", "car.toml:"),
        ("front_axle_m", "-0.5", "full-car.front_axle_m: expected a positive number, found -0.5"),
        ("front_track_m", "0.0", "full-car.front_track_m: expected a positive number, found 0"),
        ("front_track_m", "1.5\ncg_left_m = 2.0", "full-car.cg_left_m: expected a c.g. between"),
        ("front_track_m", "1.5\nfront_trak_m = 2.0", "did you mean `front_track_m`"),
    ] {
        folder.file("car.toml", &edit(key, value));
        folder.wrong("modes car.toml", &["car.toml", part]);
    }
    let quarter = folder.ok("cases turkay-quarter-car");
    for (from, to, part) in [
        (
            "tire_stiffness_n_per_m = 160000",
            "tire_stiffness_n_per_m = 0",
            "quarter-car.tire_stiffness_n_per_m",
        ),
        ("damping_n_s_per_m = 980", "damping_n_s_per_m = -980", "expected a number ≥ 0, found -980"),
        ("[quarter-car]", "[half-car]", "car.toml:"),
        ("model = \"quarter-car\"", "model = \"quarter-kar\"", "did you mean `quarter-car`"),
        (
            "model = \"quarter-car\"",
            "model = \"half-car\"",
            "[quarter-car]: expected the table of the model only",
        ),
    ] {
        assert!(quarter.contains(from), "{from}");
        folder.file("car.toml", &quarter.replace(from, to));
        folder.wrong("modes car.toml", &["car.toml", part]);
    }
    let matrices = "model = \"matrices\"\n[matrices]\nm = [[1.0, 2.0], [2.0, 1.0]]\nc = [[0.0, 0.0], [0.0, 0.0]]\n\
                    k = [[1.0, 0.0], [0.0, 1.0]]\n";
    folder.file("car.toml", matrices);
    folder.wrong("modes car.toml", &["car.toml: ", "not positive definite", "-1"]);
    folder.file("car.toml", &matrices.replace("[2.0, 1.0]]", "[2.0]]"));
    folder.wrong("modes car.toml", &["car.toml: matrices.m: expected"]);
    folder.file("car.toml", &matrices.replace("2.0, 1.0", "0.0, 1.0").replace("1.0, 2.0", "1.0, 0.0"));
    folder.ok("modes car.toml");
    folder.wrong("ride car.toml --road case:iso8608-c --speed-m-s 20", &["car.toml: ", "no wheels"]);
}

#[test]
fn roads_that_cannot_be() {
    let folder = Folder::new("roads");
    let line = "ride case:turkay-half-car --road road.toml --speed-m-s 20";
    let table = "kind = \"table\"\ndata = \"psd.csv\"\n";
    for (road, psd, parts) in [
        ("kind = \"iso8608\"\nclass = \"C\"\n", "", ["road.toml: band_rad_per_m: expected", "found none"]),
        (
            "kind = \"iso8608\"\nclas = \"C\"\n",
            "",
            ["road.toml:2: unknown field `clas`", "did you mean `class`?"],
        ),
        ("class = \"C\"\n", "", ["road.toml", "missing field `kind`"]),
        (
            "kind = \"iso8608\"\nclass = \"C\"\nband_rad_per_m = [1.0, 0.1]\n",
            "",
            ["road.toml: band_rad_per_m: expected", "found"],
        ),
        ("kind = \"table\"\ndata = \"none.csv\"\n", "", ["none.csv: cannot read", ""]),
        (table, "nu_rad_per_m,psd\n0.1,1\n1,x\n", ["psd.csv:3: psd: expected a number", "\"x\""]),
        (table, "nu_rad_per_m,psd\n0.1,1\n1\n", ["psd.csv:3: expected 2 fields, found 1", ""]),
        (table, "nu,psd\n0.1,1\n", ["psd.csv:1: expected one column nu_rad_per_m", ""]),
        (table, "", ["psd.csv: expected a header line, found an empty file", ""]),
    ] {
        folder.file("road.toml", road).file("psd.csv", psd);
        folder.wrong(line, &parts);
    }
}

#[test]
fn recordings_that_cannot_be() {
    let folder = Folder::new("recordings");
    folder.ok(SIMULATE);
    let (csv, toml) = ["RUN.csv", "RUN.toml"].map(|n| fs::read_to_string(folder.0.join(n)).unwrap()).into();
    let (csv, toml): (String, String) = (csv, toml);
    let third: Vec<&str> = csv.lines().nth(2).unwrap().split(',').collect();
    let cell = |text: &str| csv.replacen(third[1], text, 1);
    for (data, parts) in [
        (cell("NaN"), ["RUN.csv:3: column `body_fl`: expected a finite number", "found \"NaN\""]),
        (cell("fast"), ["RUN.csv:3: column `body_fl`: expected a finite number", "found \"fast\""]),
        (cell(&format!("{0},{0}", third[1])), ["RUN.csv:3: row: expected 9 fields", "found 10"]),
        (csv.replacen(&format!(",{}", third[8]), "", 1), ["RUN.csv:3: row: expected 9 fields", "found 8"]),
        (csv.replacen("body_fr", "body_f", 1), ["RUN.csv:1: column `body_fr`", "did you mean"]),
        (csv.lines().next().unwrap().to_owned(), ["RUN.csv", "found nothing"]),
        (String::new(), ["RUN.csv", "found nothing"]),
    ] {
        folder.file("RUN.csv", &data);
        folder.wrong("identify RUN.toml -o out", &parts);
    }
    folder.file("RUN.csv", &csv);
    for (from, to, parts) in [
        ("\"m/s^2\"", "\"m/s^3\"", ["RUN.toml:", "did you mean `m/s^2`?"]),
        ("\"m/s^2\"", "\"mm\"", ["RUN.toml: channel `body_fl`: unit: expected", "found mm"]),
        ("speed_m_s = 20.0", "speed_m_s = 0.0", ["speed_m_s: expected a positive", "found 0"]),
        ("speed_m_s = 20.0", "speed_m_s = -20.0", ["speed_m_s: expected a positive", "found -20"]),
        ("rate_hz = 100.0", "rate_hx = 100.0", ["RUN.toml:2: unknown field", "did you mean `rate_hz`?"]),
        ("data = \"RUN.csv\"", "data = \"none.csv\"", ["none.csv: cannot read", ""]),
    ] {
        assert!(toml.contains(from), "{from}");
        folder.file("RUN.toml", &toml.replacen(from, to, 1));
        folder.wrong("identify RUN.toml -o out", &parts);
    }
    folder.file("RUN.toml", &toml);
    folder.wrong(
        "identify RUN.toml --method ssi --segment-s 60 -o out",
        &["samples", "segment_s: expected", "found 60"],
    );
    folder.wrong(
        "identify RUN.toml --segment-s -5 -o out",
        &["segment_s: expected a positive number, found -5"],
    );
    folder.wrong("identify RUN.toml --band-hz 9,2 -o out", &["band_hz: expected", "found [9, 2]"]);
    fs::create_dir(folder.0.join("full")).unwrap();
    folder.file("full/mine", "x");
    folder.wrong("identify RUN.toml -o full", &["full: the directory is not empty; --overwrite"]);
    folder.wrong("identify RUN.toml -o RUN.csv", &["RUN.csv: expected a directory, found a file"]);
    assert_eq!(fs::read_to_string(folder.0.join("full/mine")).unwrap(), "x");
}

/// The README's tour from simulate to ride, on a short drive.
#[test]
fn from_a_drive_to_a_page_and_on() {
    let folder = Folder::new("tour");
    let simulate = "simulate case:guiggiani-full-car --road case:iso8608-c --speed-m-s 20 --duration-s 240 --rate-hz 100 \
                    --noise 0.02 -o RUN.csv";
    folder.ok(simulate);
    let table = folder.ok("identify RUN.toml --vehicle case:guiggiani-full-car -o found");
    assert!(table.contains("heave") && table.contains("class C"), "{table}");
    let result: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.0.join("found/result.json")).unwrap()).unwrap();
    assert_eq!((result["schema_version"].as_u64(), result["converged"].as_bool()), (Some(1), Some(true)));
    assert_eq!(result["modes"].as_array().unwrap().len(), 7);
    // the truth is not among what was read
    let read: Vec<&str> =
        result["inputs"].as_array().unwrap().iter().map(|i| i["path"].as_str().unwrap()).collect();
    assert_eq!(read, ["RUN.toml", "RUN.csv", "case:guiggiani-full-car"]);
    let page = fs::read_to_string(folder.0.join("found/report.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") || page.starts_with("<!doctype html>"));
    fs::remove_file(folder.0.join("found/report.html")).unwrap();
    folder.ok("report found");
    assert_eq!(fs::read_to_string(folder.0.join("found/report.html")).unwrap(), page);
    let ride = folder.ok("ride found/vehicle.toml --road found/road.toml --speed-m-s 25");
    assert!(ride.contains("heave_acceleration"), "{ride}");
    let json = folder.ok("identify RUN.toml --vehicle case:guiggiani-full-car --json");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&json).unwrap()["modes"], result["modes"]);
}
