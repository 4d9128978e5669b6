//! Tables of text: columns aligned, numbers to the right, and numbers rounded to what a reader can use.

/// Columns of a terminal that a sentence fills.
const WIDTH: usize = 80;

/// Significant digits of a number in a table.
const DIGITS: usize = 4;

/// A table: a header and rows; a column is text (left) or numbers (right).
#[derive(Debug)]
pub struct Table {
    /// Right-aligned?
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of these columns; a header that begins with `<` is of a column of text.
    pub fn new(header: &[&str]) -> Self {
        let right = header.iter().map(|h| !h.starts_with('<')).collect();
        let names = header.iter().map(|h| h.trim_start_matches('<').to_owned()).collect();
        Table { right, rows: vec![names] }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Whether it has only its header.
    pub fn is_empty(&self) -> bool {
        self.rows.len() == 1
    }

    /// The text, with a newline after every row.
    pub fn text(&self) -> String {
        let width = |c: usize| {
            self.rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.right.len()).map(width).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for (c, cell) in row.iter().enumerate() {
                let fill = " ".repeat(widths[c] - cell.chars().count());
                let gap = if c == 0 { "" } else { "  " };
                line +=
                    &if self.right[c] { format!("{gap}{fill}{cell}") } else { format!("{gap}{cell}{fill}") };
            }
            text += line.trim_end();
            text.push('\n');
        }
        text
    }
}

/// A sentence in lines that fit a terminal, the later ones set in; with a newline at its end.
pub fn wrapped(sentence: &str) -> String {
    let mut text = String::new();
    let mut used = 0;
    for word in sentence.split(' ') {
        let length = word.chars().count();
        if used > 0 && used + 1 + length > WIDTH {
            text.push_str("\n  ");
            used = 2;
        } else if !text.is_empty() {
            text.push(' ');
            used += 1;
        }
        text.push_str(word);
        used += length;
    }
    text.push('\n');
    text
}

/// A number in four significant digits, with an exponent where it is very large or small.
pub fn number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{x:.*e}", DIGITS - 1);
    }
    let before = size.log10().floor() as i32 + 1;
    format!("{x:.*}", (DIGITS as i32 - before).max(0) as usize)
}

/// A number and its standard deviation, `1.234 ± 0.005`: both to two digits of the deviation.
pub fn with_sd(x: f64, sd: Option<f64>) -> String {
    match sd.filter(|s| s.is_finite() && *s > 0.0) {
        None => number(x),
        // what is small beside its deviation is written as the deviation is
        Some(sd) if !(1e-6..1e4).contains(&sd) || x.abs() >= 1e6 || x.abs().max(sd) < 1e-4 => {
            format!("{x:.3e} ± {sd:.1e}")
        }
        Some(sd) => {
            let places = (1 - sd.log10().floor() as i32).max(0) as usize;
            format!("{x:.places$} ± {sd:.places$}")
        }
    }
}

/// A ratio in per cent.
pub fn percent(x: f64) -> String {
    format!("{:.2}", 100.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_sensibly() {
        for (x, text) in [
            (1.234_56, "1.235"),
            (12_345.6, "12346"),
            (0.001_234_5, "0.001234"),
            (1.6e-5, "1.600e-5"),
            (-12.0, "-12.00"),
        ] {
            assert_eq!(number(x), text);
        }
        assert_eq!(with_sd(1.234_56, Some(0.012_3)), "1.235 ± 0.012");
        assert_eq!(with_sd(1.6e-5, Some(2e-7)), "1.600e-5 ± 2.0e-7");
        assert_eq!(with_sd(-6.95e-6, Some(1.7e-4)), "-0.00001 ± 0.00017");
    }

    #[test]
    fn long_sentences_are_broken_between_words_and_short_ones_left_alone() {
        assert_eq!(wrapped("note: short"), "note: short\n");
        let long = "word ".repeat(50);
        let lines = wrapped(long.trim_end());
        assert!(lines.lines().all(|l| l.len() <= WIDTH) && lines.lines().count() == 4, "{lines}");
        assert_eq!(lines.split_whitespace().count(), 50);
    }

    #[test]
    fn columns_are_aligned() {
        let mut t = Table::new(&["<mode", "f/Hz"]);
        t.row(["heave".into(), "1.2".into()]);
        t.row(["hop".into(), "12.0".into()]);
        assert_eq!(t.text(), "mode   f/Hz\nheave   1.2\nhop    12.0\n");
    }
}
