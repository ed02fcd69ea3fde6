//! Charts with two logarithmic axes.

use kirigami::ui::charts::{Area, ChartError, FONT};
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use std::ops::Range;

/// A chart with two logarithmic axes.
pub type LogLog<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// An empty chart whose axes have the given ranges and names.
pub fn log_log<'a>(
    area: &Area<'a>,
    title: &str,
    across: (Range<f64>, &str),
    up: (Range<f64>, &str),
) -> Result<LogLog<'a>, ChartError> {
    let mut chart = ChartBuilder::on(area)
        .caption(title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(64)
        .build_cartesian_2d(across.0.log_scale(), up.0.log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .x_desc(across.1)
        .y_desc(up.1)
        .draw()?;
    Ok(chart)
}
