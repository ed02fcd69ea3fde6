//! Scatter of the increments of a ray about a smooth curve; a surrogate cannot learn it.
//!
//! ```text
//! e_i = y_i - sum over j in {i-2, i-1, i+1, i+2} of c_j y_j      (cubic through the neighbours)
//! noise^2 = mean of e_i^2 / (1 + sum of c_j^2)
//! ```
//!
//! noise^2 is the variance of y if the curve is locally cubic and the errors are independent. Where the
//! curvature changes more rapidly, for example where the ligament buckles, the estimate is too large. An error that
//! is common to all increments of a ray, such as that of its mesh, is not detected.

use crate::rows::Row;
use crate::schema::{D_PEAK, NUMBERS};
use support::statistics::root_mean_square;

/// Column names of the quantities that a surrogate is trained on.
const QUANTITIES: [&str; 6] = ["W", "F_a", "F_s", "M_theta", "D", "D_peak"];

/// Scatter of each quantity that some row has, divided by its root mean square: [root mean square over all increments,
/// median].
pub fn noise(rows: &[Row]) -> Vec<(&'static str, [f64; 2])> {
    let numbers = NUMBERS.iter().map(|column| {
        let value = column.get;
        (column.name, rows.iter().map(value).collect::<Vec<f64>>())
    });
    let peaks = rows.iter().map(|row| row.sample.d_peak.unwrap_or(f64::NAN));
    let columns = numbers.chain([(D_PEAK, peaks.collect())]);
    columns
        .filter(|(name, _)| QUANTITIES.contains(name))
        .filter(|(_, values)| values.iter().any(|value| !value.is_nan()))
        .map(|(name, values)| {
            let mut first = 0;
            let mut scatter: Vec<f64> = Vec::new();
            for ray in rows.chunk_by(|left, right| left.job == right.job) {
                let own = &values[first..first + ray.len()];
                let windows = std::iter::zip(ray.windows(5), own.windows(5));
                scatter.extend(windows.map(|(rows, values)| self::scatter(rows, values).abs()));
                first += ray.len();
            }
            scatter.retain(|value| !value.is_nan());
            scatter.sort_by(f64::total_cmp);
            let scale = root_mean_square(values.into_iter().filter(|value| !value.is_nan()));
            let median = scatter.get(scatter.len() / 2).copied().unwrap_or(0.0);
            let all = root_mean_square(scatter);
            let relative = |value: f64| if scale > 0.0 { value / scale } else { 0.0 };
            (name, [relative(all), relative(median)])
        })
        .collect()
}

/// e_i / sqrt(1 + sum of c_j^2) at the middle one of five rows.
fn scatter(window: &[Row], values: &[f64]) -> f64 {
    let lambda = |i: usize| window[i].sample.lambda;
    let neighbours = [0, 1, 3, 4];
    let coefficients = neighbours.map(|j| {
        let others = neighbours.into_iter().filter(|&k| k != j);
        others
            .map(|k| (lambda(2) - lambda(k)) / (lambda(j) - lambda(k)))
            .product::<f64>()
    });
    let terms = neighbours.into_iter().zip(coefficients);
    let smooth: f64 = terms.map(|(j, c)| c * values[j]).sum();
    let squares: f64 = coefficients.iter().map(|c| c * c).sum();
    (values[2] - smooth) / (1.0 + squares).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::rows;

    #[test]
    fn a_cubic_has_no_noise_and_added_noise_is_measured() {
        let mut rows = rows(200);
        for row in &mut rows {
            row.sample.w = 1.0 + row.sample.lambda.powi(3);
        }
        let of = |rows: &[Row]| noise(rows)[0];
        let (name, [all, median]) = of(&rows);
        assert_eq!(name, "W");
        assert!(all < 1e-12 && median < 1e-12);
        let scale = root_mean_square(rows.iter().map(|row| row.sample.w));
        for (k, row) in rows.iter_mut().enumerate() {
            // Nearly independent signs, from multiples of an irrational number.
            let sign = if (0.618_033_988_7 * (k * k) as f64).fract() < 0.5 {
                1.0
            } else {
                -1.0
            };
            row.sample.w += 0.01 * sign;
        }
        let (_, [all, _]) = of(&rows);
        assert!((all * scale / 0.01 - 1.0).abs() < 0.1, "{all}");
    }

    #[test]
    fn short_rays_and_zeros_have_no_noise() {
        let mut short: Vec<Row> = rows(2).into_iter().step_by(4).collect();
        assert!(noise(&short).iter().all(|(_, values)| *values == [0.0; 2]));
        short.iter_mut().for_each(|row| row.sample.d = 0.0);
        assert!(noise(&[]).is_empty());
    }

    #[test]
    fn a_quantity_that_no_row_has_is_left_out() {
        let mut rows = rows(20);
        assert!(noise(&rows).iter().any(|(name, _)| *name == "D_peak"));
        rows.iter_mut().for_each(|row| row.sample.d_peak = None);
        assert!(noise(&rows).iter().all(|(name, _)| *name != "D_peak"));
    }
}
