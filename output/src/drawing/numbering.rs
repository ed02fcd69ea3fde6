//! The numbers of the panels and of their corners on the flat sheet, as a measurement names them.

use crate::canvas::Anchor;
use crate::drawing::page::{ACCENT, INK, MUTED, PANELS, Page, TEAL};
use design::sheet::cut_sheet::Sheet;
use design::sheet::topology::is_even;

/// Distance of a corner's number from the corner, as a fraction of the distance to the centre.
const INSET: f64 = 0.24;

/// The flat sheet with the number of every panel, its corners 0 to 3 and its centre.
pub fn numbering(title: &str, sheet: &Sheet) -> String {
    let subtitle = "Numbers of the panels and corners in a measurement; + marks the centre";
    let mut page = Page::around(sheet.outline.corners, title, subtitle, false);
    let edge = page.stroke(INK, 1.0);
    for (k, panel) in sheet.panels.iter().enumerate() {
        let fill = PANELS[usize::from(!is_even(sheet.grid, k))];
        page.canvas
            .polygon(&panel.corners, &format!("fill=\"{fill}\""));
        page.canvas.polygon(&panel.corners, &edge);
        let size = panel.area().sqrt();
        let height = f64::min(22.0 * page.unit, 0.16 * size);
        let [x, y] = panel.centroid;
        let arm = 0.3 * height;
        let thin = page.stroke(TEAL, 1.2);
        page.canvas.line([x - arm, y], [x + arm, y], &thin);
        page.canvas.line([x, y - arm], [x, y + arm], &thin);
        let bold = format!("fill=\"{INK}\" font-weight=\"bold\"");
        let above = [x, y + 0.5 * height];
        page.canvas
            .text(above, height, Anchor::Middle, &bold, &format!("P{k}"));
        let small = 0.75 * height;
        for (number, [cx, cy]) in panel.corners.into_iter().enumerate() {
            let at = [cx + INSET * (x - cx), cy + INSET * (y - cy) - 0.35 * small];
            let colour = if number == 0 { ACCENT } else { MUTED };
            let style = format!("fill=\"{colour}\"");
            page.canvas
                .text(at, small, Anchor::Middle, &style, &number.to_string());
        }
    }
    page.finish()
}
