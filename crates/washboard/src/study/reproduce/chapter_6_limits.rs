//! §6.1: the half car on one track, what no controller beats in H2, figures 6.2 and 6.3.

use super::ReproduceError;
use super::context::Context;
use super::item::{Axis, Curve, INPUT, Relation, Sheet};
use super::lmi_cars::outputs;
use crate::cases;
use crate::lti::GeneralizedPlant;
use crate::road::{Coherence, Spectrum};
use crate::synthesis::{full_information, h2_limit};
use crate::vehicle::{Disturbance, PlantSettings};

/// Λ of the two figures: travels, tire deflections, accelerations.
pub(super) const WEIGHTS: [[f64; 6]; 2] = [[1.0; 6], [10.0, 10.0, 100.0, 100.0, 1.0, 1.0]];
/// Padé's order as printed, and one from which on the limit does not change.
pub(super) const PRINTED_ORDER: usize = 2;
pub(super) const CONVERGED: usize = 40;
/// Speeds of the curves that are drawn, m/s.
const SPEEDS_M_S: [f64; 5] = [5.0, 10.0, 20.0, 30.0, 40.0];
/// Points of a curve to 100 N s/m.
const STEPS: usize = 10;
const CASE: &str = "turkay-half-car";
const ROAD: &str = "turkay-first-order";
const TWO_ROUTES: (f64, &str) = (1e-9, "two routes to one number");

/// Travels, tire deflections, heave and pitch acceleration; both travels measured; one track on the road of §6.1.1.
pub(super) fn plant(ct: f64, speed_m_s: f64, delay_order: usize) -> Result<GeneralizedPlant, ReproduceError> {
    let road = cases::road(ROAD)?.with_coherence(Coherence::Full);
    let spec = cases::vehicle_spec(CASE)?;
    let car = spec.with_overrides(&[("tire_damping_n_s_per_m".into(), ct)])?.build_alone()?;
    let z = ["suspension_travel", "tire_deflection", "heave_acceleration", "pitch_acceleration"];
    let disturbance = Disturbance::RoadNoise;
    let settings = PlantSettings { road: (&road).into(), speed_m_s, disturbance, delay_order };
    Ok(car.plant(&outputs(&car, &z)?, &outputs(&car, &z[..1])?, &settings)?)
}

/// μ(c_t; Λ): the least H2 norm of any controller over the passive one.
pub(super) fn least_share(ct: f64, v: f64, order: usize, lambda: &[f64; 6]) -> Result<f64, ReproduceError> {
    let plant = plant(ct, v, order)?.with_weights(lambda)?;
    Ok(full_information(&plant)?.0 / plant.passive().h2_norm()?)
}

/// Table 6.1: what the case starts from.
pub(super) fn table_1(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let spec = cases::vehicle_spec(CASE)?;
    let Some(car) = spec.half_car.as_ref() else {
        return Err(ReproduceError::unexpected("case", "a half car", CASE));
    };
    let both = |of: &dyn Fn(&crate::vehicle::Axle) -> crate::vehicle::LeftRight| {
        [&car.front, &car.rear].map(|axle| of(axle).sides()[0])
    };
    let [mu1, mu2] = both(&|a| a.unsprung_mass_kg);
    let [cs1, cs2] = both(&|a| a.suspension_damping_n_s_per_m);
    let [ks1, ks2] = both(&|a| a.suspension_stiffness_n_per_m);
    let [kt1, kt2] = both(&|a| a.tire_stiffness_n_per_m);
    for (name, digits, found) in [
        ("m_s, kg", "500", car.sprung_mass_kg),
        ("I_p, kg m²", "2700", car.pitch_inertia_kg_m2),
        ("m_u1, kg", "36", mu1),
        ("m_u2, kg", "36", mu2),
        ("c_s1, N s/m", "980", cs1),
        ("c_s2, N s/m", "980", cs2),
        ("k_s1, N/m", "16000", ks1),
        ("k_s2, N/m", "16000", ks2),
        ("k_t1, N/m", "160000", kt1),
        ("k_t2, N/m", "160000", kt2),
        ("l₁, m", "1.5", car.front_axle_m),
        ("l₂, m", "2.5", car.rear_axle_m),
    ] {
        sheet.within(name, digits, found, (0.0, INPUT));
    }
    Ok(())
}

/// §6.1.1: the road's filter; §6.1.2: (6.12) attains the infimum (6.9); ratios of passive rms values.
pub(super) fn section(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    if let Spectrum::FirstOrder { gain, corner_rad_per_m } = cases::road(ROAD)?.spectrum() {
        sheet.within("G̃: gain", "0.0195", *gain, (0.0, INPUT));
        sheet.within("G̃: corner, rad/m", "0.0572", *corner_rad_per_m, (0.0, INPUT));
    }
    let order = plant(0.0, 20.0, PRINTED_ORDER)?.order();
    sheet.count("states: 8, of G̃ 1, of L 2", 11, order);
    for (lambda, name) in WEIGHTS.iter().zip(["I", "diag(10 I, 100 I, I)"]) {
        for ct in [0.0, 100.0] {
            let plant = plant(ct, 20.0, PRINTED_ORDER)?.with_weights(lambda)?;
            let ratio = h2_limit(&plant)?.h2 / full_information(&plant)?.0;
            let text = format!("(6.12) over the Riccati route, Λ = {name}, c_t = {ct}");
            sheet.within(text, "1", ratio, TWO_ROUTES);
        }
    }
    let [travel, tire, heave] = passive_ratios(20.0, PRINTED_ORDER)?;
    let text = "front, 20 m/s, c_t = 0";
    sheet
        .bound("rms heave acceleration over rms travel", Relation::AtLeast, "100", heave / travel)
        .excused_by("E6.8")
        .noted(text);
    let about = (1.0, "\"about three times\", taken as 1; front, 20 m/s, c_t = 0");
    sheet.within("rms travel over rms tire deflection", "3", travel / tire, about);
    Ok(())
}

