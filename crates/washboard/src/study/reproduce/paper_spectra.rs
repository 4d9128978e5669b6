//! The paper's figures 6 and 7: spectra and correlations by the interaction model and by the input-output formula.

use super::ReproduceError;
use super::context::{Context, SPEED_M_S};
use super::item::{Axis, Curve, Sheet};
use super::paper_car::car;
use super::paper_road::{BAND_RAD_S, lags_of, road};
use crate::identify::interaction::InteractionModel;
use crate::linalg::{C64, CMat, Mat};
use crate::units::{hz, per_hz_from_two_sided};
use crate::vehicle::{Output, Ride, Vehicle};

/// z_s, z_s2, z_s3, z_u1, z_u3, z_u4.
const OUTPUTS: [&str; 6] = [
    "heave_displacement",
    "body_displacement_front_left",
    "body_displacement_rear_right",
    "unsprung_displacement_front_right",
    "unsprung_displacement_rear_right",
    "unsprung_displacement_rear_left",
];
/// Panels (a)–(d): rows of [`OUTPUTS`].
const PAIRS: [(&str, &str, [usize; 2]); 4] = [
    ("a", "z_s z_u1", [0, 3]),
    ("b", "z_s2 z_s3", [1, 2]),
    ("c", "z_u1 z_u3", [3, 4]),
    ("d", "z_u1 z_u4", [3, 5]),
];
/// "Perfectly overlap".
const OVERLAP: (f64, &str) =
    (1e-9, "\"perfectly overlap\": rounding of 196 terms, which cancel at high frequencies");
const OVERLAP_OF_LAGS: (f64, &str) = (1e-8, "\"overlapping\": two quadratures");
/// Points of figure 6, and lags of figure 7 to [`LAG_S`].
const POINTS: i32 = 240;
const LAGS: i32 = 60;
const LAG_S: f64 = 3.0;
/// Wheelbase of table 1, m.
const WHEELBASE_M: f64 = 2.66;

fn outputs(vehicle: &Vehicle) -> Result<Vec<&Output>, ReproduceError> {
    OUTPUTS.iter().map(|n| Ok(vehicle.output(n)?)).collect()
}

fn model(vehicle: &Vehicle, outputs: &[&Output]) -> Result<InteractionModel, ReproduceError> {
    let rows = Mat::from_fn(outputs.len(), 7, |i, j| outputs[i].q[0][j]);
    Ok(InteractionModel::new(&vehicle.wheeled(rows)?, &road()?, SPEED_M_S)?)
}

/// Figure 6: (45) and (50) over the band.
pub(super) fn figure_6(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let (vehicle, road) = (car(true)?, road()?);
    let outputs = outputs(&vehicle)?;
    let model = model(&vehicle, &outputs)?;
    let ride = Ride::new(&vehicle, &road, SPEED_M_S)?;
    // the band's ends belong to it but for rounding
    let [low, high] = [BAND_RAD_S[0] * (1.0 + 1e-12), BAND_RAD_S[1] * (1.0 - 1e-12)];
    let omega: Vec<f64> =
        (0..=POINTS).map(|k| low + (high - low) * f64::from(k) / f64::from(POINTS)).collect();
    let by_model: Vec<_> = omega.iter().map(|w| model.spectrum(*w)).collect();
    let direct: Vec<_> = omega.iter().map(|w| ride.spectrum(&outputs, *w)).collect::<Result<_, _>>()?;
    let x: Vec<f64> = omega.iter().map(|w| hz(*w)).collect();
    for (panel, name, [i, j]) in PAIRS {
        let of = |all: &[CMat]| -> Vec<C64> { all.iter().map(|s| s[(i, j)]).collect() };
        let (ours, known) = (of(&by_model), of(&direct));
        let off = ours.iter().zip(&known).map(|(a, b)| (a - b).norm() / b.norm()).fold(0.0, f64::max);
        sheet.within(format!("S of {name}: largest relative difference of (45) and (50)"), "0", off, OVERLAP);
        let curve = |label: &str, all: &[C64], f: &dyn Fn(&C64) -> f64| Curve {
            label: label.to_owned(),
            y: all.iter().map(f).collect(),
        };
        for (kind, up, f) in [
            (
                "",
                Axis::log("|S|, m²/Hz"),
                &(|s: &C64| per_hz_from_two_sided(s.norm())) as &dyn Fn(&C64) -> f64,
            ),
            ("-phase", Axis::linear("phase, degrees"), &|s: &C64| s.arg().to_degrees()),
        ] {
            let curves = vec![curve("input-output (50)", &known, f), curve("model (45)", &ours, f)];
            let title = format!("Cross spectrum of {name}");
            sheet.figure(&format!("{panel}{kind}"), &title, Axis::linear("frequency, Hz").at(&x), up, curves);
        }
    }
    let delay = -mean_slope(&omega, &direct.iter().map(|s| s[(3, 4)]).collect::<Vec<_>>());
    let reading = (0.05, "\"saw-tooth trend caused by time-delayed signals\", taken as 5 % of the delay");
    let ratio = delay * SPEED_M_S / WHEELBASE_M;
    sheet.within("mean delay by the phase of (c) over wheelbase/speed", "1", ratio, reading);
    Ok(())
}

