//! RUN.toml beside its data: what is declared comes out in SI, what is done on the way is told, what contradicts is named.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;
use washboard::signal::{Direction, Place, Quantity, Recording, RepairKind, read_recording};

const CHANNEL: &str = "[[channel]]\ncolumn = \"a\"\nquantity = \"acceleration\"\nunit = \"g\"\ndirection = \"-z\"\nplace = \"hub\"\n";

/// A directory of its own for each test, gone at the end.
struct Run(PathBuf);

impl Run {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("washboard-run-{name}-{}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        Run(dir)
    }

    fn data(&self, name: &str, text: impl AsRef<[u8]>) -> &Self {
        fs::write(self.0.join(name), text).unwrap();
        self
    }

    fn read(&self, toml: &str) -> Result<Recording, String> {
        fs::write(self.0.join("RUN.toml"), toml).unwrap();
        read_recording(&self.0.join("RUN.toml")).map_err(|e| e.to_string())
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// t, a, v, b at 50 Hz.
fn table(rows: usize) -> String {
    let row =
        |k: usize| format!("{},{},{},7\n", k as f64 / 50.0, (k as f64 * 0.3).sin(), 36.0 + (k % 2) as f64);
    "t,a,v,b\n".to_owned() + &(0..rows).map(row).collect::<String>()
}

#[test]
fn units_signs_wheels_and_speed_are_as_declared() {
    let run = Run::new("declared");
    let toml = "data = \"d.csv\"\nrate_hz = 50.0\nspeed_column = \"v\"\nspeed_unit = \"km/h\"\n\
                [[wheel]]\nname = \"front-left\"\nat_m = [1.0, 0.7]\n"
        .to_owned()
        + CHANNEL
        + "wheel = \"front-left\"\n";
    let r = run.data("d.csv", table(100)).read(&toml).unwrap();
    assert!((r.samples()[0][5] + 9.80665 * 1.5_f64.sin()).abs() < 1e-12, "-z in g becomes +z in m/s²");
    let c = &r.channels()[0];
    assert_eq!((c.quantity, c.direction, c.place), (Quantity::Acceleration, Direction::PlusZ, Place::Hub));
    assert_eq!((c.wheel, c.name.as_str(), r.wheels()[0].at_m), (Some(0), "a", [1.0, 0.7]));
    assert!((r.speed_m_s().unwrap() - 36.5 / 3.6).abs() < 1e-12);
    assert!((r.speed_spread_m_s().unwrap() - 0.5 / 3.6).abs() < 1e-12);
    assert!(r.repairs().is_empty());
}

#[test]
fn counts_take_their_size_from_the_scale() {
    let run = Run::new("counts");
    let counts = CHANNEL.replace("\"g\"", "\"counts\"\nscale = 0.5\nscale_unit = \"mm/s^2\"");
    let r =
        run.data("d.csv", table(100)).read(&format!("data = \"d.csv\"\nrate_hz = 50.0\n{counts}")).unwrap();
    assert!((r.samples()[0][5] + 0.5e-3 * 1.5_f64.sin()).abs() < 1e-15);
}

#[test]
fn a_dead_channel_is_left_out_and_all_dead_is_an_error() {
    let run = Run::new("dead");
    let dead = CHANNEL.replace("\"a\"", "\"b\"");
    run.data("d.csv", table(100));
    let r = run.read(&format!("data = \"d.csv\"\nrate_hz = 50.0\n{dead}{CHANNEL}")).unwrap();
    assert_eq!(r.channels().len(), 1);
    assert_eq!(
        (r.repairs()[0].what, r.repairs()[0].channel.as_deref()),
        (RepairKind::DeadChannel, Some("b"))
    );
    let e = run.read(&format!("data = \"d.csv\"\nrate_hz = 50.0\n{dead}")).unwrap_err();
    assert!(e.contains("constant"), "{e}");
}

#[test]
fn the_speed_file_counts_only_where_the_recording_is() {
    let run = Run::new("speed");
    run.data("d.csv", table(200)).data("gps.csv", "0.5,9,10\n2.5,9,20\n3.5,9,30\n9,9,500\n");
    let toml = format!(
        "data = \"d.csv\"\ntime_column = \"t\"\nspan_s = [2.0, 3.9]\nspeed_unit = \"knots\"\n\
         speed_file = {{ data = \"gps.csv\", header = false, time_column = 0, column = 2 }}\n{CHANNEL}"
    );
    let r = run.read(&toml).unwrap();
    assert!((r.speed_m_s().unwrap() - 25.0 * 1852.0 / 3600.0).abs() < 1e-9, "{:?}", r.speed_m_s());
    assert_eq!(r.len(), 96);
    let e = run.read(&toml.replace("2.0, 3.9", "0.6, 2.0")).unwrap_err();
    assert!(e.contains("gps.csv") && e.contains("speeds between"), "{e}");
}

#[test]
fn what_contradicts_is_named_with_expected_and_found() {
    let run = Run::new("wrong");
    run.data("d.csv", table(100)).data("d.bin", "x");
    let sst = b"SST\x03\xe8\x03\x01\x10\0\0\0\0\0\0\0\0\x01\0\x02\0\x03\0\x04\0";
    run.data("d.sst", sst);
    let base = format!("data = \"d.csv\"\nrate_hz = 50.0\n{CHANNEL}");
    let wheel = "[[wheel]]\nname = \"front-left\"\nat_m = [1.0, 0.7]\n";
    let cases = [
        (
            base.replace("\"g\"", "\"mm\""),
            "channel `a`: unit: expected a unit of acceleration (m/s^2, mm/s^2, g, mg, or counts), found mm",
        ),
        (base.replace("\"g\"", "\"counts\""), "channel `a`: scale: expected the size of one count in m/s^2"),
        (base.replace("\"g\"", "\"counts\"\nscale = 0.0"), "not 0, found 0"),
        (base.replace("\"g\"", "\"counts\"\nscale = 1.0\nscale_unit = \"mm\""), "channel `a`: scale_unit:"),
        (base.replace("\"g\"", "\"g\"\nscale = 2.0"), "with unit = \"counts\" only, found g"),
        (base.replace("rate_hz = 50.0", ""), "rate_hz: expected rate_hz or time_column, found neither"),
        (base.replace("rate_hz = 50.0", "rate_hz = 50.0\ntime_column = \"t\""), "found both"),
        (
            base.replace("rate_hz = 50.0", "rate_hz = -1.0"),
            "rate_hz: expected a positive finite number, found -1",
        ),
        (
            base.replace("rate_hz = 50.0", "rate_hz = 50.0\nspeed_column = \"v\""),
            "speed_unit: expected a unit",
        ),
        (base.replace("rate_hz = 50.0", "rate_hz = 50.0\nspeed_m_s = 0.0"), "speed_m_s: expected a positive"),
        (base.replace("\"a\"", "\"aa\""), "d.csv:1: column `aa`: expected a column of this name"),
        (format!("{base}{CHANNEL}"), "two channels are named `a`"),
        (
            format!("{base}wheel = \"front-left\"\nat_m = [1.0, 2.0]\n{wheel}"),
            "either wheel or at_m, found both",
        ),
        (format!("{base}wheel = \"front-lefd\"\n{wheel}"), "(did you mean `front-left`?)"),
        (base.replace("d.csv", "d.bin"), "format: expected a data file that ends in .csv, .npy or .sst"),
        (base.replace("d.csv", "d.sst").replace("\"a\"", "\"front\""), "rate_hz: expected 1000"),
        (base.replace("d.csv", "none.csv"), "none.csv: cannot read"),
        ("data = \"d.csv\"\nrate_hz = 50.0\nchannel = []\n".to_owned(), "at least one [[channel]]"),
    ];
    for (toml, expected) in cases {
        let e = run.read(&toml).unwrap_err();
        assert!(e.contains(expected), "{e}\nshould have: {expected}");
    }
    assert!(run.read(&base).is_ok());
}
