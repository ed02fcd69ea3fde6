//! Charts of tensile tests, trainings and replays as SVG: common helpers; one file per kind of
//! chart.

pub mod axes;
mod learning_curve;
#[cfg(feature = "pipeline")]
mod parity;
mod tensile_test;

pub use learning_curve::learning_curve;
#[cfg(feature = "pipeline")]
pub use parity::parity;
pub use tensile_test::tensile_test;

use anyhow::{Result, anyhow};
use plotters::{chart::SeriesLabelPosition, coord::Shift, prelude::*};
use std::ops::Range;

/// Colour of the first curve and of points.
pub const POINT: RGBColor = RGBColor(31, 110, 140);
/// Colour of the second curve, such as the validation error.
pub const VALIDATION: RGBColor = RGBColor(217, 95, 2);
/// Colours of the curves of one chart, in order.
pub const COLOURS: [RGBColor; 7] = [
    POINT,
    VALIDATION,
    RGBColor(117, 112, 179),
    RGBColor(102, 166, 30),
    RGBColor(166, 118, 29),
    RGBColor(231, 41, 138),
    RGBColor(0, 0, 0),
];
/// Colour of guide lines.
pub const GUIDE: RGBColor = RGBColor(120, 120, 120);
/// Font of all texts.
pub const FONT: &str = "DejaVu Sans";

/// A part of the drawing area.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// The result of drawing.
pub type ChartResult =
    Result<(), DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>>;

/// A chart of the given size on a white background, as SVG.
pub fn drawn(size: (u32, u32), draw: impl FnOnce(&Area) -> ChartResult) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let whole = || -> ChartResult {
            root.fill(&WHITE)?;
            draw(&root)?;
            root.present()
        };
        whole().map_err(|error| anyhow!("cannot draw the chart: {error}"))?;
    }
    Ok(svg)
}

/// The range of the values with a margin of 5 % at both ends.
pub fn padded(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (min, max) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), v| (l.min(v), g.max(v)));
    if min > max {
        return 0.0..1.0;
    }
    let margin = 0.05 * (max - min).max(1e-12);
    min - margin..max + margin
}
