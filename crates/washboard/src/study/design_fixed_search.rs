//! A fixed-order search that looks again where its bounds are not met.

use crate::lti::{Continuous, StateSpace};
use crate::synthesis::{
    Aim, FixedOrder, FixedOrderDesign, FixedOrderEnd, FixedOrderSettings, FixedOrderWork, SynthesisError,
    Target, fixed_order,
};

/// Random starts of a search for bounds alone.
const FEW: usize = 4;

/// The design; where its bounds are not met, the one that exceeds them least, or from one that meets them the design again.
pub(super) fn searched(
    asked: &FixedOrder,
    settings: &FixedOrderSettings,
) -> Result<FixedOrderEnd, SynthesisError> {
    let first = match fixed_order(asked, settings)? {
        FixedOrderEnd::BoundsNotMet(first) => first,
        end => return Ok(end),
    };
    let targets: Vec<Target> = asked.targets.iter().filter(|t| is_bound(t)).cloned().collect();
    if targets.is_empty() || targets.len() == asked.targets.len() {
        return Ok(FixedOrderEnd::BoundsNotMet(first));
    }
    let again = |targets: Vec<Target>, from: &StateSpace<Continuous>, tries: usize| {
        let starts = std::iter::once(from).chain(&asked.starts).cloned().collect();
        let settings = FixedOrderSettings { tries, lower_orders: false, ..*settings };
        // what rounding spoils here leaves the first result as it is
        fixed_order(&FixedOrder { targets, starts, ..asked.clone() }, &settings).ok()
    };
    let mut work = first.work;
    let least = match again(targets, &first.controller, settings.tries.min(FEW)) {
        Some(FixedOrderEnd::Designed(within)) => {
            work = both(work, within.work);
            match again(asked.targets.clone(), &within.controller, 0) {
                Some(FixedOrderEnd::Designed(d)) => {
                    let work = both(work, d.work);
                    return Ok(FixedOrderEnd::Designed(Box::new(FixedOrderDesign { work, ..*d })));
                }
                _ => first,
            }
        }
        Some(FixedOrderEnd::BoundsNotMet(least)) => {
            work = both(work, least.work);
            if least.violation < first.violation { least } else { first }
        }
        _ => first,
    };
    Ok(FixedOrderEnd::BoundsNotMet(Box::new(FixedOrderDesign { work, ..*least })))
}

pub(super) fn is_bound(t: &Target) -> bool {
    matches!(t.aim, Aim::Bound(_))
}

fn both(one: FixedOrderWork, other: FixedOrderWork) -> FixedOrderWork {
    FixedOrderWork {
        starts: one.starts + other.starts,
        stabilised: one.stabilised + other.stabilised,
        loops: one.loops + other.loops,
        factorisations: one.factorisations + other.factorisations,
        eigenproblems: one.eigenproblems + other.eigenproblems,
        lyapunov: one.lyapunov + other.lyapunov,
    }
}
