//! Plants that several tests share.

use std::path::Path;
use washboard::linalg::Mat;
use washboard::lti::{GeneralizedPlant, Signals, StateSpace};

pub fn names(text: &[&str]) -> Vec<String> {
    text.iter().map(|t| (*t).to_owned()).collect()
}

/// Türkay's quarter car on white road velocity, (4.46)–(4.49): z = acceleration, travel, tire deflection.
pub fn quarter_car(ct: f64, measurements: &[&str]) -> GeneralizedPlant {
    let (ms, mu, ks, kt, cs) = (240.0, 36.0, 16_000.0, 160_000.0, 980.0);
    let a = [
        [0.0, 0.0, 1.0, -1.0],
        [0.0, 0.0, 0.0, 1.0],
        [-ks / ms, 0.0, -cs / ms, cs / ms],
        [ks / mu, -kt / mu, cs / mu, -(cs + ct) / mu],
    ];
    let b = [[0.0, 0.0], [-1.0, 0.0], [0.0, -1.0 / ms], [ct / mu, 1.0 / mu]];
    let acceleration = [-ks / ms, 0.0, -cs / ms, cs / ms];
    let rows = [acceleration, [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], acceleration, [1.0, 0.0, 0.0, 0.0]];
    let through = [-1.0 / ms, 0.0, 0.0, -1.0 / ms, 0.0];
    let system = StateSpace::continuous(
        Mat::from_fn(4, 4, |i, j| a[i][j]),
        Mat::from_fn(4, 2, |i, j| b[i][j]),
        Mat::from_fn(5, 4, |i, j| rows[i][j]),
        Mat::from_fn(5, 2, |i, j| if j == 1 { through[i] } else { 0.0 }),
    )
    .unwrap();
    let signals = Signals {
        disturbances: names(&["road velocity"]),
        controls: names(&["force"]),
        performances: names(&["acceleration", "travel", "tire"]),
        measurements: names(&["y1", "y2"]),
    };
    let plant = GeneralizedPlant::new(system, signals).unwrap();
    plant.select(&["acceleration", "travel", "tire"], measurements).unwrap()
}

/// (2πn₀)²κv of the thesis, m²/s.
pub const ROAD: f64 = 1.480625e-4;

/// The eight-state plant of a published example; None where the data is not at hand.
pub fn mathworks() -> Option<GeneralizedPlant> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/mathworks_susp/quarter_car_beta_0_5.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("skipped: {} is not at hand", path.display());
        return None;
    };
    let v: serde_json::Value = serde_json::from_str(&text).unwrap();
    let m = |name: &str| {
        let rows: Vec<Vec<f64>> = serde_json::from_value(v[name].clone()).unwrap();
        Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
    };
    let system = StateSpace::continuous(m("A"), m("B"), m("C"), m("D")).unwrap();
    let signals = Signals {
        disturbances: names(&["d1", "d2", "d3"]),
        controls: names(&["u"]),
        performances: names(&["e1", "e2", "e3"]),
        measurements: names(&["y1", "y2"]),
    };
    Some(GeneralizedPlant::new(system, signals).unwrap())
}
