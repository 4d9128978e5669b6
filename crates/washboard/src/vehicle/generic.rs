//! Families without a vehicle file: what a vehicle is before anybody knows it, from the places of its wheels alone.

use super::multi_axle::{Layout, MultiAxle};
use super::parametric::Template;
use super::values::{Axle, LeftRight};
use super::{FullCar, HalfCar, HalfCarVariant, ParametricVehicle, QuarterCar, VehicleError, VehicleSpec};
use crate::lti::Parametric as _;
use crate::signal::{Channel, WheelPlace};
use std::f64::consts::TAU;

/// The sprung mass that sets the scale, kg.
const SPRUNG_MASS_KG: f64 = 1000.0;
/// Unsprung over sprung mass of a corner: .045 of the whole body on each of four.
const UNSPRUNG_SHARE: f64 = 0.18;
/// Radius of gyration about x over the track width, and about y over the wheelbase.
const GYRATION: [f64; 2] = [0.45, 0.5];
/// Tire damping as a share of the wheel's critical, and an anti-roll bar as a share of the springs: small, not absent.
const TIRE_DAMPING_RATIO: f64 = 0.01;
const BAR_SHARE: f64 = 0.1;
/// Places within this agree: a file of the car has one place an axle and one middle line, and a delay must be true.
const SAME_M: f64 = 0.02;

/// Whether left and right are alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Symmetry {
    /// One value an axle, the c.g. on the middle line.
    #[default]
    Symmetric,
    /// Unsprung mass, suspension and tire stiffness and damping of each corner; the c.g. anywhere.
    Asymmetric,
}

/// What a generic vehicle is made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GenericStart {
    /// Heave of the body on its springs.
    pub body_hz: f64,
    /// A wheel between its spring and its tire.
    pub hop_hz: f64,
    /// Damping ratio of the body on its springs.
    pub damping: f64,
}

impl GenericStart {
    /// Three starts that together reach the passenger cars, vans and sports cars tried.
    pub const ALL: [GenericStart; 3] = [
        GenericStart { body_hz: 1.3, hop_hz: 10.0, damping: 0.3 },
        GenericStart { body_hz: 1.8, hop_hz: 14.0, damping: 0.4 },
        GenericStart { body_hz: 1.0, hop_hz: 8.0, damping: 0.2 },
    ];
}

impl ParametricVehicle {
    /// A family from the places of a recording's wheels, and the derivative that each channel measures.
    ///
    /// | wheels | file | free, symmetric | free, asymmetric |
    /// |---|---|---|---|
    /// | two pairs | `full-car` | 15 | 26 |
    /// | two in line | `half-car` | 12 | 12 |
    /// | one | `quarter-car` | 5 | 5 |
    /// | n axles, one or two wheels each | `matrices`: rigid body, one mass a wheel | 3 + 6 a pair | 4 + 11 a pair |
    ///
    /// Wheels within 0.1 m in x are an axle. A
    /// sprung mass m = 1000 kg, held, sets the scale; c.g. in the middle; with n wheels m_u = .18 m/n,
    /// k = (m/n)(2π body)², k_t = m_u(2π hop)² − k, c = 2ζ√(k m/n), J_x = m(.45 W)², J_y = m(L/2)².
    ///
    /// `known` values are held, as in [`ParametricVehicle::with_known`], and set the scale of what is not known.
    ///
    /// # Errors
    /// Wheels that no body stands on; a start that is not positive, or a hop below what the body's spring alone gives; a
    /// known name that is none; a channel that such a vehicle does not have.
    pub fn generic(
        start: &GenericStart,
        symmetry: Symmetry,
        channels: &[Channel],
        wheels: &[WheelPlace],
        known: &[(String, f64)],
    ) -> Result<(Self, Vec<usize>), VehicleError> {
        Self::of_layout(template(start, &Layout::new(wheels)?)?, symmetry, channels, wheels, known)
    }

    fn of_layout(
        template: Template,
        symmetry: Symmetry,
        channels: &[Channel],
        wheels: &[WheelPlace],
        known: &[(String, f64)],
    ) -> Result<(Self, Vec<usize>), VehicleError> {
        if symmetry == Symmetry::Symmetric {
            return Self::from_template(template, channels, wheels, &[], known, true);
        }
        // sides have their own names here, so that one side alone may be known
        let (symmetric, _) = Self::from_template(template, channels, wheels, &[], &[], false)?;
        let (template, freed) = symmetric.split(&symmetric.start())?;
        Self::from_template(template, channels, wheels, &freed, known, true)
    }
}

/// The numbers of one wheel.
struct Numbers {
    corner: Axle,
    track_stiffness: f64,
}

impl Numbers {
    fn new(start: &GenericStart, wheels: usize) -> Result<Self, VehicleError> {
        for (field, value) in
            [("body_hz", start.body_hz), ("hop_hz", start.hop_hz), ("damping", start.damping)]
        {
            super::values::positive(field, value)?;
        }
        let share = SPRUNG_MASS_KG / wheels as f64;
        let unsprung = UNSPRUNG_SHARE * share;
        let k = share * (TAU * start.body_hz).powi(2);
        let tire = unsprung * (TAU * start.hop_hz).powi(2) - k;
        super::values::positive("hop_hz: tire stiffness", tire)?;
        let both = LeftRight::Both;
        let corner = Axle {
            unsprung_mass_kg: both(unsprung),
            suspension_stiffness_n_per_m: both(k),
            suspension_damping_n_s_per_m: both(2.0 * start.damping * (k * share).sqrt()),
            tire_stiffness_n_per_m: both(tire),
            tire_damping_n_s_per_m: both(2.0 * TIRE_DAMPING_RATIO * (tire * unsprung).sqrt()),
            anti_roll_stiffness_n_m_per_rad: 0.0,
            damper_curve: None,
        };
        Ok(Numbers { corner, track_stiffness: BAR_SHARE * k })
    }

