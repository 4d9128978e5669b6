//! `washboard design` with `method = "fixed-order"`, as a user meets it: published values, several vehicles, structures, and
//! what is refused.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, names, number, text_of};
use serde_json::Value;
use std::fs;

/// Section 5.3 of the thesis: c_t = 98, the travel measured, bounds 1 and 1.
const CAR: &str = r#"vehicle = "case:turkay-quarter-car"
road = "case:turkay-white-velocity"
speed_m_s = 20.0
measurements = ["suspension_travel"]
method = "fixed-order"
[override]
tire_damping_n_s_per_m = 98.0
[goal]
minimize = { sprung_acceleration = 1.0 }
bound = { suspension_travel = 1.0, tire_deflection = 1.0 }
"#;

/// One controller an axle.
const HALF: &str = r#"vehicle = "case:turkay-half-car"
road = "case:turkay-white-velocity"
speed_m_s = 20.0
measurements = ["suspension_travel"]
method = "fixed-order"
delay_order = 2
structure = "decentralised"
[override]
tire_damping_n_s_per_m = 50.0
[goal]
minimize = { body = 1.0 }
groups = { body = ["heave_acceleration", "pitch_acceleration"] }
bound = { suspension_travel = 1.2, tire_deflection = 1.2 }
[[local]]
measurements = ["suspension_travel_front"]
actuators = ["front"]
order = 1
[[local]]
measurements = ["suspension_travel_rear"]
actuators = ["rear"]
order = 1
"#;

/// A bound may be exceeded by rounding, and the same norm comes out by two routines.
const ROUNDING: f64 = 1e-6;
/// What no controller of any order beats, (4.30) with the bound of the tire deflection on the true passive norms.
const LOWER_BOUND: f64 = 0.45012;
/// k_t/m_u of the car.
const WHEEL: f64 = 160_000.0 / 36.0;

fn of_order(order: usize) -> String {
    format!("{CAR}order = {order}\n")
}

/// A line before the tables.
fn with(text: &str, line: &str) -> String {
    text.replacen("[override]", &format!("{line}\n[override]"), 1)
}

fn rows(made: &Value, matrix: &str) -> Vec<Vec<f64>> {
    serde_json::from_value(made["controller"][matrix].clone()).unwrap()
}

fn target<'a>(made: &'a Value, name: &str, aim: &str) -> &'a Value {
    let all = made["fixed_order"]["targets"].as_array().unwrap();
    all.iter().find(|t| t["name"] == name && t["aim"] == aim).unwrap()
}

/// The thesis's values, converted to true passive norms: .4542 and .4514 of HIFOO's best.
#[test]
fn the_quarter_car_is_as_good_as_published_at_each_order_and_better_with_more_states() {
    let folder = Folder::new("quarter");
    let mut last = f64::INFINITY;
    for (order, published) in [(0, 1.0), (1, 0.4543), (2, 0.4515)] {
        let made = folder.designed(&of_order(order));
        let value = number(&made, &["objective", "verified"]);
        assert!(value <= published && value >= LOWER_BOUND && value <= last, "order {order}: {value}");
        last = value;
        let proven = &made["fixed_order"];
        let bound = number(proven, &["lower_bound"]);
        assert!((bound - LOWER_BOUND).abs() < 2e-5, "{bound}");
        assert!((number(proven, &["gap"]) - (value / bound - 1.0)).abs() < 1e-4, "{proven}");
        // next to √(k_t/m_u)
        let at = number(proven, &["lower_bound_hz"]) * std::f64::consts::TAU;
        assert!((at / WHEEL.sqrt() - 1.0).abs() < 0.02, "{at}");
        assert_eq!(made["order"], order);
        // the claim beside the loop, whose peaks are the page's own
        let claimed = number(&made, &["claimed", "objective"]);
        assert!((value / claimed - 1.0).abs() < 1e-5, "{value} {claimed}");
        let own = number(&made, &["verified", "hinf", "sprung_acceleration"])
            / number(&made, &["passive", "hinf", "sprung_acceleration"]);
        assert!((value / own - 1.0).abs() < ROUNDING);
        for name in ["suspension_travel", "tire_deflection"] {
            let share =
                number(&made, &["verified", "hinf", name]) / number(&made, &["passive", "hinf", name]);
            assert!(share <= 1.0 + ROUNDING, "{name} {share}");
            let said = target(&made, name, "bound");
            assert!((number(said, &["relative"]) / share - 1.0).abs() < ROUNDING);
        }
        if order > 0 {
            assert!(number(&made, &["claimed", "fastest_controller_pole"]) <= 5e3);
        }
        // multipliers of the goals sum to 1, those of bounds with room are none
        let all = made["fixed_order"]["targets"].as_array().unwrap();
        let goals = all.iter().filter(|t| t["aim"] == "goal").map(|t| number(t, &["multiplier"]));
        assert!((goals.sum::<f64>() - 1.0).abs() < 1e-3);
        for t in all.iter().filter(|t| number(t, &["relative"]) < 0.99 && t["aim"] == "bound") {
            assert!(number(t, &["multiplier"]) < 0.1, "{t}");
        }
        let starts = &made["fixed_order"];
        assert!(number(starts, &["stabilised"]) <= number(starts, &["starts"]));
        assert!(number(starts, &["work", "loops"]) > 10.0);
    }
}

