//! Chart of the levels of a scene: seconds of a search against the difference to the finest level.

use super::axes::{Axis, axes, names};
use super::*;
use analysis::error_budget::ErrorCause;
use analysis::levels::Levels;

/// Size of the chart (px).
const SIZE: (u32, u32) = (640, 460);
/// What the axes reach beyond the first and the last value, as a factor.
const MARGIN: f64 = 3.0;
/// Causes of errors that no level lowers, with a line each, and their colours.
const LINES: [(ErrorCause, RGBColor); 4] = [
    (ErrorCause::MaterialLaw, COLOURS[2]),
    (ErrorCause::LoadingPath, COLOURS[5]),
    (ErrorCause::Kerf, COLOURS[3]),
    (ErrorCause::Thickness, COLOURS[4]),
];

/// One point for every level but the finest, a grey band up to the error of the mesh, and lines for
/// what no level lowers.
pub fn levels(found: &Levels) -> Result<String> {
    let points: Vec<(f64, f64, &str)> = (found.levels.iter())
        .filter_map(|level| {
            let corners = level.difference.as_ref()?.corners[1];
            Some((level.search?, corners, level.level.name()))
        })
        .filter(|(seconds, corners, _)| *seconds > 0.0 && *corners > 0.0)
        .collect();
    let of = |cause: ErrorCause| {
        let part = found.others.iter().find(|part| part.cause == cause)?;
        Some(part.effect.as_ref()?.corners[1]).filter(|corners| *corners > 0.0)
    };
    let others = LINES.into_iter().filter_map(|(cause, _)| of(cause));
    let heights = points.iter().map(|point| point.1);
    let heights = heights.chain(others).chain(of(ErrorCause::WindowMesh));
    let across = around(points.iter().map(|point| point.0));
    let up = around(heights);
    drawn(SIZE, |root| {
        let seconds = Axis::powers(across.clone().log_scale(), "seconds of a search");
        let corners =
            Axis::powers(up.clone().log_scale(), "largest difference of a panel corner, mm");
        let mut chart = axes(root, "Levels, and what no level lowers", seconds, corners)?;
        if let Some(mesh) = of(ErrorCause::WindowMesh) {
            let band = [(across.start, up.start), (across.end, mesh)];
            chart
                .draw_series([Rectangle::new(band, GUIDE.mix(0.25).filled())])?
                .label("below: not known better, mesh of the windows")
                .legend(|(x, y)| {
                    Rectangle::new([(x, y - 5), (x + 18, y + 5)], GUIDE.mix(0.25).filled())
                });
        }
        for (cause, colour) in LINES {
            if let Some(corners) = of(cause) {
                let ends = [across.start, across.end].map(|seconds| (seconds, corners));
                axes::line(&mut chart, cause.name(), ends, colour.stroke_width(1))?;
            }
        }
        chart.draw_series(
            (points.iter()).map(|point| Circle::new((point.0, point.1), 5, POINT.filled())),
        )?;
        chart.draw_series(points.iter().map(|(seconds, corners, name)| {
            Text::new((*name).to_owned(), (1.12 * seconds, *corners), (FONT, 13).into_font())
        }))?;
        names(&mut chart, SeriesLabelPosition::UpperRight)
    })
}

/// The range of positive values on a logarithmic axis.
fn around(values: impl Iterator<Item = f64>) -> Range<f64> {
    let ends = values.fold(None, |ends: Option<(f64, f64)>, value| {
        let (least, most) = ends.unwrap_or((value, value));
        Some((least.min(value), most.max(value)))
    });
    let (least, most) = ends.unwrap_or((0.1, 1.0));
    least / MARGIN..most * MARGIN
}
