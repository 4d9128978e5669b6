//! `washboard sweep` and `merge` as a user meets them: whatever ends a run, and however it is divided, the files are the same.

#![allow(clippy::unwrap_used, clippy::print_stderr, clippy::print_stdout)]

mod common;

use common::Folder;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

const HEAD: &str = r#"vehicle = "case:turkay-quarter-car"
road = "case:turkay-white-velocity"
speed_m_s = 20.0
measurements = ["suspension_travel"]
"#;
const LQG: &str = r#"method = "lqg"
[goal]
minimize = { sprung_acceleration = 1.0, suspension_travel = 1.0, tire_deflection = 1.0 }
"#;
const FIXED: &str = r#"method = "fixed-order"
[goal]
minimize = { sprung_acceleration = 1.0 }
bound = { suspension_travel = 1.0, tire_deflection = 1.0 }
order = 1
[fixed-order]
tries = 2
iterations = 60
"#;

fn write(folder: &Folder, name: &str, parts: &[&str]) {
    fs::write(folder.0.join(name), parts.concat()).unwrap();
}

/// Every file of a directory with its bytes.
fn files(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(dir).unwrap().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            all.extend(files(&entry.path()).into_iter().map(|(n, b)| (format!("{name}/{n}"), b)));
        } else {
            all.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    all
}

fn same(folder: &Folder, one: &str, other: &str) {
    let (a, b) = (files(&folder.0.join(one)), files(&folder.0.join(other)));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{one} and {other}");
    for (name, bytes) in &a {
        assert!(*bytes == b[name], "{name} differs between {one} and {other}");
    }
}

fn result(folder: &Folder, dir: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.0.join(dir).join("result.json")).unwrap()).unwrap()
}

fn wrong(folder: &Folder, line: &str, said: &[&str]) {
    let (status, out, err) = folder.run(line);
    assert_eq!((status, out.as_str()), (2, ""), "{line}: {err}");
    for s in said {
        assert!(err.contains(s), "{line}: expected {s:?} in {err}");
    }
}

