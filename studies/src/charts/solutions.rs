//! Charts of the set of designs that reach one shape.

use super::contours::{PlaneValues, contours};
use anyhow::Result;
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// The data of one row of charts.
pub struct SolutionChart<'a> {
    /// The outline corners compared with the target.
    pub name: &'a str,
    /// Starts, and the solutions of each family, in the plane of the principal components.
    pub starts: Vec<[f64; 2]>,
    pub families: Vec<Vec<[f64; 2]>>,
    /// Root of the loss on this plane, relative to the sheet's side.
    pub losses: &'a PlaneValues,
    /// Eigenvalues of the Hessian relative to the largest, in descending order.
    pub spectrum: &'a [f64],
    /// The ratio below which they are negligible.
    pub negligible: f64,
    /// Opening (deg) and root of the minimum loss, relative to the sheet's side.
    pub profile: &'a [[f64; 2]],
    /// Outline error (%) against the step, one line per family: its median run.
    pub errors: Vec<Vec<f64>>,
}

/// The solution sets, one row of charts each.
pub fn solutions(rows: &[SolutionChart]) -> Result<String> {
    drawn((1720, 420 * rows.len() as u32), |root| {
        for (area, chart) in root.split_evenly((rows.len(), 1)).iter().zip(rows) {
            let areas = area.split_evenly((1, 4));
            plane_chart(&areas[0], chart)?;
            curvature_chart(&areas[1], chart)?;
            profile_chart(&areas[2], chart)?;
            error_chart(&areas[3], &chart.errors)?;
        }
        Ok(())
    })
}

fn plane_chart(area: &Area, chart: &SolutionChart) -> ChartResult {
    /// Values of the contours, in % of the side.
    const LEVELS: [f64; 16] = [
        3.6, 3.8, 4.0, 4.25, 4.5, 4.75, 5.0, 5.5, 6.0, 6.5, 7.0, 8.0, 9.0, 10.0, 12.0, 15.0,
    ];
    let axes = &chart.losses.axes;
    let range = |axis: &[f64]| axis[0]..axis[axis.len() - 1];
    let caption = format!("{} corners: starts (black) and solutions", chart.name);
    let mut context = ChartBuilder::on(area)
        .caption(caption, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(range(&axes[0]), range(&axes[1]))?;
    context
        .configure_mesh()
        .disable_mesh()
        .label_style((FONT, 12))
        .x_desc("first principal component")
        .y_desc("second principal component")
        .draw()?;
    for level in LEVELS {
        let lines = contours(chart.losses, 0.01 * level).into_iter();
        context.draw_series(lines.map(|line| {
            let points = line.map(|[x, y]| (x, y));
            PathElement::new(points.to_vec(), GUIDE.mix(0.6))
        }))?;
    }
    let dot =
        |p: &[f64; 2], colour: RGBColor| Circle::new((p[0], p[1]), 2, colour.mix(0.8).filled());
    context.draw_series(chart.starts.iter().map(|p| dot(p, BLACK)))?;
    for (i, family) in chart.families.iter().enumerate() {
        let colour = SLICES[i % SLICES.len()];
        context.draw_series(family.iter().map(|p| dot(p, colour)))?;
    }
    Ok(())
}

fn curvature_chart(area: &Area, chart: &SolutionChart) -> ChartResult {
    /// Smaller ratios are drawn at this value.
    const MIN_RATIO: f64 = 1e-14;
    let points: Vec<_> = (chart.spectrum.iter().enumerate())
        .map(|(k, ratio)| {
            (
                k as f64 + 1.0,
                ratio.abs().max(MIN_RATIO),
                *ratio < -chart.negligible,
            )
        })
        .collect();
    let across = 0.0..points.len() as f64 + 1.0;
    let mut context = ChartBuilder::on(area)
        .caption("curvature (orange: negative)", (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(64)
        .build_cartesian_2d(across.clone(), (MIN_RATIO / 10.0..10.0).log_scale())?;
    context
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .x_desc("direction")
        .y_desc("|eigenvalue| / largest")
        .draw()?;
    let limit = [across.start, across.end].map(|x| (x, chart.negligible));
    context.draw_series(DashedLineSeries::new(limit, 4, 4, GUIDE.into()))?;
    context.draw_series(points.iter().map(|&(k, ratio, negative)| {
        let colour = if negative { VALIDATION } else { POINT };
        Circle::new((k, ratio), 3, colour.filled())
    }))?;
    Ok(())
}

fn profile_chart(area: &Area, chart: &SolutionChart) -> ChartResult {
    let points = || chart.profile.iter().map(|[x, y]| (*x, 100.0 * y));
    let mut context = ChartBuilder::on(area)
        .caption("minimum at a fixed opening", (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(padded(points().map(|p| p.0)), padded(points().map(|p| p.1)))?;
    context
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("opening, deg")
        .y_desc("root of the loss, % of the side")
        .draw()?;
    context.draw_series(LineSeries::new(points(), POINT.stroke_width(2)))?;
    context.draw_series(points().map(|p| Circle::new(p, 3, POINT.filled())))?;
    Ok(())
}

fn error_chart(area: &Area, errors: &[Vec<f64>]) -> ChartResult {
    let longest = errors.iter().map(Vec::len).max().unwrap_or(1).max(2);
    let up = decades(
        errors
            .iter()
            .flatten()
            .copied()
            .filter(|error| *error > 0.0),
    );
    let mut context = ChartBuilder::on(area)
        .caption("outline error of each family's median run", (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..longest as f64, up.log_scale())?;
    context
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("step")
        .y_desc("outline error, % of the side")
        .draw()?;
    for (i, line) in errors.iter().enumerate() {
        let points = line
            .iter()
            .enumerate()
            .map(|(step, error)| (step as f64, *error));
        let colour = SLICES[i % SLICES.len()].stroke_width(2);
        context.draw_series(LineSeries::new(points, colour))?;
    }
    Ok(())
}
