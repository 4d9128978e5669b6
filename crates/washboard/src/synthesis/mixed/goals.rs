//! What a mixed design is asked for, and what is refused before it is tried.

use crate::lti::{GeneralizedPlant, LtiError};

/// ‖T∞‖ of some outputs: minimised, bounded, or both.
#[derive(Debug, Clone, PartialEq)]
pub struct HinfGoal {
    /// Performances and their weights: the norm is of the stacked, weighted vector.
    pub outputs: Vec<(usize, f64)>,
    /// Disturbances; all where it is empty.
    pub disturbances: Vec<usize>,
    /// α in the objective α‖T∞‖².
    pub weight: f64,
    /// ‖T∞‖ is to be below this.
    pub bound: Option<f64>,
}

/// ‖T₂‖ of some outputs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct H2Goal {
    /// Performances and their weights.
    pub outputs: Vec<(usize, f64)>,
    /// Disturbances; all where it is empty.
    pub disturbances: Vec<usize>,
    /// β in the objective β‖T₂‖².
    pub weight: f64,
    /// ‖T₂‖ is to be below this.
    pub bound: Option<f64>,
}

/// Where the closed loop's poles are to be: the intersection of all that is given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PoleRegion {
    /// Re s < −this, rad/s.
    pub faster_than: Option<f64>,
    /// Re s > −this, rad/s.
    pub slower_than: Option<f64>,
    /// |Im s| < this, rad/s.
    pub below_frequency: Option<f64>,
    /// |s| < this, rad/s.
    pub within: Option<f64>,
    /// |arg(−s)| < this, rad: a damping ratio of cos of it.
    pub cone: Option<f64>,
}

/// The scale between the Lyapunov matrices of the H2 and the H∞ inequality, which are one matrix but for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LyapunovScale {
    /// Chosen with everything else: never worse.
    Searched,
    /// s in \[·, B, Cᵀ; · −I/s, Dᵀ; · · −sγ²I\]: 1 is the normalisation of published designs, and of MATLAB's `hinfmix`.
    Fixed(f64),
}

/// The goals of a mixed design.
#[derive(Debug, Clone, PartialEq)]
pub struct MixedGoals {
    /// Any number of H2 channels.
    pub h2: Vec<H2Goal>,
    /// Any number of H∞ channels.
    pub hinf: Vec<HinfGoal>,
    /// The closed loop's poles.
    pub region: PoleRegion,
    /// How the two inequalities share one Lyapunov matrix.
    pub scale: LyapunovScale,
    /// The objective is given up by this share for a controller of small gains: the least value is often not attained.
    pub back_off: f64,
}

impl MixedGoals {
    /// Refuses goals that say nothing or contradict themselves.
    pub(super) fn check(&self, plant: &GeneralizedPlant) -> Result<(), LtiError> {
        let number = |field: &'static str, found: f64, least: f64| {
            if found >= least && found.is_finite() {
                return Ok(());
            }
            let expected =
                if least > 0.0 { "a positive, finite number" } else { "a finite number, not negative" };
            Err(LtiError::Field { field, expected, found })
        };
        let signals = |outputs: &[(usize, f64)], disturbances: &[usize]| {
            let wrong = |what: &'static str, most: usize, found: usize| LtiError::Join {
                what,
                expected: format!("below {most}"),
                found: found.to_string(),
            };
            if outputs.is_empty() {
                let expected = "at least one".to_owned();
                return Err(LtiError::Join { what: "a goal's outputs", expected, found: "none".into() });
            }
            for (row, weight) in outputs {
                if *row >= plant.nz() {
                    return Err(wrong("a goal's output", plant.nz(), *row));
                }
                number("a goal's weight of an output", *weight, 0.0)?;
            }
            if outputs.iter().all(|(_, weight)| *weight == 0.0) {
                let expected = "a weight above 0".to_owned();
                return Err(LtiError::Join { what: "a goal's outputs", expected, found: "zeros".into() });
            }
            match disturbances.iter().find(|w| **w >= plant.nw()) {
                Some(found) => Err(wrong("a goal's disturbance", plant.nw(), *found)),
                None => Ok(()),
            }
        };
        for goal in &self.hinf {
            signals(&goal.outputs, &goal.disturbances)?;
            number("an H∞ goal's weight", goal.weight, 0.0)?;
            goal.bound.map_or(Ok(()), |b| number("an H∞ goal's bound", b, f64::MIN_POSITIVE))?;
        }
        for goal in &self.h2 {
            signals(&goal.outputs, &goal.disturbances)?;
            number("an H2 goal's weight", goal.weight, 0.0)?;
            goal.bound.map_or(Ok(()), |b| number("an H2 goal's bound", b, f64::MIN_POSITIVE))?;
        }
        let minimised =
            self.hinf.iter().map(|g| g.weight).chain(self.h2.iter().map(|g| g.weight)).any(|w| w > 0.0);
        let bounded =
            self.hinf.iter().map(|g| g.bound).chain(self.h2.iter().map(|g| g.bound)).any(|b| b.is_some());
        if !minimised && !bounded && self.region == PoleRegion::default() {
            let expected = "something to minimise, a bound or a pole region".to_owned();
            return Err(LtiError::Join { what: "goals", expected, found: "none".into() });
        }
        if let LyapunovScale::Fixed(s) = self.scale {
            number("the Lyapunov scale", s, f64::MIN_POSITIVE)?;
        }
        number("back_off", self.back_off, 0.0)?;
        self.region.check()
    }
}

impl PoleRegion {
    fn check(&self) -> Result<(), LtiError> {
        let positive = |field: &'static str, value: Option<f64>| match value {
            Some(found) if !(found > 0.0 && found.is_finite()) => {
                Err(LtiError::Field { field, expected: "a positive, finite number", found })
            }
            _ => Ok(()),
        };
        positive("slower_than", self.slower_than)?;
        positive("below_frequency", self.below_frequency)?;
        positive("within", self.within)?;
        positive("cone", self.cone)?;
        if let Some(found) = self.faster_than.filter(|v| !(*v >= 0.0 && v.is_finite())) {
            return Err(LtiError::Field {
                field: "faster_than",
                expected: "a finite number, not negative",
                found,
            });
        }
        if let Some(found) = self.cone.filter(|v| *v > std::f64::consts::FRAC_PI_2) {
            return Err(LtiError::Field {
                field: "cone",
                expected: "an angle of at most a right one",
                found,
            });
        }
        let fastest = [self.slower_than, self.within].into_iter().flatten().fold(f64::INFINITY, f64::min);
        match self.faster_than {
            Some(found) if found >= fastest => Err(LtiError::Field {
                field: "faster_than",
                expected: "less than slower_than and within: no pole is in this region",
                found,
            }),
            _ => Ok(()),
        }
    }

    /// By how much a pole is outside, rad/s (rad of a cone times its size); not above 0 within.
    pub(super) fn outside(&self, pole: crate::linalg::C64) -> f64 {
        let size = pole.norm();
        let angle = pole.im.abs().atan2(-pole.re);
        [
            self.faster_than.map(|v| pole.re + v),
            self.slower_than.map(|v| -pole.re - v),
            self.below_frequency.map(|v| pole.im.abs() - v),
            self.within.map(|v| size - v),
            self.cone.map(|v| (angle - v) * size),
        ]
        .into_iter()
        .flatten()
        .fold(f64::NEG_INFINITY, f64::max)
    }
}
