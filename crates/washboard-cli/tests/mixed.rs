//! `washboard design` by matrix inequalities, as a user meets it: published figures, limits, ranges, and what is refused.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, names, number};
use serde_json::Value;
use std::fs;

/// §5.2.1 of the thesis: λ = .1, μ = 1, blocks (−I, −γ²I), c_t = 50.
const CAR: &str = r#"vehicle = "case:turkay-quarter-car"
road = "case:turkay-white-velocity"
speed_m_s = 20.0
method = "robust-state-feedback"
lyapunov_scale = "fixed"
[override]
tire_damping_n_s_per_m = 50.0
[goal]
minimize = { sprung_acceleration = 1.0, suspension_travel = 0.1 }
bound = { tire_deflection = 1.0 }
"#;

/// The same norm in other coordinates.
const ROUNDING: f64 = 1e-9;

/// Output feedback from the travel, which the thesis has too.
fn output_feedback() -> String {
    CAR.replace(
        "method = \"robust-state-feedback\"",
        "measurements = [\"suspension_travel\"]\nmethod = \"mixed-h2-hinf\"",
    )
}

/// The notes' figures of §5.2.1, to their digits, and the ride's own rms of the same controller from its file.
#[test]
fn the_quarter_cars_state_feedback_is_the_published_one() {
    let folder = Folder::new("state");
    for (mu, ct, published) in
        [(1.0, 50.0, 1.30914), (2.0, 50.0, 0.52389), (1.0, 0.0, 1.30523), (2.0, 100.0, 0.47419)]
    {
        let text = CAR
            .replace("tire_deflection = 1.0", &format!("tire_deflection = {mu:?}"))
            .replace("= 50.0", &format!("= {ct:?}"));
        let made = folder.designed(&text);
        let claimed = number(&made, &["claimed", "objective"]);
        assert!((claimed - published).abs() < 1e-5, "{mu} {ct}: {claimed}");
        // the gap is relative to the cost itself, not to 1 + cost: 35 iterations at most were seen
        let iterations = number(&made, &["claimed", "iterations"]);
        assert!(iterations <= 40.0, "{iterations}");
        // the promise is above what is so, the bound .87 to .94 of what is allowed
        let value = number(&made, &["claimed", "objective_recomputed"]);
        assert!(value < claimed && (value / number(&made, &["objective", "verified"]) - 1.0).abs() < 1e-9);
        let bound = number(&made, &["claimed", "hinf_tire_deflection"]);
        let found = number(&made, &["claimed", "hinf_tire_deflection_recomputed"]);
        assert!((bound / (mu * number(&made, &["passive", "hinf", "tire_deflection"])) - 1.0).abs() < 1e-6);
        assert!((0.85..1.0).contains(&(found / bound)), "{}", found / bound);
        assert!((found / number(&made, &["verified", "hinf", "tire_deflection"]) - 1.0).abs() < ROUNDING);
        let searched = folder.designed(&text.replace("\"fixed\"", "\"searched\""));
        let free = number(&searched, &["claimed", "objective"]);
        assert!(
            free < 0.89 * claimed && (ct != 50.0 || free <= if mu == 1.0 { 1.155 } else { 0.417 }),
            "{free}"
        );
    }
    fs::write(folder.0.join("design.toml"), CAR).unwrap();
    let (status, out, err) = folder.run("design design.toml -o made");
    assert_eq!(status, 0, "{err}");
    assert!(out.contains("a gain from 4 states") && out.contains("N per m/s"), "{out}");
    assert!(out.lines().all(|l| l.chars().count() <= 80), "{out}");
    let page = fs::read_to_string(folder.0.join("made/report.html")).unwrap();
    assert!(page.contains("the gain K of u = K y") && page.contains("sprung_velocity"));
    let controller: Value =
        serde_json::from_str(&fs::read_to_string(folder.0.join("made/controller.json")).unwrap()).unwrap();
    assert_eq!(controller["inputs"].as_array().unwrap().len(), 4);
    assert!(controller["a"].as_array().unwrap().is_empty());
    let car = folder
        .run("cases turkay-quarter-car")
        .1
        .replace("damping_n_s_per_m = 0.0", "damping_n_s_per_m = 50.0");
    fs::write(folder.0.join("car.toml"), car).unwrap();
    let (_, out, _) =
        folder.run("ride car.toml --road case:turkay-white-velocity --speed-m-s 20 --controller made --json");
    let ride: Value = serde_json::from_str(&out).unwrap();
    for (name, rms) in
        [("sprung_acceleration", 0.48894), ("suspension_travel", 0.00439), ("tire_deflection", 0.00159)]
    {
        let digits = if rms > 0.1 { 1e-5 } else { 0.5e-5 };
        assert!((number(&ride, &["rms", name]) - rms).abs() < digits, "{name}");
    }
    assert_eq!(folder.run("report made").0, 0);
    assert_eq!(fs::read_to_string(folder.0.join("made/report.html")).unwrap(), page);
}

