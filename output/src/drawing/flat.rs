//! The flat pattern: panels, cuts, holes, ligaments with their windows, hinge numbers.

use crate::canvas::Anchor;
use crate::cut_file::CutLines;
use crate::drawing::page::{ACCENT, INK, MUTED, PANELS, Page, TEAL};
use design::sheet::cut_sheet::{Hinge, Sheet};
use design::sheet::hinge_window::Window;
use design::sheet::topology::is_even;

/// The flat sheet with its cuts.
pub fn flat(title: &str, sheet: &Sheet, cuts: &CutLines) -> String {
    let widths = sheet.hinges.iter().map(|hinge| hinge.w_lig);
    let (min, max) = (
        widths.clone().fold(f64::INFINITY, f64::min),
        widths.fold(0.0, f64::max),
    );
    let subtitle = format!(
        "Flat cut pattern: {} \u{d7} {} panels, {} hinges, ligaments {min:.1} to {max:.1} mm",
        sheet.grid.m,
        sheet.grid.n,
        sheet.hinges.len()
    );
    let mut page = Page::around(sheet.outline.corners, title, &subtitle, false);
    panels(&mut page, sheet);
    windows(&mut page, sheet);
    cut_lines(&mut page, cuts);
    ligaments(&mut page, sheet);
    page.finish()
}

fn panels(page: &mut Page, sheet: &Sheet) {
    let muted = format!("fill=\"{MUTED}\" fill-opacity=\"0.6\"");
    for (k, panel) in sheet.panels.iter().enumerate() {
        let parity = usize::from(!is_even(sheet.grid, k));
        let fill = format!("fill=\"{}\"", PANELS[parity]);
        page.canvas.polygon(&panel.corners, &fill);
        let height = f64::min(16.0 * page.unit, 0.1 * panel.area().sqrt());
        let [x, y] = panel.centroid;
        let at = [x, y - 0.35 * height];
        page.canvas
            .text(at, height, Anchor::Middle, &muted, &format!("P{k}"));
    }
}

fn windows(page: &mut Page, sheet: &Sheet) {
    let style = format!(
        "fill=\"{TEAL}\" fill-opacity=\"0.12\" stroke=\"{TEAL}\" stroke-opacity=\"0.45\" \
         stroke-width=\"{:.4}\"",
        0.8 * page.unit
    );
    for (hinge, window) in sheet.hinges.iter().zip(Window::of_sheet(sheet)) {
        for panel in [hinge.panel_a(), hinge.panel_b()] {
            page.canvas
                .polygon(&window.inside(&sheet.panels[panel]), &style);
        }
    }
}

fn cut_lines(page: &mut Page, cuts: &CutLines) {
    let stroke = page.stroke(INK, 2.0);
    for slit in &cuts.slits {
        page.canvas.line(slit.ends[0], slit.ends[1], &stroke);
    }
    page.canvas.polygon(&cuts.outline, &stroke);
    let hole = format!(
        "fill=\"#ffffff\" stroke=\"{INK}\" stroke-width=\"{:.4}\"",
        0.9 * page.unit
    );
    for drilled in &cuts.holes {
        page.canvas.circle(drilled.centre, drilled.radius, &hole);
    }
}

fn ligaments(page: &mut Page, sheet: &Sheet) {
    let stroke = page.stroke(ACCENT, 3.2);
    let ink = format!("{} font-weight=\"bold\"", page.haloed(TEAL));
    for (number, (hinge, window)) in sheet.hinges.iter().zip(Window::of_sheet(sheet)).enumerate() {
        page.canvas.line(hinge.tip, window.foot, &stroke);
        let height = f64::min(15.0 * page.unit, 0.3 * window.radius);
        let [x, y] = number_place(hinge, &window, 0.55 * window.radius);
        let at = [x, y - 0.35 * height];
        page.canvas
            .text(at, height, Anchor::Middle, &ink, &number.to_string());
    }
}

/// The middle of the number of a hinge, on panel B beside the main cut, at the distance `reach` from the hinge (mm).
pub(crate) fn number_place(hinge: &Hinge, window: &Window, reach: f64) -> [f64; 2] {
    let along = hinge.alpha / 2.0;
    window.point(reach * along.cos(), -reach * along.sin())
}
