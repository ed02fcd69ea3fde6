//! Numbers as files have them.

/// To six significant digits, so that a product of two short numbers is short.
pub fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// To a billionth of a panel's side or of a millimetre, far below the tolerance of a cut.
pub fn short(x: f64) -> f64 {
    (1e9 * x).round() / 1e9
}
