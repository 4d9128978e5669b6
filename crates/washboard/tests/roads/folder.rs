//! Folders and fits that the tests share.

use std::fs;
use std::path::PathBuf;
use washboard::study::{RoadFitOutcome, RoadFitSpec, StudyError, road_fit};

/// A folder of its own, gone at the end.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("washboard-roads-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        Folder(dir)
    }

    pub fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        fs::write(&path, text).unwrap();
        path.display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

pub fn fit(spec: RoadFitSpec) -> Result<RoadFitOutcome, StudyError> {
    road_fit(&spec).map(|run| run.outcome)
}

pub fn source(source: impl Into<String>) -> RoadFitSpec {
    RoadFitSpec { source: source.into(), ..RoadFitSpec::default() }
}

pub fn grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| low * (high / low).powf(k as f64 / (count - 1) as f64)).collect()
}
