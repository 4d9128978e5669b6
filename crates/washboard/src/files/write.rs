//! Files that appear whole or not at all, one or a directory of them.

use super::FileError;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

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
    check_target_directory(dir, overwrite)?;
    build_directory(dir, |building| {
        files.iter().try_for_each(|(file, bytes)| {
            let path = building.join(file);
            let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
            folder.and_then(|()| fs::write(&path, bytes)).map_err(|source| FileError::Write { path, source })
        })
    })
}

/// Builds a directory beside its place and renames it there when all of it has succeeded; what was there is gone then.
///
/// # Errors
/// The system's, and what `fill` says.
pub fn build_directory<E: From<FileError>>(
    dir: &Path,
    fill: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<(), E> {
    let fail = |source| E::from(FileError::Write { path: dir.to_owned(), source });
    let name = dir.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let parent = dir.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(fail)?;
    let building = parent.join(format!(".{name}.{}.part", std::process::id()));
    let old = parent.join(format!(".{name}.{}.old", std::process::id()));
    let build = || -> Result<(), E> {
        fs::create_dir(&building).map_err(fail)?;
        fill(&building)?;
        if dir.exists() {
            fs::rename(dir, &old).map_err(fail)?;
        }
        fs::rename(&building, dir).map_err(fail)
    };
    let built = build();
    if built.is_err() {
        let _ = fs::remove_dir_all(&building);
        if old.exists() && !dir.exists() {
            let _ = fs::rename(&old, dir);
        }
    }
    let _ = fs::remove_dir_all(&old);
    built
}

/// What a result's directory may hold. Overwriting takes the directory away as a whole: nobody's data may be in it.
const RESULT_FILES: [&str; 15] = [
    "result.json",
    "report.html",
    "vehicle.toml",
    "road.toml",
    "controller.json",
    "controller.mat",
    "controller.h",
    "errata.md",
    "filter.toml",
    "lmi.toml",
    "lmi-controller.json",
    "fixed-order.toml",
    "fixed-order-controller.json",
    "demo.svg",
    FIGURES,
];
/// Controllers beside the one that is the result: of fewer states, of the vehicle as stated.
fn other_controller(name: &str) -> bool {
    name.starts_with("controller-") && name.ends_with(".json")
}

/// A folder of figures: SVG files and nothing else.
const FIGURES: &str = "figures";

/// The first entry of a directory that is not a result's.
fn stranger(dir: &Path) -> Option<String> {
    let names = |dir: &Path| {
        let entries = fs::read_dir(dir).map(|d| d.flatten().collect::<Vec<_>>()).unwrap_or_default();
        entries.into_iter().map(|e| e.file_name().to_string_lossy().into_owned()).collect::<Vec<_>>()
    };
    let figure = |n: &String| Path::new(n).extension().is_some_and(|e| e == "svg");
    let of_figures =
        names(&dir.join(FIGURES)).into_iter().find(|n| !figure(n)).map(|n| format!("{FIGURES}/{n}"));
    let known = |n: &str| RESULT_FILES.contains(&n) || other_controller(n);
    names(dir).into_iter().find(|n| !known(n)).or(of_figures)
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

    #[test]
    fn a_directory_appears_whole_and_is_not_overwritten_unasked() {
        let dir = std::env::temp_dir().join(format!("washboard-files-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        write_directory(&dir, &[("road.toml", b"1".to_vec())], false).unwrap();
        assert!(write_directory(&dir, &[("result.json", b"2".to_vec())], false).is_err());
        assert_eq!(fs::read(dir.join("road.toml")).unwrap(), b"1");
        write_directory(&dir, &[("result.json", b"2".to_vec())], true).unwrap();
        assert!(!dir.join("road.toml").exists() && dir.join("result.json").exists());
        // a design's other controllers are no strangers
        for other in ["controller-nominal.json", "controller-order-6.json"] {
            fs::write(dir.join(other), b"5").unwrap();
        }
        write_directory(&dir, &[("result.json", b"2".to_vec())], true).unwrap();
        // somebody's own file is never taken away
        fs::write(dir.join("mine"), b"3").unwrap();
        let e = write_directory(&dir, &[("result.json", b"4".to_vec())], true).unwrap_err().to_string();
        assert!(e.contains("\"mine\""), "{e}");
        assert_eq!(fs::read(dir.join("mine")).unwrap(), b"3");
        fs::remove_dir_all(&dir).unwrap();
    }
}
