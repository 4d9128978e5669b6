//! A generalised plant: disturbances and controls in, performances and measurements out, each by its name.

use super::connect::cut;
use super::{Continuous, LtiError, StateSpace};
use crate::files::nearest;
use crate::linalg::Mat;

/// [z; y] = P [w; u], continuous in time.
///
/// | signal | what | blocks |
/// |---|---|---|
/// | w | disturbances: road, sensor noise | B₁, D₁₁, D₂₁ |
/// | u | controls | B₂, D₁₂, D₂₂ |
/// | z | performances: what is to be small | C₁, D₁₁, D₁₂ |
/// | y | measurements: what the controller sees | C₂, D₂₁, D₂₂ |
///
/// Names are unique within a group. The control law is u = +K y.
///
/// ```
/// use washboard::linalg::Mat;
/// use washboard::lti::{GeneralizedPlant, Signals, StateSpace};
/// // ẋ = −x + w + u, z = x, y = x
/// let one = |r, c| Mat::from_fn(r, c, |_, _| 1.0);
/// let system = StateSpace::continuous(-one(1, 1), one(1, 2), one(2, 1), Mat::zeros(2, 2))?;
/// let names = |n: &str| vec![n.to_owned()];
/// let signals =
///     Signals { disturbances: names("w"), controls: names("u"), performances: names("z"), measurements: names("y") };
/// let plant = GeneralizedPlant::new(system, signals)?;
/// let closed = plant.close(&StateSpace::continuous_gain(-one(1, 1))?)?;
/// assert_eq!(closed.poles()?[0].re, -2.0);
/// # Ok::<(), washboard::lti::LtiError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedPlant {
    system: StateSpace<Continuous>,
    signals: Signals,
}

/// The names of a plant's signals, in the order of the system's inputs [w; u] and outputs [z; y].
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Signals {
    /// w.
    pub disturbances: Vec<String>,
    /// u.
    pub controls: Vec<String>,
    /// z.
    pub performances: Vec<String>,
    /// y.
    pub measurements: Vec<String>,
}

impl GeneralizedPlant {
    /// A system with names for its inputs [w; u] and outputs [z; y].
    ///
    /// # Errors
    /// Numbers of names that are not the system's; a name twice in one group.
    pub fn new(system: StateSpace<Continuous>, signals: Signals) -> Result<Self, LtiError> {
        let Signals { disturbances, controls, performances, measurements } = &signals;
        for (what, expected, found) in [
            ("generalised plant, inputs", system.inputs(), disturbances.len() + controls.len()),
            ("generalised plant, outputs", system.outputs(), performances.len() + measurements.len()),
        ] {
            if expected != found {
                let (expected, found) = (format!("{expected} names"), format!("{found}"));
                return Err(LtiError::Join { what, expected, found });
            }
        }
        for group in [disturbances, controls, performances, measurements] {
            for (i, name) in group.iter().enumerate() {
                if group[..i].contains(name) {
                    let expected = "each name once".to_owned();
                    return Err(LtiError::Join { what: "names", expected, found: format!("`{name}` twice") });
                }
            }
        }
        Ok(GeneralizedPlant { system, signals })
    }

    /// The whole system, inputs [w; u], outputs [z; y].
    #[must_use]
    pub fn system(&self) -> &StateSpace<Continuous> {
        &self.system
    }

    /// The names.
    #[must_use]
    pub fn signals(&self) -> &Signals {
        &self.signals
    }

    /// Number of states.
    #[must_use]
    pub fn order(&self) -> usize {
        self.system.order()
    }

    /// A, n × n.
    #[must_use]
    pub fn a(&self) -> &Mat {
        self.system.a()
    }

    /// B₁, n × disturbances.
    #[must_use]
    pub fn b1(&self) -> Mat {
        cut(self.system.b(), 0, 0, self.order(), self.nw())
    }

    /// B₂, n × controls.
    #[must_use]
    pub fn b2(&self) -> Mat {
        cut(self.system.b(), 0, self.nw(), self.order(), self.nu())
    }

    /// C₁, performances × n.
    #[must_use]
    pub fn c1(&self) -> Mat {
        cut(self.system.c(), 0, 0, self.nz(), self.order())
    }

    /// C₂, measurements × n.
    #[must_use]
    pub fn c2(&self) -> Mat {
        cut(self.system.c(), self.nz(), 0, self.ny(), self.order())
    }

    /// D₁₁, performances × disturbances.
    #[must_use]
    pub fn d11(&self) -> Mat {
        cut(self.system.d(), 0, 0, self.nz(), self.nw())
    }

    /// D₁₂, performances × controls.
    #[must_use]
    pub fn d12(&self) -> Mat {
        cut(self.system.d(), 0, self.nw(), self.nz(), self.nu())
    }

    /// D₂₁, measurements × disturbances.
    #[must_use]
    pub fn d21(&self) -> Mat {
        cut(self.system.d(), self.nz(), 0, self.ny(), self.nw())
    }

