//! A controller from a file, and as the files that other programs and control units read.

use super::design_outcome::{ControllerFile, DesignOutcome};
use super::design_words::short;
use super::{Discretize, DiscretizeRule, Flag, Input, StudyError};
use crate::files::{FileError, read_text};
use crate::linalg::Mat;
use crate::lti::{Discrete, LtiError, StateSpace};
use crate::vehicle::{Control, Vehicle, VehicleSpec};
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// The controller of a design's `result.json`, of its directory, or of a file `{a, b, c, d, inputs, outputs}`.
///
/// # Errors
/// A file that is neither, a result without a controller (with its status), matrices that do not fit.
pub fn read_controller(path: &Path) -> Result<(ControllerFile, Input), StudyError> {
    let file = if path.is_dir() { path.join("result.json") } else { path.to_owned() };
    let text = read_text(&file)?;
    let wrong = |message: String| StudyError::from(FileError::content(&file, None, message));
    let value: Value =
        serde_json::from_str(&text).map_err(|e| FileError::content(&file, Some(e.line()), e.to_string()))?;
    if !value.is_object() {
        let found = match &value {
            Value::Array(_) => "a list",
            Value::Null => "null",
            Value::Bool(_) => "true or false",
            Value::Number(_) => "a number",
            _ => "a text",
        };
        let expected = "expected a result of `design`, or an object with a, b, c, d, inputs, outputs";
        return Err(wrong(format!("{expected}, found {found}")));
    }
    let own = if value.get("schema_version").is_some() {
        let text_of = |key: &str| value.get(key).and_then(Value::as_str).unwrap_or("none").to_owned();
        if value["schema_version"] != super::SCHEMA_VERSION || text_of("command") != "design" {
            let found = format!("schema {} of `{}`", value["schema_version"], text_of("command"));
            return Err(wrong(format!(
                "expected a result of `design`, schema {}, found {found}",
                super::SCHEMA_VERSION
            )));
        }
        if text_of("status") != "designed" {
            return Err(wrong(format!(
                "controller: expected one, found a result with status {}",
                text_of("status")
            )));
        }
        match value.get("controller") {
            Some(controller) if !controller.is_null() => controller.clone(),
            _ => {
                let status = value.get("status").and_then(Value::as_str).unwrap_or("none");
                return Err(wrong(format!("controller: expected one, found a result with status {status}")));
            }
        }
    } else {
        value
    };
    let controller: ControllerFile =
        serde_json::from_value(own).map_err(|e| wrong(format!("controller: {e}")))?;
    controller.state_space().map_err(|e| wrong(e.to_string()))?;
    Ok((controller, Input::of(file.display().to_string(), text.as_bytes())))
}

/// The controller of a file in the loop of a vehicle.
pub(super) fn control(vehicle: &Vehicle, path: &Path) -> Result<(Control, Input), StudyError> {
    let (file, input) = read_controller(path)?;
    let name = input.path.clone();
    let fail = |source| StudyError::Controller { name: name.clone(), source: Box::new(source) };
    let k = file.state_space().map_err(|e| fail(e.into()))?;
    let control = Control::new(vehicle, k, &file.inputs, &file.outputs).map_err(fail)?;
    Ok((control, input))
}

/// A note where a design's `[override]` is not what the vehicle has that its controller is put on.
pub(super) fn other_vehicle(path: &Path, vehicle: &VehicleSpec) -> Option<Flag> {
    let file = if path.is_dir() { path.join("result.json") } else { path.to_owned() };
    let result: Value = serde_json::from_str(&read_text(&file).ok()?).ok()?;
    let fields = result.get("design")?.get("override")?.as_object()?;
    let differ = fields.iter().filter_map(|(name, value)| {
        let value = value.as_f64()?;
        let changed = vehicle.with_overrides(&[(name.clone(), value)]).ok();
        (changed.as_ref() != Some(vehicle)).then(|| format!("{name} = {}", short(value)))
    });
    let differ: Vec<String> = differ.collect();
    let text = format!(
        "the controller was designed with [override] {}, which this vehicle has not: write that into a vehicle file to see the loop that was \
         designed",
        differ.join(", ")
    );
    (!differ.is_empty()).then(|| Flag { name: "other-vehicle".into(), text })
}