#[test]
fn a_grid_of_designs_has_the_numbers_of_each_design() {
    let folder = Folder::new("numbers");
    let grid = "[grid]\n\"goal.minimize.suspension_travel\" = { from = 0.1, to = 10.0, steps = 3, scale = \"log\" }\n\
                override.tire_damping_n_s_per_m = [0, 49.0, 98.0]\n";
    write(&folder, "sweep.toml", &[HEAD, LQG, grid]);
    let (status, out, err) = folder.run("sweep sweep.toml -o made");
    assert_eq!(status, 0, "{err}");
    assert!(out.contains("9 points: 9 designed") && out.contains("acceleration"), "{out}");
    // what the per cent are of
    assert!(out.contains("rms, to") && out.contains("passive, %"), "{out}");
    let made = result(&folder, "made");
    assert_eq!((made["command"].as_str(), made["points"].as_array().unwrap().len()), (Some("sweep"), 9));
    assert_eq!(made["goal"], "weighted H2 norms, squared and summed");
    assert_eq!(made["inputs"][0]["path"], "sweep.toml");
    assert_eq!(made["inputs"].as_array().unwrap().len(), 3);
    // the last axis varies fastest
    let point = &made["points"][5];
    assert_eq!(
        (point["at"]["override.tire_damping_n_s_per_m"].as_f64(), point["index"].as_u64()),
        (Some(98.0), Some(5))
    );
    // the notes' number of this design (weight 1, c_t = 98), and the design by itself
    assert!((point["rms"]["sprung_acceleration"].as_f64().unwrap() - 0.48951).abs() < 1e-5);
    let alone = folder.designed(&[HEAD, "override = { tire_damping_n_s_per_m = 98.0 }\n", LQG].concat());
    assert_eq!(point["rms"], alone["verified"]["rms"]);
    assert_eq!(point["hinf"], alone["verified"]["hinf"]);
    assert_eq!(point["objective"], alone["objective"]);
    let ratio = |k: &str, w: &str| alone[k]["rms"][w].as_f64().unwrap();
    let expected = ratio("verified", "suspension_travel") / ratio("passive", "suspension_travel");
    assert_eq!(point["rms_relative"]["suspension_travel"].as_f64(), Some(expected));
    // a point's file is a design's result, and so a controller
    let file: Value =
        serde_json::from_str(&fs::read_to_string(folder.0.join("made/points/0005.json")).unwrap()).unwrap();
    for key in ["controller", "verified", "passive", "gains", "status"] {
        assert_eq!(file[key], alone[key], "{key}");
    }
    // a point is not looked at for what a design by itself is: 5 % of its numbers, an actuator, peaks, hidden modes and what is
    // felt of it
    let beside = ["peak", "fragile", "actuator", "hidden-mode", "felt-more"];
    let own: Vec<&Value> = alone["warnings"].as_array().unwrap().iter().collect();
    let own: Vec<&Value> =
        own.into_iter().filter(|w| !beside.contains(&w["name"].as_str().unwrap())).collect();
    assert_eq!(file["warnings"].as_array().unwrap().iter().collect::<Vec<_>>(), own);
    let ride = "ride case:turkay-quarter-car --road case:turkay-white-velocity --speed-m-s 20 --controller made/points/0003.json";
    assert_eq!(folder.run(ride).0, 0);
    let table = fs::read_to_string(folder.0.join("made/table.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 10);
    assert!(lines[0].starts_with("index,goal.minimize.suspension_travel,override.tire_damping_n_s_per_m,status,why,order,objective_passive,objective_verified,objective_limit,rms_"), "{}", lines[0]);
    assert!(
        lines[6].starts_with("5,1.0,98,designed,,4,3,") || lines[6].starts_with("5,1,98,designed,,4,3,"),
        "{}",
        lines[6]
    );
    // again: nothing to do, and the same files; the page again from them
    let before = files(&folder.0.join("made"));
    assert_eq!(folder.run("sweep sweep.toml -o made").0, 0);
    assert_eq!(folder.run("report made").0, 0);
    assert!(files(&folder.0.join("made")) == before);
    let page = fs::read_to_string(folder.0.join("made/report.html")).unwrap();
    // three trade-offs, the goal and three outputs along the grid, all points; and nothing is fetched
    assert_eq!(page.matches("<svg viewBox").count(), 8);
    assert!(!page.contains("src=") && !page.contains("<link") && !page.contains("@import"));
}

#[test]
fn what_is_no_key_of_a_design_is_said_before_anything_is_computed() {
    let folder = Folder::new("keys");
    for (grid, said) in [
        ("\"goal.ordr\" = [1]", &["goal.ordr", "did you mean `order`"][..]),
        ("\"speed_ms\" = [1]", &["speed_ms", "did you mean `speed_m_s`"]),
        ("\"lqg.sensor_noise.x\" = [1]", &["lqg.sensor_noise.x"]),
        (
            "\"override.tyre_damping_n_s_per_m\" = [1]",
            &["tyre_damping_n_s_per_m", "did you mean `tire_damping_n_s_per_m`"],
        ),
        (
            "\"goal.minimize.suspension_travl\" = [1]",
            &["suspension_travl", "did you mean `suspension_travel`"],
        ),
        ("speed_m_s = [\"fast\"]", &["speed_m_s", "expected a number"]),
        ("speed_m_s = { from = 1.0, to = 2.0, step = 3 }", &["grid.speed_m_s", "did you mean `steps`"]),
        ("speed_m_s = 3.0", &["grid.speed_m_s", "expected a list, or { from, to, steps }"]),
        ("method = [\"lqr\"]", &["method", "did you mean `lqg`"]),
        ("vehicle = [\"car.toml\"]", &["car.toml"]),
    ] {
        write(&folder, "sweep.toml", &[HEAD, LQG, "[grid]\n", grid]);
        wrong(&folder, "sweep sweep.toml -o made", said);
        assert!(!folder.0.join("made").exists(), "{grid}");
    }
    write(&folder, "sweep.toml", &[HEAD, LQG]);
    wrong(&folder, "sweep sweep.toml -o made", &["sweep.toml", "[grid]"]);
    write(&folder, "sweep.toml", &["sped_m_s = 3\n", HEAD, LQG, "[grid]\nspeed_m_s = [1, 2]\n"]);
    wrong(&folder, "sweep sweep.toml -o made", &["sped_m_s", "did you mean `speed_m_s`"]);
    write(&folder, "sweep.toml", &[HEAD, LQG, "[grid]\nspeed_m_s = [1, 2]\n[sweep]\nwarm_start = true\n"]);
    wrong(&folder, "sweep sweep.toml -o made", &["sweep.warm_start", "fixed-order"]);
    write(&folder, "sweep.toml", &[HEAD, LQG, "[grid]\nspeed_m_s = [1, 2]\n[sweep]\nwarm_strt = true\n"]);
    wrong(&folder, "sweep sweep.toml -o made", &["did you mean `warm_start`"]);
    for shard in ["0/2", "3/2", "x"] {
        wrong(&folder, &format!("sweep sweep.toml -o made --shard {shard}"), &["1/N to N/N"]);
    }
    wrong(&folder, "sweep sweep.toml -o made --jobs 0", &["--jobs"]);
}

#[test]
fn points_that_fail_are_rows_with_their_reason() {
    let folder = Folder::new("failed");
    let grid =
        "[grid]\n\"goal.bound.tire_deflection\" = [0.001, 1.0]\n\"override.sprung_mass_kg\" = [240, -1]\n";
    write(&folder, "sweep.toml", &[HEAD, FIXED, grid]);
    let (status, _, err) = folder.run("sweep sweep.toml -o made");
    assert_eq!(status, 0, "{err}");
    let made = result(&folder, "made");
    let of = |k: usize| {
        (made["points"][k]["status"].as_str().unwrap(), made["points"][k]["why"].as_str().unwrap_or(""))
    };
    assert_eq!(of(0).0, "infeasible");
    assert!(!of(0).1.is_empty());
    assert_eq!((of(1).0, of(3).0), ("wrong-input", "wrong-input"));
    assert!(of(1).1.contains("sprung_mass_kg"), "{}", of(1).1);
    assert_eq!(of(2).0, "designed");
    // what no controller of any order beats, in result, table and page
    let file: Value =
        serde_json::from_str(&fs::read_to_string(folder.0.join("made/points/0002.json")).unwrap()).unwrap();
    let bound = &made["points"][2]["lower_bound"];
    assert!(bound.is_f64() && *bound == file["fixed_order"]["lower_bound"], "{bound}");
    let table = fs::read_to_string(folder.0.join("made/table.csv")).unwrap();
    assert!(table.lines().next().unwrap().contains(",objective_limit,lower_bound,rms_"), "{table}");
    assert!(fs::read_to_string(folder.0.join("made/report.html")).unwrap().contains("none below"));
    assert_eq!(
        (made["counts"]["wrong-input"].as_u64(), made["counts"]["designed"].as_u64()),
        (Some(2), Some(1))
    );
    // none of them has what was asked
    write(&folder, "none.toml", &[HEAD, LQG, "[grid]\n\"override.sprung_mass_kg\" = [-2, -1]\n"]);
    let (status, out, _) = folder.run("sweep none.toml -o none --json");
    let out: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((status, out["counts"]["wrong-input"].as_u64()), (1, Some(2)));
    assert!(folder.0.join("none/report.html").is_file());
}

#[test]
fn another_sweep_is_refused_in_the_same_place() {
    let folder = Folder::new("another");
    write(&folder, "car.toml", &[&folder.run("cases turkay-quarter-car").1]);
    let head = HEAD.replace("case:turkay-quarter-car", "car.toml");
    write(&folder, "sweep.toml", &[&head, LQG, "[grid]\nspeed_m_s = [10.0, 20.0]\n"]);
    assert_eq!(folder.run("sweep sweep.toml -o made").0, 0);
    // a remark changes no point
    write(&folder, "sweep.toml", &["# again\n", &head, LQG, "[grid]\nspeed_m_s = [10.0, 20.0]\n"]);
    assert_eq!(folder.run("sweep sweep.toml -o made").0, 0);
    write(&folder, "sweep.toml", &[&head, LQG, "[grid]\nspeed_m_s = [10.0, 30.0]\n"]);
    wrong(
        &folder,
        "sweep sweep.toml -o made",
        &["grid.speed_m_s: was [10.0,20.0], is [10.0,30.0]", "--overwrite"],
    );
    write(
        &folder,
        "sweep.toml",
        &[
            &head,
            &LQG.replace("acceleration = 1.0", "acceleration = 2.0"),
            "[grid]\nspeed_m_s = [10.0, 20.0]\n",
        ],
    );
    wrong(&folder, "sweep sweep.toml -o made", &["goal.minimize.sprung_acceleration: was 1.0, is 2.0"]);
    write(&folder, "sweep.toml", &[&head, LQG, "[grid]\nspeed_m_s = [10.0, 20.0]\n"]);
    let car = fs::read_to_string(folder.0.join("car.toml")).unwrap();
    fs::write(folder.0.join("car.toml"), car.replace("240.0", "241.0")).unwrap();
    wrong(&folder, "sweep sweep.toml -o made", &["sha256 of.car.toml"]);
    assert_eq!(folder.run("sweep sweep.toml -o made --overwrite").0, 0);
    // a point that was edited, and somebody's own file
    let point = folder.0.join("made/points/0001.json");
    fs::write(&point, fs::read_to_string(&point).unwrap().replace("\"index\": 1", "\"index\": 0")).unwrap();
    wrong(&folder, "sweep sweep.toml -o made", &["0001.json", "expected point 1"]);
    // a number that nothing beside it contradicts
    let text = fs::read_to_string(&point).unwrap().replace("\"index\": 0", "\"index\": 1");
    let objective = text.find("\"objective\": {").unwrap();
    let from = objective + text[objective..].find("\"verified\": ").unwrap() + 12;
    let to = from + text[from..].find(['\n', ',', '}']).unwrap();
    fs::write(&point, format!("{} 0.5{}", &text[..from], &text[to..])).unwrap();
    wrong(&folder, "sweep sweep.toml -o made", &["0001.json", "edited", "delete it"]);
    fs::write(folder.0.join("made/mine.txt"), "x").unwrap();
    wrong(&folder, "sweep sweep.toml -o made --overwrite", &["mine.txt"]);
    assert!(folder.0.join("made/mine.txt").is_file());
    fs::create_dir(folder.0.join("other")).unwrap();
    fs::write(folder.0.join("other/result.json"), "{}").unwrap();
    wrong(&folder, "sweep sweep.toml -o other", &["not empty"]);
}

#[test]
fn shards_put_together_are_the_whole() {
    let folder = Folder::new("shards");
    let grid = "[grid]\nspeed_m_s = [10.0, 20.0, 30.0]\n\"override.tire_damping_n_s_per_m\" = [0.0, 50.0]\n";
    write(&folder, "sweep.toml", &[HEAD, FIXED, grid]);
    assert_eq!(folder.run("sweep sweep.toml -o whole --jobs 1").0, 0);
    for k in 1..=2 {
        let (status, out, err) = folder.run(&format!("sweep sweep.toml -o part{k} --shard {k}/2 --jobs 2"));
        assert_eq!(status, 0, "{err}");
        assert!(out.contains("not in part"), "{out}");
        assert!(!folder.0.join(format!("part{k}/result.json")).exists());
    }
    // rows along the last axis stay together: points 0, 1 and 4, 5 in the first part
    assert_eq!(files(&folder.0.join("part2/points")).keys().collect::<Vec<_>>(), ["0002.json", "0003.json"]);
    assert_eq!(folder.run("merge part1 part2 -o merged").0, 0);
    same(&folder, "whole", "merged");
    // the parts may as well be computed in one place
    assert_eq!(folder.run("sweep sweep.toml -o part1 --shard 2/2").0, 0);
    same(&folder, "whole", "part1");
    let (status, out, _) = folder.run("merge part1 part2 -o twice");
    assert!(status == 0 && out.contains("in several directories, alike to the last byte: 2, 3"), "{out}");
    same(&folder, "whole", "twice");
    wrong(&folder, "merge part1 part2 -o twice", &["not empty"]);
    // what is missing, what contradicts, what is of another sweep
    let (status, out, _) = folder.run("merge part2 -o less --json");
    let out: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((status, out["missing"].to_string().as_str()), (1, "[0,1,4,5]"));
    assert!(!folder.0.join("less").exists());
    let (status, out, _) = folder.run("merge part2 -o less");
    assert!(status == 1 && out.contains("missing 4 of 6 points: 0, 1, 4, 5"), "{out}");
    let point = folder.0.join("part2/points/0003.json");
    let text = fs::read_to_string(&point).unwrap();
    fs::write(&point, text.replacen("\"delay_order\": 4", "\"delay_order\": 5", 1)).unwrap();
    wrong(&folder, "merge part1 part2 -o less", &["0003.json", "edited"]);
    fs::write(&point, text + "\n").unwrap();
    wrong(&folder, "merge part1 part2 -o less", &["differ", "directory's: 3 ("]);
    write(&folder, "sweep.toml", &[HEAD, LQG, grid]);
    assert_eq!(folder.run("sweep sweep.toml -o lqg").0, 0);
    wrong(&folder, "merge whole lqg -o less", &["another sweep", "method: was \"fixed-order\", is \"lqg\""]);
}

#[test]
fn a_neighbour_is_one_more_start_unless_told() {
    let folder = Folder::new("warm");
    let grid = "[grid]\n\"override.tire_damping_n_s_per_m\" = [0.0, 50.0, 98.0]\n";
    write(&folder, "warm.toml", &[HEAD, FIXED, grid]);
    write(&folder, "cold.toml", &[HEAD, FIXED, grid, "[sweep]\nwarm_start = false\n"]);
    assert_eq!((folder.run("sweep warm.toml -o warm").0, folder.run("sweep cold.toml -o cold").0), (0, 0));
    let starts = |dir: &str, k: usize| -> (Value, u64) {
        let text = fs::read_to_string(folder.0.join(dir).join(format!("points/000{k}.json"))).unwrap();
        let point: Value = serde_json::from_str(&text).unwrap();
        (point["point"]["started_from"].clone(), point["fixed_order"]["starts"].as_u64().unwrap())
    };
    for k in 0..3 {
        assert_eq!(starts("cold", k).0, Value::Null);
        let from = if k == 0 { Value::Null } else { Value::from(k - 1) };
        assert_eq!(starts("warm", k).0, from);
        let more = starts("warm", k).1 - starts("cold", k).1;
        assert_eq!(more > 0, k > 0, "point {k}: {more} more starts");
    }
}

/// Numbers that are the same in every run (Knuth's multiplier).
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) as f64 / (1u64 << 31) as f64
}

