//! A controller of given order: many starts, a local search from each, the best one verified.

use super::asked::{FixedOrder, FixedOrderSettings, check};
use super::outcome::{FixedOrderDesign, FixedOrderEnd, FixedOrderWork, describe};
use super::problem::{Id, Problem, own_poles};
use super::restored::restored;
use super::scales::Scales;
use super::search::{KEPT, Led, MET, from, further, promising, race, sort};
use super::settled::{MIDDLE, PATIENT, settled};
use super::structure::{Entry, Structure};
use super::targets::{Aim, Measure, Target};
use super::{full_order, starts};
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::optimize::{BundleResult, BundleSettings};
use crate::synthesis::SynthesisError;
use rayon::prelude::*;

/// Bounds are aimed at this much below themselves.
const BELOW: f64 = 2e-6;
/// Steps of the first search from each start.
const SHORT: usize = 40;
/// One start of so many that is stabilised quickly is enough.
const ENOUGH: usize = 3;

/// The controller of the structure given for which the largest of all goals is as small as a local search from many starts
/// finds it, under the bounds.
///
/// Every start is brought into the stable set (BFGS on the largest real part), then ln of the goal under ln of the bounds
/// is minimised by [`minimize`](crate::optimize::minimize): the pieces are Re uᴴT(iω)v at every peak of every channel, H2
/// norms and eigenvalues, with exact gradients. The three best are searched to the end, the best is verified by the
/// library's own norms (the Hamiltonian's test, factored Lyapunov equations) of the loop closed anew, and where these stand
/// higher, their frequencies are added and the search goes on.
///
/// # Errors
/// Plants whose signals don't fit the structure or each other, targets that name no signal, numbers that are none.
///
/// Source: Burke, Henrion, Lewis, Overton, *HIFOO*, IFAC ROCOND 2006; Apkarian and Noll, IEEE Trans. Automat. Control 51
/// (2006) 71–86.
pub fn fixed_order(
    asked: &FixedOrder,
    settings: &FixedOrderSettings,
) -> Result<FixedOrderEnd, SynthesisError> {
    check(asked)?;
    let mut given = asked.starts.clone();
    given.extend(full_order::controllers(&asked.plants, &asked.targets));
    let order = asked.structure.order();
    let mut work = FixedOrderWork::default();
    let mut lower: Option<FixedOrderDesign> = None;
    if settings.lower_orders && asked.structure.is_full() {
        for less in 0..order {
            let s = &asked.structure;
            let structure = Structure::full(less, s.controls(), s.measurements());
            let starts = given.clone();
            let less = FixedOrder { structure, starts, ..asked.clone() };
            let found = one_order(&less, settings)?;
            work.add(found.1);
            if let FixedOrderEnd::Designed(d) | FixedOrderEnd::BoundsNotMet(d) = found.0 {
                given.push(d.controller.clone());
                if lower.as_ref().is_none_or(|l| d.is_better(l)) {
                    lower = Some(*d);
                }
            }
        }
    }
    // of a structure with zeros the gains without states: to begin with, as states that nothing reads change nothing
    if settings.lower_orders
        && !asked.structure.is_full()
        && order > 0
        && let Some(structure) = asked.structure.feedthrough()
    {
        let less = FixedOrder { structure, starts: given.clone(), ..asked.clone() };
        let found = one_order(&less, settings)?;
        work.add(found.1);
        if let FixedOrderEnd::Designed(d) | FixedOrderEnd::BoundsNotMet(d) = found.0 {
            given.push(d.controller);
        }
    }
    let last = FixedOrder { starts: given, ..asked.clone() };
    let (mut end, own) = one_order(&last, settings)?;
    work.add(own);
    // more states are never worse
    if let Some(mut less) = lower
        && end.design().is_none_or(|d| less.is_better(d))
    {
        let (slowest, fastest) = own_poles(asked.margin_rad_s, asked.max_pole_rad_s);
        let pole = Scales::of(&asked.plants, &asked.targets).pace.max(slowest).min(fastest);
        less.controller = starts::padded(&less.controller, order, pole)?;
        end = FixedOrderEnd::of(less);
    }
    match &mut end {
        FixedOrderEnd::Designed(d) | FixedOrderEnd::BoundsNotMet(d) => d.work = work,
        FixedOrderEnd::NotStabilised { work: of, .. } => *of = work,
    }
    Ok(end)
}

