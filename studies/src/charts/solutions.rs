//! Charts of the set of designs that reach one shape.

use super::contours::{PlaneValues, contours};
use anyhow::Result;
use kirigami::ui::charts::axes::{Axis, axes, line, marks};
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
    let mut context = axes(
        area,
        "curvature (orange: negative)",
        Axis::new(across.clone(), "direction"),
        Axis::powers(
            (MIN_RATIO / 10.0..10.0).log_scale(),
            "|eigenvalue| / largest",
        ),
    )?;
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
    let mut context = axes(
        area,
        "minimum at a fixed opening",
        Axis::new(padded(points().map(|p| p.0)), "opening, deg"),
        Axis::new(
            padded(points().map(|p| p.1)),
            "root of the loss, % of the side",
        ),
    )?;
    line(&mut context, "", points(), POINT.stroke_width(2))?;
    marks(&mut context, points(), 3, POINT)
}

fn error_chart(area: &Area, errors: &[Vec<f64>]) -> ChartResult {
    let longest = errors.iter().map(Vec::len).max().unwrap_or(1).max(2);
    let positive = errors
        .iter()
        .flatten()
        .copied()
        .filter(|error| *error > 0.0);
    let mut context = axes(
        area,
        "outline error of each family's median run",
        Axis::new(0.0..longest as f64, "step"),
        Axis::new(
            decades(positive).log_scale(),
            "outline error, % of the side",
        ),
    )?;
    for (errors, colour) in errors.iter().zip(SLICES.into_iter().cycle()) {
        let points = (0..).map(f64::from).zip(errors.iter().copied());
        line(&mut context, "", points, colour.stroke_width(2))?;
    }
    Ok(())
}
