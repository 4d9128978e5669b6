//! The schema of specifications and results: what is in tests/golden is read and comes out the same, to the last key.
//!
//! A key that is added, renamed or dropped fails here: change docs/interface.md, CHANGELOG.md and, where a reader of old
//! files would stumble, `SCHEMA_VERSION` with it.

#![allow(clippy::unwrap_used)]

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::Path;
use washboard::study::{
    CompareOutcome, DampingOutcome, DesignOutcome, DriveTruth, Envelope, IdentifyOutcome, ModesOutcome,
    ModesSpec, ReproduceOutcome, RespondOutcome, RideOutcome, SimulateOutcome, Spec, modes,
};

fn golden(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap()
}

fn comes_out_the_same<T: Serialize + DeserializeOwned>(name: &str) {
    let written = golden(name);
    let value: T = serde_json::from_value(written.clone()).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!(serde_json::to_value(value).unwrap(), written, "{name}");
}

#[test]
fn specifications_keep_their_keys() {
    for job in [
        "modes",
        "ride",
        "simulate",
        "identify",
        "demo",
        "compare",
        "damping",
        "design",
        "reproduce",
        "sweep",
        "respond",
        "road-fit",
        "road-profile",
        "road-iri",
        "road-analytic",
    ] {
        comes_out_the_same::<Spec>(&format!("spec-{job}.json"));
        let mut stray = golden(&format!("spec-{job}.json"));
        stray["stray"] = Value::Bool(true);
        let e = serde_json::from_value::<Spec>(stray).unwrap_err().to_string();
        assert!(e.contains("unknown field `stray`"), "{job}: {e}");
    }
}

#[test]
fn outcomes_keep_their_keys() {
    comes_out_the_same::<Envelope<ModesOutcome>>("outcome-modes.json");
    comes_out_the_same::<Envelope<RideOutcome>>("outcome-ride.json");
    comes_out_the_same::<Envelope<DampingOutcome>>("outcome-damping.json");
    comes_out_the_same::<Envelope<SimulateOutcome>>("outcome-simulate.json");
    comes_out_the_same::<Envelope<DriveTruth>>("truth.json");
    comes_out_the_same::<Envelope<IdentifyOutcome>>("outcome-identify.json");
    comes_out_the_same::<Envelope<CompareOutcome>>("outcome-compare.json");
    comes_out_the_same::<Envelope<DesignOutcome>>("outcome-design.json");
    comes_out_the_same::<Envelope<ReproduceOutcome>>("outcome-reproduce.json");
    comes_out_the_same::<Envelope<RespondOutcome>>("outcome-respond.json");
}

/// The golden file is not only consistent: it is what the job gives (a regression value).
#[test]
fn the_golden_modes_are_those_of_today() {
    let (outcome, _) = modes(&ModesSpec { vehicle: "case:turkay-quarter-car".to_owned() }).unwrap();
    let kept: Envelope<ModesOutcome> = serde_json::from_value(golden("outcome-modes.json")).unwrap();
    assert_eq!(outcome.modes.len(), kept.outcome.modes.len());
    for (a, b) in outcome.modes.iter().zip(&kept.outcome.modes) {
        assert!((a.freq_hz / b.freq_hz - 1.0).abs() < 1e-12 && (a.damping - b.damping).abs() < 1e-12);
        assert_eq!((&a.label, a.kind), (&b.label, b.kind));
    }
}