#[test]
fn a_run_that_is_killed_ten_times_ends_with_the_files_of_one_that_is_not() {
    let folder = Folder::new("killed");
    let grid = "[grid]\n\"goal.order\" = [0, 1]\nspeed_m_s = [10.0, 20.0, 30.0]\n\
                \"override.tire_damping_n_s_per_m\" = { from = 0, to = 100, steps = 5 }\n";
    write(&folder, "sweep.toml", &[HEAD, FIXED, grid]);
    let begun = std::time::Instant::now();
    assert_eq!(folder.run("sweep sweep.toml -o whole").0, 0);
    let whole = begun.elapsed();
    let mut seed = 5;
    let is_point = |e: &fs::DirEntry| !e.file_name().to_string_lossy().starts_with('.');
    let points = |dir: &str| {
        let entries = fs::read_dir(folder.0.join(dir).join("points")).into_iter().flatten().flatten();
        entries.filter(is_point).count()
    };
    let (mut killed, mut between) = (0, Vec::new());
    while killed < 10 {
        let mut run = Command::new(env!("CARGO_BIN_EXE_washboard"))
            .current_dir(&folder.0)
            .args(["sweep", "sweep.toml", "-o", "killed"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // somewhere in the next fifth of all: ten of these are about one whole run
        std::thread::sleep(Duration::from_secs_f64(0.2 * whole.as_secs_f64() * random(&mut seed)));
        run.kill().unwrap();
        run.wait().unwrap();
        killed += 1;
        between.push(points("killed"));
    }
    // not all before the first point, nor all after the last
    assert!(between.iter().any(|n| (1..30).contains(n)), "{between:?} of 30 points in {whole:?}");
    assert!(between.windows(2).all(|w| w[0] <= w[1]), "a point was lost: {between:?}");
    let (status, _, err) = folder.run("sweep sweep.toml -o killed");
    assert_eq!(status, 0, "{err}");
    same(&folder, "whole", "killed");
}

/// A loop that rings on after the bump has not settled: its cell is empty, and never the passive vehicle's time.
#[test]
fn what_has_not_settled_in_the_loop_is_not_the_passive_value() {
    let folder = Folder::new("unsettled");
    let design = "method = \"interpolation\"\n[interpolation]\nfictitious_tire_damping_n_s_per_m = 1960.0\npsi = [500.0, 10.0]\n\
                  [metrics]\nbump = { height_m = 0.1, length_m = 2.0 }\n[grid]\noverride.tire_damping_n_s_per_m = [2.0, 98.0]\n";
    write(&folder, "sweep.toml", &[HEAD, design]);
    let (status, _, err) = folder.run("sweep sweep.toml -o made");
    assert_eq!(status, 0, "{err}");
    let made = result(&folder, "made");
    let key = "bump_settling_suspension_travel";
    let of = |k: usize| made["points"][k]["metrics"][key].as_f64();
    assert!(of(0).is_none() && of(1).is_some(), "{made}");
    // what is finite in the loop is there, and is the loop's
    assert!(made["points"][0]["metrics"]["bump_peak_suspension_travel"].is_f64());
    let table = fs::read_to_string(folder.0.join("made/table.csv")).unwrap();
    let column = table.lines().next().unwrap().split(',').position(|c| c == key).unwrap();
    let cells: Vec<&str> = table.lines().skip(1).map(|l| l.split(',').nth(column).unwrap()).collect();
    assert!(cells[0].is_empty() && !cells[1].is_empty(), "{cells:?}");
    let page = fs::read_to_string(folder.0.join("made/report.html")).unwrap();
    assert!(page.contains("bump settling suspension travel") && page.contains("Bold: on the Pareto front"));
}
