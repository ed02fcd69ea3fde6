//! Chart of the Taylor remainders of a gradient.

use super::log_log::log_log;
use anyhow::Result;
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
    let points = || {
        lines
            .iter()
            .flat_map(|line| &line.points)
            .filter(|p| p.1 > 0.0)
    };
    let across = decades(points().map(|p| p.0));
    let up = decades(points().map(|p| p.1));
    let mut chart = log_log(
        area,
        "Taylor remainders",
        (across.clone(), "step h"),
        (up.clone(), "Taylor remainder / loss"),
    )?;
    for (order, name) in [(1, "order 1"), (2, "order 2")] {
        // Through the upper right corner, as far as it is visible.
        let at = |x: f64| up.end * (x / across.end).powi(order);
        let first = across.end * (up.start / up.end).powf(1.0 / f64::from(order));
        let ends = [first.max(across.start), across.end].map(|x| (x, at(x)));
        chart
            .draw_series(DashedLineSeries::new(
                ends,
                2 * order as u32,
                4,
                GUIDE.into(),
            ))?
            .label(name)
            .legend(|(x, y)| PathElement::new([(x, y), (x + 14, y)], GUIDE));
    }
    for (i, line) in lines.iter().enumerate() {
        let colour = SLICES[i % SLICES.len()];
        let marks = line.points.iter().filter(|p| p.1 > 0.0);
        chart
            .draw_series(LineSeries::new(marks.copied(), colour.stroke_width(2)))?
            .label(line.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .label_font((FONT, 12))
        .border_style(GUIDE)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    Ok(())
}
