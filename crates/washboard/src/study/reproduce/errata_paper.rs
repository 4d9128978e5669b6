//! Evidence for the errata of the paper.

use super::ReproduceError;
use super::context::{Context, SPEED_M_S};
use super::errata::shown;
use super::item::Evidence;
use super::paper_car::{car, coordinates};
use super::paper_road::{BAND_RAD_PER_M, BAND_RAD_S, MU, TRACK_M, lags_of, model, road, spectrum, variance};
use super::paper_spectra::direct;
use crate::linalg::{C64, CMat, Mat, solve};
use crate::lti::ModalForm;
use crate::road::Coherence;
use crate::units::Convention;
use crate::vehicle::Vehicle;
use std::f64::consts::TAU;

type Shown = Result<Vec<Evidence>, ReproduceError>;

fn difference(a: &CMat, b: &CMat) -> f64 {
    (a - b).norm_l2() / b.norm_l2()
}

/// Below this, a relative difference of two routes is rounding, which no two machines share.
fn beyond_rounding(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}

/// (45)–(46) with λ_m in the tires' factors, as (A11)–(A12) and (A16)–(A21) are printed, or λ_n.
fn spectrum_of_factors(
    vehicle: &Vehicle,
    rows: &Mat,
    omega: f64,
    printed: bool,
) -> Result<CMat, ReproduceError> {
    let form = ModalForm::new(vehicle.system())?;
    let (poles, l) = (form.poles(), form.l());
    let psi = CMat::from_fn(7, 14, |i, m| (0..7).map(|k| form.psi()[(k, m)] * rows[(i, k)]).sum::<C64>());
    let tires: Vec<(usize, f64, f64, [f64; 2])> = (0..4)
        .map(|w| {
            let dof = 3 + w;
            let (k, c) = (vehicle.wheel_stiffness()[(dof, w)], vehicle.wheel_damping()[(dof, w)]);
            (dof, k, c, vehicle.wheels()[w].at_m)
        })
        .collect();
    let road = road()?;
    let fraction = |omega: f64| {
        let sd = road.spectrum().psd(omega, SPEED_M_S);
        let mut phi = CMat::zeros(7, 14);
        for (da, ka, ca, at_a) in &tires {
            for (db, kb, cb, at_b) in &tires {
                let gamma = road.coherence().gamma((at_a[1] - at_b[1]).abs(), omega, SPEED_M_S);
                let turn = C64::new(0.0, -omega * (at_a[0] - at_b[0]) / SPEED_M_S).exp() * (gamma * sd);
                for (n, m) in (0..14).flat_map(|n| (0..14).map(move |m| (n, m))) {
                    let at = if printed { poles[m] } else { poles[n] };
                    let tire = (C64::from(*ka) - at * *ca) * (C64::from(*kb) + at * *cb);
                    let term = tire * l[(*da, m)] * l[(*db, n)] / (poles[n] + poles[m]) * turn;
                    for i in 0..7 {
                        phi[(i, n)] -= psi[(i, m)] * term;
                    }
                }
            }
        }
        let weighted = CMat::from_fn(7, 14, |i, n| phi[(i, n)] / (C64::new(0.0, omega) - poles[n]));
        &weighted * psi.transpose()
    };
    Ok(&fraction(omega) + fraction(-omega).transpose())
}

pub(super) fn tire_factors(_: &Context) -> Shown {
    let car = car(true)?;
    let [q1, _] = coordinates(&car)?;
    let mut all = Vec::new();
    for freq in [0.5, 1.0, 5.0, 15.0, 28.0] {
        let known = direct(&car, &q1, TAU * freq)?;
        let off = |printed| {
            Ok::<_, ReproduceError>(beyond_rounding(difference(
                &spectrum_of_factors(&car, &q1, TAU * freq, printed)?,
                &known,
            )))
        };
        all.push(shown(format!("S(2π {freq} Hz): relative difference from (50)"), off(true)?, off(false)?));
    }
    Ok(all)
}

/// Modal a by M₁T⁻¹ and by the congruence, mode by mode.
pub(super) fn second_coordinates(_: &Context) -> Shown {
    let car = car(true)?;
    let [q1, q2] = coordinates(&car)?;
    let s = car.system();
    let inverse = solve(&q1, &Mat::identity(7, 7))?;
    let first = |a: &Mat| inverse.transpose() * a * &inverse;
    let (m1, c1) = (first(s.m()), first(s.c()));
    let t_inverse = solve(&(&q2 * &inverse), &Mat::identity(7, 7))?;
    let printed = |a: &Mat| a * &t_inverse;
    let right = |a: &Mat| t_inverse.transpose() * a * &t_inverse;
    let form = ModalForm::new(s)?;
    let modal_a = |rows: &Mat, m: &Mat, c: &Mat, n: usize| -> C64 {
        let psi = CMat::from_fn(7, 1, |i, _| (0..7).map(|k| form.psi()[(k, n)] * rows[(i, k)]).sum::<C64>());
        let inner = CMat::from_fn(7, 7, |i, j| form.poles()[n] * (2.0 * m[(i, j)]) + c[(i, j)]);
        (psi.transpose() * inner * &psi)[(0, 0)]
    };
    let asymmetry = |m: &Mat| (m - m.transpose()).norm_max();
    let mut all = vec![shown(
        "largest M₂ − M₂ᵀ, kg",
        beyond_rounding(asymmetry(&printed(&m1))),
        beyond_rounding(asymmetry(&right(&m1))),
    )];
    for (mode, label) in car.modes()? {
        let distance = |n: &usize| (form.poles()[*n] - mode.pole).norm();
        let nearest = (0..14).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(n) = nearest else { continue };
        let known = modal_a(&q1, &m1, &c1, n);
        let off = |m: &Mat, c: &Mat| beyond_rounding((modal_a(&q2, m, c, n) / known - C64::from(1.0)).norm());
        all.push(shown(
            format!("{label}: |m_a/m_a of the first coordinates − 1|"),
            off(&printed(&m1), &printed(&c1)),
            off(&right(&m1), &right(&c1)),
        ));
    }
    Ok(all)
}

