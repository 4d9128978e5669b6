//! `washboard demo` as a user meets it: from a drive to controllers that the true car judges.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, number};
use serde_json::Value;
use std::fs;

/// Apart by more than this, rms of the body's acceleration says that what the drive showed is no car to design for. The matrix
/// inequalities have one optimum: parameters and road that are within .5 % of the truth moved it by .30 and .24 % (seeds 0 and 3). The search of
/// fixed order is local; to its end it came .13 and .41 % apart.
const LMI_APART: f64 = 0.01;
const FIXED_ORDER_APART: f64 = 0.02;
/// What the controllers buy at least, of the passive rms.
const BOUGHT: [f64; 2] = [0.35, 0.18];

#[test]
fn a_drive_leads_to_controllers_as_good_as_those_that_know_the_truth() {
    let folder = Folder::new("demo");
    let twice = std::thread::scope(|both| {
        let runs = ["one", "two"].map(|dir| {
            both.spawn({
                let f = &folder;
                move || f.run(&format!("demo -o {dir}"))
            })
        });
        runs.map(|run| run.join().unwrap())
    });
    for (status, out, err) in &twice {
        assert_eq!((*status, err.as_str()), (0, ""));
        assert!(out.contains("on identified") && out.contains("\ntime "), "{out}");
    }
    // the same seed, the same bytes
    let read = |path: &str| fs::read(folder.0.join(path)).unwrap();
    let files = [
        "result.json",
        "report.html",
        "demo.svg",
        "vehicle.toml",
        "road.toml",
        "filter.toml",
        "lmi.toml",
        "lmi-controller.json",
        "fixed-order.toml",
        "fixed-order-controller.json",
    ];
    for file in files {
        assert!(read(&format!("one/{file}")) == read(&format!("two/{file}")), "{file}");
    }
    let mut entries = fs::read_dir(folder.0.join("one")).unwrap();
    assert_eq!(entries.by_ref().count(), files.len());

    let result: Value = serde_json::from_slice(&read("one/result.json")).unwrap();
    // the keys of an identification stand where they stood
    assert_eq!((result["converged"].as_bool(), result["command"].as_str()), (Some(true), Some("demo")));
    assert_eq!(
        (result["modes"].as_array().unwrap().len(), result["truth"]["modes"].as_array().unwrap().len()),
        (7, 7)
    );
    let designs = &result["designs"];
    assert!(number(designs, &["filter", "log10_rms_error"]) < 0.02);
    let goal = |ride: &Value| number(ride, &["rms", "body_acceleration"]);
    let passive = goal(&designs["passive"]);
    for (k, (name, apart)) in [("lmi", LMI_APART), ("fixed-order", FIXED_ORDER_APART)].into_iter().enumerate()
    {
        let method = &designs["methods"][k];
        assert_eq!(method["name"], name);
        let (a, b) = (goal(&method["on_identified"]["ride"]), goal(&method["on_true"]["ride"]));
        assert!((a / b - 1.0).abs() < apart, "{name}: {a} {b}");
        assert!((number(method, &["difference", "body_acceleration"]) - (a / b - 1.0)).abs() < 1e-12);
        assert!(a < (1.0 - BOUGHT[k]) * passive, "{name}: {a} of {passive}");

        // `ride` with the file that was written says the same, by itself
        let line = format!(
            "ride case:guiggiani-full-car --road case:iso8608-c --speed-m-s 20 --controller one/{name}-controller.json --json"
        );
        let (status, out, err) = folder.run(&line);
        assert_eq!((status, err.as_str()), (0, ""));
        let ridden: Value = serde_json::from_str(&out).unwrap();
        assert!((goal(&ridden) / a - 1.0).abs() < 1e-9, "{name}: {} {a}", goal(&ridden));
    }

    // README's picture is what a demo draws
    let drawn = String::from_utf8(read("one/demo.svg")).unwrap();
    same_picture(include_str!("../../../docs/demo.svg"), &drawn);

    // what the shown controllers cost is said in words, in the page and in print
    let story = String::from_utf8(read("one/report.html")).unwrap();
    let printed = twice[0].1.split_whitespace().collect::<Vec<_>>().join(" ");
    for k in 0..2 {
        let warnings = designs["methods"][k]["on_identified"]["warnings"].as_array().unwrap();
        assert!(!warnings.is_empty());
        for w in warnings {
            let (name, text) = (w["name"].as_str().unwrap(), w["text"].as_str().unwrap());
            let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(printed.contains(&format!("{words} ({name})")), "{name}: {printed}");
            assert!(story.contains(&format!("<code>{name}</code>")), "{name}");
        }
    }
    assert!(!story.contains("Converged, without warnings"), "the designs have some");
    // the bound that the true car exceeds: by the delay that the design approximates, and not by what was identified
    let bound = &designs["methods"][0]["on_identified"]["bounds"][1];
    assert_eq!((bound["name"].as_str(), bound["bound"].as_f64()), (Some("tire_deflection"), Some(1.1)));
    assert!(number(bound, &["kept"]) <= 1.1 * (1.0 + 1e-6), "{bound}");
    let share = |ride: &Value| {
        number(ride, &["rms", "tire_deflection"]) / number(&designs["passive"], &["rms", "tire_deflection"])
    };
    let found = share(&designs["methods"][0]["on_identified"]["ride"]);
    assert!(
        found > 1.105 && (found / number(bound, &["with_exact_delay"]) - 1.0).abs() < 0.005,
        "{found} {bound}"
    );
    assert!(printed.contains("the approximation of the delay is what the bound misses"), "{printed}");

    // the page again from the result, and the result as one of an identification
    let page = read("one/report.html");
    fs::remove_file(folder.0.join("one/report.html")).unwrap();
    assert_eq!(folder.run("report one").0, 0);
    assert!(read("one/report.html") == page);
    assert_eq!(folder.run("compare one two").0, 0);
    // a demo is replaced, whole
    assert_eq!(folder.run("demo -o one").0, 2);
}

