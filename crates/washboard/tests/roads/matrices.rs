//! Spectra of several points.

use super::folder::{Folder, fit, grid, source};
use std::fmt::Write;
use washboard::linalg::{C64, CMat, Mat};
use washboard::lti::StateSpace;
use washboard::study::{RoadFitOutcome, RoadFitSpec, road_fit};

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

/// Rear wheels follow the front ones by a delay, with a coherence of .9: an order too low for it has the trace, and says that the phase is lost.
#[test]
fn a_lost_delay_is_told() {
    let folder = Folder::new("delay");
    let (delay_s, share) = (0.2, 0.95);
    let omega = grid(0.3, 30.0, 80);
    let density = |w: f64| 4e-4 / (w * w + 1.3);
    // E[X_1* X_2] of a second that lags
    let cross = |w: f64| C64::from_polar(share * density(w), -w * delay_s);
    let mut text = "omega_rad_s,psd_11,psd_12_re,psd_12_im,psd_22".to_owned();
    for w in &omega {
        write!(text, "\n{w},{0},{1},{2},{0}", density(*w), cross(*w).re, cross(*w).im).unwrap();
    }
    let file = folder.file("S.csv", &text);
    let run = |order| fit(RoadFitSpec { order: Some(order), ..source(file.clone()) }).unwrap();
    let said = |found: &RoadFitOutcome| found.notes.iter().any(|n| n.name == "cross-spectra");
    let low = run(2);
    let error = low.cross.clone().unwrap();
    println!("order 2: trace {:.3}, {error:?}", low.log10_rms_error);
    assert!(said(&low) && error.phase_deg > 30.0 && error.off_pair == Some([1, 2]), "{error:?}");
    assert_eq!((error.count, error.samples_averaged), (omega.len(), 1));
    // its own a, b, c, d
    let mat = |rows: &[Vec<f64>]| Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
    let filter = StateSpace::continuous(mat(&low.a), mat(&low.b), mat(&low.c), mat(&low.d)).unwrap();
    let off = |w: f64| {
        let h = filter.at(C64::new(0.0, w)).unwrap();
        // G Gᴴ is the conjugate of what files have
        let p = (&h * h.adjoint())[(0, 1)].conj();
        ((p / cross(w)).arg().abs().to_degrees(), (p - cross(w)).norm_sqr() / density(w).powi(2))
    };
    let largest = omega.iter().map(|w| off(*w).0).fold(0.0, f64::max);
    let first = omega.iter().copied().find(|w| off(*w).0 > 30.0).unwrap();
    let rms = (omega.iter().map(|w| off(*w).1).sum::<f64>() / omega.len() as f64).sqrt();
    assert!(
        (error.phase_deg / largest - 1.0).abs() < 1e-6 && (error.rms / rms - 1.0).abs() < 1e-6,
        "{largest} {rms}"
    );
    assert!((error.off_from_rad.unwrap() / first - 1.0).abs() < 1e-9, "{first}");
    let high = run(12);
    println!("order 12: {:?}", high.cross);
    assert!(!said(&high) && high.cross.unwrap().rms < 0.1);
}
