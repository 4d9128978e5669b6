//! `washboard compare` as a user meets it.

#![allow(clippy::unwrap_used)]

use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// A folder of its own with two results in it: `one` of a published car, `two` of the same with stiffer front springs.
struct Results(PathBuf);

impl Results {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("washboard-compare-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).unwrap();
        let results = Results(folder);
        let car = results.run("cases guiggiani-full-car").1;
        let stiff = car.replacen(
            "suspension_stiffness_n_per_m = 15750.0",
            "suspension_stiffness_n_per_m = 18000.0",
            1,
        );
        assert_ne!(car, stiff);
        fs::write(results.0.join("stiff.toml"), stiff).unwrap();
        for (vehicle, seed, to) in [("case:guiggiani-full-car", 0, "one"), ("stiff.toml", 1, "two")] {
            let simulate = format!(
                "simulate {vehicle} --road case:iso8608-c --speed-m-s 20 --duration-s 240 --rate-hz 100 --noise 0.02 \
                 --seed {seed} -o {to}.csv"
            );
            assert_eq!(results.run(&simulate).0, 0);
            let identify = format!("identify {to}.toml --vehicle case:guiggiani-full-car -o {to}");
            assert_eq!(results.run(&identify).0, 0);
        }
        results
    }

    /// Exit status, standard output, standard error.
    fn run(&self, line: &str) -> (i32, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_washboard"));
        let out = command.args(line.split_whitespace()).current_dir(&self.0).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (out.status.code().unwrap(), text(out.stdout), text(out.stderr))
    }

    fn json(&self, line: &str, status: i32) -> Value {
        let (found, out, err) = self.run(&format!("{line} --json"));
        assert_eq!((found, err.as_str()), (status, ""), "{line}");
        serde_json::from_str(&out).unwrap()
    }

    /// Exit status 2, nothing on standard output, one line that has all parts.
    fn wrong(&self, line: &str, parts: &[&str]) {
        let (status, out, err) = self.run(line);
        assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{line}: {err}");
        for part in parts {
            assert!(err.contains(part), "{line}: {err} should have {part:?}");
        }
    }

    /// Writes a copy of `one` with a change, as `changed.json`.
    fn edited(&self, edit: impl FnOnce(&mut Value)) {
        let text = fs::read_to_string(self.0.join("one/result.json")).unwrap();
        let mut result: Value = serde_json::from_str(&text).unwrap();
        edit(&mut result);
        fs::write(self.0.join("changed.json"), result.to_string()).unwrap();
    }

    fn changed(&self, pointer: &str, to: Value) {
        self.edited(|r| *r.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer} is missing")) = to);
    }
}

