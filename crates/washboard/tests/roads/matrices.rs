//! Spectra of several points.

use super::folder::{Folder, fit, grid, source};
use std::fmt::Write;
use washboard::linalg::{C64, CMat, Mat};
use washboard::lti::StateSpace;
use washboard::study::{RoadFitSpec, road_fit};

/// A 4 × 4 spectrum as the house writes it, S_ij = E[X_i* X_j]: the filter's G Gᴴ has the conjugate, delays the right way round.
#[test]
fn four_points_of_a_chassis_become_one_filter() {
    let folder = Folder::new("matrix");
    let n = 5;
    let a = Mat::from_fn(n, n, |i, j| match (i, j) {
        (0, 0) => -0.8,
        (1, 1) | (2, 2) => -1.5,
        (1, 2) => 7.0,
        (2, 1) => -7.0,
        (3, 3) | (4, 4) => -4.0,
        (3, 4) => 30.0,
        (4, 3) => -30.0,
        _ => 0.0,
    });
    let b = Mat::from_fn(n, 4, |i, j| (1.0 + (3 * i + 5 * j) as f64).sin() + if i == j { 1.0 } else { 0.0 });
    let c = Mat::from_fn(4, n, |i, j| 0.01 * ((2.0 + (4 * i + 7 * j) as f64).cos() + 0.5));
    let g = StateSpace::continuous(a, b, c, Mat::identity(4, 4) * faer::Scale(1e-3)).unwrap();
    let omega = grid(0.3, 120.0, 60);
    let spectrum = |w: f64| -> CMat {
        let h = g.at(C64::new(0.0, w)).unwrap();
        &h * h.adjoint()
    };
    let mut text = "omega_rad_s".to_owned();
    for i in 1..=4 {
        for j in i..=4 {
            text += &if i == j { format!(",psd_{i}{i}") } else { format!(",psd_{i}{j}_re,psd_{i}{j}_im") };
        }
    }
    for w in &omega {
        let s = spectrum(*w);
        write!(text, "\n{w}").unwrap();
        for i in 0..4 {
            for j in i..4 {
                // E[X_i* X_j]
                let z = s[(i, j)].conj();
                write!(text, ",{}", z.re).unwrap();
                if i != j {
                    write!(text, ",{}", z.im).unwrap();
                }
            }
        }
    }
    let file = folder.file("S.csv", &text);
    let spec = RoadFitSpec { order: Some(n), proper: true, ..source(file.clone()) };
    let found = fit(spec.clone()).unwrap();
    assert_eq!((found.states, found.b[0].len(), found.c.len(), found.gain), (n, 4, 4, None));
    let mat = |rows: &[Vec<f64>]| Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
    let filter = StateSpace::continuous(mat(&found.a), mat(&found.b), mat(&found.c), mat(&found.d)).unwrap();
    for w in grid(0.4, 100.0, 25) {
        let h = filter.at(C64::new(0.0, w)).unwrap();
        let (own, known) = (&h * h.adjoint(), spectrum(w));
        assert!((own - &known).norm_max() < 1e-7 * known.norm_max(), "{w}");
    }
    // as a road file it is a matrix filter, with S_ij = E[X_i* X_j] again
    let run = road_fit(&RoadFitSpec { output: Some(folder.0.join("F.toml")), ..spec.clone() }).unwrap();
    let written = String::from_utf8(run.file.unwrap().1).unwrap();
    let (_, read) = washboard::road::MatrixFilterSpec::parse(&written, "F.toml".as_ref()).unwrap();
    let (own, known) = (read.height_spectrum(3.0), spectrum(3.0).conjugate().to_owned());
    assert!((own - &known).norm_max() < 1e-7 * known.norm_max());
    let run = road_fit(&RoadFitSpec { output: Some(folder.0.join("F.json")), ..spec }).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&run.file.unwrap().1).unwrap();
    assert_eq!(json["c"].as_array().unwrap().len(), 4);
    // and a strictly proper one for a chassis's heights
    let rolled = fit(RoadFitSpec { order: Some(n), ..source(file.clone()) }).unwrap();
    assert!(rolled.roll_off_rad.is_some() && rolled.d.iter().flatten().all(|d| *d == 0.0));
    println!("4 × 4 strictly proper: log10 rms {:.4}", rolled.log10_rms_error);
    let tampered = text.replace("\n0.3,", "\n0.3,-");
    let e = fit(source(folder.file("T.csv", &tampered))).unwrap_err().to_string();
    assert!(e.contains("T.csv:2: column psd_11: expected a density of 0 or more"), "{e}");
}
