//! `washboard road` as a user meets it: files that go on, exit status, one message for what is wrong.

#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("washboard-road-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        Folder(dir)
    }

    fn run(&self, line: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_washboard"))
            .args(line.split_whitespace())
            .current_dir(&self.0)
            .output()
            .unwrap()
    }

    fn ok(&self, line: &str) -> String {
        let out = self.run(line);
        assert_eq!(out.status.code(), Some(0), "{line}: {}", String::from_utf8_lossy(&out.stderr));
        assert!(out.stderr.is_empty(), "{line}");
        String::from_utf8(out.stdout).unwrap()
    }

    fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.ok(&format!("{line} --json"))).unwrap()
    }

    /// Status 2, nothing on standard output, one line with all parts, and no new file.
    fn wrong(&self, line: &str, parts: &[&str]) {
        let files = || fs::read_dir(&self.0).unwrap().count();
        let before = files();
        let out = self.run(line);
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(
            (out.status.code(), out.stdout.len(), said.lines().count()),
            (Some(2), 0, 1),
            "{line}: {said}"
        );
        for part in parts {
            assert!(said.contains(part), "{line}: {said} should have {part:?}");
        }
        assert_eq!(files(), before);
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Profile → index → filter → ride, design and another profile.
#[test]
fn a_profile_goes_all_the_way() {
    let folder = Folder::new("way");
    let line =
        "road profile case:iso8608-c --length-m 1000 --step-m 0.2 --track-width-m 1.5 --seed 3 -o P.csv";
    let made = folder.json(line);
    assert_eq!((made["command"].as_str(), made["points"].as_u64()), (Some("road profile"), Some(5001)));
    let text = fs::read_to_string(folder.0.join("P.csv")).unwrap();
    assert!(text.starts_with("x_m,left_m,right_m\n0,") && text.lines().nth(4).unwrap().starts_with("0.6,"));
    folder.wrong(line, &["P.csv", "--overwrite replaces it"]);
    folder.ok(&format!("{line} --overwrite"));
    assert_eq!(fs::read_to_string(folder.0.join("P.csv")).unwrap(), text);

    let index = folder.json("road iri P.csv --segment-m 100");
    assert_eq!(index["tracks"][1]["segments"].as_array().unwrap().len(), 10);
    assert_eq!(index["inputs"][0]["path"], "P.csv");
    // class C at 1 m/km and more: between a good road and a bad one
    let mean = index["mean_iri_mm_per_m"].as_f64().unwrap();
    assert!((2.0..10.0).contains(&mean), "{mean}");
    let table = folder.ok("road iri P.csv --segment-m 300");
    assert!(table.contains("left_m (mm/m)") && table.contains("the last 100 m are in no segment"), "{table}");

    let fit = folder.json("road fit P.csv -o F.toml");
    for key in [
        "order",
        "poles",
        "zeros",
        "gain",
        "log10_rms_error",
        "band",
        "positivity_repaired",
        "singular_values",
        "orders",
        "lambda",
        "p",
        "folded",
        "a",
        "b",
        "c",
        "d",
    ] {
        assert!(!fit[key].is_null(), "{key}");
    }
    assert!(fit["log10_rms_error"].as_f64().unwrap() < 0.1);
    let table = folder.ok("road fit P.csv");
    for part in ["Bayes' criterion", "singular values:", "chosen", "log10 error", "note: fitted from"] {
        assert!(table.contains(part), "{table}");
    }
    let rms = |road: &str| {
        let line = format!("ride case:turkay-quarter-car --road {road} --speed-m-s 20");
        folder.json(&line)["rms"]["sprung_acceleration"].as_f64().unwrap()
    };
    // an estimate from 1 km of two tracks
    assert!(
        (rms("F.toml") / rms("case:iso8608-c") - 1.0).abs() < 0.25,
        "{} {}",
        rms("F.toml"),
        rms("case:iso8608-c")
    );
    let design = "vehicle = \"case:turkay-quarter-car\"\nroad = \"F.toml\"\nspeed_m_s = 20.0\nmeasurements = [\"suspension_travel\"]\n\
        method = \"lqg\"\ndisturbance = \"road-noise\"\n[goal]\nminimize = { sprung_acceleration = 1.0, suspension_travel = 1.0, tire_deflection = 1.0 }\n\
        [lqg]\nsensor_noise = 1e-8\nprocess_noise = 1.0\n";
    fs::write(folder.0.join("design.toml"), design).unwrap();
    assert_eq!(folder.json("design design.toml")["status"], "designed");
    folder.ok("road profile F.toml --length-m 200 --step-m 0.2 -o Q.csv");
    folder.ok("road fit F.toml --band 0.2,10 -o G.json");
    assert!(fs::read_to_string(folder.0.join("G.json")).unwrap().contains("\"unit\": \"rad/m\""));
}

/// What `identify` found goes on as a filter; a road over time wants a speed.
#[test]
fn other_sources() {
    let folder = Folder::new("sources");
    fs::create_dir(folder.0.join("found")).unwrap();
    let road = "kind = \"iso8608\"\nroughness_m3 = 2e-5\nexponent = 2.1\nband_rad_per_m = [0.2, 8.0]\n[coherence]\nkind = \"bogsjo\"\nmu = 3.0\n";
    fs::write(folder.0.join("found/road.toml"), road).unwrap();
    folder.ok("road fit found -o F.toml");
    let text = fs::read_to_string(folder.0.join("F.toml")).unwrap();
    assert!(text.starts_with("# washboard road fit found\n") && text.contains("mu = 3.0"), "{text}");
    folder.ok("ride case:guiggiani-full-car --road F.toml --speed-m-s 20");

    let over_time = "kind = \"white-velocity\"\nintensity_m2_per_s = 1e-4\n";
    fs::write(folder.0.join("white.toml"), over_time).unwrap();
    folder.wrong(
        "road profile white.toml --length-m 100 --step-m 0.1 -o P.csv",
        &["speed_m_s", "written over time"],
    );
    folder.ok("road profile white.toml --length-m 100 --step-m 0.1 --speed-m-s 20 -o P.csv");
    folder
        .wrong("road profile case:iso8608-c --length-m 100 --step-m 0 -o X.csv", &["case:iso8608-c: step_m"]);
    folder.wrong(
        "road profile case:iso8608-c --length-m 100 --step-m 1 -o no/X.csv",
        &["no/X.csv", "a directory that exists"],
    );
}

#[test]
fn wrong_files_and_failures_have_their_status() {
    let folder = Folder::new("wrong");
    fs::write(folder.0.join("S.csv"), "nu_rad_per_m,psd\n0.1,1\n0.2,-1\n").unwrap();
    folder.wrong("road fit S.csv -o F.toml", &["S.csv:3: column psd", "found -1"]);
    folder.wrong("road iri S.csv", &["S.csv:1: expected a column x_m", "nu_rad_per_m, psd"]);
    folder.wrong("road analytic S.csv --order 2", &["S.csv:1", "psd"]);
    // of other programs and other jobs
    let utf16 = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    let marked = |text: &str| [vec![0xff, 0xfe], utf16(text)].concat();
    let text = "nu_rad_per_m,psd\n0.1,1\n0.2,1\n";
    for (name, bytes) in [
        ("U.csv", marked(text)),
        ("U.csv", utf16(text)),
        ("U.csv", text.encode_utf16().flat_map(u16::to_be_bytes).collect()),
        ("U.toml", marked("kind = \"iso8608\"")),
    ] {
        fs::write(folder.0.join(name), bytes).unwrap();
        folder
            .wrong(&format!("road fit {name}"), &[&format!("{name}: the file is UTF-16: save it as UTF-8")]);
    }
    folder.wrong("identify U.csv", &["U.csv: the file is UTF-16"]);
    fs::write(folder.0.join("B.csv"), b"PK\x03\x04\x14\x00psd,\xff\x8b".repeat(400)).unwrap();
    let found = "B.csv: expected text, found the byte 0x03 at place 2: a binary file?";
    folder.wrong("road fit B.csv", &[found]);
    let rows = "kind = \"filter\"\na = [[-1.0]]\nb = [[1.0, 0.0]]\nc = [1.0]\n";
    fs::write(folder.0.join("M.toml"), rows).unwrap();
    folder.wrong("road fit M.toml", &["M.toml:3: b: invalid type: sequence", "kind = \"matrix-filter\""]);
    folder
        .wrong("identify S.csv", &["S.csv:1: ", "A RUN.toml is expected", "(data = \"S.csv\")", "simulate"]);
    let out = folder.run("road fit S.csv --order -1");
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(said.contains("'-1' for '--order <N>': expected a whole number above 0"), "{said}");
    fs::write(folder.0.join("H.csv"), "omega_rad_s,psd\n1,1e-7\n2,1e300\n3,1e-7\n").unwrap();
    folder.wrong(
        "road fit H.csv",
        &["H.csv:3: expected densities within a factor of 1e100", "found 1.000e300 beside 1.000e-7"],
    );
    // samples that no filter of order 1 has: it ran, and the answer is no
    let mut text = "omega_rad_s,psd\n".to_owned();
    for k in 1..12 {
        writeln!(text, "{k},{}", if k % 2 == 0 { 1e6 } else { 1e-6 }).unwrap();
    }
    fs::write(folder.0.join("Z.csv"), text).unwrap();
    let out = folder.run("road fit Z.csv --order 1 --proper --json -o F.toml");
    let said: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((out.status.code(), said["status"].as_str()), (Some(1), Some("failed")), "{said}");
    let why = said["why"].as_str().unwrap();
    assert!(why.starts_with("Z.csv: order 1: ") && why.contains("Try a lower or a higher order"), "{why}");
    assert!(!folder.0.join("F.toml").exists());
}

#[test]
fn a_part_of_a_function_gives_the_rest() {
    let folder = Folder::new("analytic");
    let mut text = "theta_rad,real\n".to_owned();
    for k in 0..40 {
        let theta = 0.02 + 0.078 * f64::from(k);
        // Re 1/(z − 0.5) on the circle
        let re = (theta.cos() - 0.5) / (1.25 - theta.cos());
        writeln!(text, "{theta},{re:.17e}").unwrap();
    }
    fs::write(folder.0.join("D.csv"), text).unwrap();
    let found = folder.json("road analytic D.csv --order 1 -o O.csv");
    assert!((found["poles"][0][0].as_f64().unwrap() - 0.5).abs() < 1e-9, "{}", found["poles"]);
    let imag = found["samples"]["imag"].as_array().unwrap();
    let theta = 0.02 + 0.078 * 20.0;
    let known = -f64::sin(theta) / (1.25 - f64::cos(theta));
    assert!((imag[20].as_f64().unwrap() - known).abs() < 1e-9);
    assert!(folder.ok("road analytic D.csv --order 1").contains("rms error"));
    folder.wrong("road analytic D.csv --order 1 --lambda 2", &["lambda", "on the circle already"]);
    folder.wrong("road analytic D.csv --order 30", &["D.csv: order 30"]);
}
