//! Charts of choices by cost and error; a choice on the Pareto front has no other to its lower left.

use super::log_log::log_log;
use anyhow::Result;
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
    let points: Vec<(&str, (f64, f64))> = panel
        .points
        .iter()
        .filter(|(_, cost, error)| cost.is_finite() && error.is_finite())
        .map(|(name, cost, error)| (name.as_str(), (*cost, error.max(MIN_ERROR))))
        .collect();
    let across = decades(points.iter().map(|(_, (cost, _))| *cost));
    // Space for the labels.
    let across = across.start..4.0 * across.end;
    let up = decades(points.iter().map(|(_, (_, error))| *error));
    let mut chart = log_log(
        area,
        panel.title,
        (across, "cost, s"),
        (up, "error of the deployed shape, % of the sheet"),
    )?;
    let mut named: Vec<(f64, f64)> = Vec::new();
    chart.draw_series(points.iter().map(|(name, at)| {
        // Labels must not overlap: of several close points the first is labelled.
        let crowded = |other: &(f64, f64)| {
            let apart = |x: f64, y: f64| (x / y).log10().abs();
            apart(at.0, other.0) < NAME[0] && apart(at.1, other.1) < NAME[1]
        };
        let name = match named.iter().any(crowded) {
            true => "",
            false => {
                named.push(*at);
                *name
            }
        };
        EmptyElement::at(*at)
            + Circle::new((0, 0), 4, POINT.filled())
            + Text::new(name.to_owned(), (8, -6), (FONT, 11).into_font())
    }))?;
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
