//! Files in and out: TOML whose unknown keys are answered with the nearest name, and files that appear whole or not at all.

use serde::de::DeserializeOwned;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The largest text file that is read whole (descriptions, not data).
const MAX_DESCRIPTION_BYTES: u64 = 16 << 20;

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
    String::from_utf8(bytes).map_err(|e| {
        FileError::content(
            path,
            None,
            format!("expected UTF-8 text, found byte {} that is none", e.utf8_error().valid_up_to()),
        )
    })
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
        let line = e.span().map(|s| text[..s.start.min(text.len())].matches('\n').count() + 1);
        FileError::content(path, line, with_suggestion(e.message()))
    })
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

/// Writes a file so that it appears whole or not at all: a temporary neighbour, then a rename.
///
/// # Errors
/// The system's, with the file's name.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_files(&[(path.to_owned(), bytes.to_vec())])
}

/// Writes several files so that none appears before all are on disk: temporary neighbours first, then the renames.
///
/// # Errors
/// The system's, with the file's name; nothing is left behind unless a rename fails after another has succeeded.
pub fn write_files(files: &[(PathBuf, Vec<u8>)]) -> Result<(), FileError> {
    let temporary = |path: &Path| {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        path.with_file_name(format!(".{name}.{}.part", std::process::id()))
    };
    let written = files.iter().try_for_each(|(path, bytes)| {
        let fail = |source| FileError::Write { path: path.clone(), source };
        fs::File::create(temporary(path))
            .and_then(|mut f| f.write_all(bytes).and_then(|()| f.sync_all()))
            .map_err(fail)
    });
    let renamed = written.and_then(|()| {
        files.iter().try_for_each(|(path, _)| {
            fs::rename(temporary(path), path)
                .map_err(|source| FileError::Write { path: path.clone(), source })
        })
    });
    if renamed.is_err() {
        files.iter().for_each(|(path, _)| drop(fs::remove_file(temporary(path))));
    }
    renamed
}

/// Writes several files of one directory so that all appear or none does: the whole directory is built beside its
/// place and renamed into it.
///
/// An existing directory that is not empty is refused unless `overwrite`.
///
/// # Errors
/// The system's, and a directory in the way.
pub fn write_directory(dir: &Path, files: &[(&str, Vec<u8>)], overwrite: bool) -> Result<(), FileError> {
    let fail = |source| FileError::Write { path: dir.to_owned(), source };
    check_target_directory(dir, overwrite)?;
    let name = dir.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let parent = dir.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(fail)?;
    let building = parent.join(format!(".{name}.{}.part", std::process::id()));
    let old = parent.join(format!(".{name}.{}.old", std::process::id()));
    let build = || -> std::io::Result<()> {
        fs::create_dir(&building)?;
        for (file, bytes) in files {
            fs::write(building.join(file), bytes)?;
        }
        if dir.exists() {
            fs::rename(dir, &old)?;
        }
        fs::rename(&building, dir)
    };
    let built = build();
    if built.is_err() {
        let _ = fs::remove_dir_all(&building);
        if old.exists() && !dir.exists() {
            let _ = fs::rename(&old, dir);
        }
    }
    let _ = fs::remove_dir_all(&old);
    built.map_err(fail)
}

/// What a result's directory may hold. Overwriting takes the directory away as a whole: nobody's data may be in it.
const RESULT_FILES: [&str; 7] = [
    "result.json",
    "report.html",
    "vehicle.toml",
    "road.toml",
    "controller.json",
    "controller.mat",
    "controller.h",
];

/// The first entry of a directory that is not a result's.
fn stranger(dir: &Path) -> Option<String> {
    let entries = fs::read_dir(dir).ok()?.flatten();
    entries
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .find(|n| !RESULT_FILES.contains(&n.as_str()))
}

/// Refuses a directory that is a file, or that has something in it and may not be overwritten: to be asked before work
/// starts.
///
/// # Errors
/// [`FileError::Content`] with what is in the way.
pub fn check_target_directory(dir: &Path, overwrite: bool) -> Result<(), FileError> {
    if dir.as_os_str().is_empty() || dir.file_name().is_none() {
        return Err(FileError::content(dir, None, "expected the name of a new directory"));
    }
    if dir.exists() && !dir.is_dir() {
        return Err(FileError::content(dir, None, "expected a directory, found a file"));
    }
    let filled = fs::read_dir(dir).map(|mut d| d.next().is_some()).unwrap_or(false);
    if filled && !overwrite {
        return Err(FileError::content(dir, None, "the directory is not empty; --overwrite replaces it"));
    }
    if let Some(stranger) = stranger(dir) {
        let message =
            format!("holds {stranger:?}, which no result has: expected only {}", RESULT_FILES.join(", "));
        return Err(FileError::content(dir, None, message));
    }
    Ok(())
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

    #[test]
    fn a_directory_appears_whole_and_is_not_overwritten_unasked() {
        let dir = std::env::temp_dir().join(format!("washboard-files-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        write_directory(&dir, &[("road.toml", b"1".to_vec())], false).unwrap();
        assert!(write_directory(&dir, &[("result.json", b"2".to_vec())], false).is_err());
        assert_eq!(fs::read(dir.join("road.toml")).unwrap(), b"1");
        write_directory(&dir, &[("result.json", b"2".to_vec())], true).unwrap();
        assert!(!dir.join("road.toml").exists() && dir.join("result.json").exists());
        // somebody's own file is never taken away
        fs::write(dir.join("mine"), b"3").unwrap();
        let e = write_directory(&dir, &[("result.json", b"4".to_vec())], true).unwrap_err().to_string();
        assert!(e.contains("\"mine\""), "{e}");
        assert_eq!(fs::read(dir.join("mine")).unwrap(), b"3");
        fs::remove_dir_all(&dir).unwrap();
    }
}
