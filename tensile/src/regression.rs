//! The straight line through rows [x, y], by least squares, and linear interpolation between them.

use support::interpolation::piece;

/// The line through a set of rows.
pub(super) struct Regression {
    /// Means of x and y.
    pub mean: [f64; 2],
    /// Sum of the squared deviations of x from its mean.
    pub squares: f64,
    /// Slope of the line; not finite if all x are equal.
    pub slope: f64,
    /// Standard error of the slope, from the distances of the rows to the line; not a number for
    /// two rows.
    pub error: f64,
}

impl Regression {
    pub(crate) fn new(rows: &[[f64; 2]]) -> Self {
        let mean = mean(rows);
        let (mut squares, mut products, mut total) = (0.0, 0.0, 0.0);
        for row in rows {
            let [x, y] = [0, 1].map(|of| row[of] - mean[of]);
            squares += x * x;
            products += x * y;
            total += y * y;
        }
        let slope = products / squares;
        let left = (total - slope * products).max(0.0);
        Self { mean, squares, slope, error: (left / (rows.len() as f64 - 2.0) / squares).sqrt() }
    }
}

/// The mean of rows.
pub(super) fn mean(rows: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|of| rows.iter().map(|row| row[of]).sum::<f64>() / rows.len() as f64)
}

/// The value in the column `of` of a curve at the value `x` in its other column, which increases:
/// linear between rows, constant beyond the ends.
pub(super) fn interpolated(curve: &[[f64; 2]], of: usize, x: f64) -> f64 {
    let (low, high, fraction) = piece(curve, |row| row[1 - of], x);
    low[of] + (high[of] - low[of]) * fraction
}
