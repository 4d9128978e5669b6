//! A benchmark collection, where it is present.

use super::*;

/// The collection, where it is here.
fn collection() -> Option<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/compleib/compleib_part.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("skipped: {} is not here", path.display());
        return None;
    };
    // facts beside the matrices hold infinities, which are no JSON
    Some(serde_json::from_str(&text.replace("Infinity", "null")).unwrap())
}

fn plant_of(v: &Value) -> GeneralizedPlant {
    let m = |name: &str| {
        let rows: Vec<Vec<f64>> = serde_json::from_value(v[name].clone()).unwrap();
        Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
    };
    let [a, b1, b2, c1, c2] = ["A", "B1", "B", "C1", "C"].map(m);
    let [d11, d12, d21] = ["D11", "D12", "D21"].map(m);
    generalized(&a, [&b1, &b2], [&c1, &c2], [&d11, &d12, &d21])
}

/// Without D₂₂.
pub fn generalized(a: &Mat, b: [&Mat; 2], c: [&Mat; 2], d: [&Mat; 3]) -> GeneralizedPlant {
    let (n, nw, nu) = (a.nrows(), b[0].ncols(), b[1].ncols());
    let (nz, ny) = (c[0].nrows(), c[1].nrows());
    let system = StateSpace::continuous(
        a.clone(),
        Mat::from_fn(n, nw + nu, |i, j| if j < nw { b[0][(i, j)] } else { b[1][(i, j - nw)] }),
        Mat::from_fn(nz + ny, n, |i, j| if i < nz { c[0][(i, j)] } else { c[1][(i - nz, j)] }),
        Mat::from_fn(nz + ny, nw + nu, |i, j| match (i < nz, j < nw) {
            (true, true) => d[0][(i, j)],
            (true, false) => d[1][(i, j - nw)],
            (false, true) => d[2][(i - nz, j)],
            (false, false) => 0.0,
        }),
    )
    .unwrap();
    let names = |letter: &str, n: usize| (1..=n).map(|k| format!("{letter}{k}")).collect();
    let signals = Signals {
        disturbances: names("w", nw),
        controls: names("u", nu),
        performances: names("z", nz),
        measurements: names("y", ny),
    };
    GeneralizedPlant::new(system, signals).unwrap()
}

fn static_hinf(plant: &GeneralizedPlant) -> FixedOrder {
    let goal = target(0, Measure::Hinf(all_outputs(plant)), Aim::Goal(1.0));
    asked(vec![plant.clone()], vec![goal], Structure::full(0, plant.nu(), plant.ny()))
}

#[test]
fn static_gains_of_a_collection_are_as_good_as_the_best_known() {
    let Some(all) = collection() else { return };
    for name in ["AC7", "NN1", "EB1", "DLR1", "MFP", "NN5", "HE4", "AC16"] {
        let plant = plant_of(&all[name]);
        let best = all[name]["best_known_static_hinf_upper_bound"].as_f64().unwrap();
        let d = designed(&static_hinf(&plant), &few(12));
        let closed = plant.close(&d.controller).unwrap();
        assert!(closed.is_stable().unwrap(), "{name}");
        let norm = peak(&closed, &(0..plant.nz()).collect::<Vec<_>>());
        println!("{name}: {norm:.6} best known {best:.6} ratio {:.6}", norm / best);
        assert!(
            (d.verified_goal.unwrap() / norm - 1.0).abs() < NORMS,
            "{name}: {norm} {:?}",
            d.verified_goal
        );
        assert!(norm <= AS_GOOD * best, "{name}: {norm} {best}");
    }
}

#[test]
fn plants_without_a_stabilising_gain_are_said_to_be_so() {
    let Some(all) = collection() else { return };
    // one control and one measurement: the root locus says how far left a gain brings the rightmost pole
    for (name, known) in [("REA4", 0.6425), ("NN3", 2.1358)] {
        let plant = plant_of(&all[name]);
        let locus = |gain: f64| {
            let k = System::continuous_gain(Mat::from_fn(1, 1, |_, _| gain)).unwrap();
            let poles = plant.close(&k).unwrap().poles().unwrap();
            poles.iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max)
        };
        let steps = (0..=4000).map(|k| 10f64.powf(-8.0 + 0.004 * f64::from(k)));
        let least = steps.flat_map(|g| [locus(g), locus(-g)]).fold(locus(0.0), f64::min);
        let FixedOrderEnd::NotStabilised { abscissa, .. } =
            fixed_order(&static_hinf(&plant), &few(4)).unwrap()
        else {
            panic!("{name} is stabilised");
        };
        println!("{name}: {abscissa} locus {least}");
        assert!(least > known - 1e-4, "{name}: {least}");
        // what is reported is a pole of some gain, and within 1e-3 of the least
        assert!(abscissa > least - 1e-4 && abscissa < least + 1e-3, "{name}: {abscissa} {least}");
    }
}
