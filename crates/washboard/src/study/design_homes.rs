//! In which table of a DESIGN.toml a key belongs that was found outside it.

use super::design_fixed_spec::FixedOrderSection;
use super::design_mixed_spec::{MixedSection, PolesSection};
use super::{ActuatorSection, Goal, LqgSection, MetricsSection};
use crate::files::FileError;
use serde::de::DeserializeOwned;

/// An error of reading a design; of a key that belongs in one of its tables, with that table.
pub(super) fn at_home(error: FileError) -> FileError {
    match error {
        FileError::Content { path, line, message } => {
            FileError::Content { path, line, message: told(message) }
        }
        other => other,
    }
}

/// serde's message, or the table that its key belongs in.
pub(super) fn told(message: String) -> String {
    let told = home(&message).map(|(key, table)| {
        format!("`{key}` is a key of [{table}], found outside it: write it below the line [{table}]")
    });
    told.unwrap_or(message)
}

/// The key that no design has by itself, and the table that has it.
fn home(message: &str) -> Option<(&str, &'static str)> {
    let (key, expected) = message.strip_prefix("unknown field `")?.split_once('`')?;
    // another table's keys do not begin with the vehicle
    expected.starts_with(", expected one of `vehicle`").then_some(())?;
    let tables = [
        ("goal", knows::<Goal>(key)),
        ("lqg", knows::<LqgSection>(key)),
        ("fixed-order", knows::<FixedOrderSection>(key)),
        ("mixed", knows::<MixedSection>(key)),
        ("poles", knows::<PolesSection>(key)),
        ("metrics", knows::<MetricsSection>(key)),
        ("actuator", knows::<ActuatorSection>(key)),
    ];
    tables.into_iter().find(|(_, knows)| *knows).map(|(table, _)| (key, table))
}

/// Whether a table has a key of this name; keys are refused before what is missing is.
fn knows<T: DeserializeOwned>(key: &str) -> bool {
    let table = toml::Table::from_iter([(key.to_owned(), toml::Value::Boolean(false))]);
    !T::deserialize(table).is_err_and(|e| e.message().starts_with("unknown field"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{DesignSpec, StudyError};
    use std::path::Path;

    fn said(text: &str) -> String {
        let head =
            "vehicle = \"case:turkay-quarter-car\"\nroad = \"r\"\nspeed_m_s = 20.0\nmethod = \"lqg\"\n";
        let error = crate::files::parse_toml::<DesignSpec>(&(head.to_owned() + text), Path::new("d.toml"));
        StudyError::from(at_home(error.expect_err("the key stands outside its table"))).to_string()
    }

    #[test]
    fn a_key_outside_its_table_is_told_where_it_belongs() {
        for (text, table) in [
            ("order = 1", "goal"),
            ("sensor_noise = 1e-8", "lqg"),
            ("tries = 3", "fixed-order"),
            ("stroke_m = 0.1", "metrics"),
            ("bandwidth_hz = 20.0", "actuator"),
            ("max_real_rad_s = -1.0", "poles"),
        ] {
            let key = text.split(' ').next().unwrap_or_default();
            let e = said(text);
            assert!(e.starts_with(&format!("d.toml:5: `{key}` is a key of [{table}]")), "{e}");
        }
        // nobody's key, and a key of another table's neighbour
        let e = said("ordr = 1");
        assert!(e.starts_with("d.toml:5: unknown field `ordr`"), "{e}");
        let e = said("[lqg]\norder = 1");
        assert!(e.starts_with("d.toml:6: unknown field `order`"), "{e}");
    }
}
