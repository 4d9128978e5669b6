//! A folder of its own for each test, and the program run in it.

#![allow(dead_code, clippy::unwrap_used, clippy::panic)]

use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let own = format!("washboard-{}-{name}-{}", env!("CARGO_CRATE_NAME"), std::process::id());
        let folder = std::env::temp_dir().join(own);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).unwrap();
        Folder(folder)
    }

    /// Exit status, standard output, standard error.
    pub fn run(&self, line: &str) -> (i32, String, String) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let run =
            Command::new(env!("CARGO_BIN_EXE_washboard")).current_dir(&self.0).args(words).output().unwrap();
        let text = |b: &[u8]| String::from_utf8(b.to_vec()).unwrap();
        (run.status.code().unwrap(), text(&run.stdout), text(&run.stderr))
    }

    pub fn design(&self, text: &str) -> (i32, Value, String) {
        fs::write(self.0.join("design.toml"), text).unwrap();
        let (status, out, err) = self.run("design design.toml --json");
        (status, serde_json::from_str(&out).unwrap_or(Value::Null), err)
    }

    pub fn designed(&self, text: &str) -> Value {
        let (status, made, err) = self.design(text);
        assert_eq!((status, made["status"].as_str()), (0, Some("designed")), "{err} {}", made["why"]);
        made
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

pub fn number(of: &Value, path: &[&str]) -> f64 {
    path.iter().fold(of, |v, key| &v[*key]).as_f64().unwrap_or_else(|| panic!("{path:?}"))
}

pub fn names(of: &Value) -> Vec<&str> {
    of.as_array().unwrap().iter().map(|v| v["name"].as_str().unwrap()).collect()
}

pub fn text_of<'a>(of: &'a Value, name: &str) -> &'a str {
    let all = of.as_array().unwrap();
    all.iter().find(|v| v["name"] == name).and_then(|v| v["text"].as_str()).unwrap_or_default()
}
