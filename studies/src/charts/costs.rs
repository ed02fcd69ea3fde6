//! Charts of errors against costs.

use anyhow::Result;
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
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(
            (min.floor()..max.ceil() + 1.6).step(1.0),
            (MIN_ERROR.log10()..0.6).step(2.0),
        )?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_label_formatter(&|x| 10_f64.powf(*x).to_string())
        .y_label_formatter(&|y| format!("1e{y:.0}"))
        .label_style((FONT, 12))
        .x_desc("cost with gradient, ms")
        .y_desc("error of the gradient")
        .draw()?;
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
    chart
        .configure_series_labels()
        .label_font((FONT, 10))
        .position(SeriesLabelPosition::UpperRight)
        .border_style(GUIDE)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    Ok(())
}
