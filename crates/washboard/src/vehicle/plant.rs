//! A vehicle with its actuators as a generalised plant: road in, performances and measurements out.

use super::driven::sources;
use super::{Output, Vehicle};
use crate::linalg::{LinalgError, Mat, solve};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, Signals, StateSpace, pade_delay};
use crate::road::{Road, Shapes};
use thiserror::Error;

/// A coefficient below this share of the terms that it is a sum of has cancelled.
const CANCELLED: f64 = 1e-10;
/// Padé's order of a rear wheel's delay, where none is given.
pub const DELAY_ORDER: usize = 4;

/// What drives the plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disturbance {
    /// The vertical velocity of the road under each wheel that leads, m/s.
    RoadVelocity,
    /// Its height, m.
    RoadDisplacement,
    /// The white noise (unit intensity) behind the road's shaping filter.
    RoadNoise,
}

/// The road that a plant stands on, and how it is to be written down.
#[derive(Debug, Clone, Copy)]
pub struct PlantSettings<'a> {
    /// Spectrum and coherence; only the coherence counts unless the disturbance is the road's noise.
    pub road: &'a Road,
    /// Forward speed.
    pub speed_m_s: f64,
    /// What drives the plant.
    pub disturbance: Disturbance,
    /// Order of Padé's approximation of the delay of wheels that follow.
    pub delay_order: usize,
}

