//! The control problems of SDPLIB (B. Borchers, *Optimization Methods and Software* 11, 1999), in SDPA's format.

use std::path::Path;
use washboard::linalg::Mat;
use washboard::optimize::{Block, Sdp, SdpOutcome, SdpSettings, Status};

fn read(name: &str) -> Option<Sdp> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/sdplib");
    let text = std::fs::read_to_string(dir.join(format!("{name}.dat-s"))).ok()?;
    let clean: String = text.chars().map(|c| if "{}(),".contains(c) { ' ' } else { c }).collect();
    let mut lines = clean.lines().filter(|l| !l.starts_with(['"', '*']));
    let mut first = || lines.next()?.split_whitespace().next()?.parse::<usize>().ok();
    let (variables, blocks) = (first()?, first()?);
    let sizes: Vec<usize> =
        lines.next()?.split_whitespace().take(blocks).map(|s| s.parse().unwrap()).collect();
    let rest: Vec<f64> = lines.flat_map(str::split_whitespace).map(|s| s.parse().unwrap()).collect();
    let (objective, entries) = rest.split_at(variables);
    let mut parts: Vec<(Mat, Vec<(usize, usize, usize, f64)>)> =
        sizes.iter().map(|n| (Mat::zeros(*n, *n), Vec::new())).collect();
    for e in entries.chunks_exact(5) {
        let [variable, block, i, j] = [e[0], e[1], e[2], e[3]].map(|v| v as usize);
        let (constant, coefficients) = &mut parts[block - 1];
        if variable == 0 {
            // F₀ of SDPA is subtracted
            (constant[(i - 1, j - 1)], constant[(j - 1, i - 1)]) = (-e[4], -e[4]);
        } else {
            coefficients.push((variable - 1, i - 1, j - 1, e[4]));
        }
    }
    let blocks = parts.into_iter().map(|(constant, entries)| Block::from_entries(constant, &entries));
    Some(Sdp::new(objective.to_vec(), blocks.collect()).unwrap())
}

/// What an optimum is, checked on the program itself.
pub fn assert_optimal(name: &str, sdp: &Sdp, o: &SdpOutcome) {
    assert_eq!(o.status, Status::Optimal, "{name}: {:?} after {:?}", o.measures, o.iterations);
    let at = sdp.at(&o.x);
    let (mut slackness, mut sizes) = (0.0, 1.0);
    for ((f, s), z) in at.iter().zip(&o.slack).zip(&o.multiplier) {
        assert!((f - s).norm_max() <= 1e-12 * (1.0 + f.norm_max()));
        let least = |m: &Mat| m.self_adjoint_eigenvalues(faer::Side::Lower).unwrap()[0];
        assert!(least(f) >= -1e-7 * (1.0 + f.norm_max()), "{name}: slack {:e}", least(f));
        assert!(least(z) >= -1e-12 * (1.0 + z.norm_max()), "{name}: multiplier {:e}", least(z));
        sizes += f.norm_l2() * z.norm_l2();
        slackness += (f * z).diagonal().column_vector().iter().sum::<f64>();
    }
    // complementary slackness, and the dual's value beside the primal's
    // of the size of its terms: x and Z hold their equations to 1e-8 of the largest numbers in them
    assert!(slackness.abs() <= 1e-7 * sizes, "{name}: F(x)•Z = {slackness:e} of {sizes:e}");
    assert!((o.objective - o.bound).abs() <= 1e-6 * (1.0 + o.objective.abs()), "{name}: {o:?}");
}

/// control1–3 to 1e-6; hinf1–8 to the digits that SDPLIB prints.
#[test]
fn published_optima() {
    if read("control1").is_none() {
        return;
    }
    for (name, published, tolerance) in [
        ("control1", 17.784_63, 1e-6 * 17.8),
        ("control2", 8.300_000, 1e-6 * 8.3),
        ("control3", 13.633_27, 1e-6 * 13.6),
        ("hinf1", 2.0326, 0.5e-4),
        ("hinf2", 10.967, 0.5e-3),
        ("hinf3", 56.9, 0.05),
        ("hinf4", 274.764, 0.5e-3),
        // printed 363: an upper bound of 362.2135 (a feasible x) and a lower one (a Z) say otherwise
        ("hinf5", 362.2135, 1e-3),
        ("hinf6", 449.0, 0.1),
        ("hinf7", 391.0, 0.5),
        ("hinf8", 116.0, 0.5),
    ] {
        let sdp = read(name).unwrap();
        let o = sdp.solve(&SdpSettings::default());
        println!(
            "{name}: {:.8} ≥ {:.8}, {:?}, iterations {:?}",
            o.objective, o.bound, o.measures, o.iterations
        );
        assert_optimal(name, &sdp, &o);
        assert!((o.objective - published).abs() <= tolerance, "{name}: {} for {published}", o.objective);
    }
}
