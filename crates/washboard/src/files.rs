//! Files in and out: TOML whose unknown keys are answered with the nearest name, and files that appear whole or not at all.

use serde::de::DeserializeOwned;
use std::fs;
use std::path::{Path, PathBuf};
use thiserror::Error;

mod write;
pub use write::{build_directory, check_target_directory, write_directory, write_files, write_whole};

/// The largest text file that is read whole (descriptions, not data).
const MAX_DESCRIPTION_BYTES: u64 = 16 << 20;

/// Bytes from which UTF-16 without a mark is told.
const UTF16_BYTES: usize = 16;
/// Bytes at a file's beginning from which it is told whether it is text.
pub const HEAD_BYTES: usize = 256;

/// What went wrong with a file: each names the file, the place in it, what was expected and what was found.
#[derive(Debug, Error)]
pub enum FileError {
    /// The file cannot be opened or read.
    #[error("{}: cannot read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error("{}: cannot write: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file was read, and its contents are not what they should be.
    #[error("{}{}: {message}", path.display(), place(*line))]
    Content {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1, where known.
        line: Option<usize>,
        /// Field, what was expected, what was found.
        message: String,
    },
}

fn place(line: Option<usize>) -> String {
    line.map_or_else(String::new, |l| format!(":{l}"))
}

impl FileError {
    /// An error in a file's contents.
    pub fn content(path: &Path, line: Option<usize>, message: impl Into<String>) -> Self {
        FileError::Content { path: path.to_owned(), line, message: message.into() }
    }
}

/// The text of a description file (at most 16 MiB of UTF-8).
///
/// # Errors
/// A file that is missing, is not readable, is too large or is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let read = |source| FileError::Read { path: path.to_owned(), source };
    let size = size_of_file(path)?;
    if size > MAX_DESCRIPTION_BYTES {
        return Err(FileError::content(
            path,
            None,
            format!("expected a description of at most {MAX_DESCRIPTION_BYTES} bytes, found {size}"),
        ));
    }
    let bytes = fs::read(path).map_err(read)?;
    refuse_binary(&bytes, path)?;
    String::from_utf8(bytes).map_err(|e| {
        FileError::content(
            path,
            None,
            format!("expected UTF-8 text, found byte {} that is none", e.utf8_error().valid_up_to()),
        )
    })
}

/// Refuses bytes at a file's beginning that are no text: UTF-16, as some editors save it (a byte order mark, or a zero in every second
/// place), or control characters.
///
/// # Errors
/// [`FileError::Content`] that says how to save it, or what was found.
pub fn refuse_binary(head: &[u8], path: &Path) -> Result<(), FileError> {
    let zeros =
        |from: usize| head.len() > 3 && head.iter().take(UTF16_BYTES).skip(from).step_by(2).all(|b| *b == 0);
    if head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]) || zeros(0) != zeros(1) {
        return Err(FileError::content(path, None, "the file is UTF-16: save it as UTF-8"));
    }
    let control = |b: &u8| *b < b' ' && !matches!(b, b'\t' | b'\n' | b'\r' | 0x0c);
    if let Some(at) = head.iter().take(HEAD_BYTES).position(control) {
        let message =
            format!("expected text, found the byte 0x{:02x} at place {at}: a binary file?", head[at]);
        return Err(FileError::content(path, None, message));
    }
    Ok(())
}

/// The size in bytes of what is a file indeed: to be asked before it is opened, since a pipe may keep a reader for ever.
///
/// # Errors
/// A path that does not exist, or that is a directory, pipe or device.
pub fn size_of_file(path: &Path) -> Result<u64, FileError> {
    let metadata = fs::metadata(path).map_err(|source| FileError::Read { path: path.to_owned(), source })?;
    if metadata.is_file() {
        Ok(metadata.len())
    } else {
        Err(FileError::content(path, None, "expected a file, found a directory, pipe or device"))
    }
}

/// A value read from a TOML file; an unknown key is an error that suggests the nearest name.
///
/// # Errors
/// See [`read_text`] and [`parse_toml`].
pub fn read_toml<T: DeserializeOwned>(path: &Path) -> Result<T, FileError> {
    parse_toml(&read_text(path)?, path)
}