/// The worst of four cars is what is minimised, each over its own passive norm; no car alone may be worse than in company.
#[test]
fn one_controller_serves_four_tires_and_is_never_better_than_each_tires_own() {
    let folder = Folder::new("plants");
    let tires = [0.0, 25.0, 50.0, 98.0];
    let plants: String =
        tires.iter().map(|c| format!("[[plant]]\ntire_damping_n_s_per_m = {c:?}\n")).collect();
    let made = folder.designed(&format!("{}{plants}", of_order(1)));
    let worst = number(&made, &["objective", "worst"]);
    let vertices = made["vertices"].as_array().unwrap();
    assert_eq!(vertices.len(), 4);
    for (v, tire) in vertices.iter().zip(tires) {
        assert_eq!(v["at"]["tire_damping_n_s_per_m"], tire);
        let value = number(v, &["objective", "closed"]);
        assert!(
            value <= worst * (1.0 + ROUNDING) && (number(v, &["objective", "passive"]) - 1.0).abs() < 1e-9
        );
        let gain = |of: &str| number(v, &[of, "hinf", "sprung_acceleration"]);
        assert!((value / (gain("closed") / gain("passive")) - 1.0).abs() < 1e-9, "over its own norm");
        // without tire damping no control changes the acceleration at √(k_t/m_u), m_s|T₁| = m_u√(k_t/m_u): the price is paid there
        if tire == 0.0 {
            let invariant = 36.0 * WHEEL.sqrt() / 240.0;
            assert!((gain("closed") / invariant - 1.0).abs() < 1e-6, "{} {invariant}", gain("closed"));
        }
    }
    let (status, out, err) = folder.run("design design.toml -o out");
    assert_eq!(status, 0, "{err}");
    assert!(out.contains("the search") && out.contains("goals and bounds"), "{out}");
    let (status, _, err) = folder.run("report out");
    let page = fs::read_to_string(folder.0.join("out/report.html")).unwrap();
    assert!(status == 0 && page.contains("Every vehicle that it is for"), "{err}");
    assert!(!page.contains("robust gain") && page.contains("A local optimum"));
    let alone = folder.designed(&of_order(1));
    assert!(number(&alone, &["objective", "verified"]) < number(&vertices[3], &["objective", "closed"]));
    // normalize_at: all over the same norms
    let fixed = of_order(1).replace("[goal]", "[normalize_at]\ntire_damping_n_s_per_m = 98.0\n[goal]");
    let made = folder.designed(&format!("{fixed}{plants}"));
    let first = &made["vertices"][0];
    let over = number(first, &["objective", "passive"]);
    let own = number(first, &["passive", "hinf", "sprung_acceleration"]);
    assert!((over / (own / number(&alone, &["passive", "hinf", "sprung_acceleration"])) - 1.0).abs() < 1e-9);
    assert!(over > 1.0001);
}

