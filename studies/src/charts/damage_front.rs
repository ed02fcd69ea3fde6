//! Designs by their outline error and the damage of their hinges, one line for each weight of the damage.

use anyhow::Result;
use kirigami::ui::charts::axes::{Axis, axes, line, marks, names};
use kirigami::ui::charts::*;
use plotters::chart::SeriesLabelPosition;

/// Designs of one weight of the damage: (outline error (mm), mean damage), by increasing weight of the compression.
pub struct DamageLine {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

/// Damage against outline error.
pub fn damage_front(lines: &[DamageLine]) -> Result<String> {
    let all = || lines.iter().flat_map(|line| &line.points);
    drawn((700, 480), |root| {
        let mut chart = axes(
            root,
            "",
            Axis::new(padded(all().map(|point| point.0)), "outline error, mm"),
            Axis::new(
                padded(all().map(|point| point.1)),
                "mean over the hinges of the maximum damage, D_s",
            ),
        )?;
        for (of_weight, colour) in lines.iter().zip(SLICES) {
            let points = || of_weight.points.iter().copied();
            line(&mut chart, &of_weight.name, points(), colour)?;
            marks(&mut chart, points(), 4, colour)?;
        }
        names(&mut chart, SeriesLabelPosition::UpperRight)
    })
}
