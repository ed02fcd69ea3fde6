//! Numbers as text.

/// A number with the given number of significant digits: in full between 1e-3 and 1e6, with an
/// exponent otherwise.
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
}
