//! The numbers of the panels and of their corners on the flat sheet, as a measurement names them.

use crate::{
    display::{Anchor, Style},
    drawing::page::{ACCENT, INK, MUTED, Page, TEAL, panel_colour},
};
use design::sheet::cut_sheet::Sheet;

/// Distance of a corner's number from the corner, as a fraction of the distance to the centre.
const INSET: f64 = 0.24;

/// The flat sheet with the number of every panel, its corners 0 to 3 and its centre.
pub fn numbering(title: &str, sheet: &Sheet) -> String {
    let subtitle = "Numbers of the panels and corners in a measurement; + marks the centre";
    let mut page = Page::around(sheet.outlines().concat(), title, subtitle, false);
    let canvas = &mut page.canvas;
    let edge = canvas.stroke(INK, 1.0);
    for (k, panel) in sheet.panels.iter().enumerate() {
        let fill = panel_colour(&sheet.topology, k);
        canvas.polygon(&panel.boundary, Style::fill(fill));
        canvas.polygon(&panel.boundary, edge);
        let size = panel.area.sqrt();
        let height = f64::min(22.0 * canvas.unit, 0.16 * size);
        let [x, y] = panel.centroid;
        let thin = canvas.stroke(TEAL, 1.2);
        canvas.cross([x, y], 0.3 * height, thin);
        let bold = Style::fill(INK).bold();
        let above = [x, y + 0.5 * height];
        canvas.text(above, height, Anchor::Middle, bold, &format!("P{k}"));
        let small = 0.75 * height;
        let corners = panel.corners.into_iter().enumerate();
        for (number, [cx, cy]) in corners.filter(|(number, _)| panel.has_corner(*number)) {
            let at = [cx + INSET * (x - cx), cy + INSET * (y - cy) - 0.35 * small];
            let colour = if number == 0 { ACCENT } else { MUTED };
            let style = Style::fill(colour);
            canvas.text(at, small, Anchor::Middle, style, &number.to_string());
        }
    }
    page.finish()
}
