//! A spectrum of a vehicle's road inputs as a user brings it: fit, ride, design; and one message for what is wrong.

#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("washboard-points-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        Folder(dir)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap()
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

    /// Status 2, nothing on standard output, one line with all parts.
    fn wrong(&self, line: &str, parts: &[&str]) {
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
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// 2 × 2: |G|² of g/((s + 2)(s + 30)) in both, and a share of the one in the other.
fn two_tracks() -> String {
    let mut text = "omega_rad_s,psd_11,psd_12_re,psd_12_im,psd_22\n".to_owned();
    for k in 0..80 {
        let w = 0.2 * 1000f64.powf(f64::from(k) / 79.0);
        let s = 1.0 / ((w * w + 4.0) * (w * w + 900.0));
        writeln!(text, "{w},{:e},{:e},0,{:e}", s, 0.6 * s, s).unwrap();
    }
    text
}

const DESIGN: &str = "vehicle = \"case:turkay-half-car\"\nroad = \"F.toml\"\nspeed_m_s = 20.0\nmeasurements = [\"suspension_travel\"]\n\
    method = \"lqg\"\ndisturbance = \"road-noise\"\ninput_weight = 1e-7\n[goal]\nminimize = { heave_acceleration = 1.0, pitch_acceleration = 1.0 }\n\
    [lqg]\nsensor_noise = 1e-8\n";

#[test]
fn a_matrix_spectrum_goes_all_the_way() {
    let folder = Folder::new("way");
    folder.write("S.csv", &two_tracks());
    let fit = folder.json("road fit S.csv --points rear,front -o F.toml");
    assert_eq!((fit["order"].as_u64(), fit["c"].as_array().unwrap().len()), (Some(4), 2));
    assert_eq!(fit["points"], serde_json::json!(["rear", "front"]));
    let text = folder.read("F.toml");
    assert!(text.starts_with("# washboard road fit S.csv\n# order 4, fitted from"), "{text}");
    assert!(
        text.contains("kind = \"matrix-filter\"") && text.contains("fitted_band_rad = [0.2, 200"),
        "{text}"
    );
    // at another speed nothing changes but the note's number, and the car has no delay of its own
    let at = |v: u32| folder.json(&format!("ride case:turkay-half-car --road F.toml --speed-m-s {v}"));
    let (slow, fast) = (at(10), at(30));
    assert_eq!(slow["rms"], fast["rms"]);
    assert!(slow["rms"]["heave_acceleration"].as_f64().unwrap() > 0.0);
    assert_eq!(slow["notes"][0]["name"], "own-speed");
    assert!(slow["beyond_band"]["share"]["heave_acceleration"].as_f64().unwrap() < 0.05);
    let said = folder.ok("ride case:turkay-half-car --road F.toml --speed-m-s 10");
    assert!(said.contains("note: F.toml is over time, of the speed at which its data was taken"), "{said}");

    folder.write("D.toml", DESIGN);
    let designed = folder.json("design D.toml -o D");
    assert_eq!(designed["status"], "designed", "{}", designed["why"]);
    let (passive, active) = (&designed["passive"]["rms"], &designed["verified"]["rms"]);
    let number = |v: &Value| v["heave_acceleration"].as_f64().unwrap();
    assert!(number(active) < 0.9 * number(passive));
    // the passive rms of the design is the ride's, and so is the loop's
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
    close(number(passive), number(&slow["rms"]));
    let loop_ = folder.json("ride case:turkay-half-car --road F.toml --speed-m-s 20 --controller D");
    close(number(active), number(&loop_["rms"]));
    assert_eq!(designed["notes"][0]["name"], "own-speed");
    // and so is what of it no data says
    for (measured, ridden) in [("passive", &slow), ("verified", &loop_)] {
        let shares = designed[measured]["beyond_band"]["share"].as_object().unwrap();
        assert!(shares.len() > 2, "{measured}");
        for (name, share) in shares {
            let of_ride = ridden["beyond_band"]["share"][name].as_f64().unwrap();
            assert!((share.as_f64().unwrap() - of_ride).abs() < 1e-6, "{measured} {name}: {share} {of_ride}");
        }
    }
    let notes = designed["notes"].as_array().unwrap();
    let beyond: Vec<&str> =
        notes.iter().filter(|n| n["name"] == "beyond-band").filter_map(|n| n["text"].as_str()).collect();
    for (whose, measured) in
        [("variance, passive, that", "passive"), ("variance, designed, that", "verified")]
    {
        let shares = designed[measured]["beyond_band"]["share"].as_object().unwrap();
        let large = shares.values().any(|s| s.as_f64().unwrap() > 0.05);
        assert_eq!(beyond.iter().any(|text| text.contains(whose)), large, "{beyond:?}");
    }
    println!("{beyond:?}");
}

#[test]
fn wrong_filters_are_answered_with_file_field_expected_and_found() {
    let folder = Folder::new("wrong");
    folder.write("S.csv", &two_tracks());
    folder.ok("road fit S.csv --order 4 -o F.toml");
    let ride = |vehicle: &str, file: &str| format!("ride case:{vehicle} --road {file} --speed-m-s 20");
    // sizes, both numbers
    folder.wrong(
        &ride("turkay-truck-cabin", "F.toml"),
        &[
            "F.toml: points: expected as many points as the vehicle has road inputs",
            "found 2 points, 4 road inputs",
        ],
    );
    folder.wrong(&ride("turkay-quarter-car", "F.toml"), &["F.toml", "found 2 points, 1 road inputs (wheel)"]);
    folder.write("D.toml", &DESIGN.replace("turkay-half-car", "guiggiani-full-car"));
    folder.wrong("design D.toml", &["F.toml: points: expected", "found 2 points, 4 road inputs"]);
    // names
    folder.ok("road fit S.csv --order 4 --points left,right -o N.toml");
    folder.wrong(&ride("turkay-half-car", "N.toml"), &["N.toml: points: expected the vehicle's road inputs, found left, right; the vehicle has front, rear"]);
    for (names, hint) in [
        ("chassis_front_left,rear", "(chassis_… are the points of a truck cabin, and this vehicle is none)"),
        ("frnt,rear", "(`frnt`: did you mean `front`?)"),
    ] {
        folder.ok(&format!("road fit S.csv --order 4 --points {names} -o N.toml --overwrite"));
        folder.wrong(&ride("turkay-half-car", "N.toml"), &["the vehicle has front, rear", hint]);
    }
    folder.wrong("road fit S.csv --points a,b,c -o X.toml", &["points: expected 2 names", "found 3 names"]);
    folder.wrong(
        "road fit S.csv --points a,a -o X.toml",
        &["points: expected every name once, found `a` twice"],
    );
    folder.wrong("road fit case:iso8608-c --points a -o X.toml", &["points: expected none"]);
    folder.wrong("road fit S.csv --roll-off-order 3", &["roll_off_order: expected 1 or 2, found 3"]);
    // contents
    let whole = folder.read("F.toml");
    let a = whole.lines().find(|l| l.starts_with("a = [[")).unwrap().to_owned();
    let first = a["a = [[".len()..].split(',').next().unwrap().to_owned();
    for (to, parts) in [
        (
            whole.replace(&a, &a.replacen(&first, "nan", 1)),
            ["F2.toml: a: expected", "finite", "found NaN in row 1"],
        ),
        (
            whole.replace(&a, &a.replacen(&first, "1e6", 1)),
            ["F2.toml: a: expected a stable filter", "negative real part", "found a pole with real part"],
        ),
        (
            whole.replace(&a, &a.replacen(&format!("{first}, "), "", 1)),
            ["F2.toml: a: expected a square matrix", "found", "in row 1 where"],
        ),
        (
            whole.replace("\nc = [", "\nc = [[1.0], "),
            ["F2.toml: c: expected rows as long as a", "found 1 numbers", "in row 1 where"],
        ),
        (whole.replace("of = \"displacement\"\n", ""), ["F2.toml", "missing field", "`of`"]),
        (
            whole.replace("matrix-filter", "matrix-fliter"),
            ["F2.toml", ":3:", "did you mean `matrix-filter`?"],
        ),
        (
            whole.replace("fitted_band_rad = [0.2", "fitted_band_rad = [1e9"),
            ["F2.toml", "fitted_band_rad: expected two ascending", "found [1000000000"],
        ),
    ] {
        assert_ne!(to, whole, "{parts:?}");
        folder.write("F2.toml", &to);
        folder.wrong(&ride("turkay-half-car", "F2.toml"), &parts);
    }
    folder.wrong(&ride("turkay-half-car", "missing.toml"), &["missing.toml"]);
    // jobs for tracks
    for line in [
        "simulate case:turkay-half-car --road F.toml --speed-m-s 20 --duration-s 5 --rate-hz 100 -o R.csv",
        "road profile F.toml --length-m 100 --step-m 0.5 -o P.csv",
        "road fit F.toml --order 2",
    ] {
        folder.wrong(line, &["F.toml: kind: expected a road of tracks", "found a matrix-filter of 2 points"]);
    }
}
