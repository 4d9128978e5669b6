//! Who may import whom: downwards only (see ARCHITECTURE.md).

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Each module and those right below it; what these may import, it may import too.
const BELOW: &[(&str, &[&str])] = &[
    ("report", &["study"]),
    ("study", &["cases", "metrics", "synthesis", "identify", "subspace", "vehicle"]),
    ("cases", &["vehicle"]),
    ("vehicle", &["road", "lti"]),
    ("identify", &["signal", "road", "lti"]),
    ("synthesis", &["optimize", "subspace", "lti"]),
    ("metrics", &["road", "signal", "lti"]),
    ("road", &["signal", "lti"]),
    ("subspace", &["signal", "lti"]),
    ("lti", &["linalg"]),
    ("signal", &["linalg"]),
    ("optimize", &["linalg"]),
    ("linalg", &["units"]),
    ("units", &["files"]),
    ("files", &[]),
];

fn allowed() -> BTreeMap<&'static str, BTreeSet<&'static str>> {
    fn collect(module: &str, into: &mut BTreeSet<&'static str>) {
        let Some((_, below)) = BELOW.iter().find(|(m, _)| *m == module) else { return };
        for b in *below {
            if into.insert(b) {
                collect(b, into);
            }
        }
    }
    BELOW
        .iter()
        .map(|(m, _)| {
            let mut set = BTreeSet::from([*m]);
            collect(m, &mut set);
            (*m, set)
        })
        .collect()
}

fn rust_files(dir: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            into.push(path);
        }
    }
}

/// The modules of this crate that a line names after `crate::`, braces included.
fn imports(line: &str) -> Vec<String> {
    let code = line.split("//").next().unwrap_or("");
    let mut found = Vec::new();
    for part in code.split("crate::").skip(1) {
        let word = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
        if let Some(group) = part.strip_prefix('{') {
            found.extend(group.split(',').map(|s| word(s.trim())));
        } else {
            found.push(word(part));
        }
    }
    found.retain(|m| !m.is_empty());
    found
}

#[test]
fn modules_import_downwards_only() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let allowed = allowed();
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let (mut upward, mut checked) = (Vec::new(), 0);
    for file in files {
        let relative = file.strip_prefix(&src).unwrap();
        let first = relative.iter().next().unwrap().to_string_lossy().into_owned();
        let module = first.trim_end_matches(".rs").to_owned();
        if module == "lib" {
            continue;
        }
        let below = allowed.get(module.as_str()).unwrap_or_else(|| {
            panic!("{module} has no place in the layers: add it to BELOW and ARCHITECTURE.md")
        });
        for (number, line) in fs::read_to_string(&file).unwrap().lines().enumerate() {
            for import in imports(line) {
                checked += 1;
                if !below.contains(import.as_str()) {
                    upward.push(format!("{}:{}: {module} imports {import}", relative.display(), number + 1));
                }
            }
        }
    }
    assert!(upward.is_empty(), "upward imports:\n{}", upward.join("\n"));
    assert!(checked > 0, "no import was looked at");
}

#[test]
fn an_upward_import_is_seen() {
    assert_eq!(imports("use crate::{units, report::Page};"), ["units", "report"]);
    assert_eq!(imports("let x = crate::study::Spec::new(); // crate::report"), ["study"]);
    assert!(!allowed()["identify"].contains("vehicle"));
    assert!(!allowed()["signal"].contains("road"));
    assert!(allowed()["study"].contains("linalg"));
}
