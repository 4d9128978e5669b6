//! `washboard design` by matrix inequalities where what is asked is hard, absurd or miswritten, as a user meets it.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, names, number, text_of};
use serde_json::Value;

const QUARTER: &str =
    "vehicle = \"case:turkay-quarter-car\"\nroad = \"case:turkay-white-velocity\"\nspeed_m_s = 20.0\n";
const MIXED: &str =
    "measurements = [\"suspension_travel\", \"sprung_acceleration\"]\nmethod = \"mixed-h2-hinf\"\n";
const ROBUST: &str = "method = \"robust-state-feedback\"\n";
const GOAL: &str = "[goal]\nminimize = { sprung_acceleration = 1.0, suspension_travel = 1.0 }\n";

/// A promise may be exceeded by the solver's rounding.
const EXCESS: f64 = 1e-4;

fn poles(made: &Value) -> Vec<[f64; 2]> {
    serde_json::from_value(made["verified"]["poles"].clone()).unwrap()
}

/// Where rounding leaves a pole at 0 the design is made again left of a margin, says so, and keeps what was asked.
#[test]
fn hard_bounds_and_regions_are_kept_with_a_margin() {
    let folder = Folder::new("margin");
    let bound = |b: f64| format!("{QUARTER}{MIXED}{GOAL}bound = {{ tire_deflection = {b:?} }}\n");
    for b in [0.1, 0.2, 0.3, 0.6] {
        let made = folder.designed(&bound(b));
        let (margin, warnings) = (number(&made, &["claimed", "pole_margin"]), &made["warnings"]);
        assert!(poles(&made).iter().all(|p| p[0] <= -margin * (1.0 - 1e-3)) && margin > 0.1, "{b}");
        let shown = format!("left of −{margin:.3} 1/s");
        assert!(text_of(warnings, "pole-margin").contains(&shown), "{b}: {warnings}");
        let of = |which: &str| number(&made, &[which, "hinf", "tire_deflection"]);
        assert!(of("verified") <= b * of("passive") * (1.0 + EXCESS), "{b}");
    }
    for ratio in [0.7, 0.9] {
        let made = folder.designed(&format!("{QUARTER}{MIXED}poles = {{ min_damping = {ratio} }}\n{GOAL}"));
        for [re, im] in poles(&made) {
            assert!(re < 0.0 && -re / re.hypot(im) > ratio - 1e-3, "{ratio}: {re} {im}");
        }
    }
    // an output that weighs nothing, and no back-off
    let still = GOAL.replace("suspension_travel = 1.0", "suspension_travel = 0");
    folder.designed(&format!("{QUARTER}{MIXED}{still}"));
    folder.designed(&format!("{QUARTER}{MIXED}{GOAL}[mixed]\nback_off = 0.0\n"));
    // nothing is said where nothing was done
    let plain = folder.designed(&format!("{QUARTER}{MIXED}{GOAL}"));
    assert!(plain["claimed"].get("pole_margin").is_none());
}

/// Bounds far below what output feedback keeps to, with a proof or spoiled by rounding: the smallest that can be had, and that
/// it can.
#[test]
fn the_smallest_bound_of_output_feedback_is_found_and_can_be_had() {
    let folder = Folder::new("smallest");
    let bound = |b: f64| {
        format!("{QUARTER}lyapunov_scale = \"fixed\"\n{MIXED}{GOAL}bound = {{ tire_deflection = {b:?} }}\n")
    };
    for asked in [1e-6, 0.003] {
        let (status, none, err) = folder.design(&bound(asked));
        assert_eq!(status, 1, "{err}");
        let smallest = number(&none, &["feasible_bound", "tire_deflection"]);
        let why = none["why"].as_str().unwrap();
        assert!(smallest > asked && smallest < 0.2 && why.contains("the smallest that were found"), "{why}");
        folder.designed(&bound(smallest));
    }
}