/// Mean slope of a phase, unwrapped from point to point.
fn mean_slope(omega: &[f64], values: &[C64]) -> f64 {
    let turns: f64 = values.windows(2).map(|w| (w[1] / w[0]).arg()).sum();
    match (omega.first(), omega.last()) {
        (Some(first), Some(last)) => turns / (last - first),
        _ => f64::NAN,
    }
}

/// Figure 7: (43) and the inverse transform of (50).
pub(super) fn figure_7(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let (vehicle, road) = (car(true)?, road()?);
    let outputs = outputs(&vehicle)?;
    let of_lag = lags_of(&model(&vehicle, &outputs)?, LAG_S)?;
    let ride = Ride::new(&vehicle, &road, SPEED_M_S)?;
    let x: Vec<f64> = (-LAGS..=LAGS).map(|k| LAG_S * f64::from(k) / f64::from(LAGS)).collect();
    let by_model: Vec<Mat> = x.iter().map(|t| of_lag.correlation(*t)).collect();
    let direct: Vec<Mat> = x.iter().map(|t| ride.covariance(&outputs, *t)).collect::<Result<_, _>>()?;
    let at_rest = ride.covariance(&outputs, 0.0)?;
    for (panel, name, [i, j]) in PAIRS {
        let of = |all: &[Mat]| -> Vec<f64> { all.iter().map(|r| r[(i, j)]).collect() };
        let (ours, known) = (of(&by_model), of(&direct));
        let scale = (at_rest[(i, i)] * at_rest[(j, j)]).sqrt();
        let off = ours.iter().zip(&known).map(|(a, b)| (a - b).abs() / scale).fold(0.0, f64::max);
        let text = format!("R of {name}: largest difference of (43) and (50) over √(R_ii R_jj)");
        sheet.within(text, "0", off, OVERLAP_OF_LAGS);
        let curves = vec![
            Curve { label: "input-output (50)".to_owned(), y: known },
            Curve { label: "model (43)".to_owned(), y: ours },
        ];
        let title = format!("Cross-correlation of {name}");
        sheet.figure(panel, &title, Axis::linear("lag, s").at(&x), Axis::linear("R, m²"), curves);
    }
    let peak = of_lag_peak(&x, &direct);
    let reading = (LAG_S / f64::from(LAGS), "to a step of the lags");
    sheet
        .within("lag of the largest R of z_u1 z_u3, s", "0.133", peak.abs(), reading)
        .noted("2.66 m at 20 m/s");
    Ok(())
}

/// Where R of z_u1 z_u3 is largest.
fn of_lag_peak(x: &[f64], all: &[Mat]) -> f64 {
    let best = x.iter().zip(all).max_by(|a, b| a.1[(3, 4)].total_cmp(&b.1[(3, 4)]));
    best.map_or(f64::NAN, |(t, _)| *t)
}

/// (50) by a dense solve.
pub(super) fn direct(vehicle: &Vehicle, rows: &Mat, omega: f64) -> Result<CMat, ReproduceError> {
    let h = vehicle.road_response(omega)?;
    let h = CMat::from_fn(rows.nrows(), h.ncols(), |i, j| {
        (0..h.nrows()).map(|k| h[(k, j)] * rows[(i, k)]).sum::<C64>()
    });
    let s = crate::road::wheel_spectrum(&road()?, &vehicle.wheel_places(), omega, SPEED_M_S);
    Ok(h.conjugate() * s * h.transpose())
}