/// Table 5.1: one gain for c_t from 25 to 50, the gain for c_t = 0 beside it; the column c_t = 35 by rides.
#[test]
fn one_gain_for_a_range_of_tires_is_the_published_one() {
    let folder = Folder::new("range");
    let text = CAR.replace(
        "[override]\ntire_damping_n_s_per_m = 50.0",
        "[range]\ntire_damping_n_s_per_m = [25.0, 50.0]",
    );
    let made = folder.designed(&text);
    let vertices = made["vertices"].as_array().unwrap();
    assert_eq!(vertices.len(), 3);
    for (vertex, (ct, passive, k0, kp)) in
        vertices.iter().zip([(25.0, 0.5379, 0.4951, 0.48789), (50.0, 0.5336, 0.4889, 0.48162)])
    {
        assert_eq!(number(vertex, &["at", "tire_damping_n_s_per_m"]), ct);
        let rms = |of: &str| number(vertex, &[of, "rms", "sprung_acceleration"]);
        assert!((rms("passive") - passive).abs() < 0.6e-4 && (rms("nominal") - k0).abs() < 0.6e-4, "{ct}");
        assert!((rms("closed") - kp).abs() < 2e-5, "{ct}: {}", rms("closed"));
        // the promise is one for all
        assert!(number(vertex, &["objective", "closed"]) <= number(&made, &["claimed", "objective"]));
        let found = number(vertex, &["closed", "hinf", "tire_deflection"]);
        let worst = number(&made, &["claimed", "hinf_tire_deflection_recomputed"]);
        assert!(found <= worst * (1.0 + ROUNDING));
    }
    assert_eq!(vertices[2]["corner"], Value::Bool(false));
    assert!(!names(&made["warnings"]).contains(&"corners-only"), "tire damping enters in a straight line");
    let car = folder
        .run("cases turkay-quarter-car")
        .1
        .replace("damping_n_s_per_m = 0.0", "damping_n_s_per_m = 35.0");
    fs::write(folder.0.join("car.toml"), car).unwrap();
    for (controller, published, digits) in
        [(&made["controller"], 0.48536, 2e-5), (&made["nominal"], 0.4926, 0.6e-4)]
    {
        fs::write(folder.0.join("k.json"), controller.to_string()).unwrap();
        let (_, out, err) = folder
            .run("ride car.toml --road case:turkay-white-velocity --speed-m-s 20 --controller k.json --json");
        let ride: Value = serde_json::from_str(&out).expect(&err);
        assert!((number(&ride, &["rms", "sprung_acceleration"]) - published).abs() < digits);
    }
    // a mass is in the denominator: nothing is proved between the corners
    let masses = text.replace("tire_damping_n_s_per_m = [25.0, 50.0]", "sprung_mass_kg = [200.0, 300.0]");
    assert!(names(&folder.designed(&masses)["warnings"]).contains(&"corners-only"));
    let two = text.replace("[range]\ntire_damping_n_s_per_m = [25.0, 50.0]", "")
        + "[[plant]]\ntire_damping_n_s_per_m = 25.0\n[[plant]]\ntire_damping_n_s_per_m = 50.0\n";
    let same = folder.designed(&two);
    assert_eq!(same["vertices"].as_array().unwrap().len(), 2);
    assert!(
        (number(&same, &["claimed", "objective"]) / number(&made, &["claimed", "objective"]) - 1.0).abs()
            < 1e-7
    );
}

