//! Each step on exact spectra of a known car.

use super::transfer::Transfer;
use super::*;
use crate::identify::likelihood::{Road, RoadValues, Spectra};
use crate::linalg::{CMat, solve_complex};
use crate::lti::{SecondOrder, WheeledSystem};

const SPEED_M_S: f64 = 20.0;
const MU: f64 = 3.8;
const S0: f64 = 16e-6;
/// The relocation has settled to this share of a pole.
const POLE_ERROR: f64 = 1e-6;
/// rms error of the start's responses over theirs.
const START_ERROR: f64 = 0.25;
/// Front left, front right, rear left, rear right.
const AT_M: [[f64; 2]; 4] = [[1.2, 0.75], [1.2, -0.75], [-1.4, 0.75], [-1.4, -0.75]];

/// A full car: heave, pitch, roll, four wheels; sensors at the four corners of the body and on the hubs. The sides differ by
/// `uneven`.
fn car(uneven: f64) -> WheeledSystem {
    let masses = [1150.0, 1630.0, 530.0, 40.0, 40.0, 45.0, 45.0];
    let side = |w: usize, v: f64| v * if w.is_multiple_of(2) { 1.0 + uneven } else { 1.0 - uneven };
    let [k, c] = [[19e3, 19e3, 22e3, 22e3], [1500.0; 4]];
    let (kt, ct, bars) = ([190e3, 190e3, 180e3, 180e3], 150.0, [9e3, 4e3]);
    let corner = |w: usize| {
        let [x, y] = AT_M[w];
        let mut row = [0.0; 7];
        (row[0], row[1], row[2]) = (1.0, -x, y);
        row
    };
    let travel = |w: usize| {
        let mut row = corner(w);
        row[3 + w] = -1.0;
        row
    };
    let mut stiffness = Mat::zeros(7, 7);
    let mut damping = Mat::zeros(7, 7);
    let add = |m: &mut Mat, row: &[f64; 7], v: f64| {
        for i in 0..7 {
            for j in 0..7 {
                m[(i, j)] += v * row[i] * row[j];
            }
        }
    };
    let (mut kw, mut cw) = (Mat::zeros(7, 4), Mat::zeros(7, 4));
    for w in 0..4 {
        add(&mut stiffness, &travel(w), side(w, k[w]));
        add(&mut damping, &travel(w), side(w, c[w]));
        let mut hub = [0.0; 7];
        hub[3 + w] = 1.0;
        add(&mut stiffness, &hub, kt[w]);
        add(&mut damping, &hub, ct);
        (kw[(3 + w, w)], cw[(3 + w, w)]) = (kt[w], ct);
    }
    for (axle, bar) in bars.iter().enumerate() {
        let (l, r) = (travel(2 * axle), travel(2 * axle + 1));
        let twist: [f64; 7] = std::array::from_fn(|j| (l[j] - r[j]) / 1.5);
        add(&mut stiffness, &twist, *bar);
    }
    let mass = Mat::from_fn(7, 7, |i, j| if i == j { masses[i] } else { 0.0 });
    let rows = Mat::from_fn(8, 7, |i, j| if i < 4 { corner(i)[j] } else { f64::from(u8::from(j == i - 1)) });
    let system = SecondOrder::new(mass, damping, stiffness).unwrap();
    WheeledSystem::new(system, kw, cw, AT_M.to_vec(), rows).unwrap()
}

/// H at ω: sensors × wheels.
fn h(car: &WheeledSystem, omega: f64) -> CMat {
    let b = CMat::from_fn(7, 4, |i, w| {
        C64::new(car.wheel_stiffness()[(i, w)], omega * car.wheel_damping()[(i, w)])
    });
    let q = solve_complex(&car.system().dynamic_stiffness(omega), &b).unwrap();
    CMat::from_fn(8, 7, |i, j| C64::new(car.rows()[(i, j)], 0.0)) * q
}

fn known() -> Drive {
    Drive { speed_m_s: SPEED_M_S, convention: Convention::default() }
}