/// The files of a design beside its `result.json`: controller.json, controller.mat, those of the nominal and of the truncated
/// controllers and, with a step, controller.h.
///
/// # Errors
/// A step that makes no discrete controller.
pub fn controller_files(outcome: &DesignOutcome) -> Result<Vec<(String, Vec<u8>)>, StudyError> {
    let Some(file) = &outcome.controller else { return Ok(Vec::new()) };
    let fail =
        |e: LtiError| StudyError::Design { name: outcome.design.vehicle.clone(), source: Box::new(e.into()) };
    let k = file.state_space().map_err(fail)?;
    let json =
        |file: &ControllerFile| (serde_json::to_string_pretty(file).unwrap_or_default() + "\n").into_bytes();
    let mut files = vec![
        ("controller.json".to_owned(), json(file)),
        ("controller.mat".to_owned(), mat5(&[("A", k.a()), ("B", k.b()), ("C", k.c()), ("D", k.d())])),
    ];
    if let Some(nominal) = &outcome.nominal {
        files.push(("controller-nominal.json".to_owned(), json(nominal)));
    }
    for t in outcome.truncated.iter().filter(|t| t.verified.stable) {
        files.push((format!("controller-order-{}.json", t.order), json(&t.controller)));
    }
    if let Some(discretize) = outcome.design.discretize {
        let discrete = match discretize.rule {
            DiscretizeRule::Tustin => k.tustin(discretize.dt_s),
            DiscretizeRule::ZeroOrderHold => k.sampled(discretize.dt_s),
        }
        .map_err(fail)?;
        files.push(("controller.h".to_owned(), c_header(&discrete, file, discretize).into_bytes()));
    }
    Ok(files)
}

/// Real matrices as a MAT-file of level 5, not compressed.
///
/// Source: *MAT-File Format*, The MathWorks: a 128-byte header, then one miMATRIX element a variable.
#[must_use]
pub fn mat5(variables: &[(&str, &Mat)]) -> Vec<u8> {
    const MATRIX: u32 = 14;
    const UINT32: u32 = 6;
    const INT32: u32 = 5;
    const INT8: u32 = 1;
    const DOUBLE: u32 = 9;
    const DOUBLE_CLASS: u32 = 6;
    let element = |kind: u32, bytes: &[u8]| {
        let mut all = Vec::with_capacity(bytes.len() + 16);
        all.extend(kind.to_le_bytes());
        all.extend((bytes.len() as u32).to_le_bytes());
        all.extend(bytes);
        all.resize(all.len().next_multiple_of(8), 0);
        all
    };
    let mut file = format!("{:<116}", "MATLAB 5.0 MAT-file, written by washboard").into_bytes();
    file.extend([0; 8]);
    file.extend(0x0100u16.to_le_bytes());
    file.extend(b"IM");
    for (name, m) in variables {
        let mut inside = element(UINT32, &[DOUBLE_CLASS.to_le_bytes(), 0u32.to_le_bytes()].concat());
        let size = [(m.nrows() as i32).to_le_bytes(), (m.ncols() as i32).to_le_bytes()].concat();
        inside.extend(element(INT32, &size));
        inside.extend(element(INT8, name.as_bytes()));
        let values: Vec<u8> = (0..m.ncols())
            .flat_map(|j| (0..m.nrows()).map(move |i| (i, j)))
            .flat_map(|(i, j)| m[(i, j)].to_le_bytes())
            .collect();
        inside.extend(element(DOUBLE, &values));
        file.extend(element(MATRIX, &inside));
    }
    file
}

