//! The directions m in which a domain is measured, and the norm of the gauge.

/// Number of directions m.
pub(super) const DIRECTIONS: usize = 26;
/// p of the gauge: corners where three planes meet are rounded by 5 % of their distance from the
/// centre.
pub(super) const EXPONENT: f64 = 24.0;

/// At least the ratio of the norm to the largest of its terms, 26^(1/24).
pub(super) const ROUNDED: f64 = 1.15;

/// The directions m.
pub(super) const DIRECTION: [[f64; 3]; DIRECTIONS] = {
    let mut directions = [[0.0; 3]; DIRECTIONS];
    let mut m = 0;
    while m < DIRECTIONS {
        // The zero vector, number 13 of 27, is not a direction.
        let k = if m < 13 { m } else { m + 1 };
        directions[m] = [(k % 3) as f64 - 1.0, (k / 3 % 3) as f64 - 1.0, (k / 9) as f64 - 1.0];
        m += 1;
    }
    directions
};

/// (sum of max(0, t)^p)^(1/p).
pub(super) fn norm(ratios: [f64; DIRECTIONS]) -> f64 {
    let largest = ratios.into_iter().fold(0.0, f64::max);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let powers = ratios.map(|t| (t.max(0.0) / largest).powi(EXPONENT as i32));
    largest * powers.into_iter().sum::<f64>().powf(1.0 / EXPONENT)
}