/// Exact spectra of accelerometers from .4 to 20 Hz, .05 Hz apart, seen through no window.
fn band(car: &WheeledSystem) -> BandData {
    let (first, step) = (8, rad_per_s(0.05));
    let omega: Vec<f64> = (first..=400).map(|k| step * k as f64).collect();
    let values = RoadValues { ln_s0: S0.ln(), exponent: 2.0, mu: MU, ln_delay: 0.0 };
    let road = Road::new(known(), values, &AT_M);
    let of = |omega: f64| {
        let mut s = vec![C64::new(0.0, 0.0); 16];
        road.fill(omega, &mut s);
        let h = h(car, omega) * faer::Scale(C64::new(-omega * omega, 0.0));
        h.conjugate() * CMat::from_fn(4, 4, |i, j| s[4 * i + j]) * h.transpose()
    };
    let raw: Vec<CMat> = omega.iter().map(|o| of(*o)).collect();
    let scale: Vec<f64> =
        (0..8).map(|i| (raw.iter().map(|s| s[(i, i)].re).sum::<f64>() / raw.len() as f64).sqrt()).collect();
    let scaled = raw.iter().map(|s| CMat::from_fn(8, 8, |i, j| s[(i, j)] / (scale[i] * scale[j])));
    BandData {
        first,
        measured: Spectra::of(8, scaled),
        omega,
        step,
        scale,
        averages: 100.0,
        kernel: vec![1.0],
        noise: vec![0.0; 8],
    }
}

/// The true responses to the inputs: \[input\]\[sensor\]\[bin\], the rear's share delayed.
fn truth(car: &WheeledSystem, tracks: &Tracks, omega: &[f64]) -> Vec<Vec<Vec<C64>>> {
    let all: Vec<CMat> = omega.iter().map(|o| h(car, *o)).collect();
    (0..2)
        .map(|k| {
            (0..8)
                .map(|i| {
                    (0..omega.len())
                        .map(|bin| {
                            let late = C64::new(0.0, -omega[bin] * 2.6 / SPEED_M_S).exp();
                            (0..2)
                                .map(|t| {
                                    let [front, rear] = [0, 1].map(|a| tracks.wheels[a][t].unwrap());
                                    (all[bin][(i, front)] + late * all[bin][(i, rear)]) * tracks.share(t, k)
                                })
                                .sum()
                        })
                        .collect()
                })
                .collect()
        })
        .collect()
}

fn planes() -> Vec<[f64; 3]> {
    (0..8).map(|i| [1.0, AT_M[i % 4][1], AT_M[i % 4][0]]).collect()
}

fn spectra() -> crate::signal::CrossSpectra {
    crate::signal::CrossSpectra {
        freq_hz: vec![],
        omega_rad_s: vec![],
        s: vec![],
        averages: 0.0,
        segments: 0,
        pieces: vec![],
        segment_len: 1,
        hop: 1,
        rate_hz: 1.0,
        channels: vec![],
        window: crate::signal::HannWindow::new(4),
    }
}

fn drive<'a>(spectra: &'a crate::signal::CrossSpectra, planes: &'a [[f64; 3]]) -> FreeDrive<'a> {
    FreeDrive {
        spectra,
        blocks: &[],
        at_m: &AT_M,
        derivatives: &[2; 8],
        planes,
        speed_m_s: SPEED_M_S,
        band_hz: [0.4, 20.0],
    }
}

fn tracks() -> Tracks {
    Tracks::new(&AT_M).unwrap()
}

/// Largest error over the largest value.
fn error(found: &[C64], truth: &[C64]) -> f64 {
    let scale = truth.iter().fold(0.0f64, |m, z| m.max(z.norm()));
    found.iter().zip(truth).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / scale
}

#[test]
fn front_hubs_have_the_phase_of_their_gain() {
    let car = car(0.0);
    let data = band(&car);
    let found = Transfer::new(&data, known(), &[2; 8], &tracks(), &[4, 5]).unwrap();
    let truth = truth(&car, &tracks(), &data.omega);
    // hubs nearly follow the road below .9 Hz: S₀ 8 % high, μ 2 % low
    assert!(
        (found.mu / MU - 1.0).abs() < 0.05 && (found.s0 / S0 - 1.0).abs() < 0.1,
        "{} {}",
        found.mu,
        found.s0
    );
    for k in 0..2 {
        for bin in 0..data.omega.len() {
            let t: C64 = (0..2).map(|a| truth[k][4 + a][bin] * tracks().share(a, k)).sum();
            let off = (C64::new(0.0, found.phases[k][bin]).exp() * t.conj()).arg();
            // .085 and .063 at the band's end, where the gain above it is guessed
            assert!(off.abs() < 0.1, "input {k}, bin {bin}: {off}");
        }
        for i in 0..8 {
            // S₀ is 8 % high: 4 % of a response; a tenth of a radian at the band's end
            let off = error(&found.response[k][i], &truth[k][i]);
            assert!(off < 0.07, "input {k}, sensor {i}: {off}");
        }
    }
}