/// The half car as printed, a box of both tires' damping: guaranteed costs 2.3899 (box) and 2.3889 (nominal), .07175 both;
/// heave at c_t = 100 .100713 and .100715.
#[test]
fn one_gain_for_a_box_of_tires_of_the_half_car_is_the_notes() {
    let folder = Folder::new("half");
    let car = folder.run("cases turkay-half-car").1;
    assert!(car.contains("[half-car]"));
    let car: Vec<&str> = car.lines().filter(|l| !l.starts_with("variant")).collect();
    let car = car.join("\n").replace("[half-car]", "[half-car]\nvariant = \"as-printed\"");
    fs::write(folder.0.join("half.toml"), car).unwrap();
    for (lambda, mu, box_, nominal) in [(1.0, 1.0, 2.3899, 2.3889), (0.1, 1.5, 0.07175, 0.07175)] {
        let text = format!(
            "vehicle = \"half.toml\"\nroad = \"case:turkay-white-velocity-rounded\"\nspeed_m_s = 20.0\nmethod = \"robust-state-feedback\"\n\
             lyapunov_scale = \"fixed\"\n[range]\n\"front.tire_damping_n_s_per_m\" = [0.0, 100.0]\n\"rear.tire_damping_n_s_per_m\" = [0.0, 100.0]\n\
             [goal]\nminimize = {{ heave_acceleration = 1.0, pitch_acceleration = 1.0, suspension_travel_front = {lambda:?}, \
             suspension_travel_rear = {lambda:?} }}\nbound = {{ tire_deflection = {mu:?} }}\n"
        );
        let made = folder.designed(&text);
        let printed = 0.6 * 10f64.powi(if lambda == 1.0 { -4 } else { -5 });
        assert!((number(&made, &["claimed", "objective"]) - box_).abs() < printed);
        assert!((number(&made, &["claimed", "nominal_objective"]) - nominal).abs() < printed);
        let vertices = made["vertices"].as_array().unwrap();
        assert_eq!(vertices.len(), 5);
        if lambda == 1.0 {
            let last = &vertices[3];
            assert!((number(last, &["closed", "rms", "heave_acceleration"]) - 0.100713).abs() < 2e-6);
            assert!((number(last, &["nominal", "rms", "heave_acceleration"]) - 0.100715).abs() < 2e-6);
        }
    }
}

