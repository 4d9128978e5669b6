//! H∞ norms of light resonances beside a feedthrough about as high: plants on which SLICOT's ab13dd returns the feedthrough.

use washboard::linalg::{C64, Mat};
use washboard::lti::{Continuous, StateSpace};

fn plant(a: &[&[f64]], b: &[&[f64]], c: &[&[f64]], d: &[&[f64]]) -> StateSpace<Continuous> {
    let m = |rows: &[&[f64]]| Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
    StateSpace::continuous(m(a), m(b), m(c), m(d)).unwrap()
}

/// The largest singular value on frequencies close about the poles: what the norm can't be below.
fn by_grid(g: &StateSpace<Continuous>) -> f64 {
    let gain = |w: f64| g.at(C64::new(0.0, w)).unwrap().singular_values().unwrap()[0];
    let about = |p: C64| (-4000..=4000).map(move |k| p.norm() + p.re * (f64::from(k) / 1000.0).sinh());
    let omegas = g.poles().unwrap().into_iter().flat_map(about).filter(|w| *w >= 0.0).chain([0.0]);
    omegas.map(gain).fold(0.0, f64::max)
}

#[test]
fn a_light_peak_beside_feedthrough_is_not_missed() {
    // found by random search against ab13dd (tolerance 1e-10), whose answer is the second number; confirmed with 60 digits
    let plants = [
        (
            plant(
                &[&[0.0, 7600.0], &[-7600.0, -0.018]],
                &[&[0.11], &[-0.086]],
                &[&[-0.0034, 0.055]],
                &[&[0.33]],
            ),
            0.330000,
        ),
        (
            plant(
                &[&[0.0, 1100.0], &[-1100.0, -0.0047]],
                &[&[-0.047, -0.08], &[-0.027, -8e-5]],
                &[&[0.012, -0.0055], &[0.084, -0.079]],
                &[&[0.96, -0.19], &[0.91, 1.9]],
            ),
            2.124153,
        ),
        (
            plant(
                &[
                    &[0.0, 19_000.0, 0.0, 0.0],
                    &[-19_000.0, -3.3, 0.0, 0.0],
                    &[0.0, 0.0, -0.14, 0.0],
                    &[0.0, 0.0, 0.0, -0.011],
                ],
                &[&[2.9], &[1.9], &[0.36], &[0.014]],
                &[&[-2.6, 0.75, -0.047, -0.034]],
                &[&[2.2]],
            ),
            2.200000,
        ),
    ];
    for (g, missed) in plants {
        let (found, grid) = (g.hinf_norm().unwrap().norm, by_grid(&g));
        // the peak lies between two points of the grid, by a millionth at most higher
        assert!(found >= grid * (1.0 - 1e-12) && found < grid * (1.0 + 1e-6), "{found} {grid}");
        assert!(found > 1.3 * missed, "{found} {missed}");
    }
}
