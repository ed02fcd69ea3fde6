//! What larger weights of damage and compression gain, and what they cost in the match: the front of damage against outline
//! error, and which of objective, search and physics limits the paths of the hinges.
//!
//! Every weight is tried from several random starts: the spread over them is the search's.

use super::{PolyesterStudy, Row};
use crate::charts::{self, DamageLine};
use anyhow::Result;
use design::hinge_law::DamageMeasure;
use design::scene::{ObjectiveConfig, SceneConfig};
use design::sheet::cut_sheet::HingePoint;
use kirigami::ui::progress::Progress;
use std::fmt;
use support::statistics::median;

/// Random starts of each objective, and the standard deviation of their coordinates.
const SEEDS: u64 = 4;
const START_NOISE: f64 = 0.3;

/// Weights of damage and compression that are swept together: each of the first with each of the second.
const DAMAGE: [f64; 4] = [0.0, 0.02, 0.2, 1.0];
const COMPRESSION: [f64; 5] = [0.0, 0.03, 0.1, 0.3, 1.0];

/// Other objectives: D_peak, weights that balance the gradients at the start, and weights at which the shape no longer counts.
const OTHERS: [Weights; 5] = [
    Weights::new(0.2, 0.0).of_peak(),
    Weights::new(1.0, 1.0).balanced(),
    Weights::new(1.0, 1.0).of_peak().balanced(),
    Weights::new(0.0, 10.0),
    Weights::new(0.0, 100.0),
];

/// The objectives on the hinges' paths.
#[derive(Clone, Copy)]
struct Weights {
    damage: f64,
    compression: f64,
    measure: DamageMeasure,
    balance: bool,
}

/// The compared numbers of one design.
const COLUMNS: [&str; 8] = [
    "outline, mm",
    "maximum opening, deg",
    "minimum eta_a",
    "maximum compression, N",
    "mean force, N",
    "mean damage, D_s",
    "maximum D_peak",
    "inside",
];
const OUTLINE: usize = 0;
const MEAN_DAMAGE: usize = 5;

/// The designs of one objective from all starts.
struct Designs {
    weights: Weights,
    /// In each column the known numbers.
    columns: [Vec<f64>; COLUMNS.len()],
}

/// The table and the chart.
pub(super) struct Front {
    pub table: String,
    pub chart: String,
}

impl Weights {
    const fn new(damage: f64, compression: f64) -> Self {
        Self {
            damage,
            compression,
            measure: DamageMeasure::Mean,
            balance: false,
        }
    }

    const fn of_peak(self) -> Self {
        Self {
            measure: DamageMeasure::Peak,
            ..self
        }
    }

    const fn balanced(self) -> Self {
        Self {
            balance: true,
            ..self
        }
    }

    fn apply(self, objective: &mut ObjectiveConfig) {
        (objective.damage, objective.compression) = (self.damage, self.compression);
        (objective.damage_measure, objective.balance) = (self.measure, self.balance);
    }
}

/// D or D_peak with its weight, then the compression with its weight.
impl fmt::Display for Weights {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let measure = match self.measure {
            DamageMeasure::Mean => "D",
            DamageMeasure::Peak => "D_peak",
        };
        let (damage, compression) = (self.damage, self.compression);
        let balanced = if self.balance { ", balanced" } else { "" };
        match (damage > 0.0, compression > 0.0) {
            (false, false) => write!(f, "shape alone"),
            (true, false) => write!(f, "{measure} {damage}{balanced}"),
            (false, true) => write!(f, "compression {compression}{balanced}"),
            (true, true) => write!(f, "{measure} {damage}, compression {compression}{balanced}"),
        }
    }
}

/// The designs of all weights.
pub(super) fn front(study: &PolyesterStudy, config: &SceneConfig, load: f64) -> Result<Front> {
    let grid = DAMAGE
        .iter()
        .flat_map(|&damage| COMPRESSION.map(|compression| Weights::new(damage, compression)));
    let all: Vec<Weights> = grid.chain(OTHERS).collect();
    let bar = Progress::new(all.len() * SEEDS as usize, "designs");
    let mut found = Vec::new();
    for (k, weights) in all.into_iter().enumerate() {
        let mut columns: [Vec<f64>; COLUMNS.len()] = Default::default();
        for seed in 0..SEEDS {
            let done = k * SEEDS as usize + seed as usize;
            bar.show(done, None, &weights.to_string());
            let mut config = config.clone();
            weights.apply(&mut config.objective);
            (config.optimiser.start_noise, config.optimiser.seed) = (START_NOISE, seed);
            let (scene, designed) = study.design(config, &format!("front/{k}-{seed}"))?;
            let row = Row::new(&scene, &designed, HingePoint::CutTip, "", load)?;
            for (column, number) in columns.iter_mut().zip(of(&row)) {
                column.extend(number);
            }
        }
        found.push(Designs { weights, columns });
    }
    bar.finish();
    Ok(Front {
        table: table(&found),
        chart: charts::damage_front(&lines(&found))?,
    })
}

/// The median over the starts, and in brackets the range.
fn table(found: &[Designs]) -> String {
    let mut text = format!(
        "\n## What larger weights gain\n\n\
         Hinges at the cut's tip; median and range of {SEEDS} designs from random starts. Balanced: at the start the gradients of \
         the objectives are as large as that of the shape. Outline: root mean square distance from the target. Front: no other \
         weights have both a smaller outline error and a smaller mean damage, in the medians.\n\n\
         | objective | front | {} |\n|---|---|{}\n",
        COLUMNS.join(" | "),
        "---|".repeat(COLUMNS.len())
    );
    for designs in found {
        let beaten = found.iter().any(|other| other.is_better(designs));
        let on_front = match designs.place() {
            Some(_) if !beaten => "x",
            _ => "",
        };
        let cells = designs.columns.iter().cloned().map(median_and_range);
        let cells: Vec<String> = cells.collect();
        text += &format!(
            "| {} | {on_front} | {} |\n",
            designs.weights,
            cells.join(" | ")
        );
    }
    text
}

/// The medians of the swept weights.
fn lines(found: &[Designs]) -> Vec<DamageLine> {
    let swept = found[..DAMAGE.len() * COMPRESSION.len()].chunks(COMPRESSION.len());
    let line = |(damage, designs): (f64, &[Designs])| DamageLine {
        name: format!("weight of the damage {damage}"),
        points: designs.iter().filter_map(Designs::place).collect(),
    };
    DAMAGE.into_iter().zip(swept).map(line).collect()
}

impl Designs {
    /// Medians of outline error (mm) and mean damage; `None` if the damage of no design is known.
    fn place(&self) -> Option<(f64, f64)> {
        let [outline, damage] = [OUTLINE, MEAN_DAMAGE].map(|column| self.columns[column].clone());
        (!damage.is_empty()).then(|| (median(outline), median(damage)))
    }

    /// Whether both are smaller than those of the other.
    fn is_better(&self, other: &Self) -> bool {
        match (self.place(), other.place()) {
            (Some(own), Some(other)) => own.0 < other.0 && own.1 < other.1,
            _ => false,
        }
    }
}

fn of(row: &Row) -> [Option<f64>; COLUMNS.len()] {
    let states = row.paths.iter().flat_map(|path| {
        let w_lig = path.design.w_lig;
        path.states.iter().map(move |state| state.eta(w_lig)[0])
    });
    let forces = row.forces.iter();
    let openings = row.paths.iter().map(|path| path.end().theta.to_degrees());
    let known: Vec<f64> = row.damage.iter().flatten().copied().collect();
    [
        Some(row.outline[1]),
        openings.max_by(f64::total_cmp),
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