/// One order, from all its starts.
fn one_order(
    asked: &FixedOrder,
    settings: &FixedOrderSettings,
) -> Result<(FixedOrderEnd, FixedOrderWork), SynthesisError> {
    let structure = without_infinite(asked);
    let aimed: Vec<Target> = asked
        .targets
        .iter()
        .map(|t| match (t.aim, &t.measure) {
            (Aim::Bound(b), Measure::Hinf(_) | Measure::H2(_)) => {
                Target { aim: Aim::Bound(b * (1.0 - BELOW)), ..t.clone() }
            }
            _ => t.clone(),
        })
        .collect();
    let limits = (asked.max_pole_rad_s.map(|p| p * (1.0 - BELOW)), asked.max_gain.map(|g| g * (1.0 - BELOW)));
    let mut problem =
        Problem::new(&asked.plants, &aimed, structure, limits, asked.margin_rad_s, &asked.frequencies_rad_s);
    let mut begun: Vec<Vec<f64>> = Vec::new();
    for (k, given) in asked.starts.iter().enumerate() {
        begun.extend(starts::fitted(&problem, given, settings.seed.wrapping_add(k as u64)));
    }
    begun.push(starts::silent(&problem));
    let mut seen: Vec<Vec<f64>> = Vec::new();
    begun.retain(|x| {
        let new = !seen.contains(x);
        if new {
            seen.push(x.clone());
        }
        new
    });
    let own = begun.len();
    begun.extend(starts::random(&problem, settings.tries, settings.seed));
    let short = BundleSettings {
        iterations: SHORT.min(settings.iterations),
        evaluations: 4 * SHORT,
        tolerance: 1e-4,
        ..BundleSettings::default()
    };
    let patient = settings.tries >= PATIENT;
    let mut led: Vec<Led> = if patient {
        begun.par_iter().map(|x| from(&problem, x, &short, false)).collect()
    } else {
        race(&problem, &begun, own, &short, &[(10, 2), (20, 3)])
    };
    // a plant that is hard to stabilise
    let stable = led.iter().filter(|l| matches!(l, Led::To(_))).count();
    if patient || stable * ENOUGH < led.len() {
        led = begun
            .par_iter()
            .zip(led)
            .map(|(x, l)| if let Led::Unstable(_) = l { from(&problem, x, &short, true) } else { l })
            .collect();
    }
    let mut work = FixedOrderWork { starts: begun.len(), ..FixedOrderWork::default() };
    let mut results: Vec<BundleResult<Id>> = Vec::new();
    let mut least = f64::INFINITY;
    // of the starts that are no chance
    let mut of_own = 0;
    for (k, l) in led.into_iter().enumerate() {
        match l {
            Led::Unstable(a) => least = least.min(a),
            Led::To(r) => {
                work.stabilised += 1;
                of_own += usize::from(k < own);
                results.push(*r);
            }
        }
    }
    // what chance leads to keeps none of the others from being searched to the end
    let mut chosen = promising(&results, KEPT.max(settings.tries / 6));
    for k in promising(&results[..of_own], 1) {
        if !chosen.contains(&k) {
            chosen.push(k);
        }
    }
    results = chosen.into_iter().map(|k| results[k].clone()).collect();
    let long = BundleSettings {
        iterations: settings.iterations,
        evaluations: 6 * settings.iterations,
        tolerance: settings.tolerance,
        ..BundleSettings::default()
    };
    let middle = BundleSettings { tolerance: settings.tolerance.max(MIDDLE), ..long };
    results = results.into_par_iter().map(|r| further(&problem, &r, &middle)).collect();
    results = restored(&problem, results, &middle);
    sort(&mut results);
    let found = settled(asked, &mut problem, results, settings, &long)?;
    let end = match found {
        None => FixedOrderEnd::NotStabilised { abscissa: least, work },
        Some((_, controller, _, _))
            if slowest_mode(asked, &controller)? > MET * problem.scales.pace - asked.margin_rad_s =>
        {
            FixedOrderEnd::NotStabilised { abscissa: slowest_mode(asked, &controller)?, work }
        }
        Some((best, controller, values, complete)) => {
            let mut d = describe(asked, &problem, &best, controller, &values, settings.seed)?;
            d.converged &= complete;
            FixedOrderEnd::of(d)
        }
    };
    work.count(&problem);
    Ok((end, work))
}

/// The largest real part of a pole of any loop, rad/s.
fn slowest_mode(asked: &FixedOrder, controller: &StateSpace<Continuous>) -> Result<f64, LtiError> {
    asked.plants.iter().try_fold(f64::NEG_INFINITY, |worst: f64, plant| {
        Ok(plant.close(controller)?.least_stable_pole()?.map_or(worst, |(_, margin)| worst.max(-margin)))
    })
}

/// Feedthrough that would make an H2 norm infinite is fixed at 0.
fn without_infinite(asked: &FixedOrder) -> Structure {
    let mut structure = asked.structure.clone();
    let order = structure.order();
    for t in &asked.targets {
        let Measure::H2(channel) = &t.measure else { continue };
        let plant = &asked.plants[t.plant];
        let (d12, d21) = (plant.d12(), plant.d21());
        let columns: Vec<usize> = if channel.disturbances.is_empty() {
            (0..plant.nw()).collect()
        } else {
            channel.disturbances.clone()
        };
        for u in 0..plant.nu() {
            for y in 0..plant.ny() {
                let out = channel.outputs.iter().any(|(i, w)| *w > 0.0 && d12[(*i, u)] != 0.0);
                let into = columns.iter().any(|w| d21[(y, *w)] != 0.0);
                if out && into && structure.entry(order + u, order + y) == Entry::Free {
                    structure.fix(order + u, order + y, 0.0);
                }
            }
        }
    }
    structure
}
