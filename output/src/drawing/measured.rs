//! A measured sheet and its prediction, after Fig. 10 (d)-(h) of the paper: outlines superposed
//! with magnified residuals, hinge openings measured against predicted, errors of the panel centres
//! against the floor.

use crate::{
    display::{Anchor, Canvas, Style},
    drawing::{
        chart::Chart,
        page::{self, ACCENT, INK, MUTED, Page, TEAL},
    },
    measurement::MeasurementReport,
};
use analysis::{measured_openings::MeasuredOpening, measured_points::FittedPoint, path_fit::Fit};
use design::{
    geometry::polygon::{bounds, size},
    sheet::{cut_sheet::Sheet, kinematics::deployed_boundaries},
};
use support::{Extremes, Point};

/// Magnifications of the residuals.
const MAGNIFICATIONS: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
/// The longest magnified residual, in panel sizes.
const LONGEST: f64 = 0.5;
/// Number of panels up to which every bar has its number.
const NUMBERED: usize = 16;

/// The picture of a report; `fit` is its best state.
pub fn measured(sheet: &Sheet, fit: &Fit, report: &MeasurementReport) -> String {
    let panels = deployed_boundaries(sheet, &fit.shape.configuration);
    let area: f64 = sheet.panels.iter().map(|panel| panel.area).sum();
    let panel_size = (area / sheet.panels.len() as f64).sqrt();
    let factor = magnification(fit, panel_size);
    let residuals_drawn = fit.points.iter().map(|point| residual(point, factor)[1]);
    let [low, high] = bounds(panels.iter().flatten().copied().chain(residuals_drawn));
    let [width, height] = size([low, high]);
    // Both charts stand at the right of the sheet, one above the other.
    let side = f64::max(0.36 * width, 0.34 * height);
    let left = high[0] + 0.45 * side;
    let top = f64::max(high[1], low[1] + 2.7 * side);
    let whole = [low, [left + 1.1 * side, top]];

    let best = &report.best;
    let rms = best.corners.as_ref().or(best.centres.as_ref());
    let rms = rms.map_or(String::new(), |rms| {
        format!("; rms {:.2} mm, {:.2} % of the sheet", rms.rms, rms.rms_percent)
    });
    let state = match report.load_factor_error {
        Some(_) => format!("at load factor {:.3}", best.load_factor),
        None => "at a load factor that is not determined".to_owned(),
    };
    let subtitle = format!(
        "Measured (teal) on predicted (grey) {state}; residuals magnified {factor} times{rms}"
    );
    let mut page = Page::around(whole, &report.title, &subtitle, false);
    let canvas = &mut page.canvas;
    let line = canvas.stroke(MUTED, 1.2);
    page::panels(canvas, &sheet.topology, panels, line);
    outlines(canvas, sheet, fit);
    residuals(canvas, fit, factor, panel_size);
    openings(canvas, [[left, top - 1.05 * side], [left + side, top - 0.05 * side]], report);
    centres(canvas, [[left, top - 2.55 * side], [left + side, top - 1.55 * side]], report);
    page.finish()
}

/// The largest magnification at which no residual of the fit is longer than a part of a panel.
fn magnification(fit: &Fit, panel_size: f64) -> f64 {
    let longest = fit.points.iter().map(FittedPoint::distance).largest();
    let fits = |factor: &&f64| *factor * longest <= LONGEST * panel_size;
    *MAGNIFICATIONS.iter().rev().find(fits).unwrap_or(&1.0)
}

/// Draws the edges of the panels whose two corners are measured.
fn outlines(canvas: &mut Canvas, sheet: &Sheet, fit: &Fit) {
    let mut measured = vec![[None; 4]; sheet.panels.len()];
    for point in &fit.points {
        if let Some(corner) = point.mark.corner {
            measured[point.mark.panel][corner] = Some(point.measured);
        }
    }
    let stroke = canvas.stroke(TEAL, 1.2);
    for corners in measured {
        for corner in 0..4 {
            if let (Some(from), Some(to)) = (corners[corner], corners[(corner + 1) % 4]) {
                canvas.line(from, to, stroke);
            }
        }
    }
}

