//! Controllers of the plant's own order to begin with: H∞ and H2 designs of all targets stacked, a little noise and control
//! added so that they exist.

use super::scales::Scales;
use super::targets::{Aim, Measure, Target};
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::synthesis::{HinfSettings, LqgWeights, h2, hinf, lqg_plant};
use rayon::prelude::*;

/// Control and noise against everything else: none where the plant has designs as it is.
const SHARES: [f64; 3] = [0.0, 0.03, 0.3];
/// Goals against bounds.
const EMPHASES: [f64; 3] = [1.0, 2.0, 4.0];
/// Levels are found to this share: these are beginnings.
const LEVEL: f64 = 1e-3;
/// Plants with more states take longer than these starts are worth.
const MOST_STATES: usize = 30;

/// What could be designed, for the first plant.
pub(super) fn controllers(plants: &[GeneralizedPlant], targets: &[Target]) -> Vec<StateSpace<Continuous>> {
    let Some(plant) = plants.first().filter(|p| p.order() > 0 && p.order() <= MOST_STATES) else {
        return Vec::new();
    };
    let scales = Scales::of(plants, targets);
    let bounded = targets.iter().any(|t| matches!(t.aim, Aim::Bound(_)));
    let emphases = if bounded { &EMPHASES[..] } else { &EMPHASES[..1] };
    let cases: Vec<(f64, f64)> = emphases.iter().flat_map(|e| SHARES.map(|s| (*e, s))).collect();
    let designs = |(emphasis, share): &(f64, f64)| -> Vec<StateSpace<Continuous>> {
        let Some(weighted) = weighted(plant, targets, *emphasis) else { return Vec::new() };
        let square = |v: f64| (share * v).powi(2);
        let weights = LqgWeights {
            process_noise: 1.0,
            input_weight: scales.controls.iter().map(|u| square(1.0 / u)).collect(),
            sensor_noise: scales.measurements.iter().map(|y| square(*y)).collect(),
            cross_term: true,
        };
        let Ok(full) = lqg_plant(&weighted, &weights) else { return Vec::new() };
        let level = HinfSettings { tolerance: LEVEL, ..HinfSettings::default() };
        let by_hinf = hinf(&full, &level).map(|d| d.controller);
        by_hinf.into_iter().chain(h2(&full).map(|d| d.controller)).collect()
    };
    cases.par_iter().map(designs).collect::<Vec<_>>().into_iter().flatten().collect()
}

/// The plant with each performance over its unit or bound; what no target has is left out by a weight of 0.
fn weighted(plant: &GeneralizedPlant, targets: &[Target], emphasis: f64) -> Option<GeneralizedPlant> {
    let mut weights = vec![0.0f64; plant.nz()];
    for t in targets.iter().filter(|t| t.plant == 0) {
        let size = match t.aim {
            Aim::Goal(unit) => emphasis / unit,
            Aim::Bound(limit) => 1.0 / limit,
        };
        if let Measure::Hinf(c) | Measure::H2(c) = &t.measure {
            c.outputs.iter().for_each(|(i, w)| weights[*i] = weights[*i].max(w * size));
        }
    }
    plant.with_weights(&weights).ok()
}
