//! Charts of the influence of the modelling choices of the window solve on the energy.

use anyhow::Result;
use kirigami::ui::charts::axes::{line, names};
use kirigami::ui::charts::*;
use plotters::prelude::*;
use std::collections::BTreeMap;

/// The influence of a choice on a quantity: one line per hinge over the values of the choice.
#[derive(Default)]
pub struct StudyPanel {
    pub title: &'static str,
    pub values: Vec<String>,
    /// For each hinge: (index of the value, difference in percent).
    pub lines: BTreeMap<String, Vec<(f64, f64)>>,
}

/// The panels of a study, three in a row.
pub fn studies(panels: &[StudyPanel], y_label: &str) -> Result<String> {
    let rows = panels.len().div_ceil(3).max(1);
    let size = (1260, 340 * rows as u32);
    drawn(size, |root| {
        for (area, panel) in root.split_evenly((rows, 3)).iter().zip(panels) {
            study_chart(area, panel, y_label)?;
        }
        Ok(())
    })
}

fn study_chart(area: &Area, panel: &StudyPanel, y_label: &str) -> ChartResult {
    let percents = panel.lines.values().flatten().map(|(_, percent)| *percent);
    let last = panel.values.len().max(2) as f64 - 1.0;
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(-0.2..last + 0.2, padded(percents))?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_labels(panel.values.len())
        .x_label_formatter(&|x| {
            let value = panel.values.get(x.round() as usize);
            value
                .filter(|_| x.fract() == 0.0)
                .cloned()
                .unwrap_or_default()
        })
        .label_style((FONT, 12))
        .y_desc(y_label)
        .draw()?;
    for (i, (hinge, points)) in panel.lines.iter().enumerate() {
        let colour = Palette99::pick(i).stroke_width(2);
        line(&mut chart, hinge, points.iter().copied(), colour)?;
    }
    names(&mut chart, SeriesLabelPosition::MiddleRight)
}
