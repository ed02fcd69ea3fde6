//! The numbers of the panels and of their corners on the flat sheet, as a measurement names them.

use crate::display::{Anchor, Style};
use crate::drawing::page::{ACCENT, INK, MUTED, PANELS, Page, TEAL};
use design::sheet::cut_sheet::Sheet;

/// Distance of a corner's number from the corner, as a fraction of the distance to the centre.
const INSET: f64 = 0.24;

/// The flat sheet with the number of every panel, its corners 0 to 3 and its centre.
pub fn numbering(title: &str, sheet: &Sheet) -> String {
    let subtitle = "Numbers of the panels and corners in a measurement; + marks the centre";
    let mut page = Page::around(sheet.outlines().concat(), title, subtitle, false);
    let sketch = &mut page.sketch;
    let edge = sketch.stroke(INK, 1.0);
    for (k, panel) in sheet.panels.iter().enumerate() {
        let fill = PANELS[usize::from(!sheet.topology.is_even(k))];
        sketch.canvas.polygon(&panel.boundary, Style::fill(fill));
        sketch.canvas.polygon(&panel.boundary, edge);
        let size = panel.area.sqrt();
        let height = f64::min(22.0 * sketch.unit, 0.16 * size);
        let [x, y] = panel.centroid;
        let arm = 0.3 * height;
        let thin = sketch.stroke(TEAL, 1.2);
        sketch.canvas.line([x - arm, y], [x + arm, y], thin);
        sketch.canvas.line([x, y - arm], [x, y + arm], thin);
        let bold = Style::fill(INK).bold();
        let above = [x, y + 0.5 * height];
        sketch.text(above, height, Anchor::Middle, bold, &format!("P{k}"));
        let small = 0.75 * height;
        let corners = panel.corners.into_iter().enumerate();
        for (number, [cx, cy]) in corners.filter(|(number, _)| panel.has_corner(*number)) {
            let at = [cx + INSET * (x - cx), cy + INSET * (y - cy) - 0.35 * small];
            let colour = if number == 0 { ACCENT } else { MUTED };
            let style = Style::fill(colour);
            sketch.text(at, small, Anchor::Middle, style, &number.to_string());
        }
    }
    page.finish()
}
