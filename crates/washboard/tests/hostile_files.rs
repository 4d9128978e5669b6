//! Arbitrary and damaged files to every reader: an error or data, never a panic, never more memory than the file is worth.

#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use std::path::Path;
use washboard::files::parse_toml;
use washboard::signal::{
    Clock, Column, CsvLayout, RecordingDescription, parse_csv, parse_npy, parse_sst, read_recording,
};

const RUN: &str = include_str!("../../../examples/recordings/mtb-00643.toml");

fn readers(bytes: &[u8]) {
    let path = Path::new("d");
    let numbers: Vec<Column> = vec![Column::Index(0), Column::Index(1)];
    let names = vec![Column::Name("t".to_owned()), Column::Name("a".to_owned())];
    let within = |columns: &[Vec<f64>]| {
        assert!(columns.iter().map(Vec::len).sum::<usize>() <= 2 * bytes.len());
        assert!(columns.iter().flatten().all(|x| x.is_finite()));
    };
    for (header, wanted) in [(true, &names), (true, &numbers), (false, &numbers)] {
        for delimiter in [b',', b';'] {
            let layout = CsvLayout { header, delimiter };
            if let Ok(columns) = parse_csv(bytes, path, layout, wanted, Some(0)) {
                within(&columns);
                let _ = Clock::from_stamps(&columns[0]);
            }
        }
    }
    if let Ok(columns) = parse_npy(bytes, path, &numbers) {
        within(&columns);
    }
    if let Ok(record) = parse_sst(bytes, path) {
        within(&[record.front, record.rear]);
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = parse_toml::<RecordingDescription>(text, path);
    }
}

fn npy() -> Vec<u8> {
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }                   \n";
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend((0..6).flat_map(|x| f64::from(x).to_le_bytes()));
    bytes
}

fn sst() -> Vec<u8> {
    let mut bytes = b"SST\x03\xe8\x03\x01\x10\0\0\0\0\0\0\0\0".to_vec();
    bytes.extend((0..40u16).flat_map(u16::to_le_bytes));
    bytes
}

fn csv() -> Vec<u8> {
    let rows = (0..20).map(|k| format!("{},{},\"x,{k}\"\n", f64::from(k) * 0.01, k * k));
    ["t,a,note\n".to_owned()].into_iter().chain(rows).collect::<String>().into_bytes()
}

/// A valid file with some bytes changed and its end cut.
fn damaged() -> impl Strategy<Value = Vec<u8>> {
    let valid = prop_oneof![Just(npy()), Just(sst()), Just(csv()), Just(RUN.as_bytes().to_vec())];
    (valid, prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6), any::<u16>()).prop_map(
        |(mut bytes, changes, cut)| {
            for (at, value) in changes {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            let keep = bytes.len() - if cut % 3 == 0 { usize::from(cut) % bytes.len() } else { 0 };
            bytes.truncate(keep);
            bytes
        },
    )
}

#[test]
fn the_undamaged_files_are_read() {
    let path = Path::new("d");
    assert_eq!(parse_npy(&npy(), path, &[Column::Index(1)]).unwrap(), [[1.0, 3.0, 5.0]]);
    assert_eq!(parse_sst(&sst(), path).unwrap().rear.len(), 20);
    assert_eq!(
        parse_csv(&csv()[..], path, CsvLayout::default(), &[Column::Index(1)], None).unwrap()[0][3],
        9.0
    );
    assert!(parse_toml::<RecordingDescription>(RUN, path).is_ok());
}

/// Stamps with repeats, gaps and jumps of any size.
fn stamps() -> impl Strategy<Value = Vec<f64>> {
    let step = prop_oneof![5 => Just(0.0), 5 => Just(0.01), 3 => 0.0..0.02f64, 1 => 0.0..1e12f64, 1 => Just(1e300), 1 => Just(1e-300)];
    prop::collection::vec(step, 16..200).prop_map(|steps| {
        let mut t = 0.0;
        steps
            .into_iter()
            .map(|s| {
                t += s;
                t
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        readers(&bytes);
    }

    #[test]
    fn arbitrary_text_does_no_harm(text in "[-0-9.,;ta\"#eE \r\n\\[\\]=x']{0,200}") {
        readers(text.as_bytes());
    }

    #[test]
    fn damaged_files_do_no_harm(bytes in damaged()) {
        readers(&bytes);
    }

    #[test]
    fn any_stamps_give_a_clock_or_an_error(stamps in stamps()) {
        if let Ok(clock) = Clock::from_stamps(&stamps) {
            prop_assert!(clock.period_s > 0.0 && clock.period_s.is_finite());
            prop_assert!(clock.jitter_rms_s.is_finite() && clock.start_s.is_finite());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// The whole way, from files: any stamps in either reading.
    #[test]
    fn any_stamps_are_laid_out_within_bounds(stamps in stamps(), instants in any::<bool>()) {
        let dir = std::env::temp_dir().join(format!("washboard-hostile-{}", std::process::id()));
        std::fs::create_dir_all(&dir).unwrap();
        let rows: String = stamps.iter().enumerate().map(|(k, t)| format!("{t:e},{}\n", k % 7)).collect();
        std::fs::write(dir.join("d.csv"), format!("t,a\n{rows}")).unwrap();
        let reading = if instants { "instants" } else { "clock" };
        let toml = format!(
            "data = \"d.csv\"\ntime_column = \"t\"\nstamps = \"{reading}\"\n[[channel]]\ncolumn = \"a\"\n\
             quantity = \"acceleration\"\nunit = \"g\"\ndirection = \"-z\"\nplace = \"body\"\n"
        );
        std::fs::write(dir.join("d.toml"), toml).unwrap();
        if let Ok(r) = read_recording(&dir.join("d.toml")) {
            prop_assert!(r.len() <= 17 * stamps.len());
            prop_assert!(r.rate_hz() > 0.0);
        }
    }
}