/// Entries that are to stay stay, to the last bit, and what is left free makes the goal no worse than nothing.
#[test]
fn structures_are_kept() {
    let folder = Folder::new("structure");
    let free = CAR.replace("suspension_travel = 1.0, tire_deflection = 1.0", "tire_deflection = 1.1");
    let made = folder.designed(&with(&free, "structure = \"pid\"\npid_filter_s = 0.01"));
    assert_eq!(
        (rows(&made, "a"), rows(&made, "b")),
        (vec![vec![0.0, 0.0], vec![0.0, -100.0]], vec![vec![1.0], vec![1.0]])
    );
    assert!(number(&made, &["objective", "verified"]) < 1.0);
    let made = folder.designed(&with(CAR, "structure = [[\"free\", 1.0], [\"free\", 0.0]]"));
    assert_eq!((rows(&made, "b"), rows(&made, "d")), (vec![vec![1.0]], vec![vec![0.0]]));
    assert!(number(&made, &["objective", "verified"]) < 0.46);
    let made = folder.designed(&with(&of_order(1), "structure = \"strictly-proper\""));
    assert_eq!(rows(&made, "d"), vec![vec![0.0]]);
    let made = folder.designed(HALF);
    for (matrix, apart) in
        [("a", [(0, 1), (1, 0)]), ("b", [(0, 1), (1, 0)]), ("c", [(0, 1), (1, 0)]), ("d", [(0, 1), (1, 0)])]
    {
        let found = rows(&made, matrix);
        assert!(apart.iter().all(|(i, j)| found[*i][*j] == 0.0), "{matrix} {found:?}");
        assert!(found.iter().enumerate().all(|(i, r)| r[i] != 0.0), "{matrix} {found:?}");
    }
    assert!(number(&made, &["objective", "verified"]) < 0.53);
    assert_eq!(
        (&made["order"], &made["controller"]["outputs"]),
        (&2.into(), &serde_json::json!(["front", "rear"]))
    );
}

/// H2 goals and bounds: the goal is the larger one of both kinds, and bounds of H2 norms are kept.
#[test]
fn goals_and_bounds_of_both_norms_mix() {
    let folder = Folder::new("mix");
    let text = format!(
        "{}minimize_h2 = {{ tire_deflection = 0.5, sprung_acceleration = 0.3 }}\nbound_h2 = {{ suspension_travel = 0.72 }}\n",
        of_order(1)
    );
    let made = folder.designed(&text);
    let share = |norm: &str, name: &str| {
        number(&made, &["verified", norm, name]) / number(&made, &["passive", norm, name])
    };
    let squared = (0.5 * share("h2", "tire_deflection")).hypot(0.3 * share("h2", "sprung_acceleration"));
    let value = number(&made, &["objective", "verified"]);
    assert!((value / squared.max(share("hinf", "sprung_acceleration")) - 1.0).abs() < 1e-9);
    assert!(share("h2", "suspension_travel") <= 0.72 * (1.0 + ROUNDING));
    assert!(value < 0.56, "{value}");
    assert_eq!(target(&made, "goal", "goal")["norm"], "h2");
    // bounds alone are a goal too
    let none = of_order(1).replace("minimize = { sprung_acceleration = 1.0 }\n", "");
    let made = folder.designed(&none.replace("suspension_travel = 1.0", "suspension_travel = 0.4"));
    assert!(made["objective"].get("verified").is_none());
    assert!(number(&made, &["claimed", "hinf_suspension_travel_recomputed"]) <= 0.4001 * 0.27351);
}

/// A controller at hand is begun from: with no other start and no step to spare the result is no worse.
#[test]
fn a_start_is_used_and_its_signals_are_checked() {
    let folder = Folder::new("start");
    let first = folder.designed(&of_order(1));
    fs::write(folder.0.join("k.json"), first["controller"].to_string()).unwrap();
    let text = with(&of_order(1), "start = \"k.json\"")
        + "[fixed-order]\ntries = 0\nlower_orders = false\niterations = 2\n";
    let made = folder.designed(&text);
    let [before, after] = [&first, &made].map(|m| number(m, &["objective", "verified"]));
    assert!(after <= before * (1.0 + ROUNDING), "{before} {after}");
    assert!(
        made["inputs"].as_array().unwrap().iter().any(|i| i["path"].as_str().unwrap().ends_with("k.json"))
    );
    let other = first["controller"].to_string().replace("suspension_travel", "tire_deflection");
    fs::write(folder.0.join("k.json"), other).unwrap();
    let (status, _, err) = folder.design(&text);
    assert!(status == 2 && err.contains("start") && err.contains("measurements: suspension_travel"), "{err}");
    // the same seed, the same bits
    let again = folder.designed(&of_order(1));
    assert_eq!(again["controller"], first["controller"]);
}

