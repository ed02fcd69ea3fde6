//! Lengths, the size of a sheet, and its stock as one argument.

use scene::{Paper, Stock};

/// Two positive lengths (mm) from a text such as `210x297` or `1200 x 600mm`.
fn width_by_height(text: &str) -> Option<[f64; 2]> {
    let (width, height) = text.trim_end_matches("mm").split_once(['x', 'X'])?;
    let side =
        |text: &str| text.trim().parse().ok().filter(|side: &f64| *side > 0.0 && side.is_finite());
    Some([side(width)?, side(height)?])
}

/// Width and height of a sheet (mm).
pub(super) fn size(text: &str) -> Result<[f64; 2], String> {
    width_by_height(text).ok_or_else(|| match text.parse::<Paper>() {
        Ok(paper) => format!(
            "the size of a sheet is two lengths in mm; for the largest sheet that is cut from {text} use --stock {paper}"
        ),
        Err(_) => "expected two lengths in mm, for example 210x297".into(),
    })
}

/// A stock: the name of a paper, or width and height (mm).
pub(super) fn stock(text: &str) -> Result<Stock, String> {
    let sides =
        width_by_height(text).filter(|sides| sides.iter().all(|side| Stock::SIDES.contains(side)));
    let paper = text.parse().map(Stock::Paper);
    (sides.map(Stock::Sides)).or(paper.ok()).ok_or_else(|| {
        "must be a paper, a5 to a0, letter or tabloid, or WIDTHxHEIGHT of 1 to 1e5 mm, like 600x400"
            .into()
    })
}

/// A length of 0 to 1000 mm.
pub(super) fn length(text: &str) -> Result<f64, String> {
    let length = text.trim_end_matches("mm").trim().parse().ok();
    let length = length.filter(|length| (0.0..=1e3).contains(length));
    length.ok_or_else(|| "must be 0 to 1000 mm".into())
}

/// A part of a whole, neither none of it nor all.
pub(super) fn part(text: &str) -> Result<f64, String> {
    let part = text.parse().ok().filter(|part| *part > 0.0 && *part < 1.0);
    part.ok_or_else(|| "must be between 0 and 1".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_positive_lengths() {
        assert_eq!(width_by_height("210x297"), Some([210.0, 297.0]));
        assert_eq!(width_by_height("1200 x 600mm"), Some([1200.0, 600.0]));
        assert_eq!(width_by_height("1300X40"), Some([1300.0, 40.0]));
        for wrong in ["210", "x", "axb", "0x5", "-1x5", "nanx5", "5xinf", "1x2x3"] {
            assert_eq!(width_by_height(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_stock_is_a_paper_or_two_finite_sides() {
        assert_eq!(stock("A4").unwrap().size(), [210.0, 297.0]);
        assert_eq!(stock("tabloid").unwrap().size(), [279.4, 431.8]);
        assert_eq!(stock("600x400").unwrap().size(), [600.0, 400.0]);
        for wrong in ["a7", "", "600", "600xinf", "0.5x600", "2e5x400"] {
            assert!(stock(wrong).is_err(), "{wrong}");
        }
        assert_eq!(length("5mm"), Ok(5.0));
        for wrong in ["-1", "nan", "inf", "2000", "5 %"] {
            assert!(length(wrong).is_err(), "{wrong}");
        }
    }
}
