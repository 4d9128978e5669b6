//! NumPy's .npy: a one- or two-dimensional array of real numbers, samples × channels.
//!
//! Read here rather than by a crate: the header is a Python literal, for which the crates at hand bring a recursive
//! parser and allocate what the header claims. Five kinds of number and a shape need neither.

use super::error::quoted;
use super::{Column, SignalError};
use std::path::Path;

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// How one number is stored.
struct Item {
    kind: u8,
    bytes: usize,
    big_endian: bool,
}

/// The wanted columns of an .npy file. See [`parse_npy`].
///
/// # Errors
/// Those of [`parse_npy`], and a file that cannot be read or is too large.
pub fn read_npy(path: &Path, wanted: &[Column]) -> Result<Vec<Vec<f64>>, SignalError> {
    parse_npy(&super::read::read_bytes(path)?, path, wanted)
}

/// The wanted columns (by 0-based number) of an array in .npy form; `path` is only for messages.
///
/// Floating-point (f4, f8) and whole (i1–i8, u1–u8) numbers of either byte order, in C or Fortran order; an array of one
/// dimension is one column.
///
/// # Errors
/// Another format, type or number of dimensions; a file that is longer or shorter than its shape says; a column that is
/// not there or is asked for by name; a number that is not finite.
pub fn parse_npy(bytes: &[u8], path: &Path, wanted: &[Column]) -> Result<Vec<Vec<f64>>, SignalError> {
    let fail = |place: &str, expected: &str, found: String| {
        Err(SignalError::data(path, None, place, expected, found))
    };
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        return fail("start", "NumPy's magic \\x93NUMPY", quoted(&bytes[..bytes.len().min(6)]));
    };
    let (header, data) = match rest {
        [1, _, a, b, rest @ ..] => rest.split_at_checked(usize::from(u16::from_le_bytes([*a, *b]))),
        [2 | 3, _, a, b, c, d, rest @ ..] => {
            rest.split_at_checked(u32::from_le_bytes([*a, *b, *c, *d]) as usize)
        }
        _ => return fail("version", "1, 2 or 3", quoted(&rest[..rest.len().min(2)])),
    }
    .ok_or_else(|| SignalError::data(path, None, "header", "a whole header", "the end of the file"))?;
    let Some(item) = value_of(header, b"'descr'").and_then(item) else {
        return fail("header", "'descr' of a real number such as '<f8'", quoted(header));
    };
    let Some(fortran) = value_of(header, b"'fortran_order'").and_then(boolean) else {
        return fail("header", "'fortran_order' True or False", quoted(header));
    };
    let Some((rows, columns)) = value_of(header, b"'shape'").and_then(shape) else {
        return fail("header", "'shape' of one or two dimensions", quoted(header));
    };
    let size = rows.checked_mul(columns).and_then(|n| n.checked_mul(item.bytes));
    if size != Some(data.len()) {
        let expected = format!("{rows} × {columns} numbers of {} bytes", item.bytes);
        return fail("data", &expected, format!("{} bytes", data.len()));
    }
    if rows == 0 {
        return fail("data", "rows of numbers", "none".to_owned());
    }
    let mut read = Vec::with_capacity(wanted.len());
    for column in wanted {
        let index = match column {
            Column::Index(i) if *i < columns => *i,
            Column::Index(_) => {
                let expected = format!("a column below {columns}");
                return fail(&column.to_string(), &expected, format!("{columns} columns"));
            }
            Column::Name(name) => {
                let expected = "a 0-based column number (an .npy file names no columns)";
                return fail(&column.to_string(), expected, quoted(name.as_bytes()));
            }
        };
        let mut series = Vec::with_capacity(rows);
        for row in 0..rows {
            let at = if fortran { index * rows + row } else { row * columns + index };
            let x = number(&data[at * item.bytes..(at + 1) * item.bytes], &item);
            if !x.is_finite() {
                let place = format!("{column}, row {row}");
                return fail(&place, "a finite number", x.to_string());
            }
            series.push(x);
        }
        read.push(series);
    }
    Ok(read)
}

/// What follows a key and its colon in the header's literal.
fn value_of<'a>(header: &'a [u8], key: &[u8]) -> Option<&'a [u8]> {
    let at = header.windows(key.len()).position(|w| w == key)? + key.len();
    header[at..].trim_ascii_start().strip_prefix(b":").map(<[u8]>::trim_ascii_start)
}