/// No controller: which bound, by how much, and where from.
#[test]
fn what_cannot_be_had_is_said_with_its_numbers() {
    let folder = Folder::new("none");
    let tight = of_order(1).replace(
        "suspension_travel = 1.0, tire_deflection = 1.0",
        "suspension_travel = 0.1, tire_deflection = 0.3",
    );
    let (status, made, err) = folder.design(&tight);
    assert_eq!((status, made["status"].as_str()), (1, Some("infeasible")), "{err}");
    let why = made["why"].as_str().unwrap();
    // these are proven impossible at one frequency: more states are no advice
    let said = ["% over", "times the passive one", "No controller of any order keeps them"];
    assert!(said.iter().all(|w| why.contains(w)) && !why.contains("goal.order"), "{why}");
    let violation = number(&made["fixed_order"], &["violation"]);
    let worst = made["fixed_order"]["targets"].as_array().unwrap().iter();
    let worst = worst.filter(|t| t["aim"] == "bound").map(|t| number(t, &["relative"])).fold(0.0, f64::max);
    assert!(violation > 0.1 && (worst - 1.0 - violation).abs() < 1e-9, "{violation} {worst}");
    assert!(made.get("controller").is_none() && made.get("verified").is_none());
    let fast = with(&of_order(0), "poles = { max_real_rad_s = -200.0 }");
    let (status, made, _) = folder.design(&fast);
    assert_eq!((status, made["status"].as_str()), (1, Some("stalled")));
    let why = made["why"].as_str().unwrap();
    assert!(why.contains("none of ") && why.contains("-200 rad/s"), "{why}");
    let least = number(&made["fixed_order"], &["abscissa_rad_s"]);
    assert!((-200.0..0.0).contains(&least), "{least}");
    // a margin that can be had is kept
    let made = folder.designed(&with(&of_order(1), "poles = { max_real_rad_s = -1.5 }"));
    let poles: Vec<[f64; 2]> = serde_json::from_value(made["verified"]["poles"].clone()).unwrap();
    assert!(poles.iter().all(|p| p[0] <= -1.5 + 1e-6), "{poles:?}");
    assert!(!names(&made["warnings"]).contains(&"slow-loop"));
}

