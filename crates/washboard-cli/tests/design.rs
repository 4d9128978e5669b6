//! `washboard design`, `ride --controller` and `respond` as a user meets them.

#![allow(clippy::unwrap_used, clippy::print_stderr, clippy::print_stdout)]

mod common;

use common::Folder;
use serde_json::Value;
use std::fs;
use std::process::Command;

const DESIGN: &str = r#"vehicle = "case:turkay-quarter-car"
road = "case:turkay-white-velocity"
speed_m_s = 20.0
measurements = ["suspension_travel"]
method = "lqg"
[override]
tire_damping_n_s_per_m = 98.0
[goal]
minimize = { sprung_acceleration = 1.0, suspension_travel = 1.0, tire_deflection = 1.0 }
"#;

#[test]
fn a_design_is_made_ridden_on_and_shown_again() {
    let folder = Folder::new("made");
    fs::write(folder.0.join("design.toml"), format!("{DESIGN}[discretize]\ndt_s = 0.001\n")).unwrap();
    let (status, out, err) = folder.run("design design.toml -o made");
    assert_eq!(status, 0, "{err}");
    assert!(
        out.contains("designed: a controller of order 4") && out.contains("sprung_acceleration"),
        "{out}"
    );
    for file in ["result.json", "report.html", "controller.json", "controller.mat", "controller.h"] {
        assert!(folder.0.join("made").join(file).is_file(), "{file}");
    }
    let result: Value =
        serde_json::from_str(&fs::read_to_string(folder.0.join("made/result.json")).unwrap()).unwrap();
    // the notes' number for this design
    assert!((result["verified"]["rms"]["sprung_acceleration"].as_f64().unwrap() - 0.48951).abs() < 1e-5);
    fs::write(
        folder.0.join("car.toml"),
        folder
            .run("cases turkay-quarter-car")
            .1
            .replace("damping_n_s_per_m = 0.0", "damping_n_s_per_m = 98.0"),
    )
    .unwrap();
    // the same number by the ride, from three forms of the controller
    for controller in ["made", "made/result.json", "made/controller.json"] {
        let ride = format!(
            "ride car.toml --road case:turkay-white-velocity --speed-m-s 20 --controller {controller} --json"
        );
        let (status, out, err) = folder.run(&ride);
        assert_eq!(status, 0, "{err}");
        let ride: Value = serde_json::from_str(&out).unwrap();
        let (a, b) = (&ride["rms"]["sprung_acceleration"], &result["verified"]["rms"]["sprung_acceleration"]);
        assert!((a.as_f64().unwrap() / b.as_f64().unwrap() - 1.0).abs() < 1e-12);
    }
    let page = fs::read(folder.0.join("made/report.html")).unwrap();
    assert_eq!(folder.run("report made").0, 0);
    assert_eq!(fs::read(folder.0.join("made/report.html")).unwrap(), page);
    // again over its own files
    assert_eq!(folder.run("design design.toml -o made --overwrite").0, 0);
    let edited = String::from_utf8(fs::read(folder.0.join("made/result.json")).unwrap()).unwrap();
    let edited = edited.replacen("\"order\": 4", "\"order\": 5", 1);
    fs::create_dir(folder.0.join("edited")).unwrap();
    fs::write(folder.0.join("edited/result.json"), edited).unwrap();
    let (status, _, err) = folder.run("report edited");
    assert!(status == 2 && err.contains("order: expected 4"), "{err}");
    let (status, out, _) = folder.run("respond car.toml --speed-m-s 12.5 --bump 0.1,2 --controller made");
    assert!(status == 0 && out.contains("change, %"), "{out}");
}

