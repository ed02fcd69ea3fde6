//! Parity charts of values and their finer reference values.

use crate::ui::charts;
use crate::ui::charts::ParityChart;
use crate::ui::picture;
use anyhow::Result;
use dataset::{COMPARED, ComparedState};
use std::path::Path;
use train::ParityPoint;

/// Draws every state, one chart per quantity; `axes` names the reference and the evaluated values.
pub fn draw(groups: &[&[ComparedState]], axes: [&str; 2], stem: &Path) -> Result<()> {
    let points = |quantity: usize| -> Vec<ParityPoint> {
        let states = groups.iter().copied().flatten();
        states
            .map(|state| ParityPoint {
                target: state.reference[quantity],
                predicted: state.value[quantity],
            })
            .collect()
    };
    let points: Vec<_> = (0..COMPARED.len()).map(points).collect();
    let charts: Vec<_> = COMPARED
        .iter()
        .zip(&points)
        .map(|(name, points)| ParityChart {
            title: name.to_string(),
            points,
        })
        .collect();
    picture::save(&charts::parity(&charts, axes)?, stem, 2000)?;
    Ok(())
}
