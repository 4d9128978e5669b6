//! The interaction model of De Filippis et al. against the input-output formula (50)–(51), and the printed forms, which
//! must fail.

use crate::ride::paper_road;
use std::f64::consts::PI;
use washboard::cases;
use washboard::identify::interaction::{ClassicalModel, CorrelationModel, Delay, InteractionModel};
use washboard::linalg::{C64, CMat, Mat};
use washboard::lti::{ModalForm, SecondOrder};
use washboard::road::{Coherence, Road, Spectrum};
use washboard::units::rad_per_s;
use washboard::vehicle::{Matrices, Output, Ride, Vehicle, VehicleSpec, WheelRow};

/// Our dofs for the paper's 1, 2, 3, 4.
const WHEELS: [usize; 4] = [4, 3, 6, 5];

/// The paper's q₁ (heave, roll, pitch, wheels) and q₂ (three corners, wheels) as rows over our coordinates.
fn coordinates(vehicle: &Vehicle) -> [Mat; 2] {
    let row = |name: &str| vehicle.output(name).unwrap().q[0].clone();
    let bodies = [
        ["heave_displacement", "roll_displacement", "pitch_displacement"],
        ["body_displacement_front_right", "body_displacement_front_left", "body_displacement_rear_right"],
    ];
    bodies.map(|names| {
        let top: Vec<Vec<f64>> = names.iter().map(|n| row(n)).collect();
        Mat::from_fn(7, 7, |i, j| if i < 3 { top[i][j] } else { f64::from(u8::from(j == WHEELS[i - 3])) })
    })
}

/// Eq. (50) by a dense solve at one frequency.
fn input_output(vehicle: &Vehicle, rows: &Mat, road: &Road, omega: f64) -> CMat {
    let h = vehicle.road_response(omega).unwrap();
    let h = CMat::from_fn(rows.nrows(), h.ncols(), |i, j| {
        (0..h.nrows()).map(|k| h[(k, j)] * rows[(i, k)]).sum::<C64>()
    });
    let s = washboard::road::wheel_spectrum(road, &vehicle.wheel_places(), omega, 20.0);
    h.conjugate() * s * h.transpose()
}

fn difference(a: &CMat, b: &CMat) -> f64 {
    (a - b).norm_l2() / b.norm_l2()
}

fn frequencies() -> impl Iterator<Item = f64> {
    (0..60).map(|i| rad_per_s(0.31 * (28.0f64 / 0.31).powf(f64::from(i) / 59.0)))
}

#[test]
fn frequency_domain_in_both_coordinate_sets() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    for rows in coordinates(&vehicle) {
        for coherence in
            [Coherence::bogsjo(3.8).unwrap(), Coherence::Full, Coherence::None, Coherence::Independent]
        {
            let road = paper_road().with_coherence(coherence);
            let model = InteractionModel::new(&vehicle.wheeled(rows.clone()).unwrap(), &road, 20.0).unwrap();
            let worst = frequencies()
                .map(|w| difference(&model.spectrum(w), &input_output(&vehicle, &rows, &road, w)))
                .fold(0.0, f64::max);
            // asked: 1e-10; the notes' reference reached 1.8e-13
            assert!(worst < 1e-11, "{coherence:?}: {worst:e}");
        }
    }
}

