//! The cost of paths against the number of panels.

use anyhow::Result;
use kirigami::ui::charts::axes::{Axis, axes, line, marks, names};
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
    let of_linear = |seconds: fn(&PathCost) -> f64| -> Vec<(f64, f64)> {
        let points = linear.iter();
        points
            .map(|cost| (cost.panels as f64, seconds(cost)))
            .collect()
    };
    let (paths, gradients) = (
        of_linear(|cost| cost.path),
        of_linear(|cost| cost.with_gradient),
    );
    drawn((700, 480), |root| {
        let all = || paths.iter().chain(&gradients).chain(learned);
        let panels = decades(all().map(|point| point.0));
        let mut chart = axes(
            root,
            "",
            Axis::new(panels.clone().log_scale(), "panels"),
            Axis::new(
                decades(all().map(|point| point.1)).log_scale(),
                "CPU time of one thread, s",
            ),
        )?;
        if let Some(from) = linear.iter().find(|cost| cost.panels == 600) {
            let at = |panels: f64| from.path * (panels / 600.0).powf(1.25);
            let ends = [600.0, panels.end].map(|panels| (panels, at(panels)));
            line(&mut chart, "power 1.25", ends, GUIDE)?;
        }
        for (name, points, colour) in [
            ("linear, path", &paths, SLICES[0]),
            ("linear, with gradient", &gradients, SLICES[1]),
        ] {
            line(
                &mut chart,
                name,
                points.iter().copied(),
                colour.stroke_width(2),
            )?;
            marks(&mut chart, points.iter().copied(), 3, colour)?;
        }
        let colour = SLICES[2];
        chart
            .draw_series((learned.iter()).map(|&point| Circle::new(point, 4, colour.filled())))?
            .label("learned, with gradient")
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, colour.filled()));
        names(&mut chart, SeriesLabelPosition::UpperLeft)
    })
}
