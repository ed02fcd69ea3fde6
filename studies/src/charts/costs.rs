//! Charts of errors against costs.

use anyhow::Result;
use kirigami::ui::charts::axes::{Axis, axes, names};
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// Options of one kind of choice: (scene, option, cost in ms, error); the error of the reference is 0.
pub struct CostPanel {
    pub title: &'static str,
    pub points: Vec<(&'static str, String, f64, f64)>,
}

/// Smaller errors are drawn at this value, without labels.
const MIN_ERROR: f64 = 1e-12;

/// The panels, three in a row, with logarithmic axes.
pub fn costs(panels: &[CostPanel]) -> Result<String> {
    let rows = panels.len().div_ceil(3).max(1);
    drawn((1260, 380 * rows as u32), |root| {
        for (area, panel) in root.split_evenly((rows, 3)).iter().zip(panels) {
            cost_chart(area, panel)?;
        }
        Ok(())
    })
}

fn cost_chart(area: &Area, panel: &CostPanel) -> ChartResult {
    let decades = panel.points.iter().map(|(.., cost, _)| cost.log10());
    let (min, max) = decades.fold((0.0_f64, 1.0_f64), |(l, m), x| (l.min(x), m.max(x)));
    let across = Axis {
        range: (min.floor()..max.ceil() + 1.6).step(1.0),
        name: "cost with gradient, ms",
        tick: |decade| 10_f64.powf(*decade).to_string(),
    };
    let up = Axis {
        range: (MIN_ERROR.log10()..0.6).step(2.0),
        name: "error of the gradient",
        tick: |decade| format!("1e{decade:.0}"),
    };
    let mut chart = axes(area, panel.title, across, up)?;
    let mut scenes: Vec<&str> = panel.points.iter().map(|(scene, ..)| *scene).collect();
    scenes.dedup();
    for (scene, colour) in std::iter::zip(scenes, SLICES) {
        let of_scene = panel.points.iter().filter(|(of, ..)| *of == scene);
        let marks = of_scene.map(|(_, choice, cost, error)| {
            let at = (cost.log10(), error.max(MIN_ERROR).log10());
            let label = if *error > MIN_ERROR {
                choice.as_str()
            } else {
                ""
            };
            let label = Text::new(
                label.to_owned(),
                (6, -6),
                (FONT, 10).into_font().color(&colour),
            );
            EmptyElement::at(at) + Circle::new((0, 0), 3, colour.filled()) + label
        });
        chart
            .draw_series(marks)?
            .label(scene)
            .legend(move |(x, y)| Circle::new((x + 7, y), 3, colour.filled()));
    }
    names(&mut chart, SeriesLabelPosition::UpperRight)
}
