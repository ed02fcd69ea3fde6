//! Charts of the paths of a sheet's hinges in the plane of (eta_a, eta_s).

use anyhow::Result;
use kirigami::ui::charts::*;
use plotters::prelude::*;
use std::ops::Range;

/// The hinges of one design.
pub struct PathPanel<'a> {
    pub title: String,
    /// States (eta_a, eta_s) of each hinge, from the first load step on.
    pub paths: Vec<Vec<[f64; 2]>>,
    /// The hinge that is drawn with a thick line.
    pub monitored: usize,
    /// The boundary of the training domain at the monitored hinge's width and final rotation.
    pub domain: Vec<[f64; 2]>,
    /// The damage in the background, in any unit.
    pub damage: Box<dyn Fn([f64; 2]) -> f64 + 'a>,
}

/// Number of background cells along each axis.
const CELLS: usize = 60;

/// The panels, two in a row, with the same range and damage scale.
pub fn hinge_paths(panels: &[PathPanel]) -> Result<String> {
    let points = || panels.iter().flat_map(|it| it.paths.iter().flatten());
    let within = |k: usize| points().map(move |point| point[k]).chain([0.0]);
    let (across, up) = (padded(within(0)), padded(within(1)));
    let centres = |range: &Range<f64>| -> Vec<f64> {
        let step = (range.end - range.start) / CELLS as f64;
        let centre = |k: usize| range.start + (k as f64 + 0.5) * step;
        (0..CELLS).map(centre).collect()
    };
    let (columns, lines) = (centres(&across), centres(&up));
    let planes: Vec<Vec<f64>> = panels
        .iter()
        .map(|panel| {
            let line = |y: &f64| columns.iter().map(|x| (panel.damage)([*x, *y])).collect();
            lines.iter().flat_map(|y| -> Vec<f64> { line(y) }).collect()
        })
        .collect();
    let most = planes.iter().flatten().copied().fold(1e-12, f64::max);
    let rows = panels.len().div_ceil(2).max(1);
    drawn((1080, 420 * rows as u32), |root| {
        let areas = root.split_evenly((rows, 2));
        for ((area, panel), plane) in areas.iter().zip(panels).zip(&planes) {
            let shades = plane.iter().map(|value| value / most).collect();
            path_chart(area, panel, [across.clone(), up.clone()], shades)?;
        }
        Ok(())
    })
}

fn path_chart(
    area: &Area,
    panel: &PathPanel,
    [across, up]: [Range<f64>; 2],
    shades: Vec<f64>,
) -> ChartResult {
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(across.clone(), up.clone())?;
    let steps = [&across, &up].map(|range| (range.end - range.start) / CELLS as f64);
    chart.draw_series(shades.iter().enumerate().map(|(cell, shade)| {
        let (i, j) = ((cell % CELLS) as f64, (cell / CELLS) as f64);
        let (x, y) = (across.start + i * steps[0], up.start + j * steps[1]);
        // Cells are opaque and slightly enlarged, so that no seams are visible.
        let corner = (x + 1.1 * steps[0], y + 1.1 * steps[1]);
        Rectangle::new([(x, y), corner], tint(0.75 * shade.sqrt()).filled())
    }))?;
    chart
        .configure_mesh()
        .disable_mesh()
        .label_style((FONT, 12))
        .x_desc("eta_a = a / w_lig")
        .y_desc("eta_s = s / w_lig")
        .draw()?;
    let inside = |value: f64, range: &Range<f64>| value.clamp(range.start, range.end);
    let edge = panel.domain.iter();
    let edge = edge.map(|[x, y]| (inside(*x, &across), inside(*y, &up)));
    chart.draw_series(LineSeries::new(edge, GUIDE))?;
    for (hinge, path) in panel.paths.iter().enumerate() {
        let width = if hinge == panel.monitored { 3 } else { 1 };
        let points = std::iter::once((0.0, 0.0)).chain(path.iter().map(|[x, y]| (*x, *y)));
        chart.draw_series(LineSeries::new(points, POINT.stroke_width(width)))?;
        let ends = path.last().map(|[x, y]| (*x, *y));
        chart.draw_series(
            ends.into_iter()
                .map(|end| Circle::new(end, 3, POINT.filled())),
        )?;
    }
    Ok(())
}

/// A colour between white and that of damage.
fn tint(fraction: f64) -> RGBColor {
    let mix = |channel: u8| (255.0 + fraction * (f64::from(channel) - 255.0)).round() as u8;
    RGBColor(mix(VALIDATION.0), mix(VALIDATION.1), mix(VALIDATION.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_hinge_has_an_end() {
        let panel = PathPanel {
            title: "shape alone".into(),
            paths: vec![vec![[-0.1, 0.1], [-0.2, 0.1]], vec![[0.05, -0.1]]],
            monitored: 0,
            domain: vec![[-0.8, -0.4], [0.25, 0.4], [-0.8, 0.4], [-0.8, -0.4]],
            damage: Box::new(|[x, y]| x * x + y * y),
        };
        let svg = hinge_paths(&[panel]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(hinge_paths(&[]).is_ok());
    }
}
