//! Chapter 8: the truck cabin of tables 8.1 and 8.2, and its LQG design.

use super::ReproduceError;
use super::context::{Context, SPEED_M_S};
use super::item::Sheet;
use super::lmi_cars::outputs;
use crate::cases;
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::road::{Coherence, Road, Spectrum};
use crate::synthesis::{Certificate, LqgWeights, lqg};
use crate::vehicle::{Disturbance, PlantSettings, VehicleError, VehicleSpec};

pub(super) const CABIN: &str = "turkay-truck-cabin";
pub(super) const TRUCK: &str = "turkay-bounce-truck";
/// λ of (8.6), 1/s.
pub(super) const LEAK: f64 = 0.1;
/// ε: intensity of the measurements' noise.
const SENSOR_NOISE: f64 = 1e-5;
/// ρ, whose square weighs the forces (E8.3).
pub(super) const RHO: f64 = 1e-3;
/// μ as printed.
const MU: f64 = 0.0027;
const BODY: [&str; 3] = ["heave", "pitch", "roll"];
const ACCELERATIONS: [&str; 3] = ["heave_acceleration", "pitch_acceleration", "roll_acceleration"];
/// Corner accelerations and travels.
const MEASURED: [&str; 2] = ["body_acceleration", "suspension_travel"];

/// The road of (8.6): white velocity of the chassis' filter, which leaks below 0.1 rad/s.
pub(super) fn road(context: &Context) -> Result<Road, ReproduceError> {
    let gain = (context.intensity / SPEED_M_S).sqrt();
    Ok(Road::new(Spectrum::first_order(gain, LEAK / SPEED_M_S)?, Coherence::Independent))
}

/// The truck below the cabin.
fn chassis() -> Result<VehicleSpec, VehicleError> {
    cases::vehicle_spec(TRUCK).map_err(|e| VehicleError::Field {
        field: "chassis".into(),
        expected: "a published bounce truck",
        found: e.to_string(),
    })
}

/// The cabin's plant from unit noises of the chassis' corners to z and both measurements.
pub(super) fn plant(
    context: &Context,
    spec: &VehicleSpec,
    z: &[&str],
) -> Result<GeneralizedPlant, ReproduceError> {
    let (cabin, road) = (spec.build(|_| chassis())?, road(context)?);
    let disturbance = Disturbance::RoadNoise;
    let settings = PlantSettings { road: (&road).into(), speed_m_s: SPEED_M_S, disturbance, delay_order: 0 };
    Ok(cabin.plant(&outputs(&cabin, z)?, &outputs(&cabin, &MEASURED)?, &settings)?)
}

/// What the text leaves open of the design.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    /// Intensity that Q's covariances are of, over the road's own.
    pub q: f64,
    /// Intensity that the filter expects, over the road's own.
    pub filter: f64,
    /// Weight of a squared force.
    pub force: f64,
    /// Whether the regulator's cost keeps its cross term.
    pub cross_term: bool,
}

impl Reading {
    /// μ = .0027 throughout the design, ρ² on the forces, no cross term: what gives the printed numbers.
    pub fn printed(context: &Context) -> Self {
        let rounded = MU * MU * SPEED_M_S / context.intensity;
        Reading { q: rounded, filter: rounded, force: RHO * RHO, cross_term: false }
    }

    /// The unrounded road throughout.
    pub fn unrounded() -> Self {
        Reading { q: 1.0, filter: 1.0, force: RHO * RHO, cross_term: false }
    }
}

/// rms of the accelerations (heave, pitch, roll) and of the forces A, B, C, D.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub accelerations: Vec<f64>,
    pub forces: Vec<f64>,
}

pub(super) fn rms(of: &Certificate) -> Vec<f64> {
    of.channels.iter().map(|c| c.h2.unwrap_or(f64::NAN)).collect()
}

/// rms of the passive cabin's accelerations.
pub(super) fn passive(context: &Context, spec: &VehicleSpec) -> Result<Vec<f64>, ReproduceError> {
    Ok(rms(&Certificate::passive(&plant(context, spec, &ACCELERATIONS)?)?))
}

/// The LQG controller of §8.3 as read.
pub(super) fn controller(
    context: &Context,
    spec: &VehicleSpec,
    reading: Reading,
) -> Result<StateSpace<Continuous>, ReproduceError> {
    let weights: Vec<f64> = passive(context, spec)?.iter().map(|r| 1.0 / (r * reading.q.sqrt())).collect();
    let goal = plant(context, spec, &ACCELERATIONS)?.with_weights(&weights)?;
    let settings = LqgWeights {
        sensor_noise: vec![SENSOR_NOISE; goal.ny()],
        input_weight: vec![reading.force; goal.nu()],
        process_noise: reading.filter,
        cross_term: reading.cross_term,
    };
    Ok(lqg(&goal, &settings)?.controller)
}

