//! Statistics of a list of numbers.

/// The middle value, or the mean of the two in the middle.
///
/// # Panics
/// If there are no values.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let [below, above] = [(values.len() - 1) / 2, values.len() / 2];
    0.5 * (values[below] + values[above])
}

/// Root mean square of the values and their largest magnitude; zero if there are none.
pub fn rms_and_maximum(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let mut maximum = 0.0_f64;
    let rms = root_mean_square(values.into_iter().inspect(|value| {
        maximum = maximum.max(value.abs());
    }));
    [rms, maximum]
}

/// Root mean square of the values; zero if there are none.
pub fn root_mean_square(values: impl IntoIterator<Item = f64>) -> f64 {
    let (count, sum) = values
        .into_iter()
        .fold((0.0_f64, 0.0), |(count, sum), value| (count + 1.0, sum + value * value));
    (sum / count.max(1.0)).sqrt()
}
