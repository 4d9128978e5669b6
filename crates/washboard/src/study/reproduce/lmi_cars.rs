//! The half car of §6 and the full car of §7 of the thesis, as plants with the goals of their matrix inequalities.

use super::ReproduceError;
use crate::cases;
use crate::linalg::Mat;
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use crate::road::{Coherence, Road};
use crate::synthesis::{H2Goal, HinfGoal, LyapunovScale, MixedGoals, PoleRegion};
use crate::vehicle::{Disturbance, HalfCarVariant, Output, PlantSettings, Vehicle, VehicleSpec};

/// γ of the full car's poles, rad/s: −γ < Re s < 0, |Im s| < γ.
const FASTEST: f64 = 200.0;
const SPEED_M_S: f64 = 20.0;
/// What a controller gives away for a loop that keeps its claims: the tool's default.
const BACK_OFF: f64 = 1e-3;

/// A half car: which equations, and the share of its pitch inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfCar {
    /// (6.15) and (6.18) as printed, or the equations of motion.
    pub variant: HalfCarVariant,
    /// I_p over that of table 6.1.
    pub inertia: f64,
}

/// All outputs of these names and bases, in the names' order.
pub(super) fn outputs<'a>(car: &'a Vehicle, names: &[&str]) -> Result<Vec<&'a Output>, ReproduceError> {
    let mut all = Vec::new();
    for name in names {
        let before = all.len();
        all.extend(car.outputs().iter().filter(|o| o.base == *name || o.name == *name));
        if all.len() == before {
            all.push(car.output(name)?);
        }
    }
    Ok(all)
}

/// The plant of named outputs and measurements at 20 m/s on a road of its own under each wheel.
fn plant(
    car: &Vehicle,
    [z, y]: [&[&str]; 2],
    road: &Road,
    disturbance: Disturbance,
) -> Result<GeneralizedPlant, ReproduceError> {
    let settings = PlantSettings { road: road.into(), speed_m_s: SPEED_M_S, disturbance, delay_order: 2 };
    Ok(car.plant(&outputs(car, z)?, &outputs(car, y)?, &settings)?)
}

impl HalfCar {
    /// Its vehicle on tires of these dampings front and rear, N·s/m.
    ///
    /// # Errors
    /// A case that is no half car.
    pub fn vehicle(&self, ct: [f64; 2]) -> Result<Vehicle, ReproduceError> {
        let mut spec: VehicleSpec = cases::vehicle_spec("turkay-half-car")?;
        if let Some(car) = spec.half_car.as_mut() {
            car.variant = self.variant;
            car.pitch_inertia_kg_m2 *= self.inertia;
        }
        let damped =
            [("front.tire_damping_n_s_per_m".into(), ct[0]), ("rear.tire_damping_n_s_per_m".into(), ct[1])];
        Ok(spec.with_overrides(&damped)?.build_alone()?)
    }

    /// z: travels, tire deflections, heave and pitch acceleration, forces; y: travels. c_t front and rear, N·s/m.
    ///
    /// # Errors
    /// As of [`HalfCar::vehicle`], and of the plant.
    pub fn plant(&self, ct: [f64; 2], disturbance: Disturbance) -> Result<GeneralizedPlant, ReproduceError> {
        let road = cases::road("turkay-white-velocity-rounded")?.with_coherence(Coherence::Independent);
        let z = [
            "suspension_travel",
            "tire_deflection",
            "heave_acceleration",
            "pitch_acceleration",
            "actuator_force",
        ];
        plant(&self.vehicle(ct)?, [&z, &["suspension_travel"]], &road, disturbance)
    }

    /// Λ and γ of §6.2.2: accelerations and travels against the passive car's, ‖tire deflections‖∞ below ρ₂ times its.
    ///
    /// # Errors
    /// A norm of a passive car that is not stable.
    pub fn goals(
        plant: &GeneralizedPlant,
        [rho1, rho2]: [f64; 2],
        scale: LyapunovScale,
    ) -> Result<MixedGoals, LtiError> {
        let passive = plant.passive();
        let norms = norms(&passive)?;
        let weights = [(0, rho1), (1, rho1), (4, 1.0), (5, 1.0)];
        let outputs = weights.map(|(row, w)| (row, w / norms[row])).to_vec();
        let tires = HinfGoal {
            outputs: vec![(2, 1.0), (3, 1.0)],
            disturbances: vec![],
            weight: 0.0,
            bound: Some(rho2 * gain(&passive, &[2, 3])?),
        };
        Ok(MixedGoals {
            h2: vec![H2Goal { outputs, weight: 1.0, ..H2Goal::default() }],
            hinf: vec![tires],
            region: PoleRegion::default(),
            scale,
            back_off: BACK_OFF,
        })
    }
}

/// z: accelerations at the driver (3), travels (4), tire deflections (4), forces (4); y: travels, velocities of body and wheels.
/// Driven by the noises of (7.2).
///
/// # Errors
/// Those of the plant.
pub fn full_car() -> Result<GeneralizedPlant, ReproduceError> {
    full_car_from(Disturbance::RoadNoise)
}

/// The same driven by the wheels' heights alone.
///
/// # Errors
/// Those of the plant.
pub fn full_car_on_heights() -> Result<GeneralizedPlant, ReproduceError> {
    full_car_from(Disturbance::RoadDisplacement)
}

