//! Tables of text: columns aligned, numbers to the right, and numbers rounded to what a reader can use.

/// Columns of a terminal that a sentence fills.
const WIDTH: usize = 80;

/// Between two columns.
const GAP: usize = 2;

/// A sentence in a table is not broken into narrower lines.
const LEAST_SENTENCE: usize = 20;

/// Nor are the words of its first column.
const LEAST_NAME: usize = 30;

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

    /// The text, with a newline after every row. Where it is wider than a terminal the names of columns are broken into lines, and then the
    /// sentences of a last column of text.
    pub fn text(&self) -> String {
        let Some((names, rows)) = self.rows.split_first() else { return String::new() };
        let body = |c: usize| rows.iter().filter_map(|r| r.get(c)).map(|s| letters(s)).max().unwrap_or(0);
        let body: Vec<usize> = (0..names.len()).map(body).collect();
        let mut widths: Vec<usize> = names.iter().zip(&body).map(|(name, b)| letters(name).max(*b)).collect();
        let total = |widths: &[usize]| widths.iter().sum::<usize>() + GAP * widths.len().saturating_sub(1);
        while total(&widths) > WIDTH {
            // the widest of the names that can be narrower
            let least = |c: usize| pieces(&names[c]).iter().map(|p| letters(p.trim_end())).max().unwrap_or(0);
            let open = (0..names.len()).filter(|c| widths[*c] > body[*c].max(least(*c)));
            let Some(c) = open.max_by_key(|c| widths[*c]) else { break };
            widths[c] -= 1;
        }
        // then the sentences of a last column of text, and the words of the first one
        let last = names.len().saturating_sub(1);
        for (c, least) in [(last, LEAST_SENTENCE), (0, LEAST_NAME)] {
            let over = total(&widths).saturating_sub(WIDTH);
            if over > 0 && !self.right[c] && last > 0 {
                widths[c] = widths[c].saturating_sub(over).max(least.min(widths[c]));
            }
        }
        let mut text = String::new();
        let named = |(c, name): (usize, &String)| broken(&pieces(name), widths[c]);
        self.lines(&names.iter().enumerate().map(named).collect::<Vec<_>>(), &widths, true, &mut text);
        for row in rows {
            let cells = row.iter().enumerate().map(|(c, cell)| {
                if letters(cell) <= widths[c] { vec![cell.clone()] } else { broken(&words(cell), widths[c]) }
            });
            self.lines(&cells.collect::<Vec<_>>(), &widths, false, &mut text);
        }
        text
    }

    /// One row of cells that may have several lines, which end together (a header) or begin together.
    fn lines(&self, cells: &[Vec<String>], widths: &[usize], at_the_end: bool, text: &mut String) {
        let height = cells.iter().map(Vec::len).max().unwrap_or(0);
        for k in 0..height {
            let mut line = String::new();
            for (c, cell) in cells.iter().enumerate() {
                let at = if at_the_end { (k + cell.len()).checked_sub(height) } else { Some(k) };
                let part = at.and_then(|at| cell.get(at)).map_or("", String::as_str);
                let fill = " ".repeat(widths[c].saturating_sub(letters(part)));
                let gap = if c == 0 { String::new() } else { " ".repeat(GAP) };
                line += &if self.right[c] { gap + &fill + part } else { gap + part + &fill };
            }
            *text += line.trim_end();
            text.push('\n');
        }
    }
}

fn letters(text: &str) -> usize {
    text.chars().count()
}

/// A name cut behind spaces, underscores and dots.
fn pieces(name: &str) -> Vec<&str> {
    name.split_inclusive([' ', '_', '.']).collect()
}

fn words(sentence: &str) -> Vec<&str> {
    sentence.split_inclusive(' ').collect()
}

/// Pieces in lines of a width; a piece that is longer has a line of its own.
fn broken(pieces: &[&str], width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for piece in pieces {
        let last = lines.len() - 1;
        if !lines[last].is_empty() && letters(&lines[last]) + letters(piece.trim_end()) > width {
            lines.push((*piece).to_owned());
        } else {
            lines[last] += piece;
        }
    }
    lines.into_iter().map(|l| l.trim_end().to_owned()).collect()
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

    #[test]
    fn a_table_wider_than_a_terminal_has_its_names_and_sentences_broken() {
        let name = "override.tire_damping_n_s_per_m";
        let mut t = Table::new(&["point", name, "sprung_acceleration %", "suspension_travel %", "<why"]);
        t.row(["0".into(), "98".into(), "-12.1".into(), "+3.0".into(), String::new()]);
        t.row([
            "1".into(),
            String::new(),
            String::new(),
            String::new(),
            "no controller keeps to the bounds".into(),
        ]);
        let text = t.text();
        assert!(text.lines().all(|l| l.chars().count() <= WIDTH), "{text}");
        assert!(!text.contains(name) && text.contains("no controller keeps to the bounds"), "{text}");
        // every part of a name is there, and numbers stand under its end
        let head: String = text.lines().take_while(|l| !l.contains("98")).collect();
        for piece in ["override.", "damping_", "sprung_", "acceleration", "travel", "why"] {
            assert!(head.contains(piece), "{piece}: {text}");
        }
        let mut long = Table::new(&["<item", "<note"]);
        long.row(["thesis.table-4.1".into(), "word ".repeat(30).trim_end().into()]);
        assert!(long.text().lines().all(|l| l.chars().count() <= WIDTH) && long.text().lines().count() == 4);
        let mut narrow = Table::new(&["<a b", "c_d"]);
        narrow.row(["1".into(), "2".into()]);
        assert_eq!(narrow.text(), "a b  c_d\n1      2\n");
    }
}
