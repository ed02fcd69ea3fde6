//! Whether a sheet is flat, and how far a film on a table is from that.
//!
//! Panels of a film that nothing holds leave the plane with their ligaments, which buckle
//! (docs/results/flatness). On a table the weight presses the panels down about the ligaments, over
//! the elasto-gravity length. Plates: [`out_of_plane`](crate::out_of_plane).

use crate::calibration::CALIBRATION;
use hinge::SheetMaterial;

/// Whether the panels of a sheet stay in their plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flatness {
    /// The corners are within 0.3 % of the sheet and no panel tilts by more than a degree.
    Flat,
    /// The panels tilt and do not fall over: corners within 5 % of the sheet, tilts within 5 deg.
    Tilts,
    /// Neither.
    Falls,
}

impl Flatness {
    /// The flatness by an error of the corners (root mean square) over the longer side of the flat
    /// sheet, and by the largest tilt of a panel (deg).
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

/// The expected error of the panel corners (root mean square) over the longer side of a film that
/// lies on a table, with windows of `r_win` (mm), whose hinges open by about 26 deg; `None` if its
/// weight does not hold it down.
pub fn error_on_table(material: &SheetMaterial, r_win: f64) -> Option<f64> {
    // The length at which the weight of a plate bends it as much as its stiffness resists:
    // (E t^3 / (12 (1 - nu^2) rho g t))^(1/3).
    let plate =
        material.young * material.thickness.powi(3) / (12.0 * (1.0 - material.poisson.powi(2)));
    let ratio = (plate / material.weight_by_area()).cbrt() / r_win;
    let [error, pressed] = CALIBRATION.table.value;
    (ratio <= pressed).then_some(error * ratio)
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
    fn the_weight_of_a_thin_film_holds_it_down() {
        let of = |thickness| error_on_table(&film(thickness), 20.0);
        assert!((of(0.1).unwrap() - 0.03).abs() < 2e-3);
        assert!(of(0.05) < of(0.1));
        assert_eq!(of(0.5), None);
    }
}
