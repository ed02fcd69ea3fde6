//! How far the corners of a sheet are from where the model has them because its panels leave the plane.
//!
//! The criterion is from finite elements of whole sheets of 2 x 2 panels (docs/results/flatness). Panels held flat do not leave
//! the plane. If nothing holds them, ligaments that are no wider than the sheet is thick
//! bend in the plane, and the panels of these small sheets stay there unless the sheet is drawn taut; larger plates were found up to
//! 1.3 % of their size off all the same. Wider ligaments buckle and tilt the panels. On a table the weight presses the panels
//! down about the ligaments, over the elasto-gravity length.

use crate::analysis::error_budget::interpolated;
use crate::analysis::localisation::elasto_gravity_length;
use crate::scene::Posture;
use hinge::SheetMaterial;

/// (w_lig / t of the widest ligament, error of the corners over the longer side of the flat sheet), root mean square, at openings
/// of 26 deg with nothing that holds the panels. At 65 deg it is two to three times as much.
const NOTHING: [[f64; 2]; 4] = [[0.9, 0.001], [1.2, 0.0027], [1.8, 0.013], [3.6, 0.157]];

/// Whether the panels of a sheet stay in their plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flatness {
    /// The corners are within 0.3 % of the sheet and no panel tilts by more than a degree.
    Flat,
    /// The panels tilt and do not fall over: corners within 5 % of the sheet, tilts within 5 deg.
    Tilts,
    /// Neither.
    Falls,
}

impl Flatness {
    /// Of an error of the corners (root mean square) over the longer side of the flat sheet, and the largest tilt of a panel (deg).
    pub fn of(error: f64, tilt_deg: f64) -> Self {
        if error <= 0.003 && tilt_deg <= 1.0 {
            Self::Flat
        } else if error <= 0.05 && tilt_deg <= 5.0 {
            Self::Tilts
        } else {
            Self::Falls
        }
    }
}

/// Error on a table, for each elasto-gravity length in the radius of a window.
const TABLE: f64 = 0.01;
/// The ratio of these lengths up to which the weight holds the panels down; a stiffer sheet counts as one that nothing holds.
const PRESSED: f64 = 3.2;

/// The expected error of the panel corners (root mean square) over the longer side of the flat sheet, for hinges that open by about 26 deg. Beyond
/// the widest ligaments that were solved, a lower bound.
pub fn expected_departure(
    posture: Posture,
    material: &SheetMaterial,
    widest_ligament: f64,
    r_win: f64,
) -> f64 {
    let free = between(widest_ligament / material.thickness);
    match posture {
        Posture::HeldFlat => 0.0,
        Posture::Lying => {
            let ratio = elasto_gravity_length(material) / r_win;
            if ratio <= PRESSED {
                free.min(TABLE * ratio)
            } else {
                free
            }
        }
        Posture::Hanging | Posture::Free => free,
    }
}

/// The error at a ratio; outside of the table that at its end.
fn between(ratio: f64) -> f64 {
    let [first, .., last] = NOTHING;
    let end = if ratio < first[0] { first } else { last };
    interpolated(&NOTHING, ratio).unwrap_or(end[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(thickness: f64) -> SheetMaterial {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let film = root.join("../configs/materials/pet-0.5mm.toml");
        let film = SheetMaterial::load(&film).unwrap();
        SheetMaterial { thickness, ..film }
    }

    #[test]
    fn a_sheet_is_flat_if_neither_its_corners_nor_its_panels_are_off() {
        for (error, tilt_deg, expected) in [
            (0.0, 0.0, Flatness::Flat),
            (0.003, 1.0, Flatness::Flat),
            (0.0031, 0.0, Flatness::Tilts),
            (0.0, 1.1, Flatness::Tilts),
            (0.05, 5.0, Flatness::Tilts),
            (0.051, 0.0, Flatness::Falls),
            (0.0, 5.1, Flatness::Falls),
            (f64::NAN, 0.0, Flatness::Falls),
        ] {
            let found = Flatness::of(error, tilt_deg);
            assert_eq!(found, expected, "{error} {tilt_deg}");
        }
    }

    #[test]
    fn plates_with_narrow_ligaments_stay_flat_and_films_do_not() {
        let of = |posture, thickness| expected_departure(posture, &film(thickness), 3.6, 20.0);
        for [ratio, error] in NOTHING {
            let found = of(Posture::Free, 3.6 / ratio);
            assert!((found / error - 1.0).abs() < 1e-12, "{ratio}");
        }
        assert_eq!(of(Posture::HeldFlat, 0.1), 0.0);
        assert_eq!(of(Posture::Hanging, 40.0), 0.001);
        assert_eq!(of(Posture::Free, 0.01), 0.157);
        let thinner = (5..40).map(|ratio| of(Posture::Free, 36.0 / f64::from(ratio)));
        assert!(thinner.is_sorted());
        // On a table, a film by its weight, and a plate because it stays flat by itself.
        assert!((of(Posture::Lying, 0.1) - 0.03).abs() < 2e-3);
        assert_eq!(of(Posture::Lying, 4.0), 0.001);
        // Too stiff for its weight, and too thin for its ligaments.
        assert_eq!(of(Posture::Lying, 0.5), 0.157);
    }
}
