//! JSON files with the field that is wrong: the path to the place at which a reader stopped.

use crate::files::FileError;
use serde::de::DeserializeOwned;
use std::path::Path;

/// A value from JSON, a byte order mark before it passed over.
///
/// # Errors
/// What is wrong, with its line and its field as `nodes[2].values[0]`.
pub(super) fn parse_json<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, FileError> {
    let text = text.trim_start_matches('\u{feff}');
    serde_json::from_str(text).map_err(|e| {
        let said = e.to_string();
        // serde_json writes its place at the end
        let what = said.rfind(" at line ").map_or(said.as_str(), |k| &said[..k]);
        let field = field_at(text, e.line(), e.column());
        let message = if field.is_empty() { what.to_owned() } else { format!("{field}: {what}") };
        FileError::content(path, Some(e.line()), message)
    })
}

/// One object or array that is open, and where in it.
enum Open {
    Object(String),
    Array(usize),
}

/// The path to a line and a column (bytes, from 1), such as `nodes[2].z`.
fn field_at(text: &str, line: usize, column: usize) -> String {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let end = (before + column).min(text.len());
    let mut open: Vec<Open> = Vec::new();
    let (mut last, mut from, mut escaped) = (String::new(), None, false);
    for (k, byte) in text.bytes().enumerate().take(end) {
        if let Some(start) = from {
            if byte == b'"' && !escaped {
                last = text.get(start..k).unwrap_or_default().to_owned();
                from = None;
            }
            escaped = byte == b'\\' && !escaped;
            continue;
        }
        // the byte at which the reader stopped has not closed anything yet
        let stopped = k + 1 == end;
        match byte {
            b'"' => from = Some(k + 1),
            b'{' => open.push(Open::Object(String::new())),
            b'[' if !stopped => open.push(Open::Array(0)),
            b'}' | b']' if !stopped => {
                open.pop();
            }
            b':' => {
                if let Some(Open::Object(name)) = open.last_mut() {
                    name.clone_from(&last);
                }
            }
            b',' => {
                if let Some(Open::Array(index)) = open.last_mut() {
                    *index += 1;
                }
            }
            _ => {}
        }
    }
    let mut path = String::new();
    for part in open {
        match part {
            Open::Array(index) => path += &format!("[{index}]"),
            Open::Object(name) if name.is_empty() => {}
            Open::Object(name) if path.is_empty() => path = name,
            Open::Object(name) => path += &format!(".{name}"),
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        #[serde(default)]
        #[allow(dead_code)]
        nodes: Vec<Node>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Node {
        #[allow(dead_code)]
        z: [f64; 2],
    }

    #[test]
    fn errors_have_their_line_and_field() {
        let read = |text: &str| parse_json::<File>(text, Path::new("d.json"));
        assert!(read("\u{feff}{\"nodes\": [{\"z\": [1, 2]}]}").is_ok());
        for (text, expected) in [
            ("{\"nodes\": [{\"z\": [1, 2]},\n{\"z\": [1, \"a\"]}]}", "d.json:2: nodes[1].z[1]: invalid type"),
            ("{\"nodes\": [{\"z\": [1, 2]},\n{\"z\": 7}]}", "d.json:2: nodes[1].z: invalid type"),
            ("{\"nodes\": [{\"z\": [1, 2]},\n {\"zz\": 7}]}", "d.json:2: nodes[1]: unknown field `zz`"),
            ("{\"nodes\": [{\"z\": [1, 2]}]\n \"a\"}", "d.json:2: nodes: expected `,` or `}`"),
            ("", "d.json:1: EOF while parsing a value"),
        ] {
            let e = read(text).unwrap_err().to_string();
            assert!(e.starts_with(expected), "{e}");
            assert!(!e.contains(" at line "), "{e}");
        }
    }
}