#[test]
fn the_c_header_steps_as_the_controller_does() {
    let folder = Folder::new("header");
    fs::write(folder.0.join("design.toml"), format!("{DESIGN}[discretize]\ndt_s = 0.001\n")).unwrap();
    assert_eq!(folder.run("design design.toml -o made").0, 0);
    let main = "#include <stdio.h>\n#include \"made/controller.h\"\nint main(void) { double x[CONTROLLER_STATES] = {0}, u[1]; \
                for (int k = 0; k < 50; ++k) { double y[1] = {k % 7 - 3.0}; controller_step(x, y, u); } printf(\"%.17g\", u[0]); return 0; }";
    fs::write(folder.0.join("main.c"), main).unwrap();
    let built =
        Command::new("cc").current_dir(&folder.0).args(["-Wall", "-Werror", "-o", "main", "main.c"]).status();
    let Ok(built) = built else {
        eprintln!("skipped: no C compiler");
        return;
    };
    assert!(built.success());
    let run = Command::new(folder.0.join("main")).output().unwrap();
    let c: f64 = String::from_utf8(run.stdout).unwrap().parse().unwrap();
    let (file, _) = washboard::study::read_controller(&folder.0.join("made")).unwrap();
    let discrete = file.state_space().unwrap().tustin(0.001).unwrap();
    let y: Vec<Vec<f64>> = (0..50).map(|k| vec![f64::from(k % 7) - 3.0]).collect();
    let u = discrete.respond(&y).unwrap()[49][0];
    assert!((c / u - 1.0).abs() < 1e-12, "{c} {u}");
}

#[test]
fn the_limit_and_an_h_infinity_design_have_their_own_answers() {
    let folder = Folder::new("methods");
    let (status, limit, _) = folder.design(&DESIGN.replace("\"lqg\"", "\"h2-limit\""));
    assert_eq!((status, limit["status"].as_str()), (0, Some("limit")));
    assert!(limit.get("controller").is_none());
    let (status, hinf, _) = folder.design(&DESIGN.replace("\"lqg\"", "\"hinf\""));
    assert_eq!((status, hinf["status"].as_str()), (0, Some("designed")));
    let gamma = hinf["claimed"]["gamma"].as_f64().unwrap();
    assert!(hinf["objective"]["verified"].as_f64().unwrap() <= gamma * 1.001);
    // nothing weighted moves with the force at once: said in words, exit 1
    let (status, none, _) = folder.design(&DESIGN.replace("sprung_acceleration = 1.0, ", ""));
    assert_eq!((status, none["status"].as_str()), (1, Some("infeasible")));
    assert!(none["why"].as_str().unwrap().contains("`actuator` costs nothing"), "{none}");
}

#[test]
fn an_interpolated_design_says_what_it_hides() {
    let folder = Folder::new("interpolation");
    let text = "vehicle = \"case:turkay-quarter-car\"\nroad = \"case:turkay-white-velocity\"\nspeed_m_s = 20.0\n\
                measurements = [\"suspension_travel\"]\nmethod = \"interpolation\"\n[override]\ntire_damping_n_s_per_m = 98.0\n\
                [interpolation]\nfictitious_tire_damping_n_s_per_m = 1960.0\npsi = [500.0, 10.0]\n";
    let (status, made, err) = folder.design(text);
    assert_eq!((status, made["order"].as_u64()), (0, Some(9)), "{err}");
    let number = |key: &str| made["claimed"][key].as_f64().unwrap();
    // the notes: matched to 1e-9, tire deflection .003793 against .001651, near 20 times at the wheel's own mode
    assert!(number("match_error") < 1e-9 && (number("tire_factor_at_wheel_hop") - 20.0).abs() < 0.5);
    let rms = |of: &str| made[of]["rms"]["tire_deflection"].as_f64().unwrap();
    assert!((rms("verified") - 0.003793).abs() < 1e-6 && (rms("passive") - 0.0016511).abs() < 1e-7);
    let warned = made["warnings"].to_string();
    assert!(warned.contains("hides a mode at 10.61 Hz") && warned.contains("19.78 times"), "{warned}");
    // without tire damping the wheel's mode can't be moved at all
    let (status, none, _) = folder.design(&text.replace("= 98.0", "= 0.0"));
    assert_eq!((status, none["status"].as_str()), (1, Some("infeasible")));
    let (status, _, err) = folder.design(&text.replace("quarter-car\"", "half-car\""));
    assert!(status == 2 && err.contains("a quarter car"), "{err}");
}

