//! Vectors in the degrees of freedom of the panels: all of them as (x, y, phi) per panel, or the
//! six of the two panels of a hinge.

use crate::sheet::cut_sheet::Hinge;

/// The components of the two panels of a hinge.
pub(crate) fn at_hinge(hinge: &Hinge, by_panel: &[[f64; 3]]) -> [f64; 6] {
    let [a, b] = hinge.panels().map(|panel| by_panel[panel]);
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

/// Adds the components of the two panels of a hinge.
pub(crate) fn add_at_hinge(by_panel: &mut [[f64; 3]], hinge: &Hinge, components: [f64; 6]) {
    for (panel, components) in std::iter::zip(hinge.panels(), components.chunks(3)) {
        for (sum, component) in std::iter::zip(&mut by_panel[panel], components) {
            *sum += component;
        }
    }
}