#[test]
fn wrong_designs_are_refused_with_their_numbers() {
    let folder = Folder::new("wrong");
    let refused = |text: &str, words: &[&str]| {
        let (status, made, err) = folder.design(text);
        assert!(status == 2 && made == Value::Null, "{status} {made} {err}");
        assert!(words.iter().all(|w| err.contains(w)), "{words:?}: {err}");
    };
    refused(CAR, &["goal.order", "number of states, 0 to 60"]);
    refused(&format!("{CAR}order = -1\n"), &["goal.order", "whole number from 0 to 60, found -1"]);
    refused(&format!("{CAR}order = 1.5\n"), &["found 1.5"]);
    refused(&of_order(1).replace("\"fixed-order\"", "\"lqg\""), &["method lqg"]);
    refused(&with(&of_order(1), "structure = \"pdi\""), &["structure: expected \"full\"", "\"pid\""]);
    refused(&with(&of_order(1), "structure = \"pid\""), &["pid_filter_s", "time constant"]);
    refused(
        &with(&of_order(1), "structure = \"pid\"\npid_filter_s = 0.01"),
        &["goal.order", "2, integrator", "found 1"],
    );
    refused(
        &with(CAR, "structure = \"pid\"\npid_filter_s = 1e-5"),
        &["pid_filter_s", "goal.max_pole_rad_s = 5000"],
    );
    let two = CAR.replace("[\"suspension_travel\"]", "[\"suspension_travel\", \"sprung_acceleration\"]");
    refused(&with(&two, "structure = \"pid\"\npid_filter_s = 0.01"), &["2 measurements and 1 actuators"]);
    refused(
        &with(CAR, "structure = [[\"free\", 1.0], [\"free\"]]"),
        &["2 entries: 1 states, 1 measurements", "1 in row 2"],
    );
    refused(&with(CAR, "structure = [[\"fre\", 1.0], [\"free\", 0.0]]"), &["\"free\" or numbers"]);
    refused(&with(CAR, "structure = [[1.0]]"), &["an entry that is \"free\""]);
    refused(&with(CAR, "structure = \"decentralised\""), &["[[local]]"]);
    refused(&with(&of_order(0), "structure = \"strictly-proper\""), &["goal.order", "1 or more"]);
    refused(
        &HALF.replace("actuators = [\"rear\"]", "actuators = [\"front\"]"),
        &["local.actuators", "`front` 2 times"],
    );
    refused(&HALF.replace("actuators = [\"rear\"]", "actuators = [\"back\"]"), &["front, rear", "`back`"]);
    refused(
        &HALF.replace("\"suspension_travel_rear\"", "\"heave_acceleration\""),
        &["local.measurements", "heave_acceleration"],
    );
    refused(&HALF.replace("order = 1\n[[local]]", "order = -2\n[[local]]"), &["local.order", "found -2"]);
    refused(&HALF.replace("bound = {", "order = 3\nbound = {"), &["goal.order", "2, the sum", "found 3"]);
    refused(
        &with(&of_order(1), "poles = { min_damping = 0.3 }"),
        &["poles.min_damping", "max_real_rad_s alone"],
    );
    refused(&with(&of_order(1), "lyapunov_scale = \"fixed\""), &["lyapunov_scale"]);
    refused(&with(&of_order(1), "input_weight = 1e-9"), &["input_weight", "minimize_h2"]);
    refused(
        &format!("{}minimize_hinf = {{ tire_deflection = 1.0 }}\n", of_order(1)),
        &["goal.minimize_hinf", "either this"],
    );
    refused(&format!("{}[fixed-order]\ntrys = 3\n", of_order(1)), &["trys", "tries"]);
    refused(
        &format!("{}[fixed-order]\niterations = 0\n", of_order(1)),
        &["fixed-order.iterations", "1 to 100000"],
    );
    refused(&format!("{}[[plant]]\ntire_dampin = 3.0\n", of_order(1)), &["plant", "tire_dampin"]);
    refused(&format!("{}[lqg]\nsensor_noise = 1e-6\n", of_order(1)), &["lqg", "goal.max_gain"]);
    refused(
        &format!("{}[range]\ntire_damping_n_s_per_m = [0.0, 9.0]\n", of_order(1)),
        &["range", "fixed-order"],
    );
    refused(&with(&of_order(1), "start = \"no.json\""), &["start: expected", "no.json"]);
    refused(&with(&of_order(1), "start = \"\""), &["start: expected", "found nothing"]);
    for (text, found) in [("[]", "a list"), ("null", "null")] {
        fs::write(folder.0.join("k.json"), text).unwrap();
        refused(
            &with(&of_order(1), "start = \"k.json\""),
            &["start: expected", "an object with a, b", found],
        );
    }
    refused(&of_order(1).replace("minimize = { sprung_acceleration = 1.0 }\nbound = { suspension_travel = 1.0, tire_deflection = 1.0 }\n", ""), &["goal.minimize", "or bounds"]);
}

/// What is refused is named as it stands in the file.
#[test]
fn a_wrong_name_is_answered_with_the_list_that_it_stands_in() {
    let folder = Folder::new("names");
    let wrong = |text: &str, words: &[&str]| {
        let (status, _, err) = folder.design(text);
        assert!(status == 2 && words.iter().all(|w| err.contains(w)), "{words:?}: {err}");
    };
    for list in ["minimize", "minimize_hinf", "minimize_h2"] {
        let text = of_order(1)
            .replace("minimize = { sprung_acceleration", &format!("{list} = {{ sprung_aceleration"));
        let named =
            format!("goal.{list}: expected outputs of the vehicle (did you mean `sprung_acceleration`?)");
        wrong(&text, &[&named]);
    }
    for list in ["bound", "bound_hinf", "bound_h2"] {
        let text =
            of_order(1).replace("bound = { suspension_travel", &format!("{list} = {{ suspension_travl"));
        wrong(&text, &[&format!("goal.{list}: expected outputs"), "`suspension_travel`?"]);
    }
    // by its words, before the spelling
    let truck = of_order(1)
        .replace("case:turkay-quarter-car", "case:chalasani-full-car")
        .replace("tire_damping_n_s_per_m = 98.0", "")
        .replace("sprung_acceleration", "driver_acceleration");
    wrong(&truck, &["goal.minimize: expected", "`driver_heave_acceleration`?"]);
}

