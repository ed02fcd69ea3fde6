//! The straight line through rows [x, y], by least squares, and linear interpolation between them.

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
        let count = rows.len() as f64;
        let mean = [0, 1].map(|of| rows.iter().map(|row| row[of]).sum::<f64>() / count);
        let (mut squares, mut products, mut total) = (0.0, 0.0, 0.0);
        for row in rows {
            let [x, y] = [0, 1].map(|of| row[of] - mean[of]);
            squares += x * x;
            products += x * y;
            total += y * y;
        }
        let slope = products / squares;
        let left = (total - slope * products).max(0.0);
        Self { mean, squares, slope, error: (left / (count - 2.0) / squares).sqrt() }
    }
}

/// The value in the column `of` of a curve at the value `x` in its other column, which increases:
/// linear between rows, constant beyond the ends.
pub(super) fn interpolated(curve: &[[f64; 2]], of: usize, x: f64) -> f64 {
    let by = 1 - of;
    let after = curve.partition_point(|row| row[by] < x);
    match after {
        0 => curve[0][of],
        after if after == curve.len() => curve[after - 1][of],
        after => {
            let [low, high] = [curve[after - 1], curve[after]];
            low[of] + (high[of] - low[of]) * (x - low[by]) / (high[by] - low[by])
        }
    }
}
