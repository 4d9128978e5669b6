//! From the tracks that lead to all wheels: delays of the wheels that follow.

use super::{PlantError, PlantSettings};
use crate::linalg::Mat;
use crate::lti::{Continuous, LtiError, StateSpace, pade_delay};
use crate::road::{Coherence, Road};
use crate::vehicle::Vehicle;
use crate::vehicle::driven::sources;

impl Vehicle {
    /// Every road input by itself, and names for them.
    pub(super) fn points(&self) -> Result<(StateSpace<Continuous>, Vec<String>), PlantError> {
        let (count, wheels) = (self.wheels().len(), self.wheels());
        let all = StateSpace::continuous_gain(Mat::identity(count, count))?;
        Ok((all, wheels.iter().map(|w| format!("road {}", w.name)).collect()))
    }

    /// From the tracks that lead to all wheels, and names for them.
    pub(super) fn tracks(
        &self,
        road: &Road,
        settings: &PlantSettings<'_>,
    ) -> Result<(StateSpace<Continuous>, Vec<String>), PlantError> {
        let places = self.wheel_places();
        let groups = sources(road.coherence(), &places);
        // one track is alike to itself, however it is to others
        if matches!(road.coherence(), Coherence::Bogsjo { mu } if *mu > 0.0) && groups.len() > 1 {
            return Err(PlantError::Coherence);
        }
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
}

/// Outputs added, inputs side by side: [a b].
fn beside(
    a: &StateSpace<Continuous>,
    b: &StateSpace<Continuous>,
) -> Result<StateSpace<Continuous>, LtiError> {
    Ok(a.transposed().stack(&b.transposed())?.transposed())
}
