//! Columns of numbers from CSV: the wanted ones only, every fault with its line and column.

use super::error::{quoted, suggest};
use super::read::MAX_VALUES;
use super::{Column, SignalError};
use crate::files::{FileError, HEAD_BYTES, refuse_binary};
use ::csv::{ByteRecord, ReaderBuilder};
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::ops::Range;
use std::path::Path;

/// How a CSV file is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CsvLayout {
    /// Whether the first row names the columns.
    pub header: bool,
    /// Between fields: a comma, most often.
    pub delimiter: u8,
}

impl Default for CsvLayout {
    fn default() -> Self {
        CsvLayout { header: true, delimiter: b',' }
    }
}

/// The wanted columns of a CSV file, in the order asked for. See [`parse_csv`].
///
/// # Errors
/// Those of [`parse_csv`], and a file that cannot be read.
pub fn read_csv(
    path: &Path,
    layout: CsvLayout,
    wanted: &[Column],
    ascending: Option<usize>,
) -> Result<Vec<Vec<f64>>, SignalError> {
    crate::files::size_of_file(path)?;
    let fail = |source| FileError::Read { path: path.to_owned(), source };
    let mut file = File::open(path).map_err(fail)?;
    let mut head = Vec::new();
    file.by_ref().take(HEAD_BYTES as u64).read_to_end(&mut head).map_err(fail)?;
    refuse_binary(&head, path)?;
    parse_csv(Cursor::new(head).chain(file), path, layout, wanted, ascending)
}

/// The wanted columns of CSV text; `path` is only for messages.
///
/// Other columns may hold anything. Blank lines and lines that begin with `#` are passed over. `ascending` is the place
/// in `wanted` of a column that must never decrease: the time stamps.
///
/// # Errors
/// No data; a column that is not there; rows of different length; a field that is not a finite number; a stamp smaller
/// than the one before; more than [`MAX_VALUES`] numbers: each with file, line and column.
pub fn parse_csv(
    input: impl Read,
    path: &Path,
    layout: CsvLayout,
    wanted: &[Column],
    ascending: Option<usize>,
) -> Result<Vec<Vec<f64>>, SignalError> {
    let mut row = Row::new(input, layout.delimiter);
    let read = |source| SignalError::File(FileError::Read { path: path.to_owned(), source });
    let nothing = |what: &str| SignalError::data(path, None, "file", what, "nothing");
    if !row.advance().map_err(read)? {
        return Err(nothing("rows of numbers"));
    }
    let width = row.fields.len();
    let names: Option<Vec<String>> =
        layout.header.then(|| (0..width).map(|i| header_name(row.field(i))).collect());
    let at = wanted
        .iter()
        .map(|c| place(c, names.as_deref(), width, path, row.number))
        .collect::<Result<Vec<_>, _>>()?;
    if layout.header && !row.advance().map_err(read)? {
        return Err(nothing("rows of numbers after the header"));
    }
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
    loop {
        let line = Some(row.number);
        let fail = |place: String, expected: String, found| {
            Err(SignalError::data(path, line, place, expected, found))
        };
        if row.fields.len() != width {
            return fail("row".to_owned(), format!("{width} fields"), row.fields.len().to_string());
        }
        for (column, &index) in columns.iter_mut().zip(&at) {
            match number(row.field(index)) {
                Some(x) => column.push(x),
                None => {
                    let place = label(names.as_deref(), index);
                    return fail(place, "a finite number".to_owned(), quoted(row.field(index)));
                }
            }
        }
        if let Some([.., before, now]) = ascending.map(|i| columns[i].as_slice())
            && now < before
        {
            let place = label(names.as_deref(), at[ascending.unwrap_or(0)]);
            return fail(place, format!("a time stamp of at least {before}"), now.to_string());
        }
        if columns.first().map_or(0, Vec::len).saturating_mul(columns.len()) > MAX_VALUES {
            return fail("file".to_owned(), format!("at most {MAX_VALUES} numbers"), "more".to_owned());
        }
        if !row.advance().map_err(read)? {
            return Ok(columns);
        }
    }
}

/// One row at a time, with its true line number (the csv crate's counts blank lines and remarks to the row after them).
struct Row<R> {
    input: BufReader<R>,
    delimiter: u8,
    number: usize,
    bytes: Vec<u8>,
    fields: Vec<Range<usize>>,
}

impl<R: Read> Row<R> {
    fn new(input: R, delimiter: u8) -> Self {
        let input = BufReader::with_capacity(1 << 16, input);
        Row { input, delimiter, number: 0, bytes: Vec::new(), fields: Vec::new() }
    }

    fn field(&self, index: usize) -> &[u8] {
        &self.bytes[self.fields[index].clone()]
    }

    /// The next row that is neither blank nor a remark; false at the end.
    fn advance(&mut self) -> std::io::Result<bool> {
        loop {
            self.bytes.clear();
            if self.input.read_until(b'\n', &mut self.bytes)? == 0 {
                return Ok(false);
            }
            self.number += 1;
            while self.bytes.last().is_some_and(|b| matches!(b, b'\n' | b'\r')) {
                self.bytes.pop();
            }
            if !self.bytes.starts_with(b"#") && !self.bytes.trim_ascii().is_empty() {
                break;
            }
        }
        self.fields.clear();
        if self.bytes.contains(&b'"') {
            return self.split_quoted().map(|()| true);
        }
        let mut begin = 0;
        for part in self.bytes.split(|b| *b == self.delimiter) {
            self.fields.push(begin..begin + part.len());
            begin += part.len() + 1;
        }
        Ok(true)
    }