fn item(value: &[u8]) -> Option<Item> {
    let [b'\'', order @ (b'<' | b'>' | b'|' | b'='), kind, size, b'\'', ..] = value else { return None };
    let bytes = usize::from(size.checked_sub(b'0')?);
    let known = match kind {
        b'f' => matches!(bytes, 4 | 8),
        b'i' | b'u' => matches!(bytes, 1 | 2 | 4 | 8),
        _ => false,
    };
    known.then_some(Item { kind: *kind, bytes, big_endian: *order == b'>' })
}

fn boolean(value: &[u8]) -> Option<bool> {
    if value.starts_with(b"True") { Some(true) } else { value.starts_with(b"False").then_some(false) }
}

/// (n,) or (n, m).
fn shape(value: &[u8]) -> Option<(usize, usize)> {
    let inside = value.strip_prefix(b"(")?;
    let text = std::str::from_utf8(&inside[..inside.iter().position(|b| *b == b')')?]).ok()?;
    let mut sizes = text.split(',').map(str::trim).filter(|s| !s.is_empty()).map(|s| s.parse::<usize>().ok());
    let rows = sizes.next()??;
    let columns = match sizes.next() {
        Some(size) => size?,
        None => 1,
    };
    (sizes.next().is_none() && columns > 0).then_some((rows, columns))
}

/// One number of at most eight bytes.
fn number(stored: &[u8], item: &Item) -> f64 {
    let mut b = [0u8; 8];
    for (i, byte) in stored.iter().enumerate() {
        // little-endian, at the low end
        b[if item.big_endian { stored.len() - 1 - i } else { i }] = *byte;
    }
    let whole = u64::from_le_bytes(b);
    match (item.kind, item.bytes) {
        (b'f', 8) => f64::from_bits(whole),
        (b'f', _) => f64::from(f32::from_bits(whole as u32)),
        (b'i', 1) => f64::from(whole as i8),
        (b'i', 2) => f64::from(whole as i16),
        (b'i', 4) => f64::from(whole as i32),
        (b'i', _) => whole as i64 as f64,
        _ => whole as f64,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A version 1 file as NumPy writes it.
    pub(in super::super) fn file(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let mut header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}");
        while (header.len() + 11) % 64 != 0 {
            header.push(' ');
        }
        header.push('\n');
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn columns(bytes: &[u8], n: usize) -> Result<Vec<Vec<f64>>, String> {
        let wanted: Vec<Column> = (0..n).map(Column::Index).collect();
        parse_npy(bytes, Path::new("d.npy"), &wanted).map_err(|e| e.to_string())
    }

    #[test]
    fn both_orders_and_byte_orders_give_the_same_columns() {
        let expected = vec![vec![1.0, 2.0, 3.0], vec![-4.0, -5.0, -6.0]];
        let c: Vec<u8> = [1.0f64, -4.0, 2.0, -5.0, 3.0, -6.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(columns(&file("<f8", "False", "(3, 2)", &c), 2).unwrap(), expected);
        let f: Vec<u8> = [1i16, 2, 3, -4, -5, -6].iter().flat_map(|x| x.to_be_bytes()).collect();
        assert_eq!(columns(&file(">i2", "True", "(3, 2)", &f), 2).unwrap(), expected);
        let single: Vec<u8> = [1.0f32, 2.0, 3.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(columns(&file("<f4", "False", "(3,)", &single), 1).unwrap(), expected[..1]);
        assert_eq!(columns(&file("|u1", "False", "(2,)", &[200, 3]), 1).unwrap(), [[200.0, 3.0]]);
    }

    #[test]
    fn a_file_that_is_not_what_it_says_is_refused() {
        let data = [0u8; 16];
        for (bytes, part) in [
            (file("<f8", "False", "(3, 1)", &data), "3 × 1 numbers of 8 bytes, found 16 bytes"),
            (file("<c16", "False", "(1,)", &data), "'descr'"),
            (file("<f8", "Maybe", "(2,)", &data), "'fortran_order'"),
            (file("<f8", "False", "(2, 1, 1)", &data), "'shape'"),
            (file("<f8", "False", "(99999999999999999, 99999999999999999)", &data), "found 16 bytes"),
            (
                file("<f8", "False", "(2,)", &[f64::NAN.to_le_bytes(), [0; 8]].concat()),
                "row 0: expected a finite",
            ),
            (b"PK\x03\x04".to_vec(), "magic"),
            (b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec(), "whole header"),
        ] {
            let e = columns(&bytes, 1).unwrap_err();
            assert!(e.contains(part), "{e}");
        }
        assert!(columns(&file("<f8", "False", "(2,)", &data), 2).unwrap_err().contains("a column below 1"));
    }
}
