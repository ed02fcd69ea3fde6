//! What the charts share: axes with names, named lines, the box with the names.

use super::{Area, ChartError, ChartResult, FONT, GUIDE};
use plotters::chart::SeriesLabelPosition;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

/// A chart with two axes.
pub type Chart<'a, X, Y> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>;

/// An axis: its range, linear or logarithmic, its name and the text of a tick.
pub struct Axis<'n, R> {
    /// From the first to the last value.
    pub range: R,
    /// Quantity and unit.
    pub name: &'n str,
    /// The text of a tick.
    pub tick: fn(&f64) -> String,
}

impl<'n, R> Axis<'n, R> {
    /// With ticks as the numbers are printed.
    pub fn new(range: R, name: &'n str) -> Self {
        let tick = |value: &f64| {
            // Sums of steps have rounding errors, which are not printed.
            let rounded = (1e6 * value).round() / 1e6;
            rounded.to_string()
        };
        Self { range, name, tick }
    }

    /// With ticks as powers of ten.
    pub fn powers(range: R, name: &'n str) -> Self {
        let tick = |value: &f64| format!("{value:.0e}");
        Self { range, name, tick }
    }
}

/// An empty chart with a caption, which may be empty.
pub fn axes<'a, X, Y>(
    area: &Area<'a>,
    caption: &str,
    across: Axis<X>,
    up: Axis<Y>,
) -> Result<Chart<'a, X::CoordDescType, Y::CoordDescType>, ChartError>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut builder = ChartBuilder::on(area);
    if !caption.is_empty() {
        builder.caption(caption, (FONT, 15));
    }
    let mut chart = builder
        .margin(10)
        .margin_right(24)
        .x_label_area_size(40)
        .y_label_area_size(62)
        .build_cartesian_2d(across.range, up.range)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_label_formatter(&across.tick)
        .y_label_formatter(&up.tick)
        .x_desc(across.name)
        .y_desc(up.name)
        .draw()?;
    Ok(chart)
}

/// A line with its name.
pub fn line<X, Y>(
    chart: &mut Chart<'_, X, Y>,
    name: &str,
    points: impl IntoIterator<Item = (f64, f64)>,
    style: impl Into<ShapeStyle>,
) -> ChartResult
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let style = style.into();
    chart
        .draw_series(LineSeries::new(points, style))?
        .label(name)
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], style));
    Ok(())
}

/// Filled circles.
pub fn marks<X, Y>(
    chart: &mut Chart<'_, X, Y>,
    points: impl IntoIterator<Item = (f64, f64)>,
    size: i32,
    colour: impl Into<RGBAColor>,
) -> ChartResult
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let colour = colour.into();
    let circle = |at| Circle::new(at, size, colour.filled());
    chart.draw_series(points.into_iter().map(circle))?;
    Ok(())
}

/// The box with the names of the lines.
pub fn names<X, Y>(chart: &mut Chart<'_, X, Y>, position: SeriesLabelPosition) -> ChartResult
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    chart
        .configure_series_labels()
        .position(position)
        .label_font((FONT, 12))
        .border_style(GUIDE)
        .background_style(WHITE.mix(0.85))
        .draw()
}