/// Six wheels on three axles of different tracks: every p and l of its own.
#[test]
fn any_number_of_axles_and_tracks() {
    let n = 8;
    let diagonal = |f: &dyn Fn(usize) -> f64| -> Vec<Vec<f64>> {
        (0..n).map(|i| (0..n).map(|j| if i == j { f(i) } else { 0.0 }).collect()).collect()
    };
    let at = [[2.0, 0.9], [2.0, -0.9], [-0.4, 0.8], [-0.4, -0.8], [-1.7, 0.95], [-1.7, -0.95]];
    let (mut c, mut k) =
        (diagonal(&|i| if i < 2 { 0.0 } else { 200.0 }), diagonal(&|i| if i < 2 { 0.0 } else { 9e5 }));
    for (w, place) in at.iter().enumerate() {
        let mut element = vec![0.0; n];
        (element[0], element[1], element[2 + w]) = (1.0, -place[0], -1.0);
        for i in 0..n {
            for j in 0..n {
                c[i][j] += 9e3 * element[i] * element[j];
                k[i][j] += 1.2e5 * element[i] * element[j];
            }
        }
    }
    let under = |v: f64| (0..n).map(|i| (0..6).map(|w| if i == 2 + w { v } else { 0.0 }).collect()).collect();
    let spec: VehicleSpec = Matrices {
        m: diagonal(&|i| [8000.0, 15000.0, 300.0, 310.0, 290.0, 305.0, 280.0, 295.0][i]),
        c,
        k,
        wheel_stiffness: under(9e5),
        wheel_damping: under(200.0),
        dofs: vec![],
        wheel: at.iter().map(|at| WheelRow { name: "w".into(), at_m: *at }).collect(),
        output: vec![],
        actuator: vec![],
    }
    .into();
    let vehicle = spec.build_alone().unwrap();
    let rows = Mat::identity(n, n);
    let model = InteractionModel::new(&vehicle.wheeled(rows.clone()).unwrap(), &paper_road(), 20.0).unwrap();
    // distances 0, .1, .05, .15, 1.6 … and three wheelbases, each ahead and behind
    assert!(model.terms().len() > 15, "{} terms", model.terms().len());
    for w in frequencies() {
        let d = difference(&model.spectrum(w), &input_output(&vehicle, &rows, &paper_road(), w));
        assert!(d < 1e-10, "{d:e}");
    }
}

/// λ_m in the tyre factors, (A16)–(A21) as printed: exact only for c_t = 0.
#[test]
fn the_printed_tyre_factors_fail_with_tyre_damping() {
    let error = |spec: &VehicleSpec, freq_hz: f64| {
        let vehicle = spec.build_alone().unwrap();
        let rows = coordinates(&vehicle)[0].clone();
        let mut model = PrintedModel::new(&vehicle, &rows);
        let w = rad_per_s(freq_hz);
        difference(&model.spectrum(w), &input_output(&vehicle, &rows, &paper_road(), w))
    };
    let mut spec = cases::vehicle_spec("guiggiani-full-car").unwrap();
    // the notes: .3 % at 1 Hz, 1.4 % at 15 Hz, 6.4 % at most
    assert!((error(&spec, 1.0) - 0.003).abs() < 0.001, "{}", error(&spec, 1.0));
    assert!((error(&spec, 15.0) - 0.014).abs() < 0.002, "{}", error(&spec, 15.0));
    let car = spec.full_car.as_mut().unwrap();
    car.front.tire_damping_n_s_per_m = washboard::vehicle::LeftRight::Both(0.0);
    car.rear.tire_damping_n_s_per_m = washboard::vehicle::LeftRight::Both(0.0);
    assert!(error(&spec, 15.0) < 1e-11);
}

/// Eqs. (45)–(46) with the factors as printed.
struct PrintedModel {
    form: ModalForm,
    psi: CMat,
    tires: Vec<(usize, f64, f64, [f64; 2])>,
}

impl PrintedModel {
    fn new(vehicle: &Vehicle, rows: &Mat) -> Self {
        let form = ModalForm::new(vehicle.system()).unwrap();
        let psi = CMat::from_fn(7, 14, |i, m| (0..7).map(|k| form.psi()[(k, m)] * rows[(i, k)]).sum::<C64>());
        let tires = (0..4)
            .map(|w| {
                let dof = 3 + w;
                (
                    dof,
                    vehicle.wheel_stiffness()[(dof, w)],
                    vehicle.wheel_damping()[(dof, w)],
                    vehicle.wheels()[w].at_m,
                )
            })
            .collect();
        PrintedModel { form, psi, tires }
    }