pub(super) fn coherence(_: &Context) -> Shown {
    let omega = TAU;
    let printed = |w: f64| (-MU * TRACK_M * w / (TAU * SPEED_M_S)).exp();
    let right = Coherence::bogsjo(MU)?.gamma(TRACK_M, -omega, SPEED_M_S);
    let of_lag = lags_of(&model()?, 0.0)?;
    // R_d * 1 is the integral of R_d, and so S_d(0)
    Ok(vec![
        shown("Γ₁ at ω = −2π·1 Hz, which (45) needs", printed(-omega), right),
        shown(
            "variance of one track with H₀ = 1 (∫R_d dτ = S_d(0)) and H₀ = δ, m²",
            road()?.spectrum().psd(0.0, SPEED_M_S),
            of_lag.track_correlation(0.0, 0.0),
        ),
    ])
}

pub(super) fn one_sided(_: &Context) -> Shown {
    let band = BAND_RAD_S.map(|w| w / SPEED_M_S);
    let density = |c: Convention| Ok::<_, ReproduceError>(spectrum(band, c)?.psd(TAU, SPEED_M_S));
    let factor = density(Convention::OneSidedRadPerM)? / density(Convention::Paper)?;
    Ok(vec![
        shown(
            "two-sided S_d(2π·1 Hz), m² s/rad",
            density(Convention::Paper)?,
            density(Convention::OneSidedRadPerM)?,
        ),
        shown("variance of one track, m²", variance(BAND_RAD_S), factor * variance(BAND_RAD_S)),
    ])
}

pub(super) fn band(_: &Context) -> Shown {
    let at_speed = spectrum(BAND_RAD_PER_M, Convention::Paper)?.band_rad_s(SPEED_M_S);
    Ok(vec![
        shown("ω_a at 20 m/s, rad/s", BAND_RAD_S[0], at_speed[0]),
        shown("ω_b at 20 m/s, rad/s", BAND_RAD_S[1], at_speed[1]),
        shown("R_d(0) in the paper's convention, m²", variance(BAND_RAD_S), variance(at_speed)),
    ])
}

/// The first sum of (45) beside the transform of the positive lags, 1.3 Hz.
pub(super) fn half_spectra(_: &Context) -> Shown {
    const STEPS: i32 = 360;
    const REACH_S: f64 = 6.0;
    let (omega, model) = (TAU * 1.3, model()?);
    let of_lag = lags_of(&model, REACH_S)?;
    let h = REACH_S / f64::from(STEPS);
    let mut sum = CMat::zeros(7, 7);
    for i in 0..=STEPS {
        let weight = match i {
            0 | STEPS => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let turn = C64::new(0.0, -omega * h * f64::from(i)).exp() * (weight * h / 3.0);
        let r = of_lag.correlation(h * f64::from(i));
        sum += CMat::from_fn(7, 7, |a, b| turn * r[(a, b)]);
    }
    let off = difference(&model.first_fraction(omega), &sum);
    Ok(vec![shown("first sum of (45) over the transform of positive lags, less 1, at 1.3 Hz", 0.0, off)])
}

/// (A8) at λ_m = −2 + 7i, λ_n = −3 − i, τ₁ = .133, τ = −.05: the integral with each sign, beside (A6).
pub(super) fn sign_of_delay(_: &Context) -> Shown {
    const STEPS: i32 = 200_000;
    const REACH: f64 = 12.0;
    let (m, n, delay, lag) = (C64::new(-2.0, 7.0), C64::new(-3.0, -1.0), 0.133, -0.05f64);
    let integral = |sign: f64| {
        let (upper, h) = (lag.min(-delay), REACH / f64::from(STEPS));
        let at = |k: i32| {
            let x = upper - h * f64::from(k);
            let weight = if k == 0 || k == STEPS { 0.5 } else { 1.0 };
            (m * (lag - x) + n * (-x + sign * delay)).exp() * (weight * h)
        };
        (0..=STEPS).map(at).sum::<C64>()
    };
    let (printed, right) = (integral(1.0), integral(-1.0));
    // τ + τ₁ > 0 here
    let known = -(m * (lag + delay)).exp() / (n + m);
    Ok(vec![
        shown("real part of the integral", printed.re, right.re),
        shown("imaginary part", printed.im, right.im),
        shown("real part by (A6)", known.re, known.re),
        shown("imaginary part by (A6)", known.im, known.im),
    ])
}

pub(super) fn dampers(_: &Context) -> Shown {
    let (printed, right) = (car(true)?.modes()?, car(false)?.modes()?);
    let percent = |m: &(crate::lti::Mode, String)| 100.0 * m.0.damping;
    Ok(printed
        .iter()
        .zip(&right)
        .map(|(p, r)| shown(format!("{}: damping ratio, %", p.1), percent(p), percent(r)))
        .collect())
}