#[test]
fn what_a_design_costs_is_said() {
    let folder = Folder::new("warned");
    let warned = |text: &str, name: &str| {
        let (status, made, err) = folder.design(text);
        assert_eq!(status, 0, "{err}");
        made["warnings"].as_array().unwrap().iter().any(|w| w["name"] == name)
    };
    // the filter believes in a road seven thousand times as strong as this one
    let undamped = DESIGN.replace("= 98.0", "= 0.0");
    assert!(warned(&undamped, "noise"));
    let honest = format!("{undamped}[lqg]\nprocess_noise = 1.480625e-4\nsensor_noise = 1e-8\n");
    assert!(!warned(&honest, "noise"));
    assert!(warned(&format!("{undamped}[discretize]\ndt_s = 1.0\n"), "sampled-loop"));
    assert!(!warned(&format!("{DESIGN}[discretize]\ndt_s = 0.001\n"), "sampled-loop"));
    // a loop that is not stable has no gains to show
    let push = r#"{"a": [], "b": [], "c": [[]], "d": [[-1e6]], "inputs": ["suspension_travel"], "outputs": ["actuator"]}"#;
    fs::write(folder.0.join("push.json"), push).unwrap();
    for what in ["--direction heave", "--bump 0.1,2"] {
        let (status, out, err) = folder
            .run(&format!("respond case:turkay-quarter-car --speed-m-s 20 {what} --controller push.json"));
        assert!(
            status == 2 && out.is_empty() && (err.contains("not stable") || err.contains("without end")),
            "{err}"
        );
    }
    let (status, _, err) = folder.run("respond case:turkay-quarter-car --speed-m-s 20 --bump 0.1,1e-5");
    assert!(status == 2 && err.contains("samples") && err.contains("over the bump"), "{err}");
}

#[test]
fn wrong_designs_are_answered_by_field() {
    let folder = Folder::new("wrong");
    for (from, to, words) in [
        (
            "suspension_travel\"]",
            "suspension_travl\"]",
            "measurements: expected outputs of the vehicle (did you mean `suspension_travel`?)",
        ),
        ("= \"lqg\"", "= \"lqr\"", "unknown variant `lqr`"),
        ("sprung_acceleration = 1.0", "sprung_acceleration = -1.0", "goal.minimize: expected weights"),
        ("tire_damping_n_s_per_m", "tyre_damping_n_s_per_m", "no parameter `tyre_damping_n_s_per_m`"),
        ("speed_m_s = 20.0", "speed_m_s = 0.0", "speed_m_s: expected a positive number"),
        (
            "[goal]",
            "[lqg]\nsensor_noise = -1.0\n[goal]",
            "design.toml: lqg.sensor_noise: expected 0, or a number",
        ),
        ("[goal]", "[discretize]\ndt_s = 1e300\n[goal]", "discretize.dt_s: expected 1e-9 to 100 s"),
        ("measurements", "delay_order = 121\nmeasurements", "delay_order: expected an order up to 40"),
        ("[goal]", "[gaol]", "unknown field `gaol`"),
        ("sprung_acceleration = 1.0", "sprung_displacement = 1.0", "sprung_displacement"),
    ] {
        let (status, _, err) = folder.design(&DESIGN.replace(from, to));
        assert_eq!(status, 2, "{to}: {err}");
        assert!(err.contains(words), "{to}: {err}");
    }
    let (status, out, err) = folder
        .run("ride case:turkay-quarter-car --road case:iso8608-c --speed-m-s 20 --controller none.json");
    assert!(status == 2 && out.is_empty() && err.contains("none.json"), "{err}");
}

#[test]
fn the_printed_table_has_units_and_fits_a_terminal() {
    let folder = Folder::new("table");
    let text = "vehicle = \"case:chalasani-full-car\"\nroad = \"case:turkay-first-order\"\nspeed_m_s = 20.0\n\
                measurements = [\"suspension_travel\"]\nmethod = \"lqg\"\ndisturbance = \"road-noise\"\ninput_weight = 1e-6\n\
                [goal]\nminimize = { heave_acceleration = 1.0, suspension_travel = 1.0, tire_deflection = 1.0 }\n";
    fs::write(folder.0.join("design.toml"), text).unwrap();
    let (status, out, err) = folder.run("design design.toml");
    assert_eq!(status, 0, "{err}");
    for line in out.lines() {
        assert!(line.chars().count() <= 80, "{} columns: {line}", line.chars().count());
    }
    let (_, made, _) = folder.run("design design.toml --json");
    let made: Value = serde_json::from_str(&made).unwrap();
    let units = made["units"].as_object().unwrap();
    assert_eq!(units.len(), made["passive"]["rms"].as_object().unwrap().len());
    // every output of the first table is a line with its unit, its corners below it
    let table = out.split("rms on the road").nth(1).unwrap().split("\n\n").next().unwrap();
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|l| l.split_whitespace().collect()).collect();
    let with_unit = |r: &&Vec<&str>| r.len() > 2 && ["m/s²", "rad/s²", "m", "N"].contains(&r[1]);
    assert_eq!(rows.iter().filter(with_unit).count(), units.len(), "{table}");
    assert!(out.contains("names without a corner stand for all: suspension_travel for front_left,"), "{out}");
    assert!(out.contains("m/s² per unit noise") && out.contains("limit"), "{out}");
    // no loop, no column for one
    fs::write(folder.0.join("design.toml"), text.replace("\"lqg\"", "\"h2-limit\"")).unwrap();
    let (status, out, err) = folder.run("design design.toml");
    assert_eq!(status, 0, "{err}");
    assert!(out.contains("no closed loop to show"), "{out}");
    assert!(!out.split("rms on the road").nth(1).unwrap().contains("closed "), "{out}");
}