    /// D₂₂, measurements × controls.
    #[must_use]
    pub fn d22(&self) -> Mat {
        cut(self.system.d(), self.nz(), self.nw(), self.ny(), self.nu())
    }

    /// Number of disturbances.
    #[must_use]
    pub fn nw(&self) -> usize {
        self.signals.disturbances.len()
    }

    /// Number of controls.
    #[must_use]
    pub fn nu(&self) -> usize {
        self.signals.controls.len()
    }

    /// Number of performances.
    #[must_use]
    pub fn nz(&self) -> usize {
        self.signals.performances.len()
    }

    /// Number of measurements.
    #[must_use]
    pub fn ny(&self) -> usize {
        self.signals.measurements.len()
    }

    /// From w to z without control.
    #[must_use]
    pub fn passive(&self) -> StateSpace<Continuous> {
        self.part(0..self.nz(), 0..self.nw())
    }

    /// From w to z with u = +K y.
    ///
    /// # Errors
    /// A controller whose inputs are not the measurements and outputs not the controls; a loop that is not well posed.
    pub fn close(&self, controller: &StateSpace<Continuous>) -> Result<StateSpace<Continuous>, LtiError> {
        let (expected, found) = ((self.nu(), self.ny()), (controller.outputs(), controller.inputs()));
        if expected != found {
            return Err(LtiError::Shape { name: "controller", expected, found });
        }
        self.system.lft(controller)
    }