/// What is refused of a plant.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum PlantError {
    /// An output with derivatives of the disturbance.
    #[error(
        "`{output}` contains the derivative of the {disturbance}: its response grows without bound with frequency; choose another disturbance or leave it out"
    )]
    Improper {
        /// The output.
        output: String,
        /// The disturbance, in words.
        disturbance: &'static str,
    },
    /// A road without a rational filter.
    #[error(
        "the road has no rational shaping filter: a design needs kind white-velocity, first-order or filter (road fit makes one)"
    )]
    NoFilter,
    /// A coherence without a rational form.
    #[error(
        "the road's coherence is `bogsjo`, which is not rational: a design needs full, none or independent"
    )]
    Coherence,
    /// A vehicle without actuators or wheels.
    #[error("the vehicle has no {0}")]
    Nothing(&'static str),
    /// The systems do not fit.
    #[error(transparent)]
    Lti(#[from] LtiError),
    /// Linear algebra refused.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

impl Vehicle {
    /// The vehicle with its actuators u and the outputs asked for, on a road.
    ///
    /// Driven by velocities, the state is q − K⁻¹K_w r, q̇ and as many road heights as outputs depend on; driven by
    /// heights, q and q̇ − M⁻¹C_w r. A wheel that follows another one's track repeats its input through Padé's
    /// approximation of the delay. Disturbances are one a track that leads (`road`, `road left` …), or one a wheel on a road
    /// of independent wheels.
    ///
    /// # Errors
    /// Outputs with derivatives of the disturbance, a road without rational filter or coherence, a vehicle without
    /// actuators, a stiffness matrix that can't be solved with.
    pub fn plant(
        &self,
        performances: &[&Output],
        measurements: &[&Output],
        settings: &PlantSettings<'_>,
    ) -> Result<GeneralizedPlant, PlantError> {
        if self.actuators().is_empty() {
            return Err(PlantError::Nothing("actuators"));
        }
        if self.wheels().is_empty() {
            return Err(PlantError::Nothing("wheels"));
        }
        let filter = match settings.disturbance {
            Disturbance::RoadNoise => Some(
                settings.road.spectrum().shaping_filter(settings.speed_m_s).ok_or(PlantError::NoFilter)?,
            ),
            _ => None,
        };
        let by_velocity = match (settings.disturbance, &filter) {
            (Disturbance::RoadVelocity, _) => true,
            (_, Some(filter)) => filter.of() == Shapes::Velocity,
            _ => false,
        };
        let outputs: Vec<&Output> = performances.iter().chain(measurements).copied().collect();
        let bare =
            if by_velocity { self.driven_by_velocity(&outputs)? } else { self.driven_by_height(&outputs)? };
        let (tracks, names) = self.tracks(settings)?;
        let road = match filter {
            Some(f) => {
                let column = |v: &[f64]| Mat::from_fn(v.len(), 1, |i, _| v[i]);
                let d = Mat::from_fn(1, 1, |_, _| f.d());
                let one = StateSpace::continuous(
                    f.a().clone(),
                    column(f.b()),
                    column(f.c()).transpose().to_owned(),
                    d,
                )?;
                let all = (1..names.len()).try_fold(one.clone(), |all, _| all.append(&one))?;
                all.series(&tracks)?
            }
            None => tracks,
        };
        let controls =
            StateSpace::continuous_gain(Mat::identity(self.actuators().len(), self.actuators().len()))?;
        let system = road.append(&controls)?.series(&bare)?;
        let own = |o: &&Output| o.name.clone();
        let signals = Signals {
            disturbances: names,
            controls: self.actuators().iter().map(|a| a.name.clone()).collect(),
            performances: performances.iter().map(own).collect(),
            measurements: measurements.iter().map(own).collect(),
        };
        Ok(GeneralizedPlant::new(system, signals)?)
    }

    /// From the tracks that lead to all wheels, and names for them.
    fn tracks(
        &self,
        settings: &PlantSettings<'_>,
    ) -> Result<(StateSpace<Continuous>, Vec<String>), PlantError> {
        if matches!(settings.road.coherence(), crate::road::Coherence::Bogsjo { mu } if *mu > 0.0) {
            return Err(PlantError::Coherence);
        }
        let places = self.wheel_places();
        let groups = sources(settings.road.coherence(), &places);
        let count = self.wheels().len();
        let mut columns: Option<StateSpace<Continuous>> = None;
        let mut names = Vec::new();
        for group in &groups {
            let first = group.iter().map(|j| places[*j][0]).fold(f64::NEG_INFINITY, f64::max);
            // the wheels of one track, each behind its delay; wheels side by side have none between them
            let mut track: Option<StateSpace<Continuous>> = None;
            let mut delays: Vec<(f64, Vec<usize>)> = Vec::new();
            for j in group {
                let delay_s = (first - places[*j][0]) / settings.speed_m_s;
                match delays.iter_mut().find(|(d, _)| (*d - delay_s).abs() < 1e-12) {
                    Some((_, wheels)) => wheels.push(*j),
                    None => delays.push((delay_s, vec![*j])),
                }
            }
            for (delay_s, wheels) in &delays {
                let spread = Mat::from_fn(count, 1, |i, _| f64::from(u8::from(wheels.contains(&i))));
                let order = if *delay_s > 0.0 { settings.delay_order } else { 0 };
                let one = pade_delay(*delay_s, order)?.series(&StateSpace::continuous_gain(spread)?)?;
                track = Some(match track {
                    Some(t) => t.parallel(&one)?,
                    None => one,
                });
            }
            let Some(track) = track else { continue };
            columns = Some(match columns {
                Some(c) => beside(&c, &track)?,
                None => track,
            });
            names.push(match (groups.len(), group.len()) {
                (1, _) => "road".to_owned(),
                (_, 1) => format!("road {}", self.wheels()[group[0]].name),
                _ => format!("road {}", if places[group[0]][1] > 0.0 { "left" } else { "right" }),
            });
        }
        Ok((columns.ok_or(PlantError::Nothing("wheels"))?, names))
    }

    /// From [ṙ; u] to outputs.
    fn driven_by_velocity(&self, outputs: &[&Output]) -> Result<StateSpace<Continuous>, PlantError> {
        let (n, w, m) = (self.system().order(), self.wheels().len(), self.actuators().len());
        let over_m = |x: &Mat| solve(self.system().m(), x);
        let (mk, mc) = (over_m(self.system().k())?, over_m(self.system().c())?);
        let (mcw, mbu) =
            (over_m(self.wheel_damping())?, over_m(&self.actuator_columns(&(0..m).collect::<Vec<_>>()))?);
        let t = solve(self.system().k(), self.wheel_stiffness())?;
        // outputs' dependence on heights that stand still, and an orthonormal basis of it
        let p = outputs.len();
        let mut heights = Mat::zeros(p, w);
        for (i, o) in outputs.iter().enumerate() {
            for j in 0..w {
                let from_q = o.q[0].iter().enumerate().map(|(k, v)| v * t[(k, j)]);
                let terms: Vec<f64> = from_q.chain(o.r[0].get(j).copied()).collect();
                let (sum, size) = terms.iter().fold((0.0, 0.0), |(s, a), v| (s + v, a + v.abs()));
                heights[(i, j)] = if f64::abs(sum) <= CANCELLED * size { 0.0 } else { sum };
            }
            if o.r[2].iter().any(|v| *v != 0.0) {
                let output = o.name.clone();
                return Err(PlantError::Improper { output, disturbance: "road's velocity" });
            }
        }
        let basis = row_basis(&heights)?;
        let k = basis.nrows();
        let size = 2 * n + k;
        let mut a = Mat::zeros(size, size);
        let mut b = Mat::zeros(size, w + m);
        for i in 0..n {
            a[(i, n + i)] = 1.0;
            for j in 0..n {
                a[(n + i, j)] = -mk[(i, j)];
                a[(n + i, n + j)] = -mc[(i, j)];
            }
            for j in 0..w {
                b[(i, j)] = -t[(i, j)];
                b[(n + i, j)] = mcw[(i, j)];
            }
            for j in 0..m {
                b[(n + i, w + j)] = mbu[(i, j)];
            }
        }
        for i in 0..k {
            for j in 0..w {
                b[(2 * n + i, j)] = basis[(i, j)];
            }
        }
        let on_heights = &heights * basis.transpose();
        let mut c = Mat::zeros(p, size);
        let mut d = Mat::zeros(p, w + m);
        for (i, o) in outputs.iter().enumerate() {
            for l in 0..size {
                let own = |q: &Vec<f64>, from: usize| {
                    l.checked_sub(from).and_then(|l| q.get(l)).copied().unwrap_or(0.0)
                };
                let of_acceleration: f64 = o.q[2].iter().enumerate().map(|(r, v)| v * a[(n + r, l)]).sum();
                c[(i, l)] = of_acceleration
                    + if l < n { own(&o.q[0], 0) } else { 0.0 }
                    + if (n..2 * n).contains(&l) { own(&o.q[1], n) } else { 0.0 }
                    + if l >= 2 * n { on_heights[(i, l - 2 * n)] } else { 0.0 };
            }
            for j in 0..w + m {
                let of_acceleration: f64 = o.q[2].iter().enumerate().map(|(r, v)| v * b[(n + r, j)]).sum();
                let direct = if j < w { o.r[1].get(j) } else { o.u.get(j - w) };
                d[(i, j)] = of_acceleration + direct.copied().unwrap_or(0.0);
            }
        }
        Ok(StateSpace::continuous(a, b, c, d)?)
    }

    /// From [r; u] to outputs.
    fn driven_by_height(&self, outputs: &[&Output]) -> Result<StateSpace<Continuous>, PlantError> {
        let (n, w, m) = (self.system().order(), self.wheels().len(), self.actuators().len());
        let over_m = |x: &Mat| solve(self.system().m(), x);
        let (mk, mc) = (over_m(self.system().k())?, over_m(self.system().c())?);
        let (mkw, mbu) =
            (over_m(self.wheel_stiffness())?, over_m(&self.actuator_columns(&(0..m).collect::<Vec<_>>()))?);
        // q̇ = p + J r
        let jump = over_m(self.wheel_damping())?;
        let slowed = &mc * &jump;
        let size = 2 * n;
        let a = Mat::from_fn(size, size, |i, j| match (i < n, j < n) {
            (true, true) => 0.0,
            (true, false) => f64::from(u8::from(j - n == i)),
            (false, true) => -mk[(i - n, j)],
            (false, false) => -mc[(i - n, j - n)],
        });
        let b = Mat::from_fn(size, w + m, |i, j| match (i < n, j < w) {
            (true, true) => jump[(i, j)],
            (true, false) => 0.0,
            (false, true) => mkw[(i - n, j)] - slowed[(i - n, j)],
            (false, false) => mbu[(i - n, j - w)],
        });
        let p = outputs.len();
        let mut c = Mat::zeros(p, size);
        let mut d = Mat::zeros(p, w + m);
        for (i, o) in outputs.iter().enumerate() {
            let row = |q: &Vec<f64>, m: &Mat, j: usize| -> f64 {
                q.iter().enumerate().map(|(k, v)| v * m[(k, j)]).sum()
            };
            for j in 0..w {
                let rates = [row(&o.q[2], &jump, j), o.r[1].get(j).copied().unwrap_or(0.0)];
                let size = rates.iter().map(|v| v.abs()).sum::<f64>();
                if rates.iter().sum::<f64>().abs() > CANCELLED * size || o.r[2].iter().any(|v| *v != 0.0) {
                    let output = o.name.clone();
                    return Err(PlantError::Improper { output, disturbance: "road's height" });
                }
                d[(i, j)] = o.r[0].get(j).copied().unwrap_or(0.0) + row(&o.q[1], &jump, j);
            }
            for (j, v) in o.u.iter().enumerate() {
                d[(i, w + j)] = *v;
            }
            for (k, v) in o.q[2].iter().enumerate() {
                (0..size).for_each(|l| c[(i, l)] += v * a[(n + k, l)]);
                (0..w + m).for_each(|j| d[(i, j)] += v * b[(n + k, j)]);
            }
            o.q[0].iter().enumerate().for_each(|(k, v)| c[(i, k)] += v);
            o.q[1].iter().enumerate().for_each(|(k, v)| c[(i, n + k)] += v);
        }
        Ok(StateSpace::continuous(a, b, c, d)?)
    }
}

/// Outputs added, inputs side by side: [a b].
fn beside(
    a: &StateSpace<Continuous>,
    b: &StateSpace<Continuous>,
) -> Result<StateSpace<Continuous>, LtiError> {
    Ok(a.transposed().stack(&b.transposed())?.transposed())
}

/// An orthonormal basis of a matrix's rows.
fn row_basis(m: &Mat) -> Result<Mat, LinalgError> {
    if m.norm_max() == 0.0 {
        return Ok(Mat::zeros(0, m.ncols()));
    }
    let svd = m.svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: m.ncols() })?;
    let rank = svd.S().column_vector().iter().filter(|s| **s > CANCELLED * svd.S()[0]).count();
    Ok(svd.V().subcols(0, rank).transpose().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{C64, CMat};
    use crate::road::Coherence;
    use crate::vehicle::Ride;
    use crate::vehicle::test_cases as cases;

    fn names<'a>(car: &'a Vehicle, names: &[&str]) -> Vec<&'a Output> {
        names.iter().map(|n| car.output(n).unwrap()).collect()
    }

    fn on<'a>(road: &'a Road, disturbance: Disturbance) -> PlantSettings<'a> {
        PlantSettings { road, speed_m_s: 20.0, disturbance, delay_order: DELAY_ORDER }
    }

    /// The response to heights, by mechanics, must be that of the plant: a second route through M, C, K at one frequency.
    #[test]
    fn responses_are_the_vehicles_own() {
        for case in ["turkay-quarter-car", "turkay-half-car", "chalasani-full-car", "guiggiani-full-car"] {
            let car = cases::vehicle(case).unwrap();
            let road = cases::road("turkay-white-velocity").unwrap().with_coherence(Coherence::Independent);
            let outputs: Vec<&Output> = car.outputs().iter().collect();
            let omega = 9.3;
            let s = C64::new(0.0, omega);
            let known = car.output_response(&outputs, omega).unwrap();
            let mut tried = 0;
            for (disturbance, scale) in
                [(Disturbance::RoadVelocity, s), (Disturbance::RoadDisplacement, C64::new(1.0, 0.0))]
            {
                for (i, o) in outputs.iter().enumerate() {
                    let Ok(plant) = car.plant(&[o], &[], &on(&road, disturbance)) else { continue };
                    tried += 1;
                    let g = plant.passive().at(s).unwrap();
                    for j in 0..car.wheels().len() {
                        let found = g[(0, j)] * scale;
                        let size = known[(i, j)].norm().max(1e-6);
                        assert!(
                            (found - known[(i, j)]).norm() < 1e-9 * size,
                            "{case} {} {j}: {found} {}",
                            o.name,
                            known[(i, j)]
                        );
                    }
                }
            }
            assert!(tried > outputs.len(), "{case}: {tried}");
        }
    }

    /// The response to a force: the same dynamic stiffness.
    #[test]
    fn forces_act_where_they_should() {
        let car = cases::vehicle("turkay-half-car").unwrap();
        let road = cases::road("turkay-white-velocity").unwrap();
        let z = names(&car, &["heave_acceleration", "suspension_travel_front", "actuator_force_rear"]);
        let plant = car.plant(&z, &z, &on(&road, Disturbance::RoadVelocity)).unwrap();
        let (omega, nw) = (7.0, plant.nw());
        let g = plant.system().at(C64::new(0.0, omega)).unwrap();
        let columns = car.actuator_columns(&[0, 1]);
        let forces = CMat::from_fn(columns.nrows(), 2, |i, j| C64::new(columns[(i, j)], 0.0));
        let q = crate::linalg::solve_complex(&car.system().dynamic_stiffness(omega), &forces).unwrap();
        for (i, o) in z.iter().enumerate() {
            for j in 0..2 {
                let mut known = C64::new(o.u.get(j).copied().unwrap_or(0.0), 0.0);
                for (d, power) in [1.0, omega, -omega * omega].into_iter().enumerate() {
                    let unit = if d == 1 { C64::new(0.0, power) } else { C64::new(power, 0.0) };
                    known += o.q[d].iter().enumerate().map(|(k, v)| q[(k, j)] * *v).sum::<C64>() * unit;
                }
                assert!((g[(i, nw + j)] - known).norm() < 1e-12 * known.norm().max(1e-9), "{} {j}", o.name);
            }
        }
    }

    #[test]
    fn the_h2_norm_is_the_ride() {
        // delays exact in the ride, Padé's in the plant
        for (case, road, z) in [
            (
                "turkay-quarter-car",
                "turkay-white-velocity",
                ["sprung_acceleration", "suspension_travel", "tire_deflection"],
            ),
            (
                "turkay-half-car",
                "turkay-first-order",
                ["heave_acceleration", "suspension_travel_front", "tire_deflection_rear"],
            ),
            (
                "chalasani-full-car",
                "turkay-first-order",
                ["heave_acceleration", "pitch_acceleration", "tire_deflection_rear_left"],
            ),
        ] {
            let (car, road) = (cases::vehicle(case).unwrap(), cases::road(road).unwrap());
            for coherence in [Coherence::Independent, Coherence::None] {
                let road = road.with_coherence(coherence);
                let z = names(&car, &z);
                let settings = PlantSettings { delay_order: 12, ..on(&road, Disturbance::RoadNoise) };
                let plant = car.plant(&z, &[], &settings).unwrap();
                let rms = plant.passive().h2_of_outputs().unwrap();
                let exact = Ride::new(&car, &road, 20.0).unwrap().variances(&z).unwrap();
                let tolerance = if coherence == Coherence::Independent { 1e-9 } else { 2e-3 };
                for (found, known) in rms.iter().zip(&exact) {
                    let known = known.rms().unwrap();
                    assert!((found / known - 1.0).abs() < tolerance, "{case}: {found} {known}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_a_plant_is_said() {
        let car = cases::vehicle("guiggiani-full-car").unwrap();
        let z = names(&car, &["heave_acceleration"]);
        let iso = cases::road("iso8608-c").unwrap();
        let refused = |road: &Road, d| car.plant(&z, &z, &on(road, d)).unwrap_err().to_string();
        assert!(refused(&iso, Disturbance::RoadVelocity).contains("bogsjo"));
        let full = iso.with_coherence(Coherence::Full);
        assert!(refused(&full, Disturbance::RoadNoise).contains("no rational shaping filter"));
        let hub = names(&car, &["tire_force_front_left"]);
        let e = car.plant(&hub, &[], &on(&full, Disturbance::RoadDisplacement)).unwrap_err().to_string();
        assert!(e.contains("`tire_force_front_left` contains the derivative of the road's height"), "{e}");
        assert_eq!(
            car.plant(&z, &z, &on(&full, Disturbance::RoadVelocity)).unwrap().signals().disturbances,
            ["road"]
        );
    }
}