/// Without a ridge, and of responses without error.
#[test]
fn a_vector_fit_of_exact_responses_has_the_poles() {
    let car = car(0.0);
    let data = band(&car);
    let response = truth(&car, &tracks(), &data.omega);
    let shows = vec![vec![vec![1.0; data.omega.len()]; 8]; 2];
    let exact = Transfer { response, shows, phases: Vec::new(), s0: S0, mu: MU };
    let fits = responses(&data, known(), &tracks(), &exact, &drive(&spectra(), &planes()), 0.0).unwrap();
    let found: Vec<C64> = fits.iter().flat_map(|f| f.poles.clone()).collect();
    let mut poles = FirstOrder::of_wheeled(&car).unwrap().poles().unwrap();
    poles.retain(|p| p.im > 0.0);
    assert_eq!((found.len(), poles.len()), (7, 7), "{found:?}");
    for pole in poles {
        let pole = pole / RATE;
        let off = found.iter().map(|f| (f - pole).norm() / pole.norm()).fold(f64::INFINITY, f64::min);
        assert!(off < POLE_ERROR, "{pole}: {off}");
    }
}

/// The whole start of a car and of one whose sides differ by 10 %, over all sensors and wheels and the whole band.
#[test]
fn the_start_is_near_the_car() {
    for uneven in [0.0, 0.05] {
        let car = car(uneven);
        let data = band(&car);
        let on_wheel: Vec<Option<usize>> = (0..8).map(|c| (c >= 4).then(|| c - 4)).collect();
        let (spectra, planes) = (spectra(), planes());
        let start = from_band(&data, known(), &drive(&spectra, &planes), &on_wheel, 14).unwrap();
        assert_eq!(start.system.order(), 14);
        assert!((start.roughness_m3 / S0 - 1.0).abs() < 0.3, "{}", start.roughness_m3);
        let (mut off, mut size) = (0.0, 0.0);
        for omega in &data.omega {
            let (found, truth) = (start.system.response(C64::new(0.0, *omega)).unwrap(), h(&car, *omega));
            off += (&found - &truth).squared_norm_l2();
            size += truth.squared_norm_l2();
        }
        let share = (off / size).sqrt();
        assert!(share < START_ERROR, "uneven {uneven}: {share}");
    }
}

#[test]
fn without_front_hubs_there_is_no_start() {
    let data = band(&car(0.0));
    let (spectra, planes) = (spectra(), planes());
    let of =
        |on_wheel: [Option<usize>; 8]| from_band(&data, known(), &drive(&spectra, &planes), &on_wheel, 14);
    let rear = [None, None, None, None, None, None, Some(2), Some(3)];
    assert_eq!(of(rear).unwrap_err(), NoDataStart::NoFrontHub);
    let three = [[1.2, 0.7], [1.2, 0.0], [1.2, -0.7]];
    assert_eq!(Tracks::new(&three).unwrap_err(), NoDataStart::Wheels);
}

/// On purpose: spectra as Hann's window of 5 s sees them, under a model that takes them for those of single frequencies.
#[test]
fn without_the_windows_kernel_nothing_is_explained() {
    use crate::identify::likelihood::{CHI_LIMIT, Whitening, mean};
    use crate::identify::tvimm::model::{FreeModel, Point};
    use crate::identify::tvimm::search;
    let car = car(0.0);
    let fine = band(&car);
    let first = 2;
    let step = rad_per_s(0.2);
    let system = FirstOrder::of_wheeled(&car).unwrap().in_time_of(RATE).balanced(14).unwrap().0;
    let road = RoadValues { ln_s0: S0.ln(), exponent: 2.0, mu: MU, ln_delay: 0.0 };
    let at = Point { system, road, ln_noise: vec![1e-3f64.ln(); 8] };
    let mut model = FreeModel {
        data: BandData {
            first,
            omega: (first..=100).map(|k| step * k as f64).collect(),
            step,
            averages: 240.0,
            kernel: crate::signal::HannWindow::new(1000).kernel(),
            noise: vec![1e-3; 8],
            ..fine
        },
        drive: known(),
        at_m: AT_M.to_vec(),
        derivatives: vec![2; 8],
        planes: planes(),
    };
    model.data.measured = model.spectra(&at).unwrap();
    let chi = |model: &FreeModel| {
        let found = search::search(model, &at, &[1.0]).unwrap();
        mean(&Whitening::new(&found.frame.evaluation.s).unwrap().residuals(&model.data.measured, 240.0))
    };
    assert!(chi(&model) < 1e-6, "{}", chi(&model));
    model.data.kernel = crate::signal::HannWindow::new(1000).without_kernel().kernel();
    let blind = chi(&model);
    assert!(blind > 10.0 * CHI_LIMIT, "{blind}");
}
