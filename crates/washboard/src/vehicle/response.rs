//! A vehicle known by its modes only: poles, shapes at named outputs, participation of the wheels.

use super::body::{join, motions};
use super::values::positive;
use super::{KnownModes, Output, Parts, Vehicle, VehicleError, Wheel, WheelRow};
use crate::linalg::{C64, CMat, Mat};
use crate::lti::{MechanicsError, ModalForm, Mode, ModeKind};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// An imaginary part below this share of |λ|, or a partner's distance from the conjugate, is rounding.
const CONJUGATE_TOLERANCE: f64 = 1e-9;
/// A real pole λ is realised beside the pole CANCELLED·λ with a zero on it: apart, so that both have shapes of their own.
const CANCELLED: f64 = 2.0;

/// H(ω) = Σₙ ψₙ Lₙᵀ/(iω − λₙ) from road heights to output displacements, over all poles.
///
/// | field | shape | meaning |
/// |---|---|---|
/// | `wheel` | w | names and places |
/// | `output` | m | names of displacements; `…displacement…` gives `…velocity…` and `…acceleration…` too |
/// | `mode` | pairs | λₙ = 2πf(−ζ + i√(1 − ζ²)), ψₙ (m), Lₙ (w); the conjugate goes without saying |
/// | `real` | real poles | λₙ, ψₙ (m), Lₙ (w) |
///
/// What identification of free modes gives: no masses, no tire forces, only what is named. Outputs are in m (or rad, if
/// the name begins with `pitch_` or `roll_`), so that ψₙLₙᵀ is in 1/s (rad/(m s)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Response {
    /// The wheels.
    pub wheel: Vec<WheelRow>,
    /// The displacements.
    pub output: Vec<ResponseOutput>,
    /// Conjugate pairs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mode: Vec<ResponseMode>,
    /// Real poles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub real: Vec<ResponseReal>,
}

/// A displacement of [`Response`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResponseOutput {
    /// Such as `body_displacement_front_left`.
    pub name: String,
}

/// A conjugate pair of [`Response`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResponseMode {
    /// |λ|/2π.
    pub freq_hz: f64,
    /// −Re λ/|λ|, between 0 and 1.
    pub damping: f64,
    /// What the motion is called.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// ψ of the pole with Im λ > 0, [re, im] an output.
    pub shape: Vec<[f64; 2]>,
    /// L of that pole, [re, im] a wheel.
    pub participation: Vec<[f64; 2]>,
}

/// A real pole of [`Response`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResponseReal {
    /// λ < 0, 1/s.
    pub pole: f64,
    /// ψ, a number an output.
    pub shape: Vec<f64>,
    /// L, a number a wheel.
    pub participation: Vec<f64>,
}

impl ResponseMode {
    /// λ with Im λ > 0.
    #[must_use]
    pub fn pole(&self) -> C64 {
        C64::new(-self.damping, ((1.0 - self.damping) * (1.0 + self.damping)).sqrt()) * (TAU * self.freq_hz)
    }
}

impl Response {
    /// From all poles with their conjugates: ψₙ the columns of `shapes` (outputs × poles), Lₙ those of `participation`
    /// (wheels × poles). Pairs come in the order of their poles with Im λ > 0.
    ///
    /// # Errors
    /// Shapes that do not fit; a complex pole without its conjugate; a pole that is not damped.
    pub fn new(
        wheel: Vec<WheelRow>,
        outputs: &[String],
        poles: &[C64],
        shapes: &CMat,
        participation: &CMat,
    ) -> Result<Self, VehicleError> {
        for (name, a, rows) in
            [("shape", shapes, outputs.len()), ("participation", participation, wheel.len())]
        {
            let (expected, found) = ((rows, poles.len()), (a.nrows(), a.ncols()));
            if expected != found {
                return Err(MechanicsError::Shape { name, expected, found }.into());
            }
        }
        let output = outputs.iter().map(|name| ResponseOutput { name: name.clone() }).collect();
        let mut this = Response { wheel, output, mode: vec![], real: vec![] };
        for (n, pole) in poles.iter().enumerate() {
            let column = |a: &CMat| -> Vec<C64> { (0..a.nrows()).map(|i| a[(i, n)]).collect() };
            let size = pole.norm();
            let (shape, participation) = (column(shapes), column(participation));
            if pole.im.abs() <= CONJUGATE_TOLERANCE * size {
                // ψLᵀ is real where ψ and L are only up to opposite phases
                let turn = phase(&shape);
                let (shape, participation) = (
                    shape.iter().map(|z| (z / turn).re).collect(),
                    participation.iter().map(|z| (z * turn).re).collect(),
                );
                this.real.push(ResponseReal { pole: pole.re, shape, participation });
                continue;
            }
            let partners = poles.iter().filter(|p| (*p - pole.conj()).norm() <= CONJUGATE_TOLERANCE * size);
            if partners.count() == 0 {
                return Err(VehicleError::Field {
                    field: format!("pole {n}"),
                    expected: "a pole whose conjugate is there too",
                    found: format!("{} {:+}i alone", pole.re, pole.im),
                });
            }
            if pole.im > 0.0 {
                let pairs = |v: Vec<C64>| v.into_iter().map(|z| [z.re, z.im]).collect();
                this.mode.push(ResponseMode {
                    freq_hz: size / TAU,
                    damping: -pole.re / size,
                    label: None,
                    shape: pairs(shape),
                    participation: pairs(participation),
                });
            }
        }
        this.check()?;
        Ok(this)
    }