    fn with_bar(&self, track_m: f64) -> Axle {
        Axle {
            anti_roll_stiffness_n_m_per_rad: self.track_stiffness * track_m * track_m,
            ..self.corner.clone()
        }
    }
}

/// The file that says most: a car's where the wheels are a car's, else a body on axles.
fn template(start: &GenericStart, layout: &Layout) -> Result<Template, VehicleError> {
    let numbers = Numbers::new(start, layout.wheels().len())?;
    let at = |w: usize| layout.wheels()[w].at_m;
    let file = |spec: VehicleSpec| Ok(Template::File(Box::new(spec)));
    let alike = |a: f64, b: f64| (a - b).abs() <= SAME_M;
    match layout.axles() {
        [one] if one.len() == 1 => {
            let Axle { unsprung_mass_kg: mu, suspension_stiffness_n_per_m: k, .. } = numbers.corner;
            let Axle { suspension_damping_n_s_per_m: c, tire_stiffness_n_per_m: kt, .. } = numbers.corner;
            file(VehicleSpec::from(QuarterCar {
                sprung_mass_kg: SPRUNG_MASS_KG,
                unsprung_mass_kg: mu.sides()[0],
                suspension_stiffness_n_per_m: k.sides()[0],
                suspension_damping_n_s_per_m: c.sides()[0],
                tire_stiffness_n_per_m: kt.sides()[0],
                tire_damping_n_s_per_m: numbers.corner.tire_damping_n_s_per_m.sides()[0],
                damper_curve: None,
            }))
        }
        [front, rear] if front.len() == 1 && rear.len() == 1 => {
            let half = (at(front[0])[0] - at(rear[0])[0]) / 2.0;
            file(VehicleSpec::from(HalfCar {
                sprung_mass_kg: SPRUNG_MASS_KG,
                pitch_inertia_kg_m2: SPRUNG_MASS_KG * (GYRATION[1] * 2.0 * half).powi(2),
                front_axle_m: half,
                rear_axle_m: half,
                front: numbers.corner.clone(),
                rear: numbers.corner,
                variant: HalfCarVariant::Corrected,
            }))
        }
        [front, rear] if front.len() == 2 && rear.len() == 2 => {
            let [fl, fr, rl, rr] = [front[0], front[1], rear[0], rear[1]].map(at);
            let squares = alike(fl[0], fr[0]) && alike(rl[0], rr[0]);
            if !(squares && alike(fl[1] + fr[1], rl[1] + rr[1])) {
                return Ok(on_axles(&numbers, layout));
            }
            let (front_track_m, rear_track_m) = (fl[1] - fr[1], rl[1] - rr[1]);
            let half = (fl[0] + fr[0] - rl[0] - rr[0]) / 4.0;
            let width = f64::midpoint(front_track_m, rear_track_m);
            file(VehicleSpec::from(FullCar {
                sprung_mass_kg: SPRUNG_MASS_KG,
                roll_inertia_kg_m2: SPRUNG_MASS_KG * (GYRATION[0] * width).powi(2),
                pitch_inertia_kg_m2: SPRUNG_MASS_KG * (GYRATION[1] * 2.0 * half).powi(2),
                front_axle_m: half,
                rear_axle_m: half,
                front_track_m,
                rear_track_m,
                cg_left_m: 0.0,
                driver_m: None,
                front: numbers.with_bar(front_track_m),
                rear: numbers.with_bar(rear_track_m),
            }))
        }
        _ => Ok(on_axles(&numbers, layout)),
    }
}

fn on_axles(numbers: &Numbers, layout: &Layout) -> Template {
    let y = |w: usize| layout.wheels()[w].at_m[1];
    let widths: Vec<f64> =
        layout.axles().iter().filter(|a| a.len() == 2).map(|a| y(a[0]) - y(a[1])).collect();
    let mean = widths.iter().sum::<f64>() / widths.len().max(1) as f64;
    let axle = |wheels: &Vec<usize>| match wheels[..] {
        [l, r] => numbers.with_bar(y(l) - y(r)),
        _ => numbers.corner.clone(),
    };
    let (pitch, roll) = (layout.wheelbase_m(), layout.track_m());
    let body = MultiAxle {
        sprung_mass_kg: SPRUNG_MASS_KG,
        pitch_inertia_kg_m2: pitch.map(|l| SPRUNG_MASS_KG * (GYRATION[1] * l).powi(2)),
        roll_inertia_kg_m2: roll.map(|_| SPRUNG_MASS_KG * (GYRATION[0] * mean).powi(2)),
        front_axle_m: pitch.map(|l| l / 2.0),
        cg_left_m: roll.map(|_| 0.0),
        axles: (1..).zip(layout.axles()).map(|(i, wheels)| (format!("axle_{i}"), axle(wheels))).collect(),
    };
    // finite numbers and plain names: this cannot fail, and a null would be refused by name
    Template::Axles(serde_json::to_value(body).unwrap_or_default(), layout.clone())
}

#[cfg(test)]
mod tests;
