//! Tables of numbers with their lines: what spectra, profiles and samples are read from.

use super::{Input, StudyError};
use crate::files::{FileError, nearest, refuse_binary, size_of_file};
use std::path::{Path, PathBuf};

/// Bytes of a file that is read whole.
const MOST_BYTES: u64 = 1 << 30;

/// Columns of finite numbers, and the line of each row.
#[derive(Debug, Clone)]
pub(super) struct NumberTable {
    pub path: PathBuf,
    /// As the header has them; empty without one.
    pub names: Vec<String>,
    pub columns: Vec<Vec<f64>>,
    pub lines: Vec<usize>,
    pub input: Input,
    header_line: usize,
}

impl NumberTable {
    /// A CSV file with a header; without one (`bare`) fields may be apart by commas, semicolons or blanks.
    ///
    /// Blank lines and lines that begin with `#` are passed over.
    pub fn read(path: &Path, bare: bool) -> Result<Self, FileError> {
        let fail = |line, message: String| Err(FileError::content(path, line, message));
        let size = size_of_file(path)?;
        if size > MOST_BYTES {
            return fail(None, format!("expected at most {MOST_BYTES} bytes, found {size}"));
        }
        let read = |source| FileError::Read { path: path.to_owned(), source };
        let bytes = std::fs::read(path).map_err(read)?;
        refuse_binary(&bytes, path)?;
        let input = Input::of(path.display().to_string(), &bytes);
        let text = String::from_utf8_lossy(&bytes);
        let mut rows = text
            .lines()
            .enumerate()
            .map(|(k, line)| (k + 1, line.trim_start_matches('\u{feff}').trim()))
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
            .peekable();
        let (mut names, mut header_line) = (Vec::new(), 0);
        if !bare {
            let Some((number, line)) = rows.next() else {
                return fail(None, "expected a header and rows of numbers, found nothing".into());
            };
            names = line.split(',').map(|s| s.trim().trim_matches('"').to_owned()).collect();
            header_line = number;
            if names.iter().any(|n| n.parse::<f64>().is_ok())
                || names.len() == 1 && line.contains([' ', ';', '\t'])
            {
                let message = format!(
                    "expected a header with the names of columns, comma-separated, found {:?}",
                    short(line)
                );
                return fail(Some(number), message);
            }
            if let Some(twice) = names.iter().enumerate().find(|(k, n)| names[..*k].contains(n)) {
                return fail(
                    Some(number),
                    format!("column {}: expected each name once, found it twice", twice.1),
                );
            }
        }
        let Some((_, first)) = rows.peek().copied() else {
            return fail(None, "expected rows of numbers, found none".into());
        };
        let width = if bare { fields(first, true).count() } else { names.len() };
        let (mut columns, mut lines) = (vec![Vec::new(); width], Vec::new());
        for (number, line) in rows {
            let mut found = 0;
            for field in fields(line, bare) {
                let value = field.parse::<f64>().ok().filter(|v| v.is_finite());
                match (columns.get_mut(found), value) {
                    (Some(column), Some(value)) => column.push(value),
                    (Some(_), None) => {
                        let name = names.get(found).cloned().unwrap_or_else(|| (found + 1).to_string());
                        let message =
                            format!("column {name}: expected a finite number, found {:?}", short(field));
                        return fail(Some(number), message);
                    }
                    (None, _) => {}
                }
                found += 1;
            }
            if found != width {
                return fail(Some(number), format!("expected {width} fields, found {found}"));
            }
            lines.push(number);
        }
        Ok(NumberTable { path: path.to_owned(), names, columns, lines, input, header_line })
    }

    /// The place of a column.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    /// An error about the header.
    pub fn header_error(&self, expected: &str) -> StudyError {
        let names: Vec<&str> = self.names.iter().take(20).map(String::as_str).collect();
        let message = format!("expected {expected}, found {}", names.join(", "));
        FileError::content(&self.path, Some(self.header_line), message).into()
    }

    /// An error about a row.
    pub fn row_error(&self, row: usize, message: String) -> StudyError {
        FileError::content(&self.path, self.lines.get(row).copied(), message).into()
    }

    /// Refuses columns that nothing is made of: a misspelled one would be left out silently.
    pub fn only(&self, known: &[&str]) -> Result<(), StudyError> {
        let Some(stray) = self.names.iter().find(|n| !known.contains(&n.as_str())) else { return Ok(()) };
        let near = nearest(stray, known.iter().copied())
            .map_or(String::new(), |n| format!(" (did you mean `{n}`?)"));
        let message = format!("column {stray}: expected one of {}{near}, found another", known.join(", "));
        Err(FileError::content(&self.path, Some(self.header_line), message).into())
    }

    /// Refuses a column that does not ascend, or begins below `least`.
    pub fn ascending(&self, column: usize, least: f64) -> Result<(), StudyError> {
        let (values, name) = (&self.columns[column], self.label(column));
        for (row, value) in values.iter().enumerate() {
            if *value < least {
                return Err(
                    self.row_error(row, format!("column {name}: expected {least} or more, found {value}"))
                );
            }
            if let Some(before) = row.checked_sub(1).map(|k| values[k])
                && *value <= before
            {
                let message =
                    format!("column {name}: expected ascending values, found {value} after {before}");
                return Err(self.row_error(row, message));
            }
        }
        Ok(())
    }

    /// What a column is called in messages.
    pub fn label(&self, column: usize) -> String {
        self.names.get(column).cloned().unwrap_or_else(|| (column + 1).to_string())
    }
}

fn fields(line: &str, bare: bool) -> impl Iterator<Item = &str> {
    let apart = move |c: char| if bare { c == ',' || c == ';' || c.is_whitespace() } else { c == ',' };
    line.split(apart).map(str::trim).filter(move |f| !bare || !f.is_empty())
}

/// Text short enough for a message.
fn short(text: &str) -> String {
    let cut: String = text.chars().take(60).collect();
    if cut.len() < text.len() { cut + "…" } else { cut }
}
