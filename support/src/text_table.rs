//! Tables in texts that people hand in: what separates the cells, which sign is the decimal sign,
//! and whether another one separates groups of three digits are recognised, as those with which
//! most cells are numbers and fewest others are left. Lines that start with `#` are comments, and
//! so is what follows `#` in a number.

use crate::FileError;
use crate::text_file;
use std::cmp::Reverse;
use std::path::Path;

/// What separates cells, in the order of preference; a blank means any number of them.
const SEPARATORS: [u8; 4] = *b";\t, ";
/// Signs between groups of three digits other than `,` and `.`: blanks of every width, and the
/// apostrophes of Switzerland.
const GROUPING: [char; 6] = [' ', '\u{a0}', '\u{2009}', '\u{202f}', '\'', '’'];

/// The cells of a text; they are converted to numbers where they are used.
#[derive(Debug)]
pub struct TextTable {
    /// Every line that is not empty.
    pub rows: Vec<TextRow>,
    /// How its numbers are written.
    pub style: NumberStyle,
}

/// One line of a table.
#[derive(Clone, Debug)]
pub struct TextRow {
    /// Number of the line in the file, from 1.
    pub line: u64,
    /// The cells, without blanks around them.
    pub cells: Vec<String>,
}

/// How the numbers of a table are written.
#[derive(Clone, Copy, Debug)]
pub struct NumberStyle {
    /// Whether the decimal sign is a comma.
    pub comma: bool,
    /// Whether groups of three digits are separated, as in 1,234.5 or 1 234,5.
    pub grouped: bool,
}

impl TextTable {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let text = text_file::read(path).map_err(FileError::at(path))?;
        Ok(Self::parse(&text))
    }

    /// The table in a text.
    pub fn parse(text: &str) -> Self {
        let splits = SEPARATORS.map(|separator| split(text, separator));
        let tables = NumberStyle::ALL.iter().flat_map(|styles| {
            let each = |rows| styles.iter().map(move |style| (rows, *style));
            splits.iter().flat_map(each)
        });
        let score = |(rows, style): &(&Vec<TextRow>, NumberStyle)| {
            let (mut numbers, mut others) = (0, 0);
            for row in rows.iter().filter(|row| !row.is_comment()) {
                let count = row.numbers(*style);
                numbers += count;
                others += if count > 0 { row.filled() - count } else { 0 };
            }
            // A head alone has no number.
            let columns = rows.iter().any(|row| !row.is_comment() && row.cells.len() > 1);
            (numbers, Reverse(others), columns)
        };
        // `max_by_key` returns the last maximum; the first is preferred.
        let best = tables.rev().max_by_key(score);
        let (rows, style) = best.expect("there are several ways to read a table");
        let rows = rows.clone();
        Self { rows, style }
    }
}

impl TextRow {
    /// Whether the line is a comment.
    pub fn is_comment(&self) -> bool {
        self.cells[0].starts_with('#')
    }

    /// Count of the cells that are not empty.
    fn filled(&self) -> usize {
        self.cells.iter().filter(|cell| !cell.is_empty()).count()
    }

    /// Count of the numbers, 0 if there is only one: a name with its value.
    pub fn numbers(&self, style: NumberStyle) -> usize {
        let numbers = self.cells.iter().filter_map(|cell| style.number(cell));
        match numbers.count() {
            1 => 0,
            several => several,
        }
    }
}

impl NumberStyle {
    /// Plain numbers, preferred with any separator of cells, and grouped ones; each with a point,
    /// preferred, and a comma.
    pub const ALL: [[Self; 2]; 2] = [
        [Self::new(false, false), Self::new(true, false)],
        [Self::new(false, true), Self::new(true, true)],
    ];

    const fn new(comma: bool, grouped: bool) -> Self {
        Self { comma, grouped }
    }

    /// The finite number in a cell; `None` if it is none, or is written in another style. It may be
    /// a text of a spreadsheet, `="0.5"`, or have the exponent of Fortran, 1.0D-03.
    pub fn number(self, cell: &str) -> Option<f64> {
        let cell = cell.split('#').next().unwrap_or_default().trim();
        let quoted = cell.strip_prefix("=\"").and_then(|cell| cell.strip_suffix("\""));
        let cell = quoted.unwrap_or(cell).replace(['D', 'd'], "E");
        let [decimal, other] = if self.comma { [',', '.'] } else { ['.', ','] };
        let (whole, fraction) = match cell.split_once(decimal) {
            Some((_, "")) if self.comma => return None,
            Some((whole, fraction)) => (whole, Some(fraction)),
            None => (&*cell, None),
        };
        let whole = match self.grouped {
            true => joined(whole, other)?,
            false if whole.contains(other) => return None,
            false => whole.to_owned(),
        };
        let number = fraction.map_or(whole.clone(), |fraction| format!("{whole}.{fraction}"));
        number.parse().ok().filter(|number: &f64| number.is_finite())
    }
}