/// Draws a line from every predicted point along its residual.
fn residuals(canvas: &mut Canvas, fit: &Fit, factor: f64, panel_size: f64) {
    let (stroke, dot) = (canvas.stroke(ACCENT, 1.6), Style::fill(ACCENT));
    let size = f64::min(2.2 * canvas.unit, 0.03 * panel_size);
    for point in &fit.points {
        let [from, to] = residual(point, factor);
        canvas.line(from, to, stroke);
        canvas.circle(from, size, dot);
    }
}

/// The line along the magnified residual of a point, from its prediction.
fn residual(point: &FittedPoint, factor: f64) -> [Point; 2] {
    let ([x, y], [dx, dy]) = (point.predicted, point.residual());
    [[x, y], [x + factor * dx, y + factor * dy]]
}

/// Draws the openings measured against predicted, with two standard errors and the line of
/// agreement.
fn openings(canvas: &mut Canvas, corners: [Point; 2], report: &MeasurementReport) {
    let bar = |opening: &MeasuredOpening| {
        [-2.0, 2.0].map(|k| opening.measured_deg + k * opening.error_deg)
    };
    let values = report
        .openings
        .iter()
        .flat_map(|opening| [bar(opening)[0], bar(opening)[1], opening.predicted_deg]);
    let [low, high] =
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    if low > high {
        return;
    }
    let margin = f64::max(0.08 * (high - low), 0.2);
    let range = [low - margin, high + margin];
    let names = ["predicted opening (deg)", "measured opening (deg)"];
    let chart = Chart::new(canvas, corners, [range; 2], names, [true; 2]);
    let line = canvas.dashed(MUTED, 1.0, 4.0);
    canvas.line(chart.at([range[0]; 2]), chart.at([range[1]; 2]), line);
    let (stroke, dot) = (canvas.stroke(TEAL, 1.0), Style::fill(TEAL));
    // Many openings are drawn as small dots.
    let radius = if report.openings.len() > 100 { 1.6 } else { 3.0 } * canvas.unit;
    for opening in &report.openings {
        let predicted = opening.predicted_deg;
        let [from, to] = bar(opening).map(|measured| chart.at([predicted, measured]));
        canvas.line(from, to, stroke);
        canvas.circle(chart.at([predicted, opening.measured_deg]), radius, dot);
    }
}

/// Draws the error of every panel centre as a bar, and the floor of the measurement as a line.
fn centres(canvas: &mut Canvas, corners: [Point; 2], report: &MeasurementReport) {
    let panels = &report.panels;
    if panels.is_empty() {
        return;
    }
    let closed = report.closed.as_ref().and_then(|closed| closed.floor.centres.as_ref());
    let floor = closed.map(|centres| centres.rms);
    let highest = panels.iter().map(|panel| panel.distance()).chain(floor).fold(1e-6, f64::max);
    let ranges = [[0.0, panels.len() as f64], [0.0, 1.08 * highest]];
    let name = if floor.is_some() { "panel; floor dashed" } else { "panel" };
    let names = [name, "error of the panel centre (mm)"];
    let chart = Chart::new(canvas, corners, ranges, names, [panels.len() > NUMBERED, true]);
    let muted = Style::fill(MUTED);
    for (place, panel) in panels.iter().enumerate() {
        let above = floor.is_some_and(|floor| panel.distance() > floor);
        let fill = Style::fill(if above { ACCENT } else { TEAL });
        let [left, right] = [0.15, 0.85].map(|part| place as f64 + part);
        let top = panel.distance();
        let bar = [[left, 0.0], [right, 0.0], [right, top], [left, top]].map(|at| chart.at(at));
        canvas.polygon(&bar, fill);
        if panels.len() <= NUMBERED {
            let [x, y] = chart.at([place as f64 + 0.5, 0.0]);
            let below = [x, y - 16.0 * canvas.unit];
            let number = format!("P{}", panel.panel);
            // A number of three characters is about as wide as its font is high times two.
            let pitch = chart.at([1.0, 0.0])[0] - chart.at([0.0, 0.0])[0];
            let height = f64::min(11.0 * canvas.unit, 0.45 * pitch);
            canvas.text(below, height, Anchor::Middle, muted, &number);
        }
    }
    if let Some(floor) = floor {
        let line = canvas.dashed(INK, 1.2, 4.0);
        canvas.line(chart.at([0.0, floor]), chart.at([ranges[0][1], floor]), line);
    }
}