#[test]
fn what_a_designer_gets_wrong_is_said_with_what_to_do() {
    let folder = Folder::new("help");
    let refused = |text: &str, words: &[&str]| {
        let (status, _, err) = folder.design(text);
        assert_eq!(status, 2, "{err}");
        words.iter().for_each(|w| assert!(err.contains(w), "{w}: {err}"));
    };
    // a white height moves the tire at once: which outputs, why, what instead
    let height = DESIGN
        .replace("= 98.0", "= 0.0")
        .replace("method =", "disturbance = \"road-displacement\"\nmethod =");
    refused(
        &height,
        &["disturbance: expected road-velocity", "`tire_deflection`", "the H2 norm is infinite"],
    );
    // one sensor is not two
    let full = DESIGN
        .replace("[override]\ntire_damping_n_s_per_m = 98.0\n", "")
        .replace("turkay-quarter-car", "turkay-half-car")
        .replace("sprung_acceleration", "heave_acceleration");
    let measured = |list: &str| full.replace("[\"suspension_travel\"]", list);
    refused(
        &measured("[\"suspension_travel\", \"suspension_travel_rear\"]"),
        &["`suspension_travel_rear` twice: in `suspension_travel` and in `suspension_travel_rear`"],
    );
    refused(
        &measured("[\"suspension_travel\", \"suspension_travel\"]"),
        &["measurements: expected each output once, found `suspension_travel` twice"],
    );
    // magnitudes to begin with, where a weight or a noise is missing
    let why = |text: &str| folder.design(text).1["why"].as_str().unwrap_or_default().to_owned();
    let free = DESIGN.replace("sprung_acceleration = 1.0, ", "");
    assert!(
        why(&free).contains("input_weight = 1.5e-10 (1/N²) makes a force of 1 kN rms on this road"),
        "{}",
        why(&free)
    );
    let exact = why(&format!("{DESIGN}[lqg]\nsensor_noise = 0.0\n"));
    assert!(exact.contains("an accelerometer of 100 µg/√Hz has 4.8e-7 (m/s²)² s"), "{exact}");
}

#[test]
fn a_bump_with_a_controller_says_by_how_much_peaks_change() {
    let folder = Folder::new("bump");
    let soft = r#"{"a": [], "b": [], "c": [[]], "d": [[1000.0]], "inputs": ["suspension_travel"], "outputs": ["actuator"]}"#;
    fs::write(folder.0.join("k.json"), soft).unwrap();
    let bump = "respond case:turkay-quarter-car --speed-m-s 12.5 --bump 0.1,2";
    let (_, passive, _) = folder.run(bump);
    assert!(!passive.contains("change"), "{passive}");
    let (status, out, err) = folder.run(&format!("{bump} --controller k.json"));
    assert_eq!(status, 0, "{err}");
    let cell = |text: &str, k: usize| -> f64 {
        let row = text.lines().find(|l| l.starts_with("sprung_acceleration")).unwrap();
        row.split_whitespace().nth(k).unwrap().parse().unwrap()
    };
    // from the two peaks as they are printed, four digits each
    let change = 100.0 * (cell(&out, 2) / cell(&passive, 2) - 1.0);
    assert!((change - cell(&out, 4)).abs() < 0.1, "{change}: {out}");
    assert!(out.contains("change, %") && !out.contains("less than"), "{out}");
}