    /// What is seen of a vehicle at all its outputs that are displacements of its degrees of freedom alone.
    ///
    /// With G = Σ ψₙℓₙᵀ/(iω − λₙ) and Σ ψₙℓₙᵀ = 0, rows R: RG(K_w + iωC_w) = Σ (Rψₙ)((K_w + λₙC_w)ᵀℓₙ)ᵀ/(iω − λₙ).
    ///
    /// # Errors
    /// A vehicle without a modal form, or with a pole that is not damped.
    pub fn of(vehicle: &Vehicle) -> Result<Self, VehicleError> {
        let form = ModalForm::new(vehicle.system())?;
        let only_displacement = |o: &&Output| {
            !o.q[0].is_empty()
                && o.q[1..].iter().chain(&o.r).all(|row| row.iter().all(|v| *v == 0.0))
                && o.u.is_empty()
        };
        let outputs: Vec<&Output> = vehicle.outputs().iter().filter(only_displacement).collect();
        let (n, count) = (vehicle.system().order(), form.poles().len());
        let shapes = CMat::from_fn(outputs.len(), count, |i, m| {
            (0..n).map(|k| form.psi()[(k, m)] * outputs[i].q[0][k]).sum()
        });
        let (kw, cw) = (vehicle.wheel_stiffness(), vehicle.wheel_damping());
        let participation = CMat::from_fn(vehicle.wheels().len(), count, |j, m| {
            (0..n).map(|k| (form.poles()[m] * cw[(k, j)] + kw[(k, j)]) * form.l()[(k, m)]).sum()
        });
        let wheel =
            vehicle.wheels().iter().map(|w| WheelRow { name: w.name.clone(), at_m: w.at_m }).collect();
        let names: Vec<String> = outputs.iter().map(|o| o.name.clone()).collect();
        Response::new(wheel, &names, form.poles(), &shapes, &participation)
    }

    fn check(&self) -> Result<(), VehicleError> {
        let lengths = |field: String, shape: usize, participation: usize| {
            for (what, found, expected) in
                [("shape", shape, self.output.len()), ("participation", participation, self.wheel.len())]
            {
                if found != expected {
                    return Err(VehicleError::Field {
                        field: format!("{field}.{what}"),
                        expected: "one value an output (shape) or a wheel (participation)",
                        found: format!("{found} values for {expected}"),
                    });
                }
            }
            Ok(())
        };
        for (i, m) in self.mode.iter().enumerate() {
            let field = format!("mode {}", i + 1);
            positive(&format!("{field}.freq_hz"), m.freq_hz)?;
            if !(m.damping > 0.0 && m.damping < 1.0) {
                return Err(VehicleError::Field {
                    field: format!("{field}.damping"),
                    expected: "a number between 0 and 1 (a real pole stands under [[response.real]])",
                    found: m.damping.to_string(),
                });
            }
            lengths(field, m.shape.len(), m.participation.len())?;
        }
        for (i, m) in self.real.iter().enumerate() {
            let field = format!("real {}", i + 1);
            if !(m.pole.is_finite() && m.pole < 0.0) {
                return Err(VehicleError::Field {
                    field: format!("{field}.pole"),
                    expected: "a negative number",
                    found: m.pole.to_string(),
                });
            }
            lengths(field, m.shape.len(), m.participation.len())?;
        }
        if self.mode.is_empty() && self.real.is_empty() {
            let (expected, found) = ("at least one mode", "none".to_owned());
            return Err(VehicleError::Field { field: "mode".into(), expected, found });
        }
        Ok(())
    }

