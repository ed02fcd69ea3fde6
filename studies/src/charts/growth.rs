//! The cost of paths against the number of panels.

use anyhow::Result;
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// The cost of a path.
pub struct PathCost {
    pub panels: usize,
    /// CPU time of the path, and of path and gradient (s).
    pub path: f64,
    pub with_gradient: f64,
}

/// CPU time against panels on logarithmic axes: linear sheets as lines, with and without the gradient, the learned ones, (panels,
/// CPU time with gradient), as points, and the goal of a growth with the power 1.25 from the linear sheet of 600 panels on.
pub fn growth(linear: &[PathCost], learned: &[(f64, f64)]) -> Result<String> {
    drawn((700, 480), |root| {
        let all = || {
            let linear = linear.iter().flat_map(|cost| {
                [cost.path, cost.with_gradient].map(|seconds| (cost.panels as f64, seconds))
            });
            linear.chain(learned.iter().copied())
        };
        let panels = decades(all().map(|(panels, _)| panels));
        let seconds = decades(all().map(|(_, seconds)| seconds));
        let mut chart = ChartBuilder::on(root)
            .margin(14)
            .margin_right(40)
            .x_label_area_size(40)
            .y_label_area_size(60)
            .build_cartesian_2d(panels.clone().log_scale(), seconds.log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .label_style((FONT, 13))
            .x_label_formatter(&|panels| format!("{panels:.0}"))
            .x_desc("panels")
            .y_desc("CPU time of one thread, s")
            .draw()?;
        if let Some(from) = linear.iter().find(|cost| cost.panels == 600) {
            let at = |panels: f64| from.path * (panels / 600.0).powf(1.25);
            let ends = [600.0, panels.end].map(|panels| (panels, at(panels)));
            chart
                .draw_series(LineSeries::new(ends, RGBColor(150, 150, 150)))?
                .label("power 1.25")
                .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], RGBColor(150, 150, 150)));
        }
        type Time = fn(&PathCost) -> f64;
        let lines: [(&str, Time, RGBColor); 2] = [
            ("linear, path", |cost| cost.path, SLICES[0]),
            (
                "linear, with gradient",
                |cost| cost.with_gradient,
                SLICES[1],
            ),
        ];
        for (name, time, colour) in lines {
            let points = || linear.iter().map(|cost| (cost.panels as f64, time(cost)));
            chart
                .draw_series(LineSeries::new(points(), colour.stroke_width(2)))?
                .label(name)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2))
                });
            chart.draw_series(points().map(|point| Circle::new(point, 3, colour.filled())))?;
        }
        let colour = SLICES[2];
        chart
            .draw_series(
                learned
                    .iter()
                    .map(|&point| Circle::new(point, 4, colour.filled())),
            )?
            .label("learned, with gradient")
            .legend(move |(x, y)| Circle::new((x + 9, y), 4, colour.filled()));
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE)
            .border_style(BLACK)
            .label_font((FONT, 13))
            .draw()?;
        Ok(())
    })
}
