//! The mirror image of a row; it doubles the database without further solves.
//!
//! ```text
//! W(a, s, theta; alpha) = W(a, -s, theta; pi - alpha),   and the same for D
//! ```

use crate::rows::Row;

/// The rows followed by their mirror images.
///
/// Mirror only after the split: an image contains no information beyond the information in its
/// original.
pub fn with_mirrored(rows: &[Row]) -> Vec<Row> {
    let images = rows.iter().map(|row| Row {
        design: row.design.mirrored(),
        sample: row.sample.mirrored(),
        ..row.clone()
    });
    rows.iter().cloned().chain(images).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::rows;
    use std::f64::consts::PI;

    #[test]
    fn an_image_has_the_same_energy_and_the_opposite_shear_force() {
        let rows = rows(3);
        let both = with_mirrored(&rows);
        assert_eq!(both.len(), 2 * rows.len());
        assert_eq!(both[..rows.len()], rows);
        for (row, image) in rows.iter().zip(&both[rows.len()..]) {
            assert_eq!(image.design.alpha, PI - row.design.alpha);
            assert_eq!(image.design.w_lig, row.design.w_lig);
            assert_eq!(image.eta(), [row.eta()[0], -row.eta()[1]]);
            let (sample, original) = (image.sample, row.sample);
            assert_eq!(
                [sample.w, sample.d, sample.f_a, sample.m_theta],
                [original.w, original.d, original.f_a, original.m_theta]
            );
            assert_eq!(sample.f_s, -original.f_s);
        }
    }
}