/// What it does on the unrounded road.
pub(super) fn active(
    context: &Context,
    spec: &VehicleSpec,
    reading: Reading,
) -> Result<Found, ReproduceError> {
    let k = controller(context, spec, reading)?;
    Ok(Found {
        accelerations: rms(&Certificate::of(&plant(context, spec, &ACCELERATIONS)?, &k)?),
        forces: plant(context, spec, &["actuator_force"])?.close(&k)?.h2_of_outputs()?,
    })
}

/// Table 8.1: what the case starts from.
pub(super) fn table_1(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let spec = cases::vehicle_spec(CABIN)?;
    let Some(cabin) = spec.truck_cabin.as_ref() else {
        return Err(ReproduceError::unexpected("case", "a truck cabin", CABIN));
    };
    for (name, digits, found) in [
        ("m_c, kg", "900", cabin.cabin_mass_kg),
        ("I_x, kg m²", "700", cabin.pitch_inertia_kg_m2),
        ("I_y, kg m²", "650", cabin.roll_inertia_kg_m2),
        ("k_A, k_B, N/m", "31000", cabin.front.stiffness_n_per_m),
        ("k_C, k_D, N/m", "15500", cabin.rear.stiffness_n_per_m),
        ("c_A, c_B, N s/m", "680", cabin.front.damping_n_s_per_m),
        ("c_C, c_D, N s/m", "560", cabin.rear.damping_n_s_per_m),
        ("K_F, N m/rad", "30000", cabin.front.anti_roll_n_m_per_rad),
        ("n₃, n₄, m", "0.84", cabin.front_half_width_m),
        ("n₁, n₂, m", "0.68", cabin.rear_half_width_m),
        ("l₂, m", "0.409", cabin.front_axle_m),
        ("l₁, m", "1.091", cabin.rear_axle_m),
    ] {
        sheet.within(name, digits, found, (0.0, "an input"));
    }
    Ok(())
}

/// Table 8.2: what the case starts from.
pub(super) fn table_2(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let spec = cases::vehicle_spec(TRUCK)?;
    let Some(truck) = spec.bounce_truck.as_ref() else {
        return Err(ReproduceError::unexpected("case", "a bounce model", TRUCK));
    };
    for (name, digits, found) in [
        ("m_c, kg", "900", truck.cabin_mass_kg),
        ("m_s, kg", "5100", truck.sprung_mass_kg),
        ("m_u, kg", "1000", truck.unsprung_mass_kg),
        ("k_s, N/m", "3600000", truck.primary_stiffness_n_per_m),
        ("k_c, N/m", "90000", truck.secondary_stiffness_n_per_m),
        ("c_s, N s/m", "5000", truck.primary_damping_n_s_per_m),
        ("c_c, N s/m", "2500", truck.secondary_damping_n_s_per_m),
        ("k_T, N/m", "8000000", truck.tire_stiffness_n_per_m),
    ] {
        sheet.within(name, digits, found, (0.0, "an input"));
    }
    Ok(())
}

/// §8.3.1: sizes, passive and active rms values, forces.
pub(super) fn section(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let spec = cases::vehicle_spec(CABIN)?;
    let whole = plant(context, &spec, &ACCELERATIONS)?;
    sheet.count("states", 34, whole.order());
    sheet.count("measurements", 8, whole.ny());
    let before = passive(context, &spec)?;
    for ((name, digits), found) in BODY.iter().zip(["0.710", "0.595", "1.339"]).zip(&before) {
        sheet.printed(format!("passive, rms {name}"), digits, *found).noted("on the unrounded road (E8.6)");
    }
    let (after, plain) =
        (active(context, &spec, Reading::printed(context))?, active(context, &spec, Reading::unrounded())?);
    let text = |plain: f64, places: usize| {
        format!(
            "Q and filter of μ = 0.0027, rms of the unrounded road; unrounded throughout {plain:.places$} (E8.6)"
        )
    };
    for (k, digits) in ["0.519", "0.455", "0.842"].into_iter().enumerate() {
        sheet
            .printed(format!("active, rms {}", BODY[k]), digits, after.accelerations[k])
            .noted(&text(plain.accelerations[k], 5));
    }
    for (k, digits) in ["27", "23.5", "37"].into_iter().enumerate() {
        let found = 100.0 * (1.0 - after.accelerations[k] / before[k]);
        sheet.printed(format!("reduction of rms {}, %", BODY[k]), digits, found).excused_by("E8.8");
    }
    for (k, (corner, digits)) in
        [("A", "113.2"), ("B", "113.2"), ("C", "82.5"), ("D", "82.5")].into_iter().enumerate()
    {
        sheet.printed(format!("rms u_{corner}, N"), digits, after.forces[k]).noted(&text(plain.forces[k], 2));
    }
    Ok(())
}
