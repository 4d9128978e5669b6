//! SST files of the open mountain-bike telemetry unit: fork and shock travel in counts, at a constant rate.

use super::SignalError;
use super::error::quoted;
use std::path::Path;

/// The version whose layout is known.
const VERSION: u8 = 3;
const HEADER_BYTES: usize = 16;

/// What an SST file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct SstRecord {
    /// Samples per second.
    pub rate_hz: f64,
    /// When it was recorded: seconds since 1970-01-01 UTC.
    pub unix_time_s: i64,
    /// Fork, in counts.
    pub front: Vec<f64>,
    /// Shock, in counts.
    pub rear: Vec<f64>,
}

/// An SST file. See [`parse_sst`].
///
/// # Errors
/// Those of [`parse_sst`], and a file that cannot be read or is too large.
pub fn read_sst(path: &Path) -> Result<SstRecord, SignalError> {
    parse_sst(&super::read::read_bytes(path)?, path)
}

/// SST bytes: "SST", version u8 (3), rate u16, padding u16, time i64, then front u16 and rear u16 for every sample, all
/// little-endian; `path` is only for messages.
///
/// # Errors
/// Another start or version; a rate of 0; bytes that are no whole number of samples; no sample.
pub fn parse_sst(bytes: &[u8], path: &Path) -> Result<SstRecord, SignalError> {
    let fail = |place: &str, expected: &str, found: String| {
        Err(SignalError::data(path, None, place, expected, found))
    };
    if !bytes.starts_with(b"SST") {
        return fail("start", "\"SST\"", quoted(&bytes[..bytes.len().min(3)]));
    }
    let Some((header, samples)) = bytes.split_first_chunk::<HEADER_BYTES>() else {
        return fail("header", "16 bytes", bytes.len().to_string());
    };
    if header[3] != VERSION {
        return fail("version", "3", header[3].to_string());
    }
    let rate = u16::from_le_bytes([header[4], header[5]]);
    if rate == 0 {
        return fail("rate", "a positive number of samples per second", "0".to_owned());
    }
    let mut time = [0; 8];
    time.copy_from_slice(&header[8..]);
    if samples.is_empty() || !samples.len().is_multiple_of(4) {
        return fail("samples", "a positive multiple of 4 bytes", samples.len().to_string());
    }
    let counts = |at: usize| -> Vec<f64> {
        samples.chunks_exact(4).map(|c| f64::from(u16::from_le_bytes([c[at], c[at + 1]]))).collect()
    };
    Ok(SstRecord {
        rate_hz: f64::from(rate),
        unix_time_s: i64::from_le_bytes(time),
        front: counts(0),
        rear: counts(2),
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn file(rate: u16, samples: &[[u16; 2]]) -> Vec<u8> {
        let mut bytes = b"SST\x03".to_vec();
        bytes.extend(rate.to_le_bytes());
        bytes.extend([1, 16]);
        bytes.extend(1_688_748_852_i64.to_le_bytes());
        bytes.extend(samples.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes
    }

    #[test]
    fn a_file_is_read_as_written() {
        let got = parse_sst(&file(1000, &[[1, 2], [300, 4000]]), Path::new("a.SST")).unwrap();
        let expected = SstRecord {
            rate_hz: 1000.0,
            unix_time_s: 1_688_748_852,
            front: vec![1.0, 300.0],
            rear: vec![2.0, 4000.0],
        };
        assert_eq!(got, expected);
    }

    #[test]
    fn what_is_not_one_is_refused() {
        let good = file(1000, &[[1, 2]]);
        let mut version = good.clone();
        version[3] = 4;
        for (bytes, part) in [
            (b"XST".to_vec(), "start: expected \"SST\""),
            (good[..10].to_vec(), "header: expected 16 bytes, found 10"),
            (version, "version: expected 3, found 4"),
            (file(0, &[[1, 2]]), "rate:"),
            (good[..19].to_vec(), "multiple of 4 bytes, found 3"),
            (good[..16].to_vec(), "found 0"),
        ] {
            let e = parse_sst(&bytes, Path::new("a.SST")).unwrap_err().to_string();
            assert!(e.contains(part), "{e}");
        }
    }
}
