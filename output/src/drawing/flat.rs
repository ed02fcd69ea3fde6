//! The flat pattern: panels, cuts, holes, ligaments with their windows, hinge numbers.

use crate::cut_file::CutLines;
use crate::display::{Anchor, Style};
use crate::drawing::page::{ACCENT, INK, MUTED, PANELS, Page, Sketch, TEAL};
use design::sheet::cut_sheet::{Hinge, Sheet};
use design::sheet::hinge_window::Window;

/// The flat sheet with its cuts.
pub fn flat(title: &str, sheet: &Sheet, cuts: &CutLines) -> String {
    let widths = sheet.hinges.iter().map(|hinge| hinge.w_lig);
    let (min, max) = (widths.clone().fold(f64::INFINITY, f64::min), widths.fold(0.0, f64::max));
    let subtitle = format!(
        "Flat cut pattern: {} \u{d7} {} panels, {} hinges, ligaments {min:.1} to {max:.1} mm",
        sheet.topology.grid.m,
        sheet.topology.grid.n,
        sheet.hinges.len()
    );
    let mut page = Page::around(cuts.outlines.concat(), title, &subtitle, false);
    panels(&mut page.sketch, sheet);
    windows(&mut page.sketch, sheet);
    cut_lines(&mut page.sketch, cuts);
    ligaments(&mut page.sketch, sheet);
    page.finish()
}

fn panels(sketch: &mut Sketch, sheet: &Sheet) {
    let muted = Style::fill(MUTED).opacity(0.6, 1.0);
    for (k, panel) in sheet.panels.iter().enumerate() {
        let parity = usize::from(!sheet.topology.is_even(k));
        let fill = Style::fill(PANELS[parity]);
        sketch.canvas.polygon(&panel.boundary, fill);
        let height = f64::min(16.0 * sketch.unit, 0.1 * panel.area.sqrt());
        let [x, y] = panel.centroid;
        let at = [x, y - 0.35 * height];
        sketch.text(at, height, Anchor::Middle, muted, &format!("P{k}"));
    }
}

fn windows(sketch: &mut Sketch, sheet: &Sheet) {
    let style = Style::stroke(TEAL, 0.8 * sketch.unit).filled(TEAL).opacity(0.12, 0.45);
    for (hinge, window) in sheet.hinges.iter().zip(Window::of_sheet(sheet)) {
        for panel in [hinge.panel_a(), hinge.panel_b()] {
            let part = window.inside(&sheet.panels[panel]);
            part.contours().for_each(|contour| sketch.canvas.polygon(contour, style));
        }
    }
}

fn cut_lines(sketch: &mut Sketch, cuts: &CutLines) {
    let stroke = sketch.stroke(INK, 2.0);
    for slit in &cuts.slits {
        sketch.canvas.line(slit.ends[0], slit.ends[1], stroke);
    }
    cuts.outlines.iter().for_each(|outline| sketch.canvas.polygon(outline, stroke));
    let hole = Style::stroke(INK, 0.9 * sketch.unit).filled([255; 3]);
    for drilled in &cuts.holes {
        sketch.canvas.circle(drilled.centre, drilled.radius, hole);
    }
    let mark = sketch.stroke(ACCENT, 3.2);
    for attachment in &cuts.attachments {
        let radius = attachment.hole.map_or(3.0 * sketch.unit, |hole| 0.5 * hole);
        sketch.canvas.circle(attachment.at, radius, hole);
        if let Some([from, to]) = attachment.clip {
            sketch.canvas.line(from, to, mark);
        }
    }
}

fn ligaments(sketch: &mut Sketch, sheet: &Sheet) {
    let stroke = sketch.stroke(ACCENT, 3.2);
    let ink = sketch.haloed(TEAL).bold();
    for (number, (hinge, window)) in sheet.hinges.iter().zip(Window::of_sheet(sheet)).enumerate() {
        sketch.canvas.line(hinge.tip, window.foot, stroke);
        let height = f64::min(15.0 * sketch.unit, 0.3 * window.radius);
        let [x, y] = number_place(hinge, &window, 0.55 * window.radius);
        let at = [x, y - 0.35 * height];
        sketch.text(at, height, Anchor::Middle, ink, &number.to_string());
    }
}

/// The middle of the number of a hinge, on panel B next to the main cut, at the distance `reach`
/// from the hinge (mm).
fn number_place(hinge: &Hinge, window: &Window, reach: f64) -> [f64; 2] {
    let along = hinge.alpha / 2.0;
    window.point(reach * along.cos(), -reach * along.sin())
}