/// Numbers beyond all use are answered in a few digits, types by the key that has the wrong one.
#[test]
fn impossible_numbers_and_types_are_refused_by_their_field_and_shortly() {
    let folder = Folder::new("numbers");
    let of = |text: &str| {
        let (status, _, err) = folder.design(text);
        assert!(status == 2 && err.len() < 400, "{status} {err}");
        err
    };
    let in_goal = |line: &str| of(&format!("{}{line}\n", of_order(1)));
    let before = |line: &str| of(&with(&of_order(1), line));
    let search = |line: &str| of(&format!("{}[fixed-order]\n{line}\n", of_order(1)));
    for (err, words) in [
        (in_goal("max_gain = 1e-320"), "goal.max_gain: expected a finite number from 1e-9, found 1e-320"),
        (in_goal("max_pole_rad_s = 1e-320"), "goal.max_pole_rad_s: expected a finite number from 1e-9"),
        (before("poles = { max_real_rad_s = -1e9 }"), "poles.max_real_rad_s: expected 0 down to -5000"),
        (search("tries = 1e308"), "fixed-order.tries: expected a whole number from 0 to 10000, found 1e308"),
        (
            search("seed = -1"),
            "fixed-order.seed: expected a whole number from 0 to 9007199254740992, found -1",
        ),
        (search("iterations = 1e308"), "found 1e308"),
        (search("tolerance = 1e308"), "fixed-order.tolerance: expected 1e-12 to 0.1, found 1e308"),
        (of(&format!("{CAR}order = 9223372036854775807\n")), "found 9223372036854775807"),
        (of(&format!("{CAR}order = true\n")), "goal.order: expected a whole number from 0 to 60, found true"),
        (
            of(&of_order(1).replace("20.0", "1e308")),
            "speed_m_s: expected a positive number, 0.01 to 500 m/s, found 1e308",
        ),
        (
            of(&of_order(1).replace("20.0", "true")),
            "speed_m_s: invalid type: boolean `true`, expected a number",
        ),
        (before("fixed-order = 3"), "fixed-order: invalid type: integer `3`, expected a table"),
        (in_goal("minimize_h2 = { tire_deflection = \"x\" }"), "minimize_h2.tire_deflection: invalid type"),
        (
            of(&with(CAR, "structure = \"pid\"\npid_filter_s = 1e308")),
            "pid_filter_s: expected a positive number of seconds, up to 1000, found 1e308",
        ),
        (of(&with(CAR, "structure = [[1.0]]")), "--controller"),
        (
            of(&format!("{}[[plant]]\n[[plant]]\ntire_damping_n_s_per_m = nan\n", of_order(1))),
            "plant: expected finite numbers, found number 2: tire_damping_n_s_per_m = NaN",
        ),
        (
            of(&of_order(1).replace("98.0", "inf")),
            "override: expected finite numbers, found tire_damping_n_s_per_m = inf",
        ),
        (
            of(&HALF.replace("[\"suspension_travel_front\"]", "[]")),
            "local.measurements: expected at least one name in each [[local]], found none in number 1",
        ),
        (
            of(&HALF.replace(
                "[\"suspension_travel_front\"]",
                "[\"suspension_travel_front\", \"suspension_travel_front\"]",
            )),
            "`suspension_travel_front` twice in number 1",
        ),
    ] {
        assert!(err.contains(words), "{words}: {err}");
    }
    fs::write(
        folder.0.join("road.toml"),
        "kind = \"white-velocity\"\nroughness_m3 = 1e300\nreference_cycles_per_m = 0.1\n",
    )
    .unwrap();
    let err = of(&of_order(1).replace("case:turkay-white-velocity", "road.toml"));
    assert!(err.contains("roughness_m3: expected a positive number") && err.contains("found 1e300"), "{err}");
}