/// Nothing that is measured beats all states, and the travel comes within 2 % of them; its poles and gains are said.
#[test]
fn output_feedback_comes_near_and_keeps_to_its_limits() {
    let folder = Folder::new("output");
    let made = folder.designed(&output_feedback());
    let claimed = number(&made, &["claimed", "objective"]);
    assert!((1.30914 * (1.0 - 1e-6)..1.02 * 1.30914).contains(&claimed), "{claimed}");
    assert!(number(&made, &["claimed", "objective_recomputed"]) < claimed);
    assert!(names(&made["warnings"]).contains(&"slow-loop"));
    let poles = |made: &Value| -> Vec<[f64; 2]> {
        serde_json::from_value(made["verified"]["poles"].clone()).unwrap()
    };
    // the controller's own poles, from its file
    let fastest = |made: &Value| {
        fs::write(folder.0.join("k.json"), made["controller"].to_string()).unwrap();
        let (file, _) = washboard::study::read_controller(&folder.0.join("k.json")).unwrap();
        file.state_space().unwrap().poles().unwrap().iter().map(|p| p.norm()).fold(0.0, f64::max)
    };
    let free = fastest(&made);
    assert!(
        (free / number(&made, &["claimed", "fastest_controller_pole"]) - 1.0).abs() < 1e-9 && free > 600.0
    );
    let slow = folder.designed(&(output_feedback() + "max_pole_rad_s = 500.0\n"));
    assert!(fastest(&slow) <= 500.0, "{}", fastest(&slow));
    assert!(names(&slow["notes"]).contains(&"backed-off"));
    assert!(number(&slow, &["claimed", "objective"]) >= claimed * (1.0 - 1e-6));
    let (status, none, _) = folder.design(&(output_feedback() + "max_pole_rad_s = 5.0\n"));
    assert_eq!((status, none["status"].as_str()), (1, Some("refused")));
    let why = none["why"].as_str().unwrap();
    assert!(why.contains("goal.max_pole_rad_s is 5 rad/s, and the controller's fastest pole is"), "{why}");
    assert!(none.get("controller").is_none() && none.get("verified").is_none());
    // what no back-off gives a weight of the control does, unless bounds ask for more
    let weighted = folder.designed(&(CAR.to_owned() + "max_gain = 2.5e4\n"));
    assert!(number(&weighted, &["claimed", "controller_gain"]) <= 2.5e4);
    assert!(names(&weighted["warnings"]).contains(&"added-weight"));
    let tight = CAR.replace("tire_deflection = 1.0", "tire_deflection = 0.3");
    let (status, none, _) = folder.design(&(tight + "max_gain = 100.0\n"));
    let why = none["why"].as_str().unwrap();
    assert!(status == 1 && why.contains("goal.max_gain is 100 N per unit"), "{why}");
    let gentle = folder.designed(&(CAR.to_owned() + "max_gain = 1e5\n"));
    assert!(number(&gentle, &["claimed", "controller_gain"]) <= 1e5);
    // a region of the loop's poles, and the sensors' noise as a part of the promise
    let region = output_feedback().replace(
        "[override]",
        "poles = { max_real_rad_s = -0.5, rectangle_rad_s = 150.0, min_damping = 0.05 }\n[override]",
    );
    let inside = folder.designed(&region);
    for [re, im] in poles(&inside) {
        assert!(re < -0.5 && re > -150.0 && im.abs() < 150.0 && -re / re.hypot(im) > 0.05, "{re} {im}");
    }
    assert!(poles(&made).iter().any(|p| p[0] > -0.5 || p[0] < -150.0), "the region asks for nothing");
    let noisy = output_feedback().replace("[goal]", "[mixed]\nsensor_noise = 1e-8\n[goal]");
    let noisy = folder.designed(&noisy);
    assert!(number(&noisy, &["claimed", "objective"]) > claimed && fastest(&noisy) < free);
}

/// Below what is possible: the smallest bound that is, and that it is one.
#[test]
fn a_bound_that_cannot_be_kept_is_answered_with_the_smallest() {
    let folder = Folder::new("bound");
    let region = |bound: f64| {
        CAR.replace("tire_deflection = 1.0", &format!("tire_deflection = {bound:?}"))
            .replace("[override]", "poles = { max_abs_rad_s = 90.0 }\n[override]")
    };
    let (status, none, err) = folder.design(&region(0.3));
    assert_eq!((status, none["status"].as_str()), (1, Some("infeasible")), "{err}");
    let smallest = number(&none, &["feasible_bound", "tire_deflection"]);
    let why = none["why"].as_str().unwrap();
    assert!(why.contains("keeps to the bounds { tire_deflection = 0.3 }") && smallest > 0.3, "{why}");
    folder.designed(&region(smallest));
    assert_eq!(folder.design(&region(0.98 * smallest)).0, 1);
    let mut nowhere = region(1.0).replace("bound = { tire_deflection = 1.0 }\n", "");
    nowhere = nowhere.replace("90.0", "1e-3");
    let (status, none, _) = folder.design(&nowhere);
    assert!(status == 1 && none.get("controller").is_none(), "{}", none["status"]);
}