    fn fraction(&self, omega: f64) -> CMat {
        let road = paper_road();
        let sd = road.spectrum().psd(omega, 20.0);
        let poles = self.form.poles();
        let mut phi = CMat::zeros(7, 14);
        for (da, ka, ca, at_a) in &self.tires {
            for (db, kb, cb, at_b) in &self.tires {
                let gamma = road.coherence().gamma((at_a[1] - at_b[1]).abs(), omega, 20.0);
                let turn = C64::new(0.0, -omega * (at_a[0] - at_b[0]) / 20.0).exp();
                for n in 0..14 {
                    for i in 0..7 {
                        for m in 0..14 {
                            let (lm, ln) = (poles[m], poles[n]);
                            let k = |v: f64| C64::new(v, 0.0);
                            let tire = (k(*ka) - lm * *ca) * (k(*kb) + lm * *cb);
                            phi[(i, n)] -=
                                self.psi[(i, m)] * tire * self.form.l()[(*da, m)] * self.form.l()[(*db, n)]
                                    / (ln + lm)
                                    * turn
                                    * (gamma * sd);
                        }
                    }
                }
            }
        }
        let weighted = CMat::from_fn(7, 14, |i, n| phi[(i, n)] / (C64::new(0.0, omega) - poles[n]));
        &weighted * self.psi.transpose()
    }

    fn spectrum(&mut self, omega: f64) -> CMat {
        &self.fraction(omega) + self.fraction(-omega).transpose()
    }
}

/// Eq. (57) taken naively: modal a from (M₂, C₂, K₂) is 27.8 % off.
#[test]
fn naive_modal_a_of_the_second_coordinates_fails() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let [q1, q2] = coordinates(&vehicle);
    let s = vehicle.system();
    // q₁ = E q, q₂ = T q₁
    let inverse = washboard::linalg::solve(&q1, &Mat::identity(7, 7)).unwrap();
    let first = |a: &Mat| inverse.transpose() * a * &inverse;
    let (m1, c1) = (first(s.m()), first(s.c()));
    let t = &q2 * &inverse;
    let t_inverse = washboard::linalg::solve(&t, &Mat::identity(7, 7)).unwrap();
    let (m2, c2) = (&m1 * &t_inverse, &c1 * &t_inverse);
    let form = ModalForm::new(s).unwrap();
    let modal_a = |rows: &Mat, m: &Mat, c: &Mat, n: usize| -> C64 {
        let psi: Vec<C64> =
            (0..7).map(|i| (0..7).map(|k| form.psi()[(k, n)] * rows[(i, k)]).sum::<C64>()).collect();
        let mut a = C64::new(0.0, 0.0);
        for i in 0..7 {
            for j in 0..7 {
                a += psi[i] * psi[j] * (form.poles()[n] * 2.0 * m[(i, j)] + C64::new(c[(i, j)], 0.0));
            }
        }
        a
    };
    let worst = (0..14)
        .map(|n| {
            let right = modal_a(&q1, &m1, &c1, n);
            (modal_a(&q2, &m2, &c2, n) / right - C64::new(1.0, 0.0)).norm()
        })
        .fold(0.0, f64::max);
    assert!(worst > 0.2, "naive modal a is {worst} off");
    // the congruence T⁻ᵀM₁T⁻¹ has the right one
    let congruent = |a: &Mat| t_inverse.transpose() * a * &t_inverse;
    let right = (0..14)
        .map(|n| {
            (modal_a(&q2, &congruent(&m1), &congruent(&c1), n) / modal_a(&q1, &m1, &c1, n)
                - C64::new(1.0, 0.0))
            .norm()
        })
        .fold(0.0, f64::max);
    assert!(right < 1e-10, "{right:e}");
}