/// A value from TOML text; `path` is only for messages.
///
/// # Errors
/// Text that is not TOML, or whose keys or values are not those of `T`, with the line.
pub fn parse_toml<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, FileError> {
    toml::from_str(text).map_err(|e| {
        let before = e.span().map(|s| text.get(..s.start.min(text.len())).unwrap_or_default());
        let line = before.map(|b| b.matches('\n').count() + 1);
        let message = said(e.message());
        // serde says of a value what it is, not whose
        let key = before.and_then(key_of).filter(|_| message.starts_with("invalid "));
        FileError::content(path, line, key.map_or_else(|| message.clone(), |k| format!("{k}: {message}")))
    })
}

/// The key that a value stands behind, where all before it on its line is known.
fn key_of(before: &str) -> Option<String> {
    let line = before.rsplit('\n').next()?;
    let (first, rest) = line.split_once('=')?;
    let inner = rest.rsplit_once('=').map(|(head, _)| head.rsplit(['{', ',']).next().unwrap_or(head).trim());
    let keys = std::iter::once(first.trim()).chain(inner.filter(|_| rest.trim_start().starts_with('{')));
    Some(keys.collect::<Vec<_>>().join("."))
}

/// serde's message in words, the nearest name beside one that is unknown.
#[must_use]
pub fn said(message: &str) -> String {
    in_words(&with_suggestion(message))
}

/// What serde calls by the names of types.
fn in_words(message: &str) -> String {
    // a number beyond 64 bits has no type of serde's
    let message = message.strip_suffix(" as i128").unwrap_or(message).replace(" as i128,", ",");
    // structures are tables to a reader
    let message = match message.split_once("expected struct ") {
        Some((before, after)) => {
            let rest = after.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_');
            format!("{before}expected a table{rest}")
        }
        None => message,
    };
    let message = message.replace("expected any value", "expected a number that 64 bits hold");
    let dotted = message.contains("invalid type: map, expected f64");
    let said = message.replace("expected f64", "expected a number");
    let said = said.replace("expected usize", "expected a whole number, not negative");
    let said = said.replace("expected u32", "expected a whole number, not negative");
    let said = said.replace("expected u64", "expected a whole number, not negative");
    if dotted { said.replace("map", "table") + " (a name with a dot stands in quotes)" } else { said }
}

/// serde's `unknown field` lists every name; say the nearest one first.
fn with_suggestion(message: &str) -> String {
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if !(message.starts_with("unknown field") || message.starts_with("unknown variant")) || names.len() < 2 {
        return message.to_owned();
    }
    let Some(best) = nearest(names[0], names[1..].iter().copied()) else { return message.to_owned() };
    format!("{message} (did you mean `{best}`?)")
}

/// The candidate nearest in spelling to `name`, if one is near: at most a third of its letters differ.
pub fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .map(|c| (edit_distance(name, c), c))
        .filter(|(d, c)| *d * 3 <= c.len().max(name.len()))
        .min()
        .map(|(_, c)| c)
}

fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code)]
    struct Car {
        sprung_mass_kg: f64,
        unsprung_mass_kg: f64,
    }

    #[test]
    fn an_unknown_key_names_line_and_neighbour() {
        let text = "unsprung_mass_kg = 1.0\nsprung_mas_kg = 2.0\n";
        let e = parse_toml::<Car>(text, Path::new("car.toml")).unwrap_err().to_string();
        assert!(e.starts_with("car.toml:2: unknown field `sprung_mas_kg`"), "{e}");
        assert!(e.ends_with("(did you mean `sprung_mass_kg`?)"), "{e}");
    }

    #[test]
    fn a_missing_field_and_a_wrong_type_are_named() {
        let e = parse_toml::<Car>("sprung_mass_kg = 1.0", Path::new("c")).unwrap_err().to_string();
        assert!(e.contains("missing field `unsprung_mass_kg`"), "{e}");
        let e = parse_toml::<Car>("sprung_mass_kg = \"x\"", Path::new("c")).unwrap_err().to_string();
        assert!(e.starts_with("c:1:") && e.contains("expected"), "{e}");
    }
}