/// A vehicle that only its controller stabilises has no passive norms: goals are over those of another one.
#[test]
fn a_vehicle_that_is_not_stable_without_control_is_designed_over_the_norms_of_another() {
    let folder = Folder::new("unstable");
    let refused = |text: &str, words: &[&str]| {
        let (status, _, err) = folder.design(text);
        assert!(status == 2 && words.iter().all(|w| err.contains(w)), "{words:?}: {err}");
    };
    let undamped = of_order(1).replace("98.0", "0.0\nsuspension_damping_n_s_per_m = 0.0");
    refused(
        &undamped,
        &["vehicle: expected a passive vehicle that is damped", "[normalize_at]", "does not decay"],
    );
    let two = format!(
        "{}[[plant]]\n[[plant]]\ntire_damping_n_s_per_m = 0.0\nsuspension_damping_n_s_per_m = 0.0\n",
        of_order(1)
    );
    refused(
        &two,
        &[
            "plant: expected vehicles that are stable without control",
            "number 2, suspension_damping",
            "does not decay",
        ],
    );
    let over = |text: &str, damping: f64| {
        format!(
            "{text}[normalize_at]\ntire_damping_n_s_per_m = 98.0\nsuspension_damping_n_s_per_m = {damping:?}\n"
        )
    };
    let made = folder.designed(&over(&undamped, 980.0));
    let (passive, notes) = (&made["passive"], names(&made["notes"]));
    assert!(passive["stable"] == false && notes.contains(&"unstable-passive"), "{notes:?}");
    assert!(made["objective"].get("passive").is_none() && made["verified"]["stable"] == true);
    // the same norms as those of the damped car's design
    let damped = folder.designed(&of_order(1));
    let over_norm = number(&made, &["verified", "hinf", "sprung_acceleration"])
        / number(&damped, &["passive", "hinf", "sprung_acceleration"]);
    assert!((number(&made, &["objective", "verified"]) / over_norm - 1.0).abs() < 1e-6);
    let (status, out, err) = folder.run("design design.toml -o out");
    assert!(status == 0 && out.contains("suspension_travel"), "{out} {err}");
    let (status, _, err) = folder.run("report out");
    assert_eq!(status, 0, "{err}");
    let made = folder.designed(&over(&two, 980.0));
    let vertex = &made["vertices"][1];
    assert!(vertex["passive"]["stable"] == false && vertex["objective"].get("passive").is_none());
    assert!(number(vertex, &["objective", "closed"]) > 0.0);
    // matrices of its own: a damper that pushes, a mass that no spring holds
    let own = |file: &str| {
        fs::write(folder.0.join("car.toml"), file).unwrap();
        let text = of_order(1).replace("case:turkay-quarter-car", "car.toml");
        text.replace("[override]\ntire_damping_n_s_per_m = 98.0\n", "").replace(", tire_deflection = 1.0", "")
    };
    let two = matrices(
        "[[240.0, 0.0], [0.0, 36.0]]",
        "[[-980.0, 980.0], [980.0, -980.0]]",
        "[[16e3, -16e3], [-16e3, 176e3]]",
        ["[\"body\", \"wheel\"]", "[[0.0], [160e3]]", "[[0.0], [0.0]]", "[1.0, 0.0]", "[1.0, -1.0]"],
    );
    refused(
        &own(&two),
        &["vehicle: expected a passive vehicle that is damped and stable", "a pole at ", "that grows"],
    );
    let one =
        matrices("[[240.0]]", "[[980.0]]", "[[0.0]]", ["[\"body\"]", "[[1.0]]", "[[0.0]]", "[1.0]", "[1.0]"]);
    refused(&own(&one), &["vehicle: expected springs that bring back every motion", "a pole at 0"]);
}

/// A vehicle file of matrices: masses, dampers, springs; names, wheel, its damping, rows of body and travel.
fn matrices(m: &str, c: &str, k: &str, [dofs, wheel, damping, body, travel]: [&str; 5]) -> String {
    format!(
        "model = \"matrices\"\n[matrices]\nm = {m}\nc = {c}\nk = {k}\ndofs = {dofs}\nwheel_stiffness = {wheel}\n\
         wheel_damping = {damping}\n[[matrices.wheel]]\nname = \"wheel\"\nat_m = [0.0, 0.0]\n[[matrices.output]]\n\
         name = \"sprung_acceleration\"\nacceleration = {body}\n[[matrices.output]]\nname = \"suspension_travel\"\n\
         displacement = {travel}\n[[matrices.actuator]]\nname = \"actuator\"\ncolumn = {travel}\n"
    )
}

