//! What a fixed-order design says where it has no controller: which bound, by how much, and what may help.

use super::design_fixed_outcome::{FixedOrderOutcome, FixedOrderTarget, TargetAim, TargetNorm};
use super::design_fixed_spec::StructureKind;
use super::design_outcome::DesignOutcome;
use super::design_problem::Problem;
use super::design_robust::words;
use super::design_words::short;
use super::{DesignSpec, Named};

/// A bound that is exceeded by less than this share of the largest excess is not named.
const BESIDE: f64 = 0.9;
/// Bounds that a sentence names.
const MOST_NAMED: usize = 3;

/// No start led to a stable loop.
pub(super) fn not_stabilised(problem: &Problem, order: usize, tried: &FixedOrderOutcome) -> String {
    let least = tried.abscissa_rad_s.map_or_else(
        || "and none of the loops could be followed".to_owned(),
        |a| format!("and the least largest real part of a pole that was found is {} rad/s", short(a)),
    );
    let margin = problem.spec.poles.and_then(|p| p.max_real_rad_s).filter(|m| *m < 0.0);
    let wanted = margin.map_or_else(
        || "has a stable loop".to_owned(),
        |m| format!("has a loop with all poles left of {} rad/s (poles.max_real_rad_s)", short(m)),
    );
    let members = if problem.spec.plant.len() > 1 { " with every vehicle" } else { "" };
    let nearer = if margin.is_some() { "a max_real_rad_s nearer to 0, " } else { "" };
    format!(
        "no controller of order {order} was found that {wanted}{members}: none of {} starts led to one, {least}. What may help: {}{nearer}more starts \
         (fixed-order.tries), other measurements",
        tried.starts,
        more_freedom(&problem.spec)
    )
}

/// A bound is exceeded at the least violation that was found.
pub(super) fn not_met(
    problem: &Problem,
    order: usize,
    outcome: &DesignOutcome,
    [pole, gain]: [f64; 2],
) -> String {
    let spec = &problem.spec;
    let block = outcome.fixed_order.as_ref();
    let mut over: Vec<(f64, String)> = block
        .into_iter()
        .flat_map(|b| &b.targets)
        .filter(|t| t.aim == TargetAim::Bound)
        .map(|t| (t.relative - 1.0, target(spec, t, outcome)))
        .collect();
    if order > 0 {
        let most = spec.max_pole_rad_s();
        let text = format!(
            "the controller's fastest pole is at {} rad/s, where goal.max_pole_rad_s is {most}",
            short(pole)
        );
        over.push((pole / most - 1.0, text));
    }
    if let Some(most) = spec.goal.max_gain {
        let text = format!(
            "the controller's largest gain is {}, where goal.max_gain is {}",
            short(gain),
            short(most)
        );
        over.push((gain / most - 1.0, text));
    }
    over.sort_by(|a, b| b.0.total_cmp(&a.0));
    let largest = over.first().map_or(0.0, |o| o.0);
    let named: Vec<String> = over
        .iter()
        .filter(|(excess, _)| *excess >= BESIDE * largest && *excess > 0.0)
        .take(MOST_NAMED)
        .map(|(excess, text)| format!("{text} ({} % over)", percent(*excess)))
        .collect();
    let starts = block.map_or(0, |b| b.starts);
    // neither states nor measurements help against a proof
    let help = if block.is_some_and(|b| b.impossible.is_some()) {
        "larger bounds".to_owned()
    } else {
        format!("{}larger bounds, more starts (fixed-order.tries), other measurements", more_freedom(spec))
    };
    format!(
        "the bounds are not kept by any controller of order {order} that {starts} starts led to. At the least violation found, {}. {} What may help: {}",
        named.join("; "),
        proof(block),
        help
    )
}

/// Whether any controller could.
fn proof(block: Option<&FixedOrderOutcome>) -> String {
    let proven = block.and_then(|b| b.impossible.zip(b.lower_bound_hz));
    proven.map_or_else(
        || "A local search does not prove that there is none.".to_owned(),
        |(share, at)| {
            format!(
                "No controller of any order keeps them: at {} Hz one of the bounds is exceeded by {} % or more, whatever the actuators do.",
                short(at),
                percent(share - 1.0)
            )
        },
    )
}

/// A share in percent, with three digits.
fn percent(share: f64) -> String {
    short(100.0 * share)
}

fn target(spec: &DesignSpec, t: &FixedOrderTarget, outcome: &DesignOutcome) -> String {
    let (norm, list) = match t.norm {
        TargetNorm::Hinf => ("largest gain", &spec.goal.bound),
        TargetNorm::H2 => ("H2 norm", &spec.goal.bound_h2),
    };
    let asked = list.get(&t.name).or_else(|| spec.goal.bound_hinf.get(&t.name));
    let times = asked.map_or_else(String::new, |m| format!(", {m} times the passive one"));
    let at = t.at_hz.map_or_else(String::new, |f| format!(" at {} Hz", short(f)));
    let which = t.vehicle.map_or_else(String::new, |k| {
        let fields = k.checked_sub(1).and_then(|k| spec.plant.get(k)).map(words).unwrap_or_default();
        let fields = if fields.is_empty() { "as stated".to_owned() } else { fields };
        format!(" of vehicle {k} ({fields})")
    });
    let unit = outcome.units.get(&t.name).map_or("", String::as_str);
    let per = if t.norm == TargetNorm::Hinf {
        format!("{unit} per {}", outcome.per())
    } else {
        format!("{unit} {}", outcome.white())
    };
    format!(
        "the {norm} of {}{which} is {} {per}{at}, where {}{times}, is allowed",
        t.name,
        short(t.value),
        short(t.value / t.relative)
    )
}

/// What has more entries to choose.
fn more_freedom(spec: &DesignSpec) -> &'static str {
    match spec.structure_kind() {
        Some(StructureKind::Full) => "more states (goal.order), ",
        Some(StructureKind::StrictlyProper) => "more states (goal.order), structure = \"full\", ",
        Some(StructureKind::Decentralised) => "more states in [[local]], structure = \"full\", ",
        Some(StructureKind::Pid) | None => "structure = \"full\", ",
    }
}

/// A controller whose loop contradicts what is claimed.
pub(super) fn refused(at: &Named<f64>, found: &str) -> String {
    let place = if at.is_empty() { String::new() } else { format!(" with {}", words(at)) };
    format!(
        "a controller was found{place}, but {found}, from vehicle and controller alone: the search was misled by rounding. Another seed \
         (fixed-order.seed), a smaller goal.max_pole_rad_s, or poles = {{ max_real_rad_s = … }} may help"
    )
}
