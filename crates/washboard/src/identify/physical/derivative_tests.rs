//! The physical fit's gradient and information against differences of its cost and spectra.

use super::joint::Joint;
use super::layout::Layout;
use super::model::Model;
use crate::identify::likelihood::checks::{AVERAGES, WIDE, assert_gradient, band, dense_information};
use crate::identify::likelihood::{Drive, Spectra, cost};
use crate::linalg::Mat;
use crate::lti::{Parametric, SecondOrder, WheeledSystem};
use crate::units::Convention;

/// Two wheels, neither side by side nor in line, under a beam: every matrix moves with a parameter.
struct Beam;

const AT_M: [[f64; 2]; 2] = [[1.2, 0.7], [-1.3, -0.6]];

impl Parametric for Beam {
    fn names(&self) -> Vec<String> {
        ["inertia", "spring", "damper", "tire", "tire damper", "place"].map(String::from).into()
    }

    fn start(&self) -> Vec<f64> {
        vec![1.4, 400.0, 12.0, 3000.0, 5.0, 1.2]
    }

    fn system(&self, v: &[f64]) -> Result<WheeledSystem, String> {
        let diagonal = |d: [f64; 4]| Mat::from_fn(4, 4, |i, j| if i == j { d[i] } else { 0.0 });
        // body, pitch, two wheels; each spring sees the body at its own place
        let arms = [[1.0, v[5], -1.0, 0.0], [1.0, -1.3, 0.0, -1.0]];
        let between = |k: f64| Mat::from_fn(4, 4, |i, j| arms.iter().map(|a| k * a[i] * a[j]).sum());
        let under = |k: f64| Mat::from_fn(4, 2, |i, j| if i == j + 2 { k } else { 0.0 });
        let system = SecondOrder::new(
            diagonal([4.0, v[0], 0.4, 0.5]),
            between(v[2]) + diagonal([0.0, 0.0, v[4], v[4]]),
            between(v[1]) + diagonal([0.0, 0.0, v[3], v[3]]),
        )
        .map_err(|e| e.to_string())?;
        let rows = Mat::from_fn(3, 4, |i, j| {
            [[1.0, v[5], 0.0, 0.0], [1.0, -0.4, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]][i][j]
        });
        WheeledSystem::new(system, under(v[3]), under(v[4]), AT_M.to_vec(), rows).map_err(|e| e.to_string())
    }
}

fn model(kernel: &[f64]) -> (Model<'static>, Vec<f64>) {
    let layout = Layout::new(6, true, true, true, 3);
    let mut theta = vec![0.0; layout.len()];
    Beam.start().iter().enumerate().for_each(|(i, v)| theta[i] = v.ln());
    let road = [0.3, 1.8, 0.9, 0.05, 0.0, 2e-3, -3e-3];
    theta[6..13].copy_from_slice(&road);
    theta[13..].copy_from_slice(&[-1.0, -2.0, -1.5]);
    let model = Model {
        vehicle: &Beam,
        derivatives: &[2, 1, 2],
        drive: Drive { speed_m_s: 15.0, convention: Convention::default() },
        layout,
        channels: &[],
        at_m: AT_M.to_vec(),
        data: band(kernel, 3),
        averages: AVERAGES,
    };
    (model, theta)
}

fn moved(theta: &[f64], i: usize, by: f64) -> Vec<f64> {
    let mut theta = theta.to_vec();
    theta[i] += by;
    theta
}

/// The data are another vehicle's on another road.
#[test]
fn the_gradient_is_the_differences_of_the_cost() {
    let (model, theta) = model(&WIDE);
    let other: Vec<f64> = theta.iter().enumerate().map(|(i, t)| t + 0.002 * (i as f64 - 7.0)).collect();
    let measured = model.spectra(&other).unwrap();
    let joint = Joint::new(vec![model]);
    let score = joint.score(&theta, std::slice::from_ref(&measured)).unwrap();
    let at = |theta: &[f64]| cost(&joint.models[0].spectra(theta).unwrap(), &measured, AVERAGES).unwrap();
    assert!((score.cost / at(&theta) - 1.0).abs() < 1e-12);
    assert_gradient(&score.gradient, &|i, by| at(&moved(&theta, i, by)));
}

/// The information takes derivatives at the middles of bins: a window that sees nothing else.
#[test]
fn the_information_is_that_of_dense_differences() {
    let (model, theta) = model(&[1.0]);
    let joint = Joint::new(vec![model]);
    let measured = joint.models[0].spectra(&theta).unwrap();
    let fisher = joint.score(&theta, std::slice::from_ref(&measured)).unwrap().fisher;
    let s = |i: usize, by: f64| -> Spectra { joint.models[0].spectra(&moved(&theta, i, by)).unwrap() };
    for a in 0..theta.len() {
        for b in [a, (a + 5) % theta.len(), (a + 9) % theta.len()] {
            let (found, scale) = (fisher[(a, b)], (fisher[(a, a)] * fisher[(b, b)]).sqrt());
            let dense = dense_information(&s, a, b);
            // differences at 1e-5 leave 1e-8
            assert!((found - dense).abs() < 1e-6 * scale, "({a}, {b}): {found}, {dense}");
        }
    }
}
