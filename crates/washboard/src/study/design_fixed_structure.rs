//! The structure of a fixed-order design's controller, for the measurements and actuators of its plant.

use super::StudyError;
use super::design_fixed_member::fail;
use super::design_fixed_spec::{FreeEntry, LocalSection, StructureEntry, StructureKind, StructureSpec};
use super::design_outputs::{once, outputs};
use super::design_problem::Problem;
use crate::lti::LtiError;
use crate::synthesis::{Entry, Local, Structure};

/// The structure asked for, for the plant's measurements and actuators.
pub(super) fn structure(problem: &Problem) -> Result<Structure, StudyError> {
    let spec = &problem.spec;
    let (nu, ny) = (problem.plant.nu(), problem.plant.ny());
    let wrong = |field, expected: String, found: String| StudyError::Setting { field, expected, found };
    let unfit = |e: LtiError| fail(problem, e);
    let asked = spec.goal.order;
    let own_order = |order: usize, why: &str| match asked {
        Some(found) if found != order => {
            Err(wrong("goal.order", format!("{order}, {why}, or nothing"), found.to_string()))
        }
        _ => Ok(order),
    };
    if let Some(StructureSpec::Entries(rows)) = &spec.structure {
        let Some(order) = rows.len().checked_sub(nu) else {
            let expected = format!("a row of each state and of each of the {nu} actuators");
            return Err(wrong("structure", expected, format!("{} rows", rows.len())));
        };
        own_order(order, &format!("the {} rows of structure less {nu} of actuators", rows.len()))?;
        let columns = order + ny;
        if let Some((k, row)) = rows.iter().enumerate().find(|(_, r)| r.len() != columns) {
            let expected = format!("rows of {columns} entries: {order} states, {ny} measurements");
            return Err(wrong("structure", expected, format!("{} in row {}", row.len(), k + 1)));
        }
        let entry = |e: &StructureEntry| match e {
            StructureEntry::Word(FreeEntry::Free) => Entry::Free,
            StructureEntry::Number(v) => Entry::Fixed(*v),
        };
        let entries: Vec<Entry> = rows.iter().flatten().map(entry).collect();
        if !entries.contains(&Entry::Free) {
            let expected = "an entry that is \"free\" (a controller of numbers alone is not designed: ride and respond take it, --controller FILE)";
            return Err(wrong("structure", expected.into(), "numbers alone".into()));
        }
        if let Some(Entry::Fixed(v)) = entries.iter().find(|e| matches!(e, Entry::Fixed(v) if !v.is_finite()))
        {
            return Err(wrong("structure", "finite numbers".into(), v.to_string()));
        }
        return Structure::of_entries(order, nu, ny, entries).map_err(unfit);
    }
    match spec.structure_kind().unwrap_or(StructureKind::Full) {
        StructureKind::Full => Ok(Structure::full(asked.unwrap_or(0), nu, ny)),
        StructureKind::StrictlyProper => {
            let order = asked.unwrap_or(0);
            if order == 0 {
                let expected = "1 or more: without states nothing of a strictly proper controller is left";
                return Err(wrong("goal.order", expected.into(), "0".into()));
            }
            Ok(Structure::full(order, nu, ny).strictly_proper())
        }
        StructureKind::Pid => {
            if (nu, ny) != (1, 1) {
                let found = format!("{ny} measurements and {nu} actuators");
                return Err(wrong(
                    "structure",
                    "one measurement and one actuator of a \"pid\"".into(),
                    found,
                ));
            }
            own_order(2, "integrator and filter of structure = \"pid\"")?;
            Structure::pid(spec.pid_filter_s.unwrap_or(0.0)).map_err(unfit)
        }
        StructureKind::Decentralised => {
            let parts = spec.local.iter().map(|l| local(problem, l)).collect::<Result<Vec<_>, _>>()?;
            let order = parts.iter().map(|p| p.order).sum();
            own_order(order, "the sum of all [[local]] orders")?;
            for (u, actuator) in problem.vehicle.actuators().iter().enumerate() {
                let times = parts.iter().flat_map(|p| &p.controls).filter(|c| **c == u).count();
                if times != 1 {
                    let expected = format!("each of the {nu} actuators in one [[local]]");
                    return Err(wrong(
                        "local.actuators",
                        expected,
                        format!("`{}` {times} times", actuator.name),
                    ));
                }
            }
            Structure::decentralised(nu, ny, &parts).map_err(unfit)
        }
    }
}

/// A part of a decentralised controller, by numbers.
fn local(problem: &Problem, of: &LocalSection) -> Result<Local, StudyError> {
    let all = outputs(&problem.vehicle, &of.measurements, "local.measurements")?;
    once(&problem.vehicle, &of.measurements, "local.measurements")?;
    let measurements = all.iter().map(|o| {
        problem.measurements.iter().position(|m| m == o).ok_or_else(|| StudyError::Setting {
            field: "local.measurements",
            expected: "some of the design's measurements".into(),
            found: format!("`{}`", o.name),
        })
    });
    let known = problem.vehicle.actuators();
    let controls = of.actuators.iter().map(|name| {
        known.iter().position(|a| a.name == *name).ok_or_else(|| {
            let names: Vec<&str> = known.iter().map(|a| a.name.as_str()).collect();
            StudyError::Setting {
                field: "local.actuators",
                expected: format!("actuators of the vehicle: {}", names.join(", ")),
                found: format!("`{name}`"),
            }
        })
    });
    Ok(Local {
        order: of.order,
        measurements: measurements.collect::<Result<_, _>>()?,
        controls: controls.collect::<Result<_, _>>()?,
    })
}