/// A discrete controller as a C header without dependencies: matrices and one step.
fn c_header(k: &StateSpace<Discrete>, names: &ControllerFile, of: Discretize) -> String {
    let (n, m, p) = (k.order(), k.inputs(), k.outputs());
    let mut h = String::new();
    let rule = match of.rule {
        DiscretizeRule::Tustin => "Tustin's rule",
        DiscretizeRule::ZeroOrderHold => "zero-order hold",
    };
    // names come from the vehicle: nothing of them may end the comment
    let safe = |names: &[String]| names.join(", ").replace("*/", "* /");
    let _ = writeln!(
        h,
        "/* u = K y, discrete by {rule}, a step every {} s.\n   y: {}\n   u: {} */",
        of.dt_s,
        safe(&names.inputs),
        safe(&names.outputs)
    );
    h += "#ifndef WASHBOARD_CONTROLLER_H\n#define WASHBOARD_CONTROLLER_H\n";
    let _ = writeln!(
        h,
        "#define CONTROLLER_STATES {n}\n#define CONTROLLER_INPUTS {m}\n#define CONTROLLER_OUTPUTS {p}\n#define CONTROLLER_DT_S {:?}",
        of.dt_s
    );
    // C knows no empty arrays: a gain keeps one zero
    let mut matrix = |name: &str, a: &Mat| {
        let _ = write!(
            h,
            "static const double CONTROLLER_{name}[{}][{}] = {{",
            a.nrows().max(1),
            a.ncols().max(1)
        );
        for i in 0..a.nrows().max(1) {
            let row: Vec<String> =
                (0..a.ncols().max(1))
                    .map(|j| {
                        if i < a.nrows() && j < a.ncols() { format!("{:?}", a[(i, j)]) } else { "0.0".into() }
                    })
                    .collect();
            let _ = write!(h, "{}{{{}}}", if i == 0 { "" } else { ",\n  " }, row.join(", "));
        }
        h += "};\n";
    };
    for (name, a) in [("A", k.a()), ("B", k.b()), ("C", k.c()), ("D", k.d())] {
        matrix(name, a);
    }
    h += "/* x: the state, zero at the start, changed; y: the measurements; u: the forces to apply now. */\n\
static inline void controller_step(double x[], const double y[], double u[])\n{\n\
  double next[CONTROLLER_STATES > 0 ? CONTROLLER_STATES : 1];\n  int i, j;\n\
  for (i = 0; i < CONTROLLER_OUTPUTS; ++i) {\n    u[i] = 0.0;\n\
    for (j = 0; j < CONTROLLER_STATES; ++j) u[i] += CONTROLLER_C[i][j] * x[j];\n\
    for (j = 0; j < CONTROLLER_INPUTS; ++j) u[i] += CONTROLLER_D[i][j] * y[j];\n  }\n\
  for (i = 0; i < CONTROLLER_STATES; ++i) {\n    next[i] = 0.0;\n\
    for (j = 0; j < CONTROLLER_STATES; ++j) next[i] += CONTROLLER_A[i][j] * x[j];\n\
    for (j = 0; j < CONTROLLER_INPUTS; ++j) next[i] += CONTROLLER_B[i][j] * y[j];\n  }\n\
  for (i = 0; i < CONTROLLER_STATES; ++i) x[i] = next[i];\n}\n#endif\n";
    h
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mat_file_is_laid_out_as_the_format_says() {
        let a = Mat::from_fn(2, 3, |i, j| (10 * i + j) as f64);
        let file = mat5(&[("A", &a)]);
        assert_eq!(&file[..10], b"MATLAB 5.0");
        assert_eq!((&file[124..126], &file[126..128]), (&[0u8, 1][..], &b"IM"[..]));
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap());
        // miMATRIX and its size: flags 16, size 16, name 16, values 8 + 48
        assert_eq!((word(128), word(132)), (14, 104));
        assert_eq!(file.len(), 128 + 8 + 104);
        assert_eq!((word(136), word(144)), (6, 6));
        assert_eq!((word(160), word(164)), (2, 3));
        let value = |k: usize| f64::from_le_bytes(file[192 + 8 * k..200 + 8 * k].try_into().unwrap());
        // column by column
        assert_eq!([0, 1, 2, 3, 4, 5].map(value), [0.0, 10.0, 1.0, 11.0, 2.0, 12.0]);
    }

    #[test]
    fn wrong_controllers_are_answered_by_field() {
        let path = std::env::temp_dir().join(format!("washboard-controller-{}.json", std::process::id()));
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_controller(&path).map(|_| ()).map_err(|e| e.to_string())
        };
        let good =
            r#"{"a": [[-1.0]], "b": [[1.0]], "c": [[1.0]], "d": [[0.0]], "inputs": ["y"], "outputs": ["u"]}"#;
        assert!(read(good).is_ok());
        let e = read(&good.replace("[[-1.0]]", "[[-1.0, 2.0]]")).unwrap_err();
        assert!(e.contains("controller.a: expected shape (1, 1), found (1, 2)"), "{e}");
        let e = read(&good.replace("\"y\"", "\"y\", \"z\"")).unwrap_err();
        assert!(e.contains("controller.b: expected shape (1, 2)"), "{e}");
        let e = read(r#"{"schema_version": 1, "command": "design", "status": "infeasible"}"#).unwrap_err();
        assert!(e.contains("a result with status infeasible"), "{e}");
        let e = read(r#"{"schema_version": 1, "command": "ride", "status": "designed"}"#).unwrap_err();
        assert!(e.contains("expected a result of `design`"), "{e}");
        assert!(read("{").is_err() && read("[]").is_err());
        std::fs::remove_file(&path).unwrap();
    }
}
