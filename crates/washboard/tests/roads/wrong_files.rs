//! What is wrong with a file.

use super::folder::{Folder, fit, source};
use std::path::PathBuf;
use washboard::study::{RoadFitSpec, RoadIriSpec, road_iri};

/// What is wrong with a file is said with its line.
#[test]
fn wrong_files_are_answered_with_their_line() {
    let folder = Folder::new("wrong");
    let good = "nu_rad_per_m,psd\n0.1,1\n0.2,0.5\n0.4,0.2\n0.8,0.1\n1.6,0.05\n";
    for (text, parts) in [
        ("".to_owned(), vec!["expected a header and rows of numbers, found nothing"]),
        ("nu_rad_per_m,psd\n".into(), vec!["expected rows of numbers, found none"]),
        (good.replace("psd", "density"), vec![":1: expected a column psd", "density"]),
        (good.replace("nu_rad_per_m", "nu"), vec![":1: expected one frequency column, omega_rad_s"]),
        (good.replace("nu_rad_per_m,psd", "nu_rad_per_m,psd,wieght").replace('\n', ",1\n").replacen(",1\n", "\n", 1),
            vec![":1: column wieght", "did you mean `weight`?"]),
        (good.replace("0.4,0.2", "0.4,-0.2"), vec![":4: column psd: expected a density of 0 or more, found -0.2"]),
        (good.replace("0.4,0.2", "0.2,0.2"), vec![":4: column nu_rad_per_m: expected ascending values, found 0.2 after 0.2"]),
        (good.replace("0.4,0.2", "0.05,0.2"), vec![":4:", "found 0.05 after 0.2"]),
        (good.replace("0.1,1", "-0.1,1"), vec![":2: column nu_rad_per_m: expected 0 or more, found -0.1"]),
        (good.replace("0.4,0.2", "0.4,NaN"), vec![":4: column psd: expected a finite number, found \"NaN\""]),
        (good.replace("0.4,0.2", "0.4"), vec![":4: expected 2 fields, found 1"]),
        ("nu_rad_per_m,psd\n0.1,1\n".into(), vec!["samples: expected 3 frequencies or more", "1 in"]),
        ("1,2\n3,4\n".into(), vec![":1: expected a header", "--no-header"]),
        ("nu_rad_per_m,psd,psd\n0.1,1,1\n".into(), vec!["column psd: expected each name once"]),
        ("nu_rad_per_m,psd,psd_11\n0.1,1,1\n".into(), vec!["either a column psd, or psd_11"]),
        ("nu_rad_per_m,psd_11,psd_22\n0.1,1,1\n".into(), vec!["columns psd_12_re and psd_12_im of a 2 × 2"]),
        (
            "omega_rad_s,psd_11,psd_11_im,psd_22,psd_12_re,psd_12_im\n1,1,0,1,0.1,0.2\n".into(),
            vec![":1: expected a channel's own density as one real column", "found omega_rad_s, psd_11, psd_11_im"],
        ),
        (
            "omega_rad_s,psd_11,psd_22,psd_12_re,psd_12_im,psd_21_re,psd_21_im\n1,1,1,0.1,0.2,0.1,-0.2\n2,1,1,0.1,0.2,0.1,0.2\n".into(),
            vec![":3: psd_21: expected the conjugate of psd_12", "not Hermitian"],
        ),
        (
            "omega_rad_s,psd_11,psd_22,psd_12_re,psd_12_im\n1,1,1,0.1,0.2\n2,1,1,1.1,0\n".into(),
            vec![":3: expected a matrix without negative eigenvalues, found -1.000e-1"],
        ),
        (good.replace("psd\n", "psd,weight\n").replace("1\n", "1,1\n").replace("5\n", "5,0\n").replace("2\n", "2,1\n"),
            vec![":3: column weight: expected a number above 0, found 0"]),
    ] {
        let file = folder.file("S.csv", &text);
        let e = fit(source(file)).unwrap_err();
        let said = e.to_string();
        assert!(e.is_wrong_input() && said.contains("S.csv"), "{said}");
        for part in parts {
            assert!(said.contains(part), "{text:?}: {said} should have {part:?}");
        }
    }
    let file = folder.file("S.csv", good);
    for (spec, part) in [
        (
            RoadFitSpec { order: Some(9), ..source(file.clone()) },
            "order: expected at most 2 of 5 frequencies, found 9",
        ),
        (RoadFitSpec { order: Some(0), ..source(file.clone()) }, "order: expected a number from 1 to 40"),
        (
            RoadFitSpec { lambda_rad: Some(-1.0), ..source(file.clone()) },
            "lambda: expected a positive number",
        ),
        (
            RoadFitSpec { lambda_rad: Some(1e300), ..source(file.clone()) },
            "lambda: expected a frequency from 1.000e-4 to 1.600e3",
        ),
        (RoadFitSpec { band_rad: Some([2.0, 1.0]), ..source(file.clone()) }, "band: expected two ascending"),
        (
            RoadFitSpec { band_rad: Some([5.0, 6.0]), ..source(file.clone()) },
            "band: expected 3 frequencies or more",
        ),
        (RoadFitSpec { output: Some(folder.0.join("F.csv")), ..source(file.clone()) }, "ends in .toml"),
        (RoadFitSpec { segment_m: Some(1.0), ..source(file.clone()) }, "segment_m: expected none"),
        (source("case:turkay-first-order"), "band: expected --band LOW,HIGH in rad/m"),
        (
            RoadFitSpec { band_rad: Some([0.001, 1.0]), ..source("case:iso8608-c") },
            "a part of the road's own band",
        ),
        (source(folder.0.display().to_string()), "a directory with a road.toml"),
        (source("no.csv"), "no.csv"),
    ] {
        let e = fit(spec).unwrap_err();
        assert!(e.is_wrong_input() && e.to_string().contains(part), "{e} should have {part:?}");
    }
    let profile = |text: &str| {
        let profile = PathBuf::from(folder.file("P.csv", text));
        let spec = RoadIriSpec { profile, no_header: false, segment_m: None, moving_average_m: None };
        road_iri(&spec).unwrap_err().to_string()
    };
    for (text, part) in [
        ("x_m\n0\n1\n", "expected a column of heights"),
        ("x,z_m\n0,0\n", ":1: expected a column x_m"),
        ("x_m,z\n0,0\n", "under a name that ends in _m"),
        ("x_m,z_m\n0,0\n1,0\n0.5,0\n", ":4: column x_m: expected ascending values, found 0.5 after 1"),
        ("x_m,z_m\n0,0\n1,0\n", "11 m or more"),
    ] {
        assert!(profile(text).contains(part), "{} should have {part:?}", profile(text));
    }
}
