//! Charts of the set of designs that reach one shape.

use anyhow::Result;
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// The data of the charts.
pub struct SolutionChart<'a> {
    /// Starts, and the solutions of each family, in the plane of the principal components.
    pub starts: &'a [[f64; 2]],
    pub families: &'a [Vec<[f64; 2]>],
    /// Eigenvalues of the Hessian relative to the largest, and the value below which they are negligible.
    pub curvatures: &'a [f64],
    pub negligible: f64,
    /// Outline error (%) against the step, one line per family: its median run.
    pub errors: &'a [Vec<f64>],
}

/// The solution set in three charts.
pub fn solutions(chart: &SolutionChart) -> Result<String> {
    drawn((1320, 420), |root| {
        let areas = root.split_evenly((1, 3));
        plane_chart(&areas[0], chart)?;
        curvature_chart(&areas[1], chart)?;
        error_chart(&areas[2], chart.errors)
    })
}

fn plane_chart(area: &Area, chart: &SolutionChart) -> ChartResult {
    let all = || chart.starts.iter().chain(chart.families.iter().flatten());
    let mut context = ChartBuilder::on(area)
        .caption("starts (grey) and solutions by family", (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(padded(all().map(|p| p[0])), padded(all().map(|p| p[1])))?;
    context
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("first principal component")
        .y_desc("second principal component")
        .draw()?;
    let dot =
        |p: &[f64; 2], colour: RGBColor| Circle::new((p[0], p[1]), 3, colour.mix(0.7).filled());
    context.draw_series(chart.starts.iter().map(|p| dot(p, GUIDE)))?;
    for (i, family) in chart.families.iter().enumerate() {
        let colour = SLICES[i % SLICES.len()];
        context.draw_series(family.iter().map(|p| dot(p, colour)))?;
    }
    Ok(())
}

fn curvature_chart(area: &Area, chart: &SolutionChart) -> ChartResult {
    /// Smaller ratios are drawn at this value.
    const MIN_RATIO: f64 = 1e-14;
    let points: Vec<_> = (chart.curvatures.iter().enumerate())
        .map(|(k, ratio)| (k as f64 + 1.0, ratio.abs().max(MIN_RATIO)))
        .collect();
    let across = 0.0..points.len() as f64 + 1.0;
    let mut context = ChartBuilder::on(area)
        .caption("curvature of the shape term", (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(64)
        .build_cartesian_2d(
            across.clone(),
            decades(points.iter().map(|p| p.1)).log_scale(),
        )?;
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
    context.draw_series(points.iter().map(|p| Circle::new(*p, 3, POINT.filled())))?;
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
