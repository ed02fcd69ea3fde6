//! Chart of the levels of a scene: seconds of a search against the difference to the finest level.

use super::{
    axes::{Axis, Look, chart, series},
    *,
};
use analysis::{error_budget::ErrorCause, levels::Levels};

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
    let seconds = Axis::powers(across.clone().log_scale(), "seconds of a search");
    let corners = Axis::powers(up.clone().log_scale(), "largest difference of a panel corner, mm");
    let band = of(ErrorCause::WindowMesh).map(|mesh| {
        let corners = [(across.start, up.start), (across.end, mesh)];
        let name = "below: not known better, mesh of the windows";
        series(name, corners, Look::Band, GUIDE.mix(0.25).filled())
    });
    let lines = LINES.into_iter().filter_map(|(cause, colour)| {
        let corners = of(cause)?;
        let ends = [across.start, across.end].map(|seconds| (seconds, corners));
        Some(series(cause.name(), ends, Look::Line, colour.stroke_width(1)))
    });
    let places = points.iter().map(|point| (point.0, point.1));
    let dots = series("", places, Look::Circles(5), POINT.filled());
    let names = points.iter().map(|(seconds, corners, name)| {
        series(*name, [(1.12 * seconds, *corners)], Look::Text(13), BLACK)
    });
    let all = band.into_iter().chain(lines).chain([dots]).chain(names).collect();
    let names = SeriesLabelPosition::UpperRight;
    drawn(SIZE, |root| {
        chart(root, "Levels, and what no level lowers", (seconds, corners), all, names)
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
