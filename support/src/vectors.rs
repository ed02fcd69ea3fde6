//! Vectors of numbers.

/// The scalar product.
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    std::iter::zip(x, y).map(|(x, y)| x * y).sum()
}

/// Adds `weight` times a vector to `sum`.
pub fn add(sum: &mut [f64], vector: &[f64], weight: f64) {
    std::iter::zip(sum, vector).for_each(|(sum, entry)| *sum += weight * entry);
}