/// The digits of a whole number without the signs between their groups; `None` if a group is not
/// one of three digits.
fn joined(whole: &str, other: char) -> Option<String> {
    let sign = |c: char| c == other || GROUPING.contains(&c);
    let Some((first, rest)) = whole.split_once(sign) else {
        return Some(whole.to_owned());
    };
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let leading = first.trim_start_matches(['-', '+']);
    let starts = digits(leading) && (1..=3).contains(&leading.len()) && !leading.starts_with('0');
    let groups = rest.split(sign).all(|group| group.len() == 3 && digits(group));
    (starts && groups).then(|| whole.replace(sign, ""))
}

/// The cells of every line that is not empty.
fn split(text: &str, separator: u8) -> Vec<TextRow> {
    if separator == b' ' {
        let lines = text.lines().zip(1..);
        let words = lines.map(|(line, number)| (number, line.split([' ', '\t'])));
        return words
            .map(|(line, words)| TextRow {
                line,
                cells: words.filter(|word| !word.is_empty()).map(str::to_owned).collect(),
            })
            .filter(|row| !row.cells.is_empty())
            .collect();
    }
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let records = reader.records().map_while(Result::ok);
    records
        .map(|record| TextRow {
            line: record.position().map_or(0, csv::Position::line),
            cells: record.iter().map(str::to_owned).collect(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Vec<Vec<f64>> {
        let table = TextTable::parse(text);
        let number = |cell: &String| table.style.number(cell).unwrap();
        let rows = table.rows.iter().filter(|row| !row.is_comment());
        rows.map(|row| row.cells.iter().map(number).collect()).collect()
    }

    #[test]
    fn separators_and_decimal_signs_are_recognised() {
        for text in [
            "0,0\n0.5,1.25\n",
            "0;0\n0.5;1.25\n",
            "0\t0\n0.5\t1.25\n",
            "0;0\n0,5;1,25\n",
            "0\t0\n0,5\t1,25\n",
            "\"0\",\"0\"\n\"0,5\",\"1,25\"\n",
            "=\"0\";=\"0\"\n=\"0,5\";=\"1,25\"\n",
            "0.0D+00 0.0d0\n5.0D-01 0.125D+1\n",
            "# a, b\n0, 0\n\n0.5, 1.25 # the end\n",
            "  0   0.\n .5   1.25\n",
            "0,0 0,0\n0,5 1,25",
        ] {
            assert_eq!(numbers(text), [[0.0, 0.0], [0.5, 1.25]], "{text}");
        }
    }

    #[test]
    fn signs_between_groups_of_digits_are_recognised() {
        for text in [
            "\"0.007\",\"999.123\"\n\"-1,000.5\",\"1,234,567.25\"\n",
            "0,007;999,123\n-1.000,5;1.234.567,25\n",
            "0,007;999,123\n-1 000,5;1\u{202f}234\u{202f}567,25\n",
            "0.007;999.123\n-1'000.5;1’234’567.25\n",
        ] {
            let expected = [[0.007, 999.123], [-1000.5, 1_234_567.25]];
            assert_eq!(numbers(text), expected, "{text}");
        }
        // Unless only groups explain a number, a comma is the decimal sign.
        assert_eq!(numbers("1,125;2,250\n3,500;4,750\n"), [[1.125, 2.25], [3.5, 4.75]]);
    }

    #[test]
    fn what_is_no_number_is_none() {
        let [[point, comma], [grouped, _]] = NumberStyle::ALL;
        for (style, cell) in [
            (point, "1,5"),
            (point, "NaN"),
            (comma, "1.5"),
            (comma, "0,"),
            (comma, "1,5,2"),
            (point, "0.5%"),
            (point, "infD"),
            (grouped, "1,23"),
            (grouped, "0,001"),
            (grouped, "1,000,00"),
            (grouped, "12 34"),
        ] {
            assert_eq!(style.number(cell), None, "{cell}");
        }
        assert_eq!(comma.number("-1,5E-3"), Some(-0.0015));
    }
}