/// A full car's travels follow the twist of its road, which comes back where the rear wheels follow the front ones, and wanders where each wheel has
/// a road of its own: then in one message, that of the measurement.
#[test]
fn a_twist_wanders_where_no_wheel_follows_another() {
    let folder = Folder::new("wander");
    let (_, road, _) = folder.run("cases iso8608-c");
    for kind in ["none", "full", "independent"] {
        let own = road.replace("kind = \"bogsjo\"", &format!("kind = \"{kind}\"")).replace("mu = 3.8\n", "");
        fs::write(folder.0.join("road.toml"), own).unwrap();
        for (goal, measured) in [
            ("heave_acceleration = 1.0", "suspension_travel"),
            ("heave_acceleration = 1.0, suspension_travel = 1.0", "suspension_travel"),
            ("heave_acceleration = 1.0", "heave_acceleration"),
        ] {
            let text = format!(
                "vehicle = \"case:chalasani-full-car\"\nroad = \"road.toml\"\nspeed_m_s = 20.0\nmeasurements = [\"{measured}\"]\n\
                 method = \"h2-limit\"\ninput_weight = 1e-9\n[goal]\nminimize = {{ {goal} }}\n"
            );
            let (status, made, err) = folder.design(&text);
            // its rear track is narrower: a road that is apart left and right twists it for good
            if kind != "full" && measured == "suspension_travel" {
                assert_eq!(status, 2, "{kind} {goal}: {made}");
                let words =
                    "measurements: expected outputs whose response dies away, found `suspension_travel`";
                assert!(err.contains(words) && err.contains("road-noise"), "{err}");
                assert_eq!(err.contains("in goal.minimize"), goal.contains("travel"), "{err}");
            } else {
                assert_eq!(status, 0, "{kind} {goal}: {err}");
                let rms = made["passive"]["rms"]["heave_acceleration"].as_f64().unwrap();
                assert!(rms > 0.1 && made["limit"].is_object(), "{made}");
            }
        }
    }
    // travels by another route: white velocity of 1.480625e-4 m²/s times H2 norms of the plant, delays by Padé, beside the ride by quadrature
    // through M, C and K, delays exact
    let (_, road, _) = folder.run("cases turkay-white-velocity");
    for kind in ["none", "full"] {
        fs::write(folder.0.join("road.toml"), road.replace("independent", kind)).unwrap();
        let text = "vehicle = \"case:guiggiani-full-car\"\nroad = \"road.toml\"\nspeed_m_s = 20.0\nmeasurements = [\"suspension_travel\"]\n\
                    delay_order = 8\nmethod = \"h2-limit\"\ninput_weight = 1e-8\n[goal]\nminimize = { heave_acceleration = 1.0, suspension_travel = 1.0 }\n";
        let (status, made, err) = folder.design(text);
        assert_eq!(status, 0, "{err}");
        for (of, name) in [
            ("passive", "suspension_travel"),
            ("passive", "heave_acceleration"),
            ("passive", "tire_deflection"),
        ] {
            let h2 = made[of]["h2"][name].as_f64().unwrap() * 1.480_625e-4_f64.sqrt();
            let rms = made[of]["rms"][name].as_f64().unwrap();
            assert!((h2 / rms - 1.0).abs() < 1e-5, "{kind} {of} {name}: {h2} {rms}");
        }
    }
    // the culprit of a quarter car's displacement is the measurement, not the goal
    let (status, _, err) =
        folder.design(&DESIGN.replace("[\"suspension_travel\"]", "[\"sprung_displacement\"]"));
    assert!(status == 2 && err.contains("measurements: expected outputs whose response dies away"), "{err}");
    assert!(!err.contains("suspension_travel"), "{err}");
}

