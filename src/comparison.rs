//! Values judged by finer ones, group by group: the spread as a table, and parity charts.

use crate::charts::{self, ParityChart};
use crate::picture;
use anyhow::Result;
use dataset::{COMPARED, ComparedState, reference_rms, relative_rms};
use std::fmt::Write;
use std::path::Path;
use train::ParityPoint;

/// What a group's own difference is relative to, at least, over the reference of all groups.
const LEAST_SCALE: f64 = 0.1;

/// How the scale of a group's difference is told.
pub const SCALE: &str = "over all states, and one by one, there relative to no less than a tenth \
                         of the reference over all";

/// The difference of each group, relative to its own reference or a tenth of that of all.
pub fn each_relative(groups: &[&[ComparedState]]) -> Vec<[f64; 6]> {
    let least = reference_rms(groups.iter().copied().flatten()).map(|rms| LEAST_SCALE * rms);
    groups
        .iter()
        .map(|states| relative_rms(states, least))
        .collect()
}

/// One line a quantity: the difference over all states, and how it is spread over the groups.
pub fn spread_table(groups: &[&[ComparedState]], group: &str) -> Result<String> {
    let mut text = format!(
        "| quantity | all states | median {group} | 90 % of {group}s | worst {group} |\n\
         |---|---|---|---|---|\n"
    );
    let all = relative_rms(&groups.concat(), [0.0; 6]);
    let each = each_relative(groups);
    for (i, name) in COMPARED.iter().enumerate() {
        let mut sorted: Vec<_> = each.iter().map(|rms| rms[i]).collect();
        sorted.sort_by(f64::total_cmp);
        let quantile = |share: f64| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
        writeln!(
            text,
            "| {name} | {} | {} | {} | {} |",
            percent(all[i]),
            percent(quantile(0.5)),
            percent(quantile(0.9)),
            percent(quantile(1.0))
        )?;
    }
    Ok(text)
}

/// Of a reference that is next to nothing, a damage of hinges that do not yield, no multiple means anything.
fn percent(relative: f64) -> String {
    match relative < 10.0 {
        true => format!("{:.2} %", 100.0 * relative),
        false => "over 1000 %".into(),
    }
}

/// Draws every state, one chart a quantity; `axes` names what judges and what is judged.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_no_measure() {
        assert_eq!(percent(0.01234), "1.23 %");
        assert_eq!(percent(5e286), "over 1000 %");
        assert_eq!(percent(f64::NAN), "over 1000 %");
    }
}