#[test]
fn lag_domain_against_the_inverse_transform() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let names = [
        "heave_displacement",
        "pitch_displacement",
        "body_displacement_front_left",
        "unsprung_displacement_front_right",
        "unsprung_displacement_rear_left",
    ];
    let outputs: Vec<&Output> = names.iter().map(|n| vehicle.output(n).unwrap()).collect();
    let rows = Mat::from_fn(5, 7, |i, j| outputs[i].q[0][j]);
    let road = paper_road();
    let model = InteractionModel::new(&vehicle.wheeled(rows).unwrap(), &road, 20.0).unwrap();
    let lags = CorrelationModel::new(&model, 3.0).unwrap();
    let ride = Ride::new(&vehicle, &road, 20.0).unwrap();
    let size = ride.covariance(&outputs, 0.0).unwrap();
    for lag in [0.0, 0.01, 0.133, -0.133, 0.5, -1.7, 3.0] {
        let (a, b) = (lags.correlation(lag), ride.covariance(&outputs, lag).unwrap());
        for i in 0..5 {
            for j in 0..5 {
                let scale = (size[(i, i)] * size[(j, j)]).sqrt();
                let d = (a[(i, j)] - b[(i, j)]).abs() / scale;
                assert!(d < 1e-8, "lag {lag} [{i}{j}]: {} {} ({d:e})", a[(i, j)], b[(i, j)]);
            }
        }
    }
}

/// E₁(z), Re z > 0 or any z off the negative axis: series for small |z|, Lentz's continued fraction for large.
fn e1(z: C64) -> C64 {
    const EULER: f64 = 0.577_215_664_901_532_9;
    if z.norm() < 3.0 {
        let mut term = C64::new(1.0, 0.0);
        let mut sum = C64::new(0.0, 0.0);
        for k in 1..200 {
            term = -term * z / f64::from(k);
            sum -= term / f64::from(k);
        }
        return -C64::new(EULER, 0.0) - z.ln() + sum;
    }
    let one = C64::new(1.0, 0.0);
    let mut b = z + one;
    let mut c = C64::new(1e300, 0.0);
    let mut d = one / b;
    let mut h = d;
    for i in 1..500 {
        let a = -f64::from(i) * f64::from(i);
        b += C64::new(2.0, 0.0);
        d = one / (d * a + b);
        c = b + C64::new(a, 0.0) / c;
        let delta = c * d;
        h *= delta;
        if (delta - one).norm() < 1e-16 {
            break;
        }
    }
    h * (-z).exp()
}

/// R_d * H_p in closed form: (S₀Vν₀²/π) Re[e^{−zω}/ω |_{ω_b}^{ω_a} − z(E₁(zω_a) − E₁(zω_b))], z = a − i|τ|.
#[test]
fn correlation_of_tracks_in_closed_form() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let rows = coordinates(&vehicle)[0].clone();
    let model = InteractionModel::new(&vehicle.wheeled(rows).unwrap(), &paper_road(), 20.0).unwrap();
    let lags = CorrelationModel::new(&model, 2.0).unwrap();
    let (wa, wb) = (1.89, 177.7);
    for (distance, lag) in [(0.0, 0.0), (0.0, 0.3), (1.49, 0.0), (1.49, 0.05), (1.49, 1.9)] {
        let z = C64::new(3.8 * distance / (2.0 * PI * 20.0), -lag);
        let edge = |w: f64| (-z * w).exp() / w;
        let mut value = edge(wa) - edge(wb);
        if z.norm() > 0.0 {
            value -= z * (e1(z * wa) - e1(z * wb));
        }
        let exact = 16e-6 * 20.0 / PI * value.re;
        let found = lags.track_correlation(distance, lag);
        assert!((found - exact).abs() < 1e-12 * 5.3e-5, "{distance} {lag}: {found} {exact}");
    }
    assert!((lags.track_correlation(0.0, 0.0) - 5.332_052_88e-5).abs() < 0.51e-13);
}