/// Gains that no actuator has are said against the vehicle's springs and dampers; a limit on them is kept by a weight.
#[test]
fn gains_without_bound_are_said_and_can_be_limited() {
    let folder = Folder::new("gain");
    let text = format!(
        "{}{ROBUST}[goal]\nminimize = {{ heave_acceleration = 1, suspension_travel = 0.5, tire_deflection = 0.5 }}\n\
         bound = {{ tire_deflection = 1.1, pitch_acceleration = 0.9 }}\n",
        QUARTER.replace("quarter", "half")
    );
    let free = folder.designed(&text);
    let said = text_of(&free["warnings"], "high-gain");
    assert!(said.contains("times the vehicle's own") && said.contains("state input_weight = "), "{said}");
    let largest = |made: &Value| -> f64 {
        let rows: Vec<Vec<f64>> = serde_json::from_value(made["controller"]["d"].clone()).unwrap();
        rows.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    assert!(largest(&free) > 1e8);
    let most = 1e5;
    let gentle = folder.designed(&(text.clone() + &format!("max_gain = {most:e}\n")));
    assert!(largest(&gentle) <= most && number(&gentle, &["claimed", "controller_gain"]) <= most);
    let weight = number(&gentle, &["claimed", "added_input_weight"]);
    assert!(weight > 0.0 && names(&gentle["warnings"]).contains(&"added-weight"));
    assert!(!names(&gentle["warnings"]).contains(&"high-gain"));
    // the same by hand
    let stated = folder.designed(&format!("input_weight = {weight:e}\n{text}"));
    let cost = |made: &Value| number(made, &["claimed", "objective"]);
    assert!((cost(&stated) / cost(&gentle) - 1.0).abs() < 1e-6);
    // the same for two vehicles, whose free gain has poles of 1e11 rad/s
    let range = format!("{text}max_gain = {most:e}\n[range]\nsprung_mass_kg = [450, 550]\n");
    assert!(largest(&folder.designed(&range)) <= most);
    // where the bounds need the gain, the least that was found is said
    let (status, none, _) = folder.design(&(text + "max_gain = 1e-3\n"));
    let why = none["why"].as_str().unwrap();
    assert!(status == 1 && why.contains("with the control weighted") && why.contains("N per unit"), "{why}");
    assert!(!names(&folder.designed(&format!("{QUARTER}{ROBUST}{GOAL}"))["warnings"]).contains(&"high-gain"));
}

/// A truncation whose loop is not stable is no controller: said, and not written.
#[test]
fn unstable_truncations_are_said_and_not_written() {
    let folder = Folder::new("truncated");
    let text = format!(
        "{}measurements = [\"suspension_travel\", \"heave_acceleration\"]\ntruncate_to = [6, 4]\nmethod = \"mixed-h2-hinf\"\n\
         [goal]\nminimize = {{ heave_acceleration = 1.0, suspension_travel = 0.1 }}\n",
        QUARTER.replace("quarter", "half")
    );
    let made = folder.designed(&text);
    let stable = |order: u64| {
        let all = made["truncated"].as_array().unwrap();
        all.iter().find(|t| t["order"] == order).unwrap()["verified"]["stable"].as_bool().unwrap()
    };
    assert!(!stable(6) || !stable(4), "the case has an unstable truncation");
    folder.run("design design.toml -o made --quiet");
    for order in [6, 4] {
        let said = text_of(&made["warnings"], "truncated-unstable");
        assert_eq!(said.contains(&order.to_string()), !stable(order), "{said}");
        let file = folder.0.join(format!("made/controller-order-{order}.json"));
        assert_eq!(file.exists(), stable(order), "{order}");
    }
}

/// The full car from few measurements without noise: what to state, with numbers, not what happened in a solver.
#[test]
fn a_solver_that_stalls_is_answered_with_what_to_state() {
    let folder = Folder::new("stalled");
    let text = "vehicle = \"case:chalasani-full-car\"\nroad = \"case:turkay-first-order\"\nspeed_m_s = 20.0\ndisturbance = \"road-noise\"\n\
                measurements = [\"suspension_travel\", \"heave_acceleration\"]\nmethod = \"mixed-h2-hinf\"\n\
                [goal]\nminimize = { heave_acceleration = 1.0, suspension_travel = 0.5 }\n";
    let (status, none, err) = folder.design(text);
    assert_eq!((status, none["status"].as_str()), (1, Some("stalled")), "{err}");
    let why = none["why"].as_str().unwrap();
    for words in [
        "mixed.sensor_noise = 1e-6",
        "mixed.back_off = 0.05",
        "input_weight = 1e-8",
        "poles = { max_real_rad_s = -0.1",
    ] {
        assert!(why.contains(words), "{words}: {why}");
    }
    let advised = format!("input_weight = 1e-8\n{text}[mixed]\nsensor_noise = 1e-6\nback_off = 0.05\n");
    let made = folder.designed(&advised);
    assert!(number(&made, &["objective", "verified"]) < number(&made, &["objective", "passive"]));
}

/// An H2 norm that is bounded instead of weighted: the bound of a point of the trade-off gives that point, since one Lyapunov
/// matrix (the covariance itself) is exact for H2 norms alone.
#[test]
fn a_bounded_h2_norm_gives_the_point_of_the_trade_off() {
    let folder = Folder::new("h2");
    let ratio = |made: &Value, name: &str| {
        number(made, &["verified", "h2", name]) / number(made, &["passive", "h2", name])
    };
    for (method, near) in [(ROBUST, 1e-3), (MIXED, 2e-2)] {
        let both = "[goal]\nminimize = { sprung_acceleration = 1.0, suspension_travel = 0.5 }\n";
        let weighted = folder.designed(&format!("{QUARTER}{method}{both}"));
        let [comfort, travel] = ["sprung_acceleration", "suspension_travel"].map(|n| ratio(&weighted, n));
        let text = |bound: f64| {
            format!(
                "{QUARTER}{method}[goal]\nminimize = {{ sprung_acceleration = 1.0 }}\nbound_h2 = {{ suspension_travel = {bound:?} }}\n"
            )
        };
        let bounded = folder.designed(&text(travel));
        assert!((ratio(&bounded, "sprung_acceleration") / comfort - 1.0).abs() < near, "{method}");
        assert!((ratio(&bounded, "suspension_travel") / travel - 1.0).abs() < near, "{method}");
        let claimed = number(&bounded, &["claimed", "h2_suspension_travel"]);
        let found = number(&bounded, &["claimed", "h2_suspension_travel_recomputed"]);
        let passive = number(&bounded, &["passive", "h2", "suspension_travel"]);
        assert!(found <= claimed * (1.0 + EXCESS) && claimed <= travel * passive * (1.0 + EXCESS));
        assert!((found / number(&bounded, &["verified", "h2", "suspension_travel"]) - 1.0).abs() < 1e-6);
        // more room is more comfort
        let wide = folder.designed(&text(1.2 * travel));
        assert!(ratio(&wide, "sprung_acceleration") < 0.99 * comfort, "{method}");
    }
    // a group, another norm beside it, and several bounds that cannot be had together
    let groups = "groups = { both = [\"suspension_travel\", \"tire_deflection\"] }\n";
    let goal = "[goal]\nminimize = { sprung_acceleration = 1.0 }\nbound = { tire_deflection = 1.2 }\n";
    let made = folder.designed(&format!("{QUARTER}{ROBUST}{goal}bound_h2 = {{ both = 0.9 }}\n{groups}"));
    assert!(ratio(&made, "both") <= 0.9 * (1.0 + EXCESS));
    let none = "[goal]\nbound_h2 = { sprung_acceleration = 0.05, suspension_travel = 0.05, tire_deflection = 0.05 }\n";
    let (status, none, err) = folder.design(&format!("{QUARTER}{ROBUST}{none}"));
    assert_eq!((status, none["status"].as_str()), (1, Some("infeasible")), "{err}");
    let smallest = number(&none, &["feasible_bound", "suspension_travel"]);
    let at = |b: f64| {
        format!(
            "{QUARTER}{ROBUST}[goal]\nbound_h2 = {{ sprung_acceleration = {b:?}, suspension_travel = {b:?}, tire_deflection = {b:?} }}\n"
        )
    };
    folder.designed(&at(smallest));
    assert_eq!(folder.design(&at(0.97 * smallest)).0, 1);
}

/// What is miswritten is refused by its field, with what was found.
#[test]
fn miswritten_fields_are_named() {
    let folder = Folder::new("wrong");
    let mixed = |top: &str, more: &str| format!("{QUARTER}{top}{MIXED}{GOAL}{more}");
    let robust = |more: &str| format!("{QUARTER}{ROBUST}{GOAL}{more}");
    let goal = |goal: &str| format!("{QUARTER}{MIXED}[goal]\n{goal}\n");
    for (text, words) in [
        (
            robust("[range]\nsprung_mass_kg = [100, 200, 300]\n"),
            "range.sprung_mass_kg: expected a list of two numbers, found 3: [100, 200, 300]",
        ),
        (
            robust("[range]\nsprung_mass_kg = [100]\n"),
            "range.sprung_mass_kg: expected a list of two numbers, found 1",
        ),
        (
            robust("[range]\nfront.tire_damping_n_s_per_m = [0, 50]\n"),
            "\"front.tire_damping_n_s_per_m\" = [low, high]",
        ),
        (
            robust("[range]\nsprung_mass_kg = [1e-300, 1e300]\n"),
            "range: expected fields and values of the vehicle, found sprung_mass_kg = 1e-300: values so small or large",
        ),
        (robust("[range]\nsprung_mass_kg = [-200, 200]\n"), "found sprung_mass_kg = -200: "),
        (robust("[[plant]]\n"), "plant: expected fields of the vehicle and their values, found nothing"),
        (robust("[[plant]]\nsprung_mass_kg = \"a\"\n"), "expected a number"),
        (robust("[[plant]]\nfront.mass_kg = 1.0\n"), "a name with a dot stands in quotes"),
        (robust("[lqg]\nsensor_noise = 1e-8\n"), "lqg: expected nothing with method robust-state-feedback"),
        (
            mixed("", "[lqg]\nsensor_noise = 1e-8\n"),
            "lqg: expected nothing with method mixed-h2-hinf: the sensors' noise is mixed.sensor_noise",
        ),
        (mixed("truncate_to = [0]\n", ""), "truncate_to: expected a list of whole numbers from 1, found 0"),
        (mixed("truncate_to = [-1]\n", ""), "truncate_to: expected a list of whole numbers from 1, found -1"),
        (mixed("truncate_to = [2, 2]\n", ""), "truncate_to: expected each order once, found 2 twice"),
        (
            mixed("poles = { min_damping = 1.0 }\n", ""),
            "poles.min_damping: expected a ratio between 0 and 1, both left out",
        ),
        (
            mixed("", "bound_h2 = { tire_deflection = -1 }\n"),
            "goal.bound_h2: expected multiples of the passive norm",
        ),
        (
            mixed("", "bound_h2 = { nosuch = 1 }\n"),
            "goal.bound_h2: expected outputs of the vehicle, found `nosuch`",
        ),
        (
            mixed("", "bound = { tire_deflection = 1e300 }\n"),
            "goal.bound: expected multiples of the passive norm, above 0, from 1e-9 to 1e9, found tire_deflection = 1e300",
        ),
        (
            goal("minimize = { sprung_acceleration = 1e200 }"),
            "goal.minimize: expected weights: 0, or finite numbers from 1e-9 to 1e9, found sprung_acceleration = 1e200",
        ),
        (goal("minimize = { sprung_acceleration = inf }"), "found sprung_acceleration = inf"),
        (
            goal("minimize = { body = 1 }\ngroups = { body = [\"tire_deflection\", \"tire_deflection\"] }"),
            "goal.groups: expected each output once, found `tire_deflection` twice in `body`",
        ),
        (
            goal("minimize = { body = 1 }\ngroups = { body = [] }"),
            "goal.groups: expected outputs in each group, found none in `body`",
        ),
        (
            goal("minimize = { body = 1 }\ngroups = { body = [\"tyres\"], tyres = [\"tire_deflection\"] }"),
            "goal.groups: expected outputs of the vehicle in each group, and no other group, found `tyres` in `body`",
        ),
        (
            robust("[range]\nsprung_mass_kg = [200, 300]\n[[plant]]\nsprung_mass_kg = 240\n"),
            "found `sprung_mass_kg` in [[plant]] number 1, and `sprung_mass_kg` in [range]",
        ),
        (
            mixed("", "").replace("\"sprung_acceleration\"]", "\"actuator_force\"]"),
            "measurements: expected outputs of the vehicle that are not the controller's own, found `actuator_force`",
        ),
        (
            mixed("", "[override]\nsuspension_damping_n_s_per_m = 0\ntire_damping_n_s_per_m = 0\n"),
            "vehicle: expected a passive vehicle that is damped and stable: goals are over its norms, found a vehicle with suspension_damping_n_s_per_m = 0, ",
        ),
    ] {
        let (status, out, err) = folder.design(&text);
        assert!(status == 2 && out.is_null(), "{words}: {status} {err}");
        assert!(err.contains(words) && !err.contains("usize") && !err.contains("f64"), "{words}: {err}");
    }
    let psi = "vehicle = \"case:turkay-quarter-car\"\nroad = \"case:turkay-white-velocity\"\nspeed_m_s = 20.0\nmethod = \"interpolation\"\n\
               measurements = [\"suspension_travel\"]\n[interpolation]\nfictitious_tire_damping_n_s_per_m = 98.0\npsi = [1.0, 2.0, 3.0]\n";
    let (status, _, err) = folder.design(psi);
    assert!(
        status == 2 && err.contains("interpolation.psi: expected a list of two numbers, found 3"),
        "{err}"
    );
    // an order that the controller has or exceeds is left out, and said
    let above = folder.designed(&mixed("truncate_to = [9]\n", ""));
    assert!(text_of(&above["notes"], "not-truncated").contains("truncate_to"), "{}", above["notes"]);
}

/// A gain from the states of a road's height measures displacements: on a road whose height wanders without bound so do its forces,
/// and no mode or rounding is at fault. Where the height is bounded the same is designed.
#[test]
fn states_that_follow_an_unbounded_road_are_refused_by_the_disturbance() {
    let folder = Folder::new("height");
    let text = |road: &str, top: &str| {
        format!(
            "{}{ROBUST}disturbance = \"road-displacement\"\n{top}[goal]\nminimize = {{ sprung_acceleration = 1, suspension_travel = 1 }}\n",
            QUARTER.replace("turkay-white-velocity", road)
        )
    };
    for top in ["input_weight = 1e-4\n", "poles = { max_real_rad_s = -0.2, max_abs_rad_s = 1000 }\n"] {
        let (status, none, err) = folder.design(&text("turkay-white-velocity", top));
        assert!(status == 2 && none.is_null(), "{status} {err}");
        assert!(
            err.contains(
                "disturbance: expected road-velocity, or road-displacement on a road of kind first-order"
            ),
            "{err}"
        );
        assert!(err.contains("sprung_displacement`") && err.contains("its height has no bound"), "{err}");
    }
    let made = folder.designed(&text("turkay-first-order", "input_weight = 1e-4\n"));
    assert!(number(&made, &["verified", "rms", "suspension_travel"]) > 0.0);
    // the same of measurements that are stated
    let mixed = format!("{QUARTER}{MIXED}disturbance = \"road-displacement\"\n{GOAL}")
        .replace("\"sprung_acceleration\"]", "\"sprung_displacement\"]");
    let (status, _, err) = folder.design(&mixed);
    assert!(status == 2 && err.contains("measurements: expected outputs with a finite variance"), "{err}");
}

/// Of a bare name and a specific one the specific one has its number, in whatever order they stand, in `override` and in `range`:
/// what is said of a corner is what was examined.
#[test]
fn a_specific_field_has_its_own_value_beside_a_bare_one() {
    let folder = Folder::new("specific");
    let text = |more: &str| {
        let top = format!("{}{ROBUST}input_weight = 1e-6\n", QUARTER.replace("quarter", "half"));
        format!("{top}[goal]\nminimize = {{ heave_acceleration = 1, tire_deflection = 0.5 }}\n{more}")
    };
    let passive = |of: &Value| number(of, &["passive", "h2", "tire_deflection"]);
    let apart = |front: f64, rear: f64| {
        let both =
            format!("\"front.tire_damping_n_s_per_m\" = {front}\n\"rear.tire_damping_n_s_per_m\" = {rear}\n");
        passive(&folder.designed(&text(&format!("[override]\n{both}"))))
    };
    let (bare, front) = ("tire_damping_n_s_per_m", "\"front.tire_damping_n_s_per_m\"");
    let expected = apart(1000.0, 50.0);
    assert!((apart(50.0, 50.0) / expected - 1.0).abs() > 1e-3, "the case can tell them apart");
    for fields in [format!("{bare} = 50\n{front} = 1000\n"), format!("{front} = 1000\n{bare} = 50\n")] {
        let made = folder.designed(&text(&format!("[override]\n{fields}")));
        assert!((passive(&made) / expected - 1.0).abs() < 1e-9, "{fields}");
    }
    let both = [format!("{bare} = [50, 60]\n"), format!("{front} = [900, 1000]\n")];
    for fields in [both.concat(), format!("{}{}", both[1], both[0])] {
        let made = folder.designed(&text(&format!("[range]\n{fields}")));
        let vertices = made["vertices"].as_array().unwrap();
        let at = |v: &Value, name: &str| v["at"][name].as_f64().unwrap();
        let corner =
            vertices.iter().find(|v| at(v, "front.tire_damping_n_s_per_m") == 1000.0 && at(v, bare) == 50.0);
        assert!((passive(corner.unwrap()) / expected - 1.0).abs() < 1e-9, "{fields}");
    }
}

/// A group that nothing weighs or bounds is said.
#[test]
fn a_group_that_is_no_part_of_the_goal_is_noted() {
    let folder = Folder::new("group");
    let made = folder.designed(&format!(
        "{QUARTER}{ROBUST}{GOAL}groups = {{ both = [\"suspension_travel\", \"tire_deflection\"] }}\n"
    ));
    assert!(text_of(&made["notes"], "unused-group").ends_with(": both"), "{}", made["notes"]);
}