impl Drop for Results {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_stiffer_spring_is_found_and_nothing_else_is_by_much() {
    let results = Results::new("springs");
    let found = results.json("compare one two/result.json -o difference", 0);
    assert_eq!((found["command"].as_str(), found["comparable"].as_bool()), (Some("compare"), Some(true)));
    assert_eq!(found["inputs"].as_array().unwrap().len(), 2);
    let modes = found["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 7);
    for m in modes {
        assert_eq!((&m["label_before"], &m["matched_by"]), (&m["label_after"], &json!("shape")), "{m}");
    }
    let parameter = |name: &str| {
        found["parameters"]
            .as_array()
            .unwrap()
            .iter()
            .find(|p| p["name"] == name)
            .unwrap_or_else(|| panic!("{name}"))
    };
    let spring = parameter("front.suspension_stiffness_n_per_m");
    let number = |key: &str| spring[key].as_f64().unwrap();
    // the springs' difference is known: 2250 N/m, here to five of its own standard deviations
    assert!(spring["significant"].as_bool().unwrap());
    assert!((number("difference") - 2250.0).abs() < 5.0 * number("difference_sd"), "{spring}");
    // the equations that a difference keeps
    let sd = number("before_sd").hypot(number("after_sd"));
    assert!((number("difference") - (number("after") - number("before"))).abs() < 1e-9);
    assert!((number("difference_sd") / sd - 1.0).abs() < 1e-12);
    // what was written is what was printed, and the page can be made again from it
    let written = fs::read_to_string(results.0.join("difference/result.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&written).unwrap(), found);
    let page = fs::read_to_string(results.0.join("difference/report.html")).unwrap();
    assert_eq!(results.run("report difference").0, 0);
    assert_eq!(fs::read_to_string(results.0.join("difference/report.html")).unwrap(), page);
    assert!(page.contains("front.suspension_stiffness_n_per_m"));
    // the table says it in words; an existing directory needs a word
    let (_, table, _) = results.run("compare one two");
    let line = table.lines().find(|l| l.starts_with("front.suspension_stiffness")).unwrap();
    assert!(line.ends_with("  changed"), "{table}");
    results.wrong("compare one two -o difference", &["difference: the directory is not empty; --overwrite"]);
    assert_eq!(results.run("compare one two -o difference --overwrite").0, 0);
    same_and_unlike(&results);
    refused(&results);
}

/// The same data twice is said; without deviations nothing is significant; what has not converged is no result.
fn same_and_unlike(results: &Results) {
    let flags = |v: &Value| -> Vec<String> {
        v["flags"].as_array().unwrap().iter().map(|f| f["name"].as_str().unwrap().to_owned()).collect()
    };
    let same = results.json("compare one one", 0);
    assert_eq!((flags(&same), same["significant"].as_u64()), (vec!["same-recording".to_owned()], Some(0)));
    // what a classical method gives: modes, and no deviations
    results.edited(|result| {
        for m in result["modes"].as_array_mut().unwrap() {
            (m["freq_sd_hz"], m["damping_sd"]) = (Value::Null, Value::Null);
        }
        (result["method"], result["parameters"]) = (json!("ssi"), json!([]));
        for key in ["road", "coherence", "delay_s"] {
            result[key] = Value::Null;
        }
    });
    let unlike = results.json("compare two changed.json", 0);
    assert_eq!(flags(&unlike), ["methods-differ", "no-deviations"]);
    assert_eq!((unlike["judged"].as_u64(), unlike["significant"].as_u64()), (Some(0), Some(0)));
    for m in unlike["modes"].as_array().unwrap() {
        assert_eq!(m["freq_hz"]["not_judged"], "no standard deviation after");
    }
    results.changed("/converged", json!(false));
    let failed = results.json("compare changed.json two", 1);
    assert_eq!((failed["comparable"].as_bool(), failed["significant"].as_u64()), (Some(false), Some(0)));
    assert!(flags(&failed).contains(&"not-converged".to_owned()));
}

/// Wrong files: the message names the file and the field.
fn refused(results: &Results) {
    results.wrong("compare none two", &["none: cannot read"]);
    results.wrong("compare one .", &["./result.json: cannot read"]);
    results.wrong("compare one stiff.toml", &["stiff.toml:1: expected value"]);
    results.wrong(
        "compare difference two",
        &["difference/result.json: command: expected `identify` or `demo`, found `compare`"],
    );
    for (pointer, to, parts) in [
        ("/schema_version", json!(2), &["schema_version: expected 1, found 2"][..]),
        ("/modes/0/freq_hz", json!(1.5), &["modes[0].freq_hz: expected 1.0", "|pole|/2π, found 1.5"]),
        ("/modes/1/damping", json!(0.5), &["modes[1].damping: expected 0.3", "found 0.5"]),
        ("/modes/2/freq_sd_hz", json!(-0.1), &["modes[2].freq_sd_hz: expected a number ≥ 0, found -0.1"]),
        ("/modes/3/label", json!(7), &["modes[3].label: invalid type", "expected a string"]),
        ("/parameters/0/sd", Value::Null, &["parameters[0].sd: invalid type: null, expected a number"]),
        ("/road/class", json!("A"), &["road.class: expected C for this roughness, found A"]),
        ("/road/roughness_m3", json!(0), &["road.roughness_m3: expected a positive number, found 0"]),
        ("/coherence/mu_sd", json!(-1), &["coherence.mu_sd: expected a number ≥ 0, found -1"]),
        (
            "/spectra/channels/0/measured",
            json!([1.0]),
            &["spectra.channels[0].measured: expected", "values, found 1"],
        ),
        ("/recording", json!([]), &["recording: "]),
    ] {
        results.changed(pointer, to);
        let mut parts = parts.to_vec();
        parts.push("changed.json: ");
        results.wrong("compare one changed.json", &parts);
        results.wrong("compare changed.json two", &parts);
    }
}
