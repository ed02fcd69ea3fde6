//! Charts of choices by cost and error; a choice on the Pareto front has no other to its lower left.

use anyhow::Result;
use kirigami::ui::charts::axes::{Axis, axes, marks};
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// Choices: (name, cost in seconds, error in percent).
pub struct FrontPanel {
    pub title: &'static str,
    pub points: Vec<(String, f64, f64)>,
}

/// Space of a label, in decades.
const NAME: [f64; 2] = [0.6, 0.09];

/// Smaller errors (%) are drawn at this value.
const MIN_ERROR: f64 = 1e-6;

/// Error against cost on logarithmic axes, one panel each.
pub fn front(panels: &[FrontPanel]) -> Result<String> {
    drawn((620 * panels.len() as u32, 460), |root| {
        for (area, panel) in root.split_evenly((1, panels.len())).iter().zip(panels) {
            front_chart(area, panel)?;
        }
        Ok(())
    })
}

fn front_chart(area: &Area, panel: &FrontPanel) -> ChartResult {
    let choices = panel.points.iter();
    let points: Vec<(&str, (f64, f64))> = choices
        .filter(|(_, cost, error)| cost.is_finite() && error.is_finite())
        .map(|(name, cost, error)| (name.as_str(), (*cost, error.max(MIN_ERROR))))
        .collect();
    let across = decades(points.iter().map(|(_, (cost, _))| *cost));
    // Space for the labels.
    let across = (across.start..4.0 * across.end).log_scale();
    let up = decades(points.iter().map(|(_, (_, error))| *error)).log_scale();
    let mut chart = axes(
        area,
        panel.title,
        Axis::powers(across, "cost, s"),
        Axis::powers(up, "error of the deployed shape, % of the sheet"),
    )?;
    marks(&mut chart, points.iter().map(|(_, at)| *at), 4, POINT)?;
    let mut named: Vec<(f64, f64)> = Vec::new();
    for (name, at) in points {
        // Labels must not overlap: of several close points the first is labelled.
        let apart = |x: f64, y: f64| (x / y).log10().abs();
        let crowded =
            |other: &(f64, f64)| apart(at.0, other.0) < NAME[0] && apart(at.1, other.1) < NAME[1];
        if !named.iter().any(crowded) {
            named.push(at);
            let label = Text::new(name.to_owned(), (8, -6), (FONT, 11).into_font());
            chart.draw_series([EmptyElement::at(at) + label])?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_is_a_mark_with_its_name() {
        let points = vec![
            ("small".to_owned(), 10.0, 0.1),
            ("fine".to_owned(), 99.0, 0.0),
        ];
        let svg = front(&[FrontPanel { title: "", points }]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(svg.contains("small"));
        let points = Vec::new();
        assert!(front(&[FrontPanel { title: "", points }]).is_ok());
    }
}