    /// The vehicle, exactly: a pair is Re z and Im z of ż = λz + Lᵀr, each of second order over the same denominator.
    ///
    /// With λ = σ + iω and L = L' + iL'': (s² − 2σs + |λ|²) [Re z; Im z] = (s [L'; L''] − [σL' + ωL''; σL'' − ωL'])ᵀ r,
    /// and y = 2(ψ' Re z − ψ'' Im z). A real pole λ: (s − λ)(s − 2λ) z = (s − 2λ) Lᵀr.
    ///
    /// # Errors
    /// Lengths that do not fit, poles that are not damped.
    pub fn assemble(&self) -> Result<Vehicle, VehicleError> {
        self.check()?;
        let n = 2 * self.mode.len() + self.real.len();
        let w = self.wheel.len();
        let (mut c, mut k) = (Mat::zeros(n, n), Mat::zeros(n, n));
        let (mut kw, mut cw) = (Mat::zeros(n, w), Mat::zeros(n, w));
        let mut rows = Mat::zeros(self.output.len(), n);
        let mut dofs = Vec::with_capacity(n);
        for (i, mode) in self.mode.iter().enumerate() {
            let (re, im, pole) = (2 * i, 2 * i + 1, mode.pole());
            for dof in [re, im] {
                c[(dof, dof)] = -2.0 * pole.re;
                k[(dof, dof)] = pole.norm_sqr();
            }
            for (j, [a, b]) in mode.participation.iter().enumerate() {
                (cw[(re, j)], cw[(im, j)]) = (*a, *b);
                kw[(re, j)] = -pole.re * a - pole.im * b;
                kw[(im, j)] = -pole.re * b + pole.im * a;
            }
            for (o, [a, b]) in mode.shape.iter().enumerate() {
                (rows[(o, re)], rows[(o, im)]) = (2.0 * a, -2.0 * b);
            }
            dofs.extend([format!("mode_{}_re", i + 1), format!("mode_{}_im", i + 1)]);
        }
        for (i, real) in self.real.iter().enumerate() {
            let dof = 2 * self.mode.len() + i;
            let beside = CANCELLED * real.pole;
            c[(dof, dof)] = -(real.pole + beside);
            k[(dof, dof)] = real.pole * beside;
            for (j, l) in real.participation.iter().enumerate() {
                (cw[(dof, j)], kw[(dof, j)]) = (*l, -beside * l);
            }
            for (o, v) in real.shape.iter().enumerate() {
                rows[(o, dof)] = *v;
            }
            dofs.push(format!("real_{}", i + 1));
        }
        let vehicle = Vehicle::new(Parts {
            m: Mat::identity(n, n),
            c,
            k,
            dofs,
            wheel_stiffness: kw,
            wheel_damping: cw,
            wheels: self.wheel.iter().map(|w| Wheel { name: plain(w), at_m: w.at_m }).collect(),
            outputs: self.outputs(&rows),
            actuators: vec![],
            patterns: vec![],
            dampers: vec![],
        })?;
        Ok(vehicle.with_known_modes(self.modes()))
    }

    fn outputs(&self, rows: &Mat) -> Vec<Output> {
        let mut found = Vec::new();
        for (o, output) in self.output.iter().enumerate() {
            let row: Vec<f64> = (0..rows.ncols()).map(|j| rows[(o, j)]).collect();
            let angle = ["pitch_", "roll_"].iter().any(|s| output.name.starts_with(s));
            let unit = if angle { "rad" } else { "m" };
            match output.name.split_once("_displacement") {
                Some((what, place)) => {
                    motions(&mut found, what, place.trim_start_matches('_'), &row, unit);
                }
                None => {
                    let of_wheel =
                        |w: &WheelRow| output.name.strip_suffix(&plain(w)).and_then(|s| s.strip_suffix('_'));
                    let base = self.wheel.iter().find_map(of_wheel).unwrap_or(&output.name).to_owned();
                    let (q, r) = ([row, vec![], vec![]], [vec![], vec![], vec![]]);
                    found.push(Output { name: output.name.clone(), base, unit, q, r, u: vec![] });
                }
            }
        }
        found
    }

    /// Each pair and each real pole once, ascending in |λ|, with the shape at the outputs.
    fn modes(&self) -> KnownModes {
        let pairs = self.mode.iter().map(|m| {
            let shape = m.shape.iter().map(|[a, b]| C64::new(*a, *b)).collect();
            (Mode::new(m.pole(), ModeKind::Oscillatory, shape), m.label.clone())
        });
        let reals = self.real.iter().map(|m| {
            let shape = m.shape.iter().map(|v| C64::new(*v, 0.0)).collect();
            (Mode::new(C64::new(m.pole, 0.0), ModeKind::Overdamped, shape), None)
        });
        let mut modes: Vec<(Mode, Option<String>)> = pairs.chain(reals).collect();
        modes.sort_by(|a, b| a.0.freq_hz.total_cmp(&b.0.freq_hz));
        let name = |(i, (mode, label)): (usize, (Mode, Option<String>))| {
            let own = match mode.kind {
                ModeKind::Oscillatory => join("mode", &(i + 1).to_string()).replace('_', " "),
                _ => "overdamped".to_owned(),
            };
            (mode, label.unwrap_or(own))
        };
        KnownModes {
            places: self.output.iter().map(|o| o.name.clone()).collect(),
            modes: modes.into_iter().enumerate().map(name).collect(),
        }
    }
}

/// A wheel's name as it stands in names of outputs.
fn plain(wheel: &WheelRow) -> String {
    wheel.name.replace(['-', ' '], "_")
}

/// The phase of the largest component.
fn phase(shape: &[C64]) -> C64 {
    let largest =
        shape.iter().copied().fold(C64::new(0.0, 0.0), |a, b| if b.norm() > a.norm() { b } else { a });
    if largest.norm() > 0.0 { largest / largest.norm() } else { C64::new(1.0, 0.0) }
}

#[cfg(test)]
mod tests;
