//! Chart of the Taylor remainders of a gradient.

use anyhow::Result;
use kirigami::ui::charts::axes::{Axis, axes, line, names};
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// One line of [`taylor`]: remainders relative to the loss, against the step.
pub struct TaylorLine<'a> {
    pub name: &'a str,
    pub points: Vec<(f64, f64)>,
}

/// Taylor remainders on logarithmic axes, with reference lines of slope 1 and 2.
pub fn taylor(lines: &[TaylorLine]) -> Result<String> {
    drawn((640, 480), |root| taylor_chart(root, lines))
}

fn taylor_chart(area: &Area, lines: &[TaylorLine]) -> ChartResult {
    let positive = |line: &TaylorLine| {
        let points = line.points.iter().copied();
        points.filter(|point| point.1 > 0.0).collect::<Vec<_>>()
    };
    let points: Vec<_> = lines.iter().flat_map(positive).collect();
    let across = decades(points.iter().map(|p| p.0));
    let up = decades(points.iter().map(|p| p.1));
    let mut chart = axes(
        area,
        "Taylor remainders",
        Axis::powers(across.clone().log_scale(), "step h"),
        Axis::powers(up.clone().log_scale(), "Taylor remainder / loss"),
    )?;
    for (order, name) in [(1, "order 1"), (2, "order 2")] {
        // Through the upper right corner, as far as it is visible.
        let at = |x: f64| up.end * (x / across.end).powi(order);
        let first = across.end * (up.start / up.end).powf(1.0 / f64::from(order));
        let ends = [first.max(across.start), across.end].map(|x| (x, at(x)));
        let dash = 2 * order as u32;
        chart
            .draw_series(DashedLineSeries::new(ends, dash, 4, GUIDE.into()))?
            .label(name)
            .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], GUIDE));
    }
    for (remainders, colour) in lines.iter().zip(SLICES.into_iter().cycle()) {
        let points = positive(remainders);
        line(&mut chart, remainders.name, points, colour.stroke_width(2))?;
    }
    names(&mut chart, SeriesLabelPosition::LowerRight)
}
