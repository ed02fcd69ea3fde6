//! Whether the weight of its panels can hold a sheet down that lies on a surface: Gamma and L* of
//! (21)-(22).
//!
//! The moment of gravity on a panel of edge L, p L^3 / 2 with p = rho g t, presses the panel down
//! against the moment E t^4 / (12 w_lig) of the folded ligament. Their ratio is
//!
//!   Gamma = 6 p L^3 w_lig / (E t^4) = (L / L*)^3,   L* = (E t^3 / (6 rho g w_lig))^(1/3).
//!
//! The paper expects for Gamma > 1 that buckling stays in the ligaments. The prefactor is of order
//! one, so L* is an order of magnitude and not a sharp limit: by finite elements of whole sheets,
//! panels lift off a table also where Gamma is above
//! 10. Gamma does not apply to a sheet that hangs or stands.

use hinge::SheetMaterial;

/// The critical panel edge length L* (mm) of (22) for a ligament width `w_lig` (mm).
pub fn critical_edge(material: &SheetMaterial, w_lig: f64) -> f64 {
    let bending = material.young * material.thickness.powi(4);
    (bending / (6.0 * material.weight_by_area() * w_lig)).cbrt()
}

/// The elasto-gravity length (mm), at which the weight of a plate bends it as much as its stiffness
/// resists:
///
///   l_eg = (E t^3 / (12 (1 - nu^2) rho g t))^(1/3).
///
/// The corners of four sheets on a table are off by about 1 % of the sheet for each l_eg in the
/// radius of a window, by finite elements.
pub fn elasto_gravity_length(material: &SheetMaterial) -> f64 {
    let plate =
        material.young * material.thickness.powi(3) / (12.0 * (1.0 - material.poisson.powi(2)));
    (plate / material.weight_by_area()).cbrt()
}

/// Gamma of (21) for a panel of edge length `edge` (mm) and ligaments of width `w_lig` (mm).
pub fn gamma(material: &SheetMaterial, w_lig: f64, edge: f64) -> f64 {
    (edge / critical_edge(material, w_lig)).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::derivatives::assert_close;

    fn material(young: f64, density_kg_m3: f64, thickness: f64) -> SheetMaterial {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let film = root.join("../configs/materials/pet-0.5mm.toml");
        let film = SheetMaterial::load(&film).unwrap();
        SheetMaterial { thickness, young, density_kg_m3, ..film }
    }

    #[test]
    fn table_2_is_reproduced() {
        // E (MPa), rho (kg/m^3), t (mm), L* (cm, as printed to one decimal); w_lig = 18 mm.
        let table = [
            (3e3, 800.0, 0.2, 3.0),
            (3e3, 1390.0, 0.5, 6.3),
            (1.5e3, 910.0, 0.8, 9.3),
            (70e3, 2700.0, 1.0, 29.0),
            (210e3, 7850.0, 1.5, 44.0),
        ];
        for (young, density, thickness, printed_cm) in table {
            let edge_cm = critical_edge(&material(young, density, thickness), 18.0) / 10.0;
            assert_close(edge_cm, printed_cm, 0.05);
        }
    }

    #[test]
    fn gamma_at_the_panel_pitch_is_that_of_the_paper() {
        let polyester = gamma(&material(3e3, 1390.0, 0.5), 18.0, 406.4);
        assert!((250.0..350.0).contains(&polyester), "{polyester}");
        let steel = gamma(&material(210e3, 7850.0, 1.5), 18.0, 406.4);
        assert_close(steel, 0.79, 0.005);
    }

    #[test]
    fn gamma_equals_its_definition_in_si_units() {
        let (e, rho, t, w, edge) = (3e9, 1390.0, 0.5e-3, 0.018, 0.4064_f64);
        let definition = 6.0 * (rho * 9.81 * t) * edge.powi(3) * w / (e * f64::powi(t, 4));
        let ours = gamma(&material(3e3, 1390.0, 0.5), 18.0, 406.4);
        assert!((ours / definition - 1.0).abs() < 1e-12);
    }
}
