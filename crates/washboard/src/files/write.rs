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
    let (parent, [building, old]) = neighbours(dir);
    fs::create_dir_all(&parent).map_err(fail)?;
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
    if built.is_ok() {
        left_by_the_killed(dir).iter().for_each(|d| drop(fs::remove_dir_all(d)));
    }
    built
}

/// Neighbours of processes that were ended by force; none where the system does not say which processes there are.
fn left_by_the_killed(dir: &Path) -> Vec<PathBuf> {
    let name = dir.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let processes = Path::new("/proc");
    if !processes.join("self").exists() {
        return Vec::new();
    }
    let ended = |n: &str| -> Option<bool> {
        let (process, end) = n.strip_prefix(&format!(".{name}."))?.split_once('.')?;
        let process: u32 = process.parse().ok()?;
        Some(["part", "old"].contains(&end) && !processes.join(process.to_string()).exists())
    };
    let entries = fs::read_dir(neighbours(dir).0).into_iter().flatten().flatten();
    entries.filter(|e| ended(&e.file_name().to_string_lossy()) == Some(true)).map(|e| e.path()).collect()
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

/// The first entry of a directory that is not a result's, by its name or by what it is: a directory under a file's name is
/// somebody's own.
fn stranger(dir: &Path) -> Option<String> {
    let entries = |dir: &Path| -> Vec<(String, fs::FileType)> {
        let entries = fs::read_dir(dir).into_iter().flatten().flatten();
        entries
            .filter_map(|e| Some((e.file_name().to_string_lossy().into_owned(), e.file_type().ok()?)))
            .collect()
    };
    let known = |(n, kind): &(String, fs::FileType)| match n.as_str() {
        FIGURES => kind.is_dir(),
        n => kind.is_file() && (RESULT_FILES.contains(&n) || other_controller(n)),
    };
    let figure = |(n, kind): &(String, fs::FileType)| {
        kind.is_file() && Path::new(n).extension().is_some_and(|e| e == "svg")
    };
    let above = entries(dir).into_iter().find(|e| !known(e)).map(|e| e.0);
    above.or_else(|| {
        let inside = entries(&dir.join(FIGURES)).into_iter().find(|e| !figure(e));
        inside.map(|e| format!("{FIGURES}/{}", e.0))
    })
}

/// Where a directory is put together before it is renamed, and where the one that it replaces waits.
fn neighbours(dir: &Path) -> (PathBuf, [PathBuf; 2]) {
    let name = dir.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let parent = dir.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = |end: &str| parent.join(format!(".{name}.{}.{end}", std::process::id()));
    (parent.to_owned(), [beside("part"), beside("old")])
}

/// Whether a directory can be made where one is to be: tried, in the nearest place that exists.
fn try_to_write(dir: &Path) -> Result<(), FileError> {
    let (parent, [probe, _]) = neighbours(dir);
    let name = probe.file_name().map(|n| n.to_owned()).unwrap_or_default();
    let Some(place) = parent
        .ancestors()
        .map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p })
        .find(|p| p.exists())
    else {
        return Ok(());
    };
    let probe = place.join(name);
    fs::create_dir(&probe)
        .and_then(|()| fs::remove_dir(&probe))
        .map_err(|source| FileError::Write { path: dir.to_owned(), source })
}

/// Refuses a directory that is a file, that has something in it and may not be overwritten, or beside which nothing may be
/// written: to be asked before work starts.
///
/// # Errors
/// [`FileError::Content`] with what is in the way; the system's.
pub fn check_target_directory(dir: &Path, overwrite: bool) -> Result<(), FileError> {
    if dir.as_os_str().is_empty() || dir.file_name().is_none() {
        return Err(FileError::content(dir, None, "expected the name of a new directory"));
    }
    if dir.exists() && !dir.is_dir() {
        return Err(FileError::content(dir, None, "expected a directory, found a file"));
    }
    if !dir.exists() && dir.is_symlink() {
        return Err(FileError::content(dir, None, "expected a directory, found a link that leads nowhere"));
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
    try_to_write(dir)
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
        // what a process left that was killed goes with the next success; a living one's stays
        let left = |process: u32| {
            dir.with_file_name(format!(".{}.{process}.part", dir.file_name().unwrap().display()))
        };
        let (dead, living) = (left(u32::MAX - 1), left(1));
        fs::create_dir(&dead).unwrap();
        fs::create_dir(&living).unwrap();
        write_directory(&dir, &[("result.json", b"2".to_vec())], true).unwrap();
        assert!(!dead.exists() && living.exists() == Path::new("/proc/1").exists());
        let _ = fs::remove_dir(living);
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
        fs::remove_file(dir.join("mine")).unwrap();
        // nor under the name of a result's file
        fs::remove_file(dir.join("result.json")).unwrap();
        fs::create_dir_all(dir.join("result.json/deep")).unwrap();
        let e = write_directory(&dir, &[("result.json", b"4".to_vec())], true).unwrap_err().to_string();
        assert!(e.contains("\"result.json\"") && dir.join("result.json/deep").is_dir(), "{e}");
        fs::remove_dir_all(&dir).unwrap();
    }
}