/// What a controller costs or fails to buy is said beside it, in words.
#[test]
fn gains_of_no_actuator_and_gains_of_no_use_are_said() {
    let folder = Folder::new("words");
    let goal = "minimize = { sprung_acceleration = 1.0 }\nbound = { suspension_travel = 1.0, tire_deflection = 1.0 }";
    let strong = of_order(1).replace(goal, "minimize_h2 = { sprung_acceleration = 1.0 }");
    let made = folder.designed(&strong);
    let said = text_of(&made["warnings"], "high-gain");
    assert!(number(&made, &["claimed", "controller_gain"]) > 1.76e6, "{}", made["claimed"]);
    assert!(said.contains("suspension_travel") && said.contains("goal.max_gain = "), "{said}");
    // with the bound that it names there is none
    let bounded = folder.designed(&format!("{strong}max_gain = 176e3\n"));
    assert!(!names(&bounded["warnings"]).contains(&"high-gain"));
    assert!(!names(&folder.designed(&of_order(1))["warnings"]).contains(&"high-gain"));
    // a gain from the travel under bounds of 1 and 1 has no room
    let made = folder.designed(&of_order(0));
    let [before, after] = ["passive", "verified"].map(|of| number(&made, &["objective", of]));
    assert!((after / before - 1.0).abs() < 1e-4, "{after}");
    assert!(names(&made["notes"]).contains(&"no-gain-better"), "{}", made["notes"]);
    assert!(!names(&made["warnings"]).contains(&"worse-goal"));
    let (status, out, err) = folder.run("design design.toml");
    assert!(
        status == 0 && out.contains("a local optimum") && out.contains("the goal is above that by"),
        "{out} {err}"
    );
    // an integrator
    let free = CAR.replace("suspension_travel = 1.0, tire_deflection = 1.0", "tire_deflection = 1.1");
    folder.designed(&with(&free, "structure = \"pid\"\npid_filter_s = 0.01"));
    let (_, out, _) = folder.run("design design.toml");
    assert!(out.contains("infinite at 0 Hz (integrator)"), "{out}");
}

/// One track is alike to itself: a road whose left and right have a coherence of no filter is a quarter car's road.
#[test]
fn a_road_of_any_coherence_is_for_a_vehicle_on_one_track() {
    let folder = Folder::new("coherence");
    let of = |text: &str| text.replace("case:turkay-white-velocity", "case:iso8608-c");
    // the example of the README
    let readme = include_str!("../../../README.md");
    let (_, after) = readme.split_once("`fixed.toml`:\n```toml\n").unwrap();
    let example = after.split("```").next().unwrap();
    assert!(example.contains("case:iso8608-c"));
    let made = folder.designed(example);
    assert!(number(&made, &["objective", "verified"]) < 0.46);
    let full = of(&of_order(1)).replace("case:turkay-quarter-car", "case:guiggiani-full-car");
    let full = full
        .replace("sprung_acceleration", "heave_acceleration")
        .replace("[override]\ntire_damping_n_s_per_m = 98.0\n", "");
    let (status, _, err) = folder.design(&full);
    assert!(status == 2 && err.contains("[coherence]") && err.contains("kind = \"full\""), "{err}");
}

/// A gain's file may leave out what has no entries.
#[test]
fn a_gain_needs_no_rows_of_states() {
    let folder = Folder::new("gain");
    let k = r#"{"a": [], "b": [], "c": [], "d": [[1000.0]], "inputs": ["suspension_travel"], "outputs": ["actuator"]}"#;
    for c in ["[]", "[[]]"] {
        fs::write(folder.0.join("k.json"), k.replace("\"c\": []", &format!("\"c\": {c}"))).unwrap();
        let (status, _, err) = folder
            .run("ride case:turkay-quarter-car --road case:iso8608-c --speed-m-s 20 --controller k.json");
        assert_eq!(status, 0, "{err}");
    }
}
