//! `washboard interpolate` as a user meets it.

#![allow(clippy::unwrap_used)]

use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder =
            std::env::temp_dir().join(format!("washboard-interpolate-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).unwrap();
        Folder(folder)
    }

    /// Exit status, standard output, standard error of a data file.
    fn run(&self, data: &Value, more: &str) -> (i32, String, String) {
        fs::write(self.0.join("data.json"), data.to_string()).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_washboard"));
        let line = format!("interpolate data.json {more}");
        let out = command.args(line.split_whitespace()).current_dir(&self.0).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (out.status.code().unwrap(), text(out.stdout), text(out.stderr))
    }

    fn json(&self, data: &Value, status: i32) -> Value {
        let (found, out, err) = self.run(data, "--json");
        assert_eq!(found, status, "{out}{err}");
        serde_json::from_str(&out).unwrap()
    }

    /// Exit status 2, nothing on standard output, one line that has all parts.
    fn wrong(&self, data: &Value, parts: &[&str]) {
        let (status, out, err) = self.run(data, "--json");
        assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{data}: {err}");
        for part in parts {
            assert!(err.contains(part), "{err} should have {part:?}");
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// 1/(z − 1/2) and its derivative at 2, itself at 3.
fn pole() -> Value {
    let derivative = -1.0 / (1.5f64 * 1.5);
    json!({"domain": "disk", "nodes": [
        {"z": [2.0, 0.0], "values": [[[[1.0 / 1.5, 0.0]]], [[[derivative, 0.0]]]]},
        {"z": [3.0, 0.0], "values": [[[[0.4, 0.0]]]]},
    ]})
}

#[test]
fn a_function_is_found_written_and_read_again() {
    let folder = Folder::new("found");
    let found = folder.json(&pole(), 0);
    assert_eq!((found["status"].as_str(), found["order"].as_u64()), (Some("found"), Some(1)));
    assert!((found["a"][0][0].as_f64().unwrap() - 0.5).abs() < 1e-12, "{found}");
    assert!(found["max_error"].as_f64().unwrap() < 1e-12 && found["stable"] == json!(true));
    assert_eq!((found["command"].as_str(), found["schema_version"].as_u64()), (Some("interpolate"), Some(1)));
    assert!(found["singular_values"].as_array().is_some_and(|s| !s.is_empty()));
    let (status, table, _) = folder.run(&pole(), "-o result.json");
    assert_eq!(status, 0);
    assert!(table.contains("order 1, 1 × 1, stable") && table.contains("wrote result.json"), "{table}");
    let written: Value =
        serde_json::from_str(&fs::read_to_string(folder.0.join("result.json")).unwrap()).unwrap();
    assert_eq!(written, found);
    // its own data are not written over
    let (status, _, err) = folder.run(&pole(), "-o data.json");
    assert_eq!(status, 2, "{err}");
    assert!(err.contains("output: expected another file than the data"), "{err}");
}

/// s/(s + 1)² from exact responses, with its zero at 0 and its relative degree 1 as constraints.
#[test]
fn measurements_with_constraints_and_the_half_plane() {
    let folder = Folder::new("measured");
    let measured: Vec<Value> = (1..30)
        .map(|k| {
            let w = 0.2 * f64::from(k);
            // iω/(1 + iω)² = iω(1 − iω)²/(1 + ω²)²
            let size = (1.0 + w * w) * (1.0 + w * w);
            json!({"z": [0.0, w], "value": [[[2.0 * w * w / size, w * (1.0 - w * w) / size]]], "variance": 0.5})
        })
        .collect();
    let zero = json!([[[[0.0, 0.0]]]]);
    let data = json!({"domain": "half-plane", "lambda": 1.0, "order": 2, "measured": measured,
        "constraints": [{"z": "infinity", "values": zero}, {"z": [0.0, 0.0], "values": zero}]});
    let found = folder.json(&data, 0);
    let entry = |m: &str, i: usize, j: usize| found[m][i][j].as_f64().unwrap();
    let trace = entry("a", 0, 0) + entry("a", 1, 1);
    let determinant = entry("a", 0, 0) * entry("a", 1, 1) - entry("a", 0, 1) * entry("a", 1, 0);
    assert!((trace + 2.0).abs() < 1e-9 && (determinant - 1.0).abs() < 1e-9, "{found}");
    assert!(entry("d", 0, 0).abs() < 1e-12 && found["max_error"].as_f64().unwrap() < 1e-12);
    folder.wrong(
        &json!({"domain": "half-plane", "lambda": 1.0, "measured": data["measured"]}),
        &["order: expected"],
    );
}

#[test]
fn answers_that_are_no() {
    let folder = Folder::new("no");
    // two poles do not fit into order 1
    let value = |z: f64| json!([[[1.0 / (z - 0.5) + 1.0 / (z + 0.5), 0.0]]]);
    let nodes: Vec<Value> =
        [1.5, 2.0, 3.0, 4.0, 5.0].iter().map(|z| json!({"z": [z, 0.0], "values": [value(*z)]})).collect();
    let low = folder.json(&json!({"domain": "disk", "nodes": nodes, "order": 1}), 1);
    assert_eq!(low["status"], "not-met");
    assert!(low["why"].as_str().unwrap().contains("misses the data"), "{low}");
    let value = |z: f64| json!([[[1.0 / (z - 1.25), 0.0]]]);
    let nodes: Vec<Value> =
        [1.5, 2.0, 3.0].iter().map(|z| json!({"z": [z, 0.0], "values": [value(*z)]})).collect();
    let unstable = folder.json(&json!({"domain": "disk", "nodes": nodes}), 1);
    assert_eq!((unstable["status"].as_str(), unstable["order"].as_u64()), (Some("not-stable"), Some(1)));
    // Schwarz: 0 at x = 1/2 and 1 at x = 1/4 take (1 − 1/8)/(1/4) = 3.5
    let two = |bound: Value| {
        json!({"domain": "disk", "bound": bound, "nodes": [
            {"z": [2.0, 0.0], "values": [[[[0.0, 0.0]]]]}, {"z": [4.0, 0.0], "values": [[[[1.0, 0.0]]]]}]})
    };
    let least = folder.json(&two(json!("least")), 0);
    assert!((least["bound"][0].as_f64().unwrap() - 3.5).abs() < 1e-9, "{least}");
    let refused = folder.json(&two(json!(3.0)), 1);
    assert_eq!(refused["status"], "failed");
    assert!(
        refused["why"].as_str().unwrap().contains("no stable function through the data is below 3.500000e0"),
        "{refused}"
    );
}

#[test]
fn wrong_files_are_answered_by_field() {
    let folder = Folder::new("wrong");
    folder.wrong(
        &json!({"domain": "strip", "nodes": []}),
        &["data.json", "domain: expected \"disk\" or \"half-plane\""],
    );
    folder.wrong(&json!({"domain": "disk", "nodes": []}), &["nodes: expected 1, found 0"]);
    folder.wrong(
        &json!({"domain": "half-plane", "nodes": []}),
        &["lambda: expected a number above 0 in the half plane", "begin with: \"lambda\": ", "found none"],
    );
    folder.wrong(&json!({"domain": "disk", "points": []}), &["unknown field `points`"]);
    let with = |pointer: &str, to: Value| {
        let mut data = pole();
        *data.pointer_mut(pointer).unwrap() = to;
        data
    };
    folder.wrong(&with("/nodes/1/z", json!([0.1, 0.0])), &["node 1: 0.1 + 0i is 9e-1 inside the unit disk"]);
    folder.wrong(&with("/nodes/1/z", json!([2.0, 0.0])), &["nodes 0 and 1 are one", "differ by"]);
    folder.wrong(&with("/nodes/1/z", json!("inf")), &["nodes[1].z: expected [re, im] or \"infinity\""]);
    folder.wrong(
        &with("/nodes/1/values/0", json!([[[0.4, 0.0], [0.4, 0.0]]])),
        &["node 1", "expected shape (1, 1), found (1, 2)"],
    );
    folder.wrong(
        &with("/nodes/0/values/1", json!([[[0.4, 0.0]], []])),
        &["nodes[0].values[1]: expected rows of 1"],
    );
    folder.wrong(
        &with("/nodes/0/values/1", json!([[[0.4, 0.3]]])),
        &["node 0, derivative 1", "at a real node"],
    );
    let mut few = pole();
    few["nodes"].as_array_mut().unwrap().pop();
    folder.wrong(&few, &["too little data: they show rank 1", "1 more is missing"]);
    let mut both = pole();
    both["measured"] = json!([{"z": [1.0, 0.0], "value": [[[1.0, 0.0]]]}]);
    folder.wrong(&both, &["nodes: expected none beside measured values"]);
}