/// Numbers of a picture may differ so much, in its units. The search of fixed order is local: from six models of one car with other
/// roundings it ended within .5 % of the goal, which is one unit of a bar, at poles that move the spectrum below 1 Hz by more.
const PICTURED: f64 = 3.0;

/// The same text but for numbers.
fn same_picture(kept: &str, made: &str) {
    let parts = |svg: &str| -> Vec<String> {
        let cut = |c: char| !(c.is_ascii_digit() || c == '.' || c == '-');
        svg.split_inclusive(cut).map(str::to_owned).collect()
    };
    let (a, b) = (parts(kept), parts(made));
    assert_eq!(a.len(), b.len(), "docs/demo.svg is of another picture: `washboard demo` makes it");
    for (a, b) in a.iter().zip(&b) {
        let number = |s: &str| s.trim_end_matches(|c: char| !c.is_ascii_digit()).parse::<f64>();
        let same = match (number(a), number(b)) {
            (Ok(x), Ok(y)) => (x - y).abs() <= PICTURED,
            _ => a == b,
        };
        assert!(same, "docs/demo.svg is out of date, `washboard demo` makes it: {a} {b}");
    }
}

#[test]
fn the_design_files_beside_the_page_are_designs() {
    // one iteration of the search: the file is read, and its vehicle and road are those beside it
    let folder = Folder::new("further");
    let (status, car, _) = folder.run("cases guiggiani-full-car");
    assert_eq!(status, 0);
    fs::write(folder.0.join("vehicle.toml"), car).unwrap();
    let filter = "kind = \"filter\"\nb = [1.0]\na = [[-0.02]]\nc = [0.0071]\nd = 0.0\nof = \"displacement\"\nvariable = \"distance\"\n\
                  [coherence]\nkind = \"none\"\n";
    fs::write(folder.0.join("filter.toml"), filter).unwrap();
    let text = include_str!("../../washboard/assets/demo/fixed-order.toml")
        .replace("iterations = 1000", "iterations = 1");
    fs::write(folder.0.join("fixed-order.toml"), text).unwrap();
    let (status, out, err) = folder.run("design fixed-order.toml --json");
    assert!(status <= 1 && err.is_empty(), "{err}");
    let made: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(made["design"]["goal"]["bound_h2"]["suspension_travel"], 1.1);
}
