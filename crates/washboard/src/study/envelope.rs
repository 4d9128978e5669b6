//! What every result begins with: the schema's version, the command, and a fingerprint of each input.

use super::StudyError;
use crate::files::{FileError, read_text, said};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::Path;

/// The version of every `result.json`.
pub const SCHEMA_VERSION: u32 = 1;

/// The SHA-256 of bytes, in hexadecimal.
pub(super) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// An input file and its SHA-256.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// As it was named: a path, or `case:NAME`.
    pub path: String,
    /// Of its bytes, in hexadecimal.
    pub sha256: String,
}

impl Input {
    /// The fingerprint of bytes.
    #[must_use]
    pub fn of(path: impl Into<String>, bytes: &[u8]) -> Self {
        Input { path: path.into(), sha256: sha256(bytes) }
    }

    /// The fingerprint of a file, read piece by piece.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn of_file(path: &Path) -> Result<Self, FileError> {
        let fail = |source| FileError::Read { path: path.to_owned(), source };
        let mut file = std::fs::File::open(path).map_err(fail)?;
        let mut hash = Sha256::new();
        let mut piece = vec![0; 1 << 16];
        loop {
            let n = std::io::Read::read(&mut file, &mut piece).map_err(fail)?;
            if n == 0 {
                break;
            }
            hash.update(&piece[..n]);
        }
        let sha256 = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
        Ok(Input { path: path.display().to_string(), sha256 })
    }
}

/// An outcome as it is written: its keys stand beside the envelope's own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Envelope<T> {
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// `modes`, `ride` …
    pub command: String,
    /// Every file that was read.
    pub inputs: Vec<Input>,
    /// What was found.
    #[serde(flatten)]
    pub outcome: T,
}

impl<T> Envelope<T> {
    /// The envelope of an outcome.
    pub fn new(command: &str, inputs: Vec<Input>, outcome: T) -> Self {
        Envelope { schema_version: SCHEMA_VERSION, command: command.to_owned(), inputs, outcome }
    }
}

impl<T: Serialize> Envelope<T> {
    /// Indented JSON, with a newline at its end.
    #[must_use]
    pub fn to_json(&self) -> String {
        // maps have string keys and numbers that are not finite become null, so that nothing can fail
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }
}

/// A `result.json` read back.
///
/// # Errors
/// A file that is missing, is not JSON of this outcome, or is of another schema version.
pub fn read_result<T: DeserializeOwned>(path: &Path) -> Result<Envelope<T>, StudyError> {
    #[derive(Deserialize)]
    struct Version {
        schema_version: u32,
    }
    let text = read_text(path)?;
    let wrong = |e: serde_json::Error| FileError::content(path, Some(e.line()), said(&e.to_string()));
    let Version { schema_version } = serde_json::from_str(&text).map_err(wrong)?;
    if schema_version != SCHEMA_VERSION {
        let message = format!("schema_version: expected {SCHEMA_VERSION}, found {schema_version}");
        return Err(FileError::content(path, None, message).into());
    }
    Ok(serde_json::from_str(&text).map_err(wrong)?)
}

/// Whether a directory holds the `result.json` of a command.
#[must_use]
pub fn is_result_of(dir: &Path, command: &str) -> bool {
    let found = read_result::<serde_json::Value>(&dir.join("result.json"));
    found.is_ok_and(|envelope| envelope.command == command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_sha_256() {
        // FIPS 180-2, appendix B.1
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(Input::of("abc", b"abc").sha256, expected);
        let path = std::env::temp_dir().join(format!("washboard-hash-{}", std::process::id()));
        std::fs::write(&path, "abc").unwrap();
        assert_eq!(Input::of_file(&path).unwrap().sha256, expected);
        std::fs::remove_file(&path).unwrap();
    }
}