/// Norms of front travel, front tire deflection and heave acceleration, passive, c_t = 0.
pub(super) fn passive_ratios(v: f64, order: usize) -> Result<[f64; 3], ReproduceError> {
    let norms = plant(0.0, v, order)?.passive().h2_of_outputs()?;
    let of = |k: usize| norms.get(k).copied().unwrap_or(f64::NAN);
    Ok([of(0), of(2), of(4)])
}

fn dampings() -> Vec<f64> {
    (0..=STEPS).map(|k| 100.0 * k as f64 / STEPS as f64).collect()
}

/// One curve a speed.
fn curves(order: usize, lambda: &[f64; 6]) -> Result<Vec<Curve>, ReproduceError> {
    let x = dampings();
    let curve = |v: &f64| {
        let y = x.iter().map(|ct| least_share(*ct, *v, order, lambda)).collect::<Result<_, _>>()?;
        Ok(Curve { label: format!("{v} m/s"), y })
    };
    SPEEDS_M_S.iter().map(curve).collect()
}

/// Both panels: Padé's printed order, and the delay as it is.
fn figure(sheet: &mut Sheet, lambda: &[f64; 6], name: &str) -> Result<Vec<Curve>, ReproduceError> {
    let x = dampings();
    let printed = curves(PRINTED_ORDER, lambda)?;
    for (panel, order, drawn) in
        [("a", PRINTED_ORDER, printed.clone()), ("b", CONVERGED, curves(CONVERGED, lambda)?)]
    {
        let title = format!("Least cost over the passive one, Λ = {name}, Padé's order {order}");
        sheet.figure(panel, &title, Axis::linear("c_t, N s/m").at(&x), Axis::linear("μ"), drawn);
    }
    let rise = |c: &Curve| c.y.windows(2).map(|w| w[1] - w[0]).fold(f64::NEG_INFINITY, f64::max);
    let worst = printed.iter().map(rise).fold(f64::NEG_INFINITY, f64::max);
    sheet.bound("largest rise of μ between points", Relation::AtMost, "0", worst).noted("tire damping helps");
    Ok(printed)
}

/// μ at 40 m/s less that at 5 m/s: the largest of a curve.
fn gain_by_speed(curves: &[Curve]) -> f64 {
    let (Some(slow), Some(fast)) = (curves.first(), curves.last()) else { return f64::NAN };
    slow.y.iter().zip(&fast.y).map(|(s, f)| f - s).fold(f64::NEG_INFINITY, f64::max)
}

/// Figure 6.2.
pub(super) fn f2(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let drawn = figure(sheet, &WEIGHTS[0], "I")?;
    let ratio = |c: &Curve| c.y.first().zip(c.y.last()).map_or(f64::NAN, |(a, b)| a / b);
    let least = drawn.iter().map(ratio).fold(f64::INFINITY, f64::min);
    let text = "\"remarkable\", taken as a factor of two at every speed";
    sheet.bound("μ(0)/μ(100), least of all speeds", Relation::AtLeast, "2", least).noted(text);
    let text = "\"further improved by increasing velocities\"";
    sheet
        .bound("μ at 40 m/s less μ at 5 m/s, largest", Relation::AtMost, "0", gain_by_speed(&drawn))
        .excused_by("E6.6")
        .noted(text);
    Ok(())
}

/// Figure 6.3.
pub(super) fn f3(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let drawn = figure(sheet, &WEIGHTS[1], "diag(10 I, 100 I, I)")?;
    let felt = |c: &Curve| c.y.first().zip(c.y.last()).map_or(f64::NAN, |(a, b)| 100.0 * (1.0 - b / a));
    let least = drawn.iter().map(felt).fold(f64::INFINITY, f64::min);
    let text = "\"still felt\", taken as half a per cent at every speed";
    sheet
        .bound("drop of μ by c_t = 100, %, least of all speeds", Relation::AtLeast, "0.5", least)
        .noted(text);
    let text = "with Padé's order 2; not with the delay as it is (E6.6)";
    sheet
        .bound("μ at 40 m/s less μ at 5 m/s, largest", Relation::AtMost, "0", gain_by_speed(&drawn))
        .noted(text);
    let right =
        least_share(0.0, 40.0, CONVERGED, &WEIGHTS[1])? - least_share(0.0, 5.0, CONVERGED, &WEIGHTS[1])?;
    sheet
        .bound("the same at c_t = 0 with the delay as it is", Relation::AtMost, "0", right)
        .excused_by("E6.6");
    Ok(())
}