#[test]
fn numbers_that_doubles_do_not_resolve_are_blamed_by_their_field() {
    let folder = Folder::new("apart");
    for (value, car) in [("tire_damping_n_s_per_m = 1e9", "quarter"), ("pitch_inertia_kg_m2 = 1e12", "half")]
    {
        let text = DESIGN.replace("tire_damping_n_s_per_m = 98.0", value).replace("quarter", car).replace(
            "sprung_acceleration",
            if car == "half" { "heave_acceleration" } else { "sprung_acceleration" },
        );
        let (status, _, err) = folder.design(&text);
        assert_eq!(status, 2, "{value}: {err}");
        let (name, _) = value.split_once(' ').unwrap();
        assert!(err.contains(&format!("[override] has {name} = ")), "{value}: {err}");
        assert!(!err.contains("follow the road") && !err.contains("no spring"), "{value}: {err}");
    }
    // a name without its axle, misspelt
    let text = DESIGN
        .replace("tire_damping_n_s_per_m = 98.0", "suspension_dampng = 98.0")
        .replace("quarter", "half");
    let (status, _, err) = folder.design(&text);
    assert!(status == 2 && err.contains("design.toml: override: "), "{err}");
    assert!(err.contains("did you mean `suspension_damping_n_s_per_m`?"), "{err}");
    // each name once, and what a seat needs
    let text = DESIGN
        .replace("[override]\ntire_damping_n_s_per_m = 98.0\n", "")
        .replace("turkay-quarter", "guiggiani-full")
        .replace("sprung_acceleration", "driver_heave_acceleration");
    let (_, car, _) = folder.run("cases guiggiani-full-car");
    let car: String = car.lines().filter(|l| !l.starts_with("driver_m")).map(|l| format!("{l}\n")).collect();
    fs::write(folder.0.join("car.toml"), car).unwrap();
    let (status, _, err) = folder.design(&text.replace("case:guiggiani-full-car", "car.toml"));
    assert!(status == 2 && err.contains("driver_m in the vehicle's file"), "{err}");
    assert_eq!(err.matches("body_acceleration,").count(), 1, "{err}");
    // a seed to its last digit
    let text = DESIGN.replace("\"lqg\"", "\"fixed-order\"")
        + "order = 0\n[fixed-order]\nseed = 9223372036854775808\n";
    let (status, _, err) = folder.design(&text);
    assert!(status == 2 && err.contains("found 9223372036854775808"), "{err}");
    let text = DESIGN.replace("\"lqg\"", "\"fixed-order\"").replace("= 1.0", "= 0.0") + "order = 0\n";
    let (status, _, err) = folder.design(&text);
    assert!(status == 2 && err.contains("goal.minimize: expected a weight above 0"), "{err}");
}

/// The README's controller on the car without tire damping: every number of comfort is worse.
#[test]
fn a_worse_ride_is_warned_of_and_another_vehicle_noted() {
    let folder = Folder::new("worse");
    let push = "method = \"fixed-order\"\n[override]\ntire_damping_n_s_per_m = 0.0\n[goal]\nminimize = { sprung_acceleration = 1.0 }\n\
                bound = { suspension_travel = 1.0, tire_deflection = 1.0 }\norder = 1\n";
    let head = "vehicle = \"case:turkay-quarter-car\"\nroad = \"case:iso8608-c\"\nspeed_m_s = 20.0\nmeasurements = [\"suspension_travel\"]\n";
    let (status, made, err) = folder.design(&format!("{head}{push}"));
    assert_eq!(status, 0, "{err}");
    let warned = |name: &str| {
        let all = made["warnings"].as_array().unwrap();
        all.iter().find(|w| w["name"] == name).map(|w| w["text"].to_string()).unwrap_or_default()
    };
    assert!(warned("felt-more").contains("felt more than without control"), "{made}");
    assert!(
        warned("worse-rms").contains("sprung_acceleration") && warned("worse-rms").contains("the goal's own"),
        "{made}"
    );
    // designed for 98 N s/m, ridden on at 0
    fs::write(folder.0.join("design.toml"), DESIGN).unwrap();
    assert_eq!(folder.run("design design.toml -o made").0, 0);
    for job in
        ["ride case:turkay-quarter-car --road case:iso8608-c", "respond case:turkay-quarter-car --bump 0.1,2"]
    {
        let (status, out, err) = folder.run(&format!("{job} --speed-m-s 20 --controller made"));
        assert_eq!(status, 0, "{err}");
        assert!(out.contains("tire_damping_n_s_per_m = 98"), "{out}");
        let (_, out, _) = folder.run(&format!("{job} --speed-m-s 20 --controller made --json"));
        assert!(out.contains("other-vehicle"), "{out}");
        let (_, out, _) = folder.run(&format!("{job} --speed-m-s 20 --controller made/controller.json"));
        assert!(!out.contains("tire_damping_n_s_per_m = 98"), "{out}");
    }
}