    /// Quotes are the csv crate's work; a quoted field does not run over the end of its line.
    fn split_quoted(&mut self) -> std::io::Result<()> {
        let mut record = ByteRecord::new();
        ReaderBuilder::new()
            .has_headers(false)
            .delimiter(self.delimiter)
            .from_reader(self.bytes.as_slice())
            .read_byte_record(&mut record)
            .map_err(std::io::Error::other)?;
        self.fields.extend((0..record.len()).filter_map(|i| record.range(i)));
        self.bytes = record.as_slice().to_vec();
        Ok(())
    }
}

fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field.trim_ascii()).ok()?;
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

/// A header's field without blanks and byte-order mark.
fn header_name(field: &[u8]) -> String {
    String::from_utf8_lossy(field).trim_start_matches('\u{feff}').trim().to_owned()
}

/// Where a wanted column is.
fn place(
    column: &Column,
    names: Option<&[String]>,
    width: usize,
    path: &Path,
    line: usize,
) -> Result<usize, SignalError> {
    let fail = |expected: String, found: String| {
        Err(SignalError::data(path, Some(line), column.to_string(), expected, found))
    };
    match (column, names) {
        (Column::Index(i), _) if *i < width => Ok(*i),
        (Column::Index(_), _) => fail(format!("a column below {width}"), format!("{width} columns")),
        (Column::Name(name), None) => {
            fail("a 0-based column number, the file having no header".to_owned(), quoted(name.as_bytes()))
        }
        (Column::Name(name), Some(names)) => match names.iter().filter(|n| *n == name).count() {
            1 => Ok(names.iter().position(|n| n == name).unwrap_or(0)),
            0 => {
                let near = suggest(name, names.iter().map(String::as_str))
                    .map_or_else(String::new, |n| format!(" (did you mean `{n}`?)"));
                let listed: Vec<&str> = names.iter().take(30).map(String::as_str).collect();
                fail("a column of this name".to_owned(), format!("{}{near}", listed.join(", ")))
            }
            n => fail("one column of this name".to_owned(), n.to_string()),
        },
    }
}

fn label(names: Option<&[String]>, index: usize) -> String {
    match names.and_then(|n| n.get(index)) {
        Some(name) => format!("column `{name}`"),
        None => format!("column {index}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, header: bool, wanted: &[Column]) -> Result<Vec<Vec<f64>>, String> {
        let layout = CsvLayout { header, ..CsvLayout::default() };
        parse_csv(text.as_bytes(), Path::new("d.csv"), layout, wanted, Some(0)).map_err(|e| e.to_string())
    }

    fn name(n: &str) -> Column {
        Column::Name(n.to_owned())
    }

    #[test]
    fn wanted_columns_come_in_the_order_asked_for() {
        let text = "\u{feff}t, a ,\"no,te\",b\r\n# remark\r\n0, 1.5,\"x,y\",-2\r\n\r\n0.1,2.5e0,,3\r\n";
        let got = parse(text, true, &[name("t"), name("b"), Column::Index(1)]).unwrap();
        assert_eq!(got, vec![vec![0.0, 0.1], vec![-2.0, 3.0], vec![1.5, 2.5]]);
        assert_eq!(parse("1,2\n3,4", false, &[Column::Index(1)]).unwrap(), vec![vec![2.0, 4.0]]);
    }

    #[test]
    fn every_fault_names_line_column_expected_and_found() {
        let cases = [
            ("t,body_fl\n0,1\n1,x1\n", "d.csv:3: column `body_fl`: expected a finite number, found \"x1\""),
            ("t,body_fl\n0,NaN\n", "d.csv:2: column `body_fl`: expected a finite number, found \"NaN\""),
            ("t,body_fl\n0,1e999\n", "found \"1e999\""),
            ("t,body_fl\n0,\n", "d.csv:2: column `body_fl`: expected a finite number, found \"\""),
            ("t,body_fl\n0,1\n\n1,2,3\n", "d.csv:4: row: expected 2 fields, found 3"),
            ("t,body_f1\n0,1\n", "(did you mean `body_f1`?)"),
            ("t,body_fl,body_fl\n0,1,1\n", "expected one column of this name, found 2"),
            ("t,body_fl\n", "d.csv: file: expected rows of numbers after the header, found nothing"),
            ("", "expected rows of numbers, found nothing"),
            (
                "t,body_fl\n1,1\n0.5,2\n",
                "d.csv:3: column `t`: expected a time stamp of at least 1, found 0.5",
            ),
        ];
        for (text, expected) in cases {
            let e = parse(text, true, &[name("t"), name("body_fl")]).unwrap_err();
            assert!(e.contains(expected), "{e}");
        }
        let e = parse("1,2\n", false, &[name("t")]).unwrap_err();
        assert!(e.contains("0-based column number"), "{e}");
        let e = parse("1,2\n", false, &[Column::Index(2)]).unwrap_err();
        assert!(e.contains("expected a column below 2"), "{e}");
    }
}
