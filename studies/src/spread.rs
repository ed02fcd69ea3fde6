//! The median of some values and their range, as a cell of a table.

use support::statistics::median;
use support::table::Cell;

/// "median (least to most)"; "-" without a value.
pub fn spread(values: &[f64], decimals: usize) -> Cell {
    let least = values.iter().copied().reduce(f64::min);
    let most = values.iter().copied().reduce(f64::max);
    let cell = least.zip(most).map(|(least, most)| {
        let middle = median(values.to_vec());
        Cell::number(
            middle,
            format!("{middle:.decimals$} ({least:.decimals$} to {most:.decimals$})"),
        )
    });
    Cell::known(cell, "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_the_median_with_the_range_in_brackets() {
        let cell = spread(&[4.0, 1.0, -2.0], 1);
        assert_eq!(cell, Cell::number(1.0, "1.0 (-2.0 to 4.0)"));
        assert_eq!(spread(&[], 1), Cell::known(None, "-"));
    }
}
