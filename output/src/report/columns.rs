//! Numbers as text, and columns that are as wide as their widest entry.

use support::table::aligned;

/// A number with the given number of significant digits: in full between 1e-3 and 1e6, with an exponent otherwise.
pub(crate) fn rounded(value: f64, digits: usize) -> String {
    let exponential = format!("{value:.*e}", digits - 1);
    let Some((_, exponent)) = exponential.split_once('e') else {
        // Infinite or not a number.
        return value.to_string();
    };
    match exponent.parse::<i32>() {
        Ok(exponent @ -3..6) => {
            let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
            let text = format!("{value:.decimals$}");
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            }
        }
        _ => exponential,
    }
}

/// A number with `decimals` decimals, or with three significant digits if it has more than five before the point.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    if value.abs() < 1e5 {
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    }
}

/// Rows of cells as lines; every column but those at the places `left` is aligned right, two spaces after the one before.
pub(super) fn columns(rows: &[Vec<String>], left: &[usize]) -> String {
    let lines = aligned(rows, |column| left.contains(&column), "  ");
    let lines = lines.iter().map(|line| line.trim_end().to_owned() + "\n");
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_significant_digits() {
        let cases = [
            (0.0, "0"),
            (27.85, "27.85"),
            (2438.4, "2438"),
            (-0.012_345, "-0.01235"),
            (99_999.6, "100000"),
            (123_456.0, "123456"),
            (1e7, "1.000e7"),
            (4.2e-12, "4.200e-12"),
            (f64::INFINITY, "inf"),
        ];
        for (value, expected) in cases {
            assert_eq!(rounded(value, 4), expected);
        }
    }

    #[test]
    fn columns_never_collide() {
        let extremes = [0.0, -1e300, 1e-300, 99_999.9, -1e5, f64::NAN, f64::MAX];
        let rows: Vec<Vec<String>> = (extremes.iter())
            .map(|value| vec![fixed(*value, 3), fixed(-value, 1), "x".repeat(7)])
            .collect();
        let text = columns(&rows, &[]);
        let ends = |line: &str| line.match_indices("  ").count();
        for (line, row) in std::iter::zip(text.lines(), &rows) {
            assert_eq!(line.split_whitespace().collect::<Vec<_>>(), *row, "{text}");
            assert_eq!(line.len(), text.lines().next().unwrap().len(), "{text}");
            assert!(ends(line) >= 2, "{text}");
        }
    }
}
