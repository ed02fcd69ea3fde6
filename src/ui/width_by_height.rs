//! Width and height as one argument.

/// Two positive lengths (mm), possibly infinite, from a text such as `210x297` or `1200 x 600mm`.
pub fn width_by_height(text: &str) -> Option<[f64; 2]> {
    let (width, height) = text.trim_end_matches("mm").split_once(['x', 'X'])?;
    let side = |text: &str| text.trim().parse().ok().filter(|side: &f64| *side > 0.0);
    Some([side(width)?, side(height)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_positive_lengths() {
        assert_eq!(width_by_height("210x297"), Some([210.0, 297.0]));
        assert_eq!(width_by_height("1200 x 600mm"), Some([1200.0, 600.0]));
        assert_eq!(width_by_height("1300Xinf"), Some([1300.0, f64::INFINITY]));
        for wrong in ["210", "x", "axb", "0x5", "-1x5", "nanx5", "1x2x3"] {
            assert_eq!(width_by_height(wrong), None, "{wrong}");
        }
    }
}