#[test]
fn fewer_states_are_shown_with_their_own_loops() {
    let folder = Folder::new("truncated");
    let text = "vehicle = \"case:turkay-half-car\"\nroad = \"case:turkay-white-velocity-rounded\"\nspeed_m_s = 20.0\n\
                measurements = [\"suspension_travel\"]\nmethod = \"mixed-h2-hinf\"\ntruncate_to = [8, 6, 2]\n\
                poles = { max_real_rad_s = -0.2 }\n[goal]\nminimize = { body = 1.0, suspension_travel = 1.0 }\n\
                bound = { tire_deflection = 1.5 }\ngroups = { body = [\"heave_acceleration\", \"pitch_acceleration\"] }\n";
    let made = folder.designed(text);
    assert_eq!(made["order"], 8);
    assert!(names(&made["notes"]).contains(&"not-truncated"), "order 8 is the controller itself");
    let cut = made["truncated"].as_array().unwrap();
    assert_eq!(cut.len(), 2);
    for (one, order) in cut.iter().zip([6, 2]) {
        let poles: Vec<[f64; 2]> = serde_json::from_value(one["verified"]["poles"].clone()).unwrap();
        assert_eq!((one["order"].as_u64(), poles.len()), (Some(order), 8 + order as usize));
        let stable = poles.iter().all(|p| p[0] < 0.0);
        assert_eq!(one["verified"]["stable"].as_bool(), Some(stable));
        assert_eq!(one.get("objective").is_some(), stable);
        // the same loop by a ride from the controller's file
        fs::write(folder.0.join("k.json"), one["controller"].to_string()).unwrap();
        let ride = "ride case:turkay-half-car --road case:turkay-white-velocity-rounded --speed-m-s 20 --controller k.json --json";
        let (status, out, _) = folder.run(ride);
        assert_eq!(status == 0, stable);
        if stable {
            let ride: Value = serde_json::from_str(&out).unwrap();
            let of = |v: &Value| number(v, &["rms", "suspension_travel"]);
            assert!((of(&ride) / of(&one["verified"]) - 1.0).abs() < 1e-9);
        }
    }
    // a group is a row of its members' kind, and not what names that begin like it are corners of
    fs::write(folder.0.join("design.toml"), text).unwrap();
    let out = folder.run("design design.toml").1;
    let comfort = out.split("comfort").nth(1).unwrap().split("rattle space").next().unwrap();
    assert!(comfort.contains("\n  body ") && comfort.contains("\n  body_acceleration "), "{out}");
    // a group has the joint norm of its members
    let h2 = |of: &str, name: &str| number(&made, &[of, "h2", name]);
    for of in ["passive", "verified"] {
        let joint = h2(of, "heave_acceleration").hypot(h2(of, "pitch_acceleration"));
        assert!((h2(of, "body") / joint - 1.0).abs() < 1e-9);
    }
}