fn full_car_from(disturbance: Disturbance) -> Result<GeneralizedPlant, ReproduceError> {
    let car = cases::vehicle("chalasani-full-car")?;
    let road = cases::road("turkay-first-order")?.with_coherence(Coherence::Independent);
    let comfort = ["driver_heave_acceleration", "pitch_acceleration", "roll_acceleration"];
    let z: Vec<&str> =
        comfort.into_iter().chain(["suspension_travel", "tire_deflection", "actuator_force"]).collect();
    let y = ["suspension_travel", "heave_velocity", "pitch_velocity", "roll_velocity", "unsprung_velocity"];
    plant(&car, [&z, &y], &road, disturbance)
}

/// [`full_car`] with the wheels' heights as four more disturbances beside the noises: ẇ = −v a_w w + √v b_w ξ of (7.2) written
/// out, and w + w' under the wheels.
///
/// # Errors
/// Those of the plant.
pub fn full_car_with_heights() -> Result<GeneralizedPlant, ReproduceError> {
    const A_W: f64 = 0.0572;
    const B_W: f64 = 0.0195;
    let heights = full_car_from(Disturbance::RoadDisplacement)?;
    let s = heights.system();
    let (n, nu, rows) = (s.order(), heights.nu(), s.outputs());
    let (a, b, c, d) = (s.a(), s.b(), s.c(), s.d());
    let wide_a = Mat::from_fn(n + 4, n + 4, |i, j| match (i < n, j < n) {
        (true, true) => a[(i, j)],
        (true, false) => b[(i, j - n)],
        (false, _) => {
            if i == j {
                -SPEED_M_S * A_W
            } else {
                0.0
            }
        }
    });
    let wide_b = Mat::from_fn(n + 4, 8 + nu, |i, j| match (i < n, j < 4) {
        (true, false) => b[(i, j - 4)],
        (false, true) if i == n + j => SPEED_M_S.sqrt() * B_W,
        _ => 0.0,
    });
    let wide_c = Mat::from_fn(rows, n + 4, |i, j| if j < n { c[(i, j)] } else { d[(i, j - n)] });
    let wide_d = Mat::from_fn(rows, 8 + nu, |i, j| if j < 4 { 0.0 } else { d[(i, j - 4)] });
    let mut signals = heights.signals().clone();
    let noises = (0..4).map(|k| format!("noise {}", k + 1));
    signals.disturbances = noises.chain(signals.disturbances).collect();
    Ok(GeneralizedPlant::new(StateSpace::continuous(wide_a, wide_b, wide_c, wide_d)?, signals)?)
}

/// Rows of the full car's accelerations.
pub const COMFORT: [usize; 3] = [0, 1, 2];
/// Of its travels.
pub const TRAVEL: [usize; 4] = [3, 4, 5, 6];
/// Of its tire deflections.
pub const TIRE: [usize; 4] = [7, 8, 9, 10];
/// Its noises.
pub const NOISES: [usize; 4] = [0, 1, 2, 3];
/// The wheels' heights beside them.
pub const HEIGHTS: [usize; 4] = [4, 5, 6, 7];

/// Λ∞ and Λ₂ of §7.2, poles in its rectangle and left of −`decay`. The tires' norm is from `tire_inputs` (the noises, or the
/// heights of [`full_car_with_heights`]).
///
/// # Errors
/// A norm of a passive car that is not stable.
pub fn full_car_goals(
    plant: &GeneralizedPlant,
    [lambda, mu]: [f64; 2],
    decay: f64,
    tire_inputs: [usize; 4],
) -> Result<MixedGoals, LtiError> {
    let passive = plant.passive();
    let from = |inputs: &[usize]| passive.select(&(0..passive.outputs()).collect::<Vec<_>>(), inputs);
    let (noises, heights) = (from(&NOISES)?, from(&tire_inputs)?);
    let rest = (1.0 - lambda).sqrt();
    let of = |rows: &[usize], weight: f64| -> Result<Vec<(usize, f64)>, LtiError> {
        let weight = weight / h2(&noises, rows)?;
        Ok(rows.iter().map(|row| (*row, weight)).filter(|(_, w)| *w > 0.0).collect())
    };
    let outputs = [of(&COMFORT, mu * rest)?, of(&TRAVEL, (1.0 - mu) * rest)?].concat();
    let weight = lambda.sqrt() / gain(&heights, &TIRE)?;
    let tires = HinfGoal {
        outputs: TIRE.map(|row| (row, weight)).to_vec(),
        disturbances: tire_inputs.to_vec(),
        weight: 1.0,
        bound: None,
    };
    Ok(MixedGoals {
        h2: vec![H2Goal { outputs, weight: 1.0, disturbances: NOISES.to_vec(), bound: None }],
        hinf: vec![tires],
        region: PoleRegion {
            faster_than: Some(decay),
            slower_than: Some(FASTEST),
            below_frequency: Some(FASTEST),
            ..PoleRegion::default()
        },
        scale: LyapunovScale::Fixed(1.0),
        back_off: BACK_OFF,
    })
}

/// ‖·‖₂ of some rows.
///
/// # Errors
/// A system that is not stable.
pub fn h2(system: &StateSpace<Continuous>, rows: &[usize]) -> Result<f64, LtiError> {
    system.select(rows, &inputs(system))?.h2_norm()
}

/// ‖·‖₂ of each row.
///
/// # Errors
/// A system that is not stable.
pub fn norms(system: &StateSpace<Continuous>) -> Result<Vec<f64>, LtiError> {
    (0..system.outputs()).map(|row| h2(system, &[row])).collect()
}

/// ‖·‖∞ of some rows.
///
/// # Errors
/// A system that is not stable.
pub fn gain(system: &StateSpace<Continuous>, rows: &[usize]) -> Result<f64, LtiError> {
    Ok(system.select(rows, &inputs(system))?.hinf_norm()?.norm)
}

fn inputs(system: &StateSpace<Continuous>) -> Vec<usize> {
    (0..system.inputs()).collect()
}
