//! A file that a job is asked to write: whether it may stand there is known before the work.

use crate::files::FileError;
use std::path::Path;

/// Refuses a directory, a place that does not exist, and what is there already unless it may be replaced.
pub(super) fn check_new_file(path: &Path, overwrite: bool) -> Result<(), FileError> {
    let fail = |message: &str| Err(FileError::content(path, None, message));
    if path.is_dir() || path.file_name().is_none() {
        return fail("expected the name of a file to write, found a directory");
    }
    if path.exists() && !overwrite {
        return fail("this file exists; --overwrite replaces it");
    }
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
    if parent.is_some_and(|p| !p.is_dir()) {
        return fail("expected a file in a directory that exists");
    }
    Ok(())
}