/// The classical model is exact for white, uncorrelated forces, and its half spectrum is the transform of the positive
/// lags (47)–(48). On a road neither holds (49).
#[test]
fn half_spectra_fail_on_a_road() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let rows = Mat::identity(7, 7);
    let force: Vec<f64> = (0..7).map(|i| 1.0 + i as f64).collect();
    let classical = ClassicalModel::new(vehicle.system(), &rows, &force).unwrap();
    let half = |r: &dyn Fn(f64) -> Mat, omega: f64, reach: f64, n: i32| {
        // Simpson's rule over the positive lags
        let h = reach / f64::from(n);
        let mut sum = CMat::zeros(7, 7);
        for i in 0..=n {
            let w = if i == 0 || i == n {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            };
            let turn = C64::new(0.0, -omega * h * f64::from(i)).exp() * (w * h / 3.0);
            let value = r(h * f64::from(i));
            sum += CMat::from_fn(7, 7, |a, b| turn * value[(a, b)]);
        }
        sum
    };
    let omega = rad_per_s(1.3);
    let white = input_output_white(vehicle.system(), &force, omega);
    assert!(difference(&classical.spectrum(omega), &white) < 1e-11);
    let transformed = half(&|t| classical.correlation(t), omega, 12.0, 6000);
    assert!(difference(&transformed, &classical.half_spectrum(omega)) < 1e-5);

    let model = InteractionModel::new(&vehicle.wheeled(rows).unwrap(), &paper_road(), 20.0).unwrap();
    let lags = CorrelationModel::new(&model, 6.0).unwrap();
    let transformed = half(&|t| lags.correlation(t), omega, 6.0, 360);
    let off = difference(&model.first_fraction(omega), &transformed);
    assert!(off > 0.2, "the first sum of (45) is {off} from the transform of the positive lags");
    // no delay in a vehicle of one axle, but a coloured road: α leaks into the other half all the same
    let delays = model.terms().iter().filter(|t| t.delay != Delay::None).count();
    assert_eq!(delays, 4);
}

fn input_output_white(system: &SecondOrder, force: &[f64], omega: f64) -> CMat {
    let g =
        washboard::linalg::solve_complex(&system.dynamic_stiffness(omega), &CMat::identity(7, 7)).unwrap();
    let s = CMat::from_fn(7, 7, |i, j| if i == j { C64::new(force[i], 0.0) } else { C64::new(0.0, 0.0) });
    g.conjugate() * s * g.transpose()
}

/// The rhombic layout of figure 1 and eq. (9), as a model: three tracks, delays both ways.
#[test]
fn rhombic_layout() {
    let at = [[0.0, 0.0], [1.2, 0.8], [-0.9, 0.8], [0.0, 1.9]];
    let rows = |v: f64| -> Vec<Vec<f64>> {
        (0..4)
            .map(|i| (0..4).map(|j| if i == j { v * (1.0 + 0.1 * i as f64) } else { -0.1 * v }).collect())
            .collect()
    };
    let under = |v: f64| -> Vec<Vec<f64>> {
        (0..4).map(|i| (0..4).map(|j| if i == j { v } else { 0.0 }).collect()).collect()
    };
    let spec: VehicleSpec = Matrices {
        m: under(60.0),
        c: rows(900.0),
        k: rows(1.5e5),
        wheel_stiffness: under(1.1e5),
        wheel_damping: under(120.0),
        dofs: vec![],
        wheel: at.iter().map(|at| WheelRow { name: "w".into(), at_m: *at }).collect(),
        output: vec![],
        actuator: vec![],
    }
    .into();
    let vehicle = spec.build_alone().unwrap();
    let spectrum = Spectrum::power_law(16e-6, 1.0, 2.4, [0.1, 9.0], Default::default()).unwrap();
    let road = Road::new(spectrum, Coherence::bogsjo(3.0).unwrap());
    let rows = Mat::identity(4, 4);
    let model = InteractionModel::new(&vehicle.wheeled(rows.clone()).unwrap(), &road, 20.0).unwrap();
    for f in [0.5, 2.0, 8.0, 20.0] {
        let w = rad_per_s(f);
        assert!(difference(&model.spectrum(w), &input_output(&vehicle, &rows, &road, w)) < 1e-10);
    }
}
