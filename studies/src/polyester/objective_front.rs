//! What a larger weight on one objective gains, and what it costs in the match: which of objective, search and physics
//! limits the paths of the hinges.
//!
//! Every weight is tried from several random starts: the spread over them is the search's.

use super::{PolyesterStudy, Row};
use anyhow::Result;
use design::hinge_law::DamageMeasure;
use design::scene::{ObjectiveConfig, SceneConfig};
use design::sheet::cut_sheet::HingePoint;
use kirigami::ui::progress::Progress;
use std::fmt::Write;
use support::statistics::median;

/// Random starts of each objective, and the standard deviation of their coordinates.
const SEEDS: u64 = 4;
const START_NOISE: f64 = 0.3;

/// Name and change of an objective whose weights of damage and compression are zero.
type Change = (&'static str, fn(&mut ObjectiveConfig));

const OBJECTIVES: [Change; 10] = [
    ("shape alone", |_| ()),
    ("compression 0.1", |it| it.compression = 0.1),
    ("compression 1", |it| it.compression = 1.0),
    ("compression 10", |it| it.compression = 10.0),
    ("compression 100", |it| it.compression = 100.0),
    ("D 0.02", |it| it.damage = 0.02),
    ("D 0.2", |it| it.damage = 0.2),
    ("D_peak 0.2", |it| peak(it, 0.2)),
    ("D and compression, balanced", |it| {
        (it.damage, it.compression, it.balance) = (1.0, 1.0, true);
    }),
    ("D_peak and compression, balanced", |it| {
        peak(it, 1.0);
        (it.compression, it.balance) = (1.0, true);
    }),
];

fn peak(objective: &mut ObjectiveConfig, weight: f64) {
    objective.damage = weight;
    objective.damage_measure = DamageMeasure::Peak;
}

/// The compared numbers of one design.
const COLUMNS: [&str; 7] = [
    "outline, mm",
    "minimum eta_a",
    "maximum compression, N",
    "mean force, N",
    "mean damage, D_s",
    "maximum D_peak",
    "inside",
];

/// The table: the median over the starts, and in brackets the range.
pub(super) fn table(study: &PolyesterStudy, config: &SceneConfig, load: f64) -> Result<String> {
    let mut text = format!(
        "\n## What a larger weight gains\n\n\
         Hinges at the cut's tip; median and range of {SEEDS} designs from random starts. Balanced: at the start the gradients of \
         the objectives are as large as that of the shape. Outline: root mean square distance from the target.\n\n\
         | objective | {} |\n|---|{}\n",
        COLUMNS.join(" | "),
        "---|".repeat(COLUMNS.len())
    );
    let bar = Progress::new(OBJECTIVES.len() * SEEDS as usize, "designs");
    for (k, (name, change)) in OBJECTIVES.into_iter().enumerate() {
        let mut numbers = Vec::new();
        for seed in 0..SEEDS {
            bar.show(k * SEEDS as usize + seed as usize, None, name);
            let mut config = config.clone();
            let objective = &mut config.objective;
            (objective.damage, objective.compression) = (0.0, 0.0);
            change(objective);
            (config.optimiser.start_noise, config.optimiser.seed) = (START_NOISE, seed);
            let folder = format!("front/{k}-{seed}");
            let (scene, designed) = study.design(config, &folder)?;
            let row = Row::new(&scene, &designed, HingePoint::CutTip, name, load)?;
            numbers.push(of(&row));
        }
        write!(text, "| {name} |")?;
        for column in 0..COLUMNS.len() {
            let values = numbers.iter().filter_map(|row| row[column]);
            write!(text, " {} |", median_and_range(values.collect()))?;
        }
        text += "\n";
    }
    bar.finish();
    Ok(text)
}

fn of(row: &Row) -> [Option<f64>; COLUMNS.len()] {
    let states = row.paths.iter().flat_map(|path| {
        let w_lig = path.design.w_lig;
        path.states.iter().map(move |state| state.eta(w_lig)[0])
    });
    let forces = row.forces.iter();
    let known: Vec<f64> = row.damage.iter().flatten().copied().collect();
    [
        Some(row.outline[1]),
        states.min_by(f64::total_cmp),
        (forces.clone().map(|[normal, _]| (-normal).max(0.0))).max_by(f64::total_cmp),
        Some(forces.map(|[_, force]| force).sum::<f64>() / row.forces.len() as f64),
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64),
        row.peaks.iter().flatten().copied().max_by(f64::total_cmp),
        Some(row.share_inside),
    ]
}

fn median_and_range(mut values: Vec<f64>) -> String {
    values.sort_by(f64::total_cmp);
    let (Some(&first), Some(&last)) = (values.first(), values.last()) else {
        return "not known".to_owned();
    };
    let shown = |value: f64| match value.abs() {
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    };
    format!(
        "{} ({} to {})",
        shown(median(values)),
        shown(first),
        shown(last)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_of_four_is_between_the_middle_two() {
        assert_eq!(
            median_and_range(vec![4.0, 1.0, 2.0, 30.0]),
            "3.00 (1.00 to 30.0)"
        );
        assert_eq!(median_and_range(Vec::new()), "not known");
    }
}
