//! What the charts share: two axes, curves and marks, and the box with their names.

use super::{Area, ChartResult, FONT, GUIDE};
use plotters::{
    chart::SeriesLabelPosition,
    coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter},
    prelude::*,
};
use std::collections::HashSet;

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

/// How points are drawn; sizes in px.
#[derive(Clone, Copy)]
pub enum Look {
    /// A line through them.
    Line,
    /// A dashed line through them.
    Dashed,
    /// A circle of this radius at each.
    Circles(i32),
    /// A cross of this size at each.
    Crosses(i32),
    /// The name of the series at each, in a font of this size.
    Text(i32),
}

/// A curve or marks of a chart.
pub struct Series {
    name: String,
    points: Vec<(f64, f64)>,
    look: Look,
    style: ShapeStyle,
}

/// A curve or marks. In the box with the names is the first series of every name that is not empty.
pub fn series(
    name: impl Into<String>,
    points: impl IntoIterator<Item = (f64, f64)>,
    look: Look,
    style: impl Into<ShapeStyle>,
) -> Series {
    let points = points.into_iter().collect();
    Series { name: name.into(), points, look, style: style.into() }
}

/// Draws a chart with a caption, and at a position the box with the names of its series.
pub fn chart<X, Y>(
    area: &Area,
    caption: &str,
    (across, up): (Axis<X>, Axis<Y>),
    all: Vec<Series>,
    box_with_names: SeriesLabelPosition,
) -> ChartResult
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut chart = ChartBuilder::on(area)
        .caption(caption, (FONT, 15))
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
    let mut named = HashSet::from([String::new()]);
    for Series { name, points, look, style } in all {
        let each = points.iter().copied();
        let drawn = match look {
            Look::Line => chart.draw_series(LineSeries::new(points, style)),
            Look::Dashed => chart.draw_series(DashedLineSeries::new(points, 6, 4, style)),
            Look::Circles(size) => chart.draw_series(each.map(|at| Circle::new(at, size, style))),
            Look::Crosses(size) => chart.draw_series(each.map(|at| Cross::new(at, size, style))),
            Look::Text(size) => {
                let text = |at| Text::new(name.clone(), at, (FONT, size).into_font());
                chart.draw_series(each.map(text))?;
                continue;
            }
        }?;
        if named.insert(name.clone()) {
            drawn.label(name).legend(move |(x, y)| match look {
                Look::Circles(size) => Circle::new((x + 9, y), size, style).into_dyn(),
                Look::Crosses(size) => Cross::new((x + 9, y), size, style).into_dyn(),
                _ => PathElement::new([(x, y), (x + 16, y)], style).into_dyn(),
            });
        }
    }
    if named.len() == 1 {
        return Ok(());
    }
    chart
        .configure_series_labels()
        .position(box_with_names)
        .label_font((FONT, 12))
        .border_style(GUIDE)
        .background_style(WHITE.mix(0.85))
        .draw()
}
