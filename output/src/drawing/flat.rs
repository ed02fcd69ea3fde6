//! The flat pattern: panels, cuts, holes, ligaments with their windows, hinge numbers.

use crate::{
    cut_file::CutLines,
    display::{Anchor, Canvas, Style},
    drawing::page::{ACCENT, INK, MUTED, Page, TEAL, panel_colour, windows},
};
use design::sheet::{
    cut_sheet::{Hinge, Sheet},
    hinge_window::HingeWindow,
};
use support::Extremes;

/// The flat sheet with its cuts.
pub fn flat(title: &str, sheet: &Sheet, cuts: &CutLines) -> String {
    let widths = sheet.hinges.iter().map(|hinge| hinge.w_lig);
    let (min, max) = (widths.clone().smallest(), widths.largest());
    let subtitle = format!(
        "Flat cut pattern: {} \u{d7} {} panels, {} hinges, ligaments {min:.1} to {max:.1} mm",
        sheet.topology.grid.m,
        sheet.topology.grid.n,
        sheet.hinges.len()
    );
    let mut page = Page::around(cuts.outlines.concat(), title, &subtitle, false);
    panels(&mut page.canvas, sheet);
    let style = Style::stroke(TEAL, 0.8 * page.canvas.unit).filled(TEAL).opacity(0.12, 0.45);
    windows(&mut page.canvas, sheet, |_| style, |_, point| point);
    cut_lines(&mut page.canvas, cuts);
    ligaments(&mut page.canvas, sheet);
    page.finish()
}

fn panels(canvas: &mut Canvas, sheet: &Sheet) {
    let muted = Style::fill(MUTED).opacity(0.6, 1.0);
    for (k, panel) in sheet.panels.iter().enumerate() {
        let fill = Style::fill(panel_colour(&sheet.topology, k));
        canvas.polygon(&panel.boundary, fill);
        let height = f64::min(16.0 * canvas.unit, 0.1 * panel.area.sqrt());
        let [x, y] = panel.centroid;
        let at = [x, y - 0.35 * height];
        canvas.text(at, height, Anchor::Middle, muted, &format!("P{k}"));
    }
}

fn cut_lines(canvas: &mut Canvas, cuts: &CutLines) {
    let stroke = canvas.stroke(INK, 2.0);
    for slit in &cuts.slits {
        canvas.line(slit.ends[0], slit.ends[1], stroke);
    }
    cuts.outlines.iter().for_each(|outline| canvas.polygon(outline, stroke));
    let hole = Style::stroke(INK, 0.9 * canvas.unit).filled([255; 3]);
    for drilled in &cuts.holes {
        canvas.circle(drilled.centre, drilled.radius, hole);
    }
    let mark = canvas.stroke(ACCENT, 3.2);
    for attachment in &cuts.attachments {
        let radius = attachment.hole.map_or(3.0 * canvas.unit, |hole| 0.5 * hole);
        canvas.circle(attachment.at, radius, hole);
        if let Some([from, to]) = attachment.clip {
            canvas.line(from, to, mark);
        }
    }
}

fn ligaments(canvas: &mut Canvas, sheet: &Sheet) {
    let stroke = canvas.stroke(ACCENT, 3.2);
    let ink = canvas.haloed(TEAL).bold();
    for (number, (hinge, window)) in
        sheet.hinges.iter().zip(HingeWindow::of_sheet(sheet)).enumerate()
    {
        canvas.line(hinge.tip, window.foot, stroke);
        let height = f64::min(15.0 * canvas.unit, 0.3 * window.radius);
        let [x, y] = number_place(hinge, &window, 0.55 * window.radius);
        let at = [x, y - 0.35 * height];
        canvas.text(at, height, Anchor::Middle, ink, &number.to_string());
    }
}

/// The middle of the number of a hinge, on panel B next to the main cut, at the distance `reach`
/// from the hinge (mm).
fn number_place(hinge: &Hinge, window: &HingeWindow, reach: f64) -> [f64; 2] {
    let along = hinge.alpha / 2.0;
    window.point(reach * along.cos(), -reach * along.sin())
}