#[test]
fn wrong_designs_are_answered_by_field() {
    let folder = Folder::new("wrong");
    let range = "[range]\ntire_damping_n_s_per_m = [25.0, 50.0]\n[override]";
    for (from, to, words) in [
        (
            "[override]",
            "[range]\ntyre_damping = [1.0, 2.0]\n[override]",
            "range: expected fields and values of the vehicle",
        ),
        (
            "[override]",
            "[range]\ntire_damping_n_s_per_m = [50.0, 25.0]\n[override]",
            "tire_damping_n_s_per_m = [50, 25]",
        ),
        (
            "[override]",
            "[range]\nsprung_mass_kg = [-1.0, 2.0]\n[override]",
            "range: expected fields and values",
        ),
        (
            "[override]",
            "truncate_to = [2]\n[override]",
            "truncate_to: expected nothing with method robust-state-feedback",
        ),
        (
            "[override]",
            "poles = { max_real_rad_s = -9.0, max_abs_rad_s = 8.0 }\n[override]",
            "-9: no pole is in this region",
        ),
        (
            "[override]",
            "poles = { max_real_rad_s = 1.0 }\n[override]",
            "poles.max_real_rad_s: expected a finite number, not positive",
        ),
        (
            "[override]",
            "poles = { min_damping = 1.5 }\n[override]",
            "poles.min_damping: expected a ratio between 0 and 1",
        ),
        ("[override]", "poles = { slower = 1.0 }\n[override]", "unknown field `slower`"),
        ("\"fixed\"", "\"free\"", "expected \"searched\", \"fixed\" or a number"),
        ("\"fixed\"", "-1.0", "lyapunov_scale: expected"),
        (
            "{ tire_deflection = 1.0 }",
            "{ tire_deflection = 0.0 }",
            "goal.bound: expected multiples of the passive norm",
        ),
        ("{ tire_deflection = 1.0 }", "{ tire_deflexion = 1.0 }", "did you mean `tire_deflection`?"),
        (
            "sprung_acceleration = 1.0, suspension_travel = 0.1",
            "sprung_acceleration = 0.0",
            "a weight above 0",
        ),
        ("[goal]\n", "[goal]\nmax_pole_rad_s = 10.0\n", "a state feedback has no poles of its own"),
        (
            "[goal]\n",
            "[goal]\ngroups = { sprung_acceleration = [\"tire_deflection\"] }\n",
            "names that are not outputs",
        ),
        (
            "\"robust-state-feedback\"",
            "\"lqg\"\nmeasurements = [\"suspension_travel\"]",
            "goal.bound: expected nothing with method lqg",
        ),
        (
            "method",
            "measurements = [\"suspension_travel\", \"tire_deflection\"]\nmethod",
            "show all 4 states, found 2 outputs that show 2",
        ),
        (
            "method",
            "measurements = [\"sprung_acceleration\"]\nmethod",
            "`sprung_acceleration`, which road or force reach at once",
        ),
        (
            "[override]",
            "[range]\nsuspension_travel = [1.0, 2.0]\n[override]",
            "no parameter `suspension_travel`",
        ),
        ("[override]", &format!("{range}\nsprung_mass = 1.0"), "no parameter `sprung_mass`"),
    ] {
        assert!(CAR.contains(from), "{from}");
        let (status, out, err) = folder.design(&CAR.replacen(from, to, 1));
        assert!(status == 2 && out.is_null(), "{to}: {err}");
        assert!(err.contains(words), "{to}: {err}");
    }
    // delays behind each other are states that nothing on the vehicle measures
    let road = "kind = \"white-velocity\"\nintensity_m2_per_s = 1e-4\n[coherence]\nkind = \"none\"\n";
    fs::write(folder.0.join("road.toml"), road).unwrap();
    let half = "vehicle = \"case:turkay-half-car\"\nroad = \"road.toml\"\nspeed_m_s = 20.0\nmethod = \"robust-state-feedback\"\n\
                [goal]\nminimize = { heave_acceleration = 1.0 }\n";
    let (status, _, err) = folder.design(half);
    assert!(status == 2 && err.contains("4 of these are of the road's filter"), "{err}");
    // a vehicle of the range with a mode without damping that no actuator reaches
    fs::write(folder.0.join("hook.toml"), HOOK).unwrap();
    let text = "vehicle = \"hook.toml\"\nroad = \"case:turkay-white-velocity\"\nspeed_m_s = 20.0\nmethod = \"robust-state-feedback\"\n\
                [range]\n\"c.2.2\" = [0.0, 20.0]\n[goal]\nminimize = { body_acceleration = 1.0, travel = 1.0 }\n";
    let (status, _, err) = folder.design(text);
    let words = "range: expected vehicles that the actuators stabilise, found c.2.2 = 0: the controls do not reach the mode at 31.6 rad/s";
    assert!(status == 2 && err.contains(words), "{err}");
    assert_eq!(folder.design(&text.replace("[0.0,", "[1.0,")).0, 0);
}

/// A car with something on a spring of its own.
const HOOK: &str = r#"model = "matrices"
[matrices]
m = [[240.0, 0.0, 0.0], [0.0, 36.0, 0.0], [0.0, 0.0, 5.0]]
c = [[980.0, -980.0, 0.0], [-980.0, 980.0, 0.0], [0.0, 0.0, 20.0]]
k = [[16000.0, -16000.0, 0.0], [-16000.0, 176000.0, 0.0], [0.0, 0.0, 5000.0]]
wheel_stiffness = [[0.0], [160000.0], [5000.0]]
[[wheel]]
name = "one"
at_m = [0.0, 0.0]
[[actuator]]
name = "damper"
column = [-1.0, 1.0, 0.0]
[[output]]
name = "body_acceleration"
acceleration = [1.0, 0.0, 0.0]
[[output]]
name = "travel"
displacement = [1.0, -1.0, 0.0]
[[output]]
name = "tire_deflection"
displacement = [0.0, 1.0, 0.0]
road = [-1.0]
[[output]]
name = "hook_travel"
displacement = [0.0, 0.0, 1.0]
road = [-1.0]
[[output]]
name = "body_velocity"
velocity = [1.0, 0.0, 0.0]
[[output]]
name = "wheel_velocity"
velocity = [0.0, 1.0, 0.0]
[[output]]
name = "hook_velocity"
velocity = [0.0, 0.0, 1.0]
"#;