    /// The plant with weights on z, V on w, and measured noise of intensities N beside y: new disturbances after the
    /// old ones, named after the measurement.
    ///
    /// # Errors
    /// A wrong number of intensities, a negative one.
    pub fn with_sensor_noise(&self, intensities: &[f64]) -> Result<Self, LtiError> {
        let (n, ny, nz) = (self.order(), self.ny(), self.nz());
        if intensities.len() != ny {
            let (expected, found) = ((ny, 1), (intensities.len(), 1));
            return Err(LtiError::Shape { name: "sensor noise", expected, found });
        }
        if let Some(found) = intensities.iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
            let (field, expected) = ("sensor noise", "intensities ≥ 0");
            return Err(LtiError::Field { field, expected, found: *found });
        }
        let (nw, all) = (self.nw(), self.system.inputs());
        let old = |j: usize| if j < nw { j } else { j - ny };
        let is_noise = |j: usize| (nw..nw + ny).contains(&j);
        let b =
            Mat::from_fn(n, all + ny, |i, j| if is_noise(j) { 0.0 } else { self.system.b()[(i, old(j))] });
        let d = Mat::from_fn(nz + ny, all + ny, |i, j| {
            if !is_noise(j) {
                self.system.d()[(i, old(j))]
            } else if i == nz + j - nw {
                intensities[j - nw].sqrt()
            } else {
                0.0
            }
        });
        let system = StateSpace::continuous(self.a().clone(), b, self.system.c().clone(), d)?;
        let mut signals = self.signals.clone();
        signals.disturbances.extend(self.signals.measurements.iter().map(|m| format!("noise of {m}")));
        GeneralizedPlant::new(system, signals)
    }

    /// The plant with each performance multiplied by a weight.
    ///
    /// # Errors
    /// A wrong number of weights, one that is not finite.
    pub fn with_weights(&self, weights: &[f64]) -> Result<Self, LtiError> {
        if weights.len() != self.nz() {
            let (expected, found) = ((self.nz(), 1), (weights.len(), 1));
            return Err(LtiError::Shape { name: "weights", expected, found });
        }
        let w = |i: usize| weights.get(i).copied().unwrap_or(1.0);
        let scaled = |m: &Mat| Mat::from_fn(m.nrows(), m.ncols(), |i, j| w(i) * m[(i, j)]);
        let s = &self.system;
        let system = StateSpace::continuous(s.a().clone(), s.b().clone(), scaled(s.c()), scaled(s.d()))?;
        GeneralizedPlant::new(system, self.signals.clone())
    }

    /// The plant with some performances and measurements, by their names, in the order asked for.
    ///
    /// # Errors
    /// A name that is none.
    pub fn select(&self, performances: &[&str], measurements: &[&str]) -> Result<Self, LtiError> {
        let z = self.indices("performance", &self.signals.performances, performances)?;
        let y = self.indices("measurement", &self.signals.measurements, measurements)?;
        let outputs: Vec<usize> = z.iter().copied().chain(y.iter().map(|i| i + self.nz())).collect();
        let inputs: Vec<usize> = (0..self.system.inputs()).collect();
        let names = |from: &[String], at: &[usize]| at.iter().map(|i| from[*i].clone()).collect();
        let signals = Signals {
            performances: names(&self.signals.performances, &z),
            measurements: names(&self.signals.measurements, &y),
            ..self.signals.clone()
        };
        GeneralizedPlant::new(self.system.select(&outputs, &inputs)?, signals)
    }

    fn indices(&self, what: &'static str, known: &[String], names: &[&str]) -> Result<Vec<usize>, LtiError> {
        let find = |name: &&str| {
            known.iter().position(|k| k == name).ok_or_else(|| LtiError::Unknown {
                what,
                name: (*name).to_owned(),
                suggestion: nearest(name, known.iter().map(String::as_str)).map(str::to_owned),
                known: known.join(", "),
            })
        };
        names.iter().map(find).collect()
    }

    fn part(
        &self,
        outputs: std::ops::Range<usize>,
        inputs: std::ops::Range<usize>,
    ) -> StateSpace<Continuous> {
        let (outputs, inputs): (Vec<usize>, Vec<usize>) = (outputs.collect(), inputs.collect());
        // indices are the system's own
        self.system.select(&outputs, &inputs).unwrap_or_else(|_| self.system.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::C64;

    fn names(letter: &str, n: usize) -> Vec<String> {
        (1..=n).map(|k| format!("{letter}{k}")).collect()
    }

    fn plant() -> GeneralizedPlant {
        let any = |r, c, s: f64| Mat::from_fn(r, c, |i, j| ((3 * i + 7 * j) as f64 + s).sin());
        let system =
            StateSpace::continuous(any(3, 3, 1.0), any(3, 3, 2.0), any(4, 3, 3.0), any(4, 3, 4.0)).unwrap();
        let signals = Signals {
            disturbances: names("w", 1),
            controls: names("u", 2),
            performances: names("z", 2),
            measurements: names("y", 2),
        };
        GeneralizedPlant::new(system, signals).unwrap()
    }

    #[test]
    fn the_blocks_make_the_whole() {
        let p = plant();
        let rebuilt = super::super::connect::blocks(&[&[&p.d11(), &p.d12()], &[&p.d21(), &p.d22()]]);
        assert_eq!(&rebuilt, p.system().d());
        assert_eq!(super::super::connect::blocks(&[&[&p.b1(), &p.b2()]]), *p.system().b());
        assert_eq!(super::super::connect::blocks(&[&[&p.c1()], &[&p.c2()]]), *p.system().c());
    }

    #[test]
    fn selection_weights_and_noise_do_what_they_say() {
        let p = plant();
        let swapped = p.select(&["z2"], &["y2", "y1"]).unwrap();
        let (s, old) = (C64::new(0.1, 2.0), p.system().at(C64::new(0.1, 2.0)).unwrap());
        let new = swapped.system().at(s).unwrap();
        for j in 0..3 {
            assert_eq!([new[(0, j)], new[(1, j)], new[(2, j)]], [old[(1, j)], old[(3, j)], old[(2, j)]]);
        }
        let e = p.select(&["z3"], &[]).unwrap_err().to_string();
        assert!(e.contains("no performance `z3`") && e.contains("there are z1, z2"), "{e}");
        let noisy = p.with_sensor_noise(&[4.0, 9.0]).unwrap();
        assert_eq!(
            noisy.d21().submatrix(0, 1, 2, 2).to_owned(),
            Mat::from_fn(2, 2, |i, j| [[2.0, 0.0], [0.0, 3.0]][i][j])
        );
        assert_eq!((noisy.d22(), noisy.d12(), noisy.b2()), (p.d22(), p.d12(), p.b2()));
        assert!(noisy.d11().submatrix(0, 1, 2, 2).norm_l2() == 0.0 && noisy.nw() == 3);
        assert!(p.with_sensor_noise(&[1.0, -1.0]).is_err());
        let weighted = p.with_weights(&[2.0, 0.5]).unwrap();
        assert_eq!(weighted.c1()[(0, 1)], 2.0 * p.c1()[(0, 1)]);
        assert_eq!((weighted.d12()[(1, 1)], weighted.d22()), (0.5 * p.d12()[(1, 1)], p.d22()));
    }

    #[test]
    fn wrong_names_and_controllers_are_refused() {
        let p = plant();
        let twice = Signals { performances: vec!["z".into(), "z".into()], ..p.signals().clone() };
        assert!(
            GeneralizedPlant::new(p.system().clone(), twice).unwrap_err().to_string().contains("`z` twice")
        );
        let few = Signals { controls: names("u", 1), ..p.signals().clone() };
        assert!(GeneralizedPlant::new(p.system().clone(), few).is_err());
        let e = p.close(&StateSpace::continuous_gain(Mat::zeros(2, 1)).unwrap()).unwrap_err().to_string();
        assert!(e.contains("controller: expected shape (2, 2), found (2, 1)"), "{e}");
        let open = p.close(&StateSpace::continuous_gain(Mat::zeros(2, 2)).unwrap()).unwrap();
        assert_eq!(open.at(C64::new(0.0, 1.0)).unwrap(), p.passive().at(C64::new(0.0, 1.0)).unwrap());
    }
}
