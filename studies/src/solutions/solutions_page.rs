//! The tables of the solution set.

use super::{CONVERGED, NEGLIGIBLE, Solution, SolutionSet};
use design::objective::shape::OutlinePoints;
use support::table::{Cell, Table};

/// The name of a point set P.
pub fn corners(outline: OutlinePoints) -> &'static str {
    match outline {
        OutlinePoints::Free => "free",
        OutlinePoints::All => "all",
    }
}

/// The runs of one family.
struct Family<'a> {
    name: String,
    runs: Vec<&'a Solution>,
}

impl<'a> Family<'a> {
    fn all(sets: &'a [SolutionSet]) -> Vec<Self> {
        let of_set = |set: &'a SolutionSet| {
            (1..).zip(&set.families).map(|(number, family)| Self {
                name: format!("{}, {number}", corners(set.outline)),
                runs: family.iter().map(|&run| &set.solutions[run]).collect(),
            })
        };
        sets.iter().flat_map(of_set).collect()
    }

    fn openings(&self) -> impl Iterator<Item = f64> {
        self.runs.iter().map(|run| run.opening_deg)
    }

    fn table<'t>() -> Table<'t, Self> {
        Table::new()
            .column("family", |family: &Self| Cell::text(&family.name))
            .column("runs", |family| Cell::text(family.runs.len()))
            .column("settled", |family| {
                Cell::text(family.runs.iter().filter(|run| run.settled()).count())
            })
            .column("gradient", |family| {
                let gradients = family.runs.iter().map(|run| run.gradient());
                Cell::scientific(gradients.fold(0.0, f64::max), 0)
            })
            .column("opening, deg", |family| {
                Cell::fixed(family.openings().sum::<f64>() / family.runs.len() as f64, 1)
            })
            .column("from", |family| {
                Cell::fixed(family.openings().fold(f64::INFINITY, f64::min), 1)
            })
            .column("to", |family| {
                Cell::fixed(family.openings().fold(f64::NEG_INFINITY, f64::max), 1)
            })
            .column("median error, %", |family| {
                Cell::fixed(100.0 * family.runs[family.runs.len() / 2].error, 3)
            })
            .column("minimum error, %", |family| {
                Cell::fixed(100.0 * family.runs[0].error, 3)
            })
    }
}

fn curvature_table<'a>() -> Table<'a, SolutionSet> {
    let count = |within: fn(f64) -> bool| {
        move |set: &SolutionSet| {
            Cell::text(set.spectrum.iter().filter(|ratio| within(**ratio)).count())
        }
    };
    Table::new()
        .column("corners", |set: &SolutionSet| {
            Cell::text(corners(set.outline))
        })
        .column("directions", |set| Cell::text(set.spectrum.len()))
        .column("positive", count(|ratio| ratio > NEGLIGIBLE))
        .column("negative", count(|ratio| ratio < -NEGLIGIBLE))
        .column("negligible", count(|ratio| ratio.abs() <= NEGLIGIBLE))
        .column("below 1e-4", count(|ratio| ratio.abs() <= 1e-4))
        .column("moving", |set| Cell::text(set.rank))
        .column("distance", |set| match &set.families[..] {
            [first, second, ..] => {
                let [within, between] = distances(&set.solutions, first, second);
                Cell::fixed(between / within, 2)
            }
            _ => Cell::text("one family"),
        })
        .column("plane, %", |set| {
            Cell::fixed(100.0 * (set.plane.shares[0] + set.plane.shares[1]), 0)
        })
}

pub fn page(sets: &[SolutionSet]) -> String {
    let mut text = format!(
        "# The solution set\n\n\
         {} runs from random patterns with the free outline corners compared with the circle, and as many with all. A run \
         has settled if no step lowers the loss; the gradient is the maximum over the runs of its norm at the end, relative \
         to that at the start. Families are the runs with an outline error below {:.0} % of the side, \
         grouped by opening; errors are in % of the side. `kirigami-studies solutions`.\n\n{}\
         \nThe Hessian of the loss at the best design of the largest family, in the chart coordinates of the pattern and \
         the opening: its eigenvalues above {NEGLIGIBLE:.0e} of the largest, below minus that, and between. Moving: the \
         number of independent motions of the compared corners; along all other directions no corner moves at all. \
         Distance: the mean distance of two designs from different ones of the two largest families divided by that of two \
         designs of the same family, in (r, tau) (paper: 9.40). Plane: the fraction of the variance of starts and \
         solutions in the plane of the picture.\n\n{}\
         \nThe root of the minimum loss at a fixed opening, in % of the side, the best of four searches from random \
         patterns:\n\n",
        sets.first().map_or(0, |set| set.solutions.len()),
        100.0 * CONVERGED,
        Family::table().markdown(&Family::all(sets)),
        curvature_table().markdown(sets),
    );
    let mut profile = Vec::new();
    if let [free, all] = sets {
        profile = std::iter::zip(&free.profile, &all.profile)
            .map(|([opening, free], [_, all])| [*opening, 100.0 * free, 100.0 * all])
            .collect();
    }
    text += &Table::new()
        .column("opening, deg", |row: &[f64; 3]| Cell::text(row[0]))
        .column("free", |row| Cell::fixed(row[1], 3))
        .column("all", |row| Cell::fixed(row[2], 3))
        .markdown(&profile);
    text
}

/// Mean distance of two designs of the same family, and of two designs of different families.
fn distances(solutions: &[Solution], first: &[usize], second: &[usize]) -> [f64; 2] {
    let apart = |i: usize, j: usize| -> f64 {
        let squares =
            std::iter::zip(&solutions[i].end, &solutions[j].end).map(|(x, y)| (x - y).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let mean = |pairs: Vec<f64>| pairs.iter().sum::<f64>() / pairs.len().max(1) as f64;
    let mut within = Vec::new();
    for family in [first, second] {
        for (k, &i) in family.iter().enumerate() {
            within.extend(family[k + 1..].iter().map(|&j| apart(i, j)));
        }
    }
    let between = first
        .iter()
        .flat_map(|&i| second.iter().map(move |&j| (i, j)));
    [
        mean(within),
        mean(between.map(|(i, j)| apart(i, j)).collect()),
    ]
}

/// One row per run.
pub fn csv(sets: &[SolutionSet]) -> String {
    let runs: Vec<(&SolutionSet, usize)> = sets
        .iter()
        .flat_map(|set| (0..set.solutions.len()).map(move |run| (set, run)))
        .collect();
    let component = |axis: usize| {
        move |row: &(&SolutionSet, usize)| {
            Cell::fixed(row.0.plane.place(&row.0.solutions[row.1].end)[axis], 6)
        }
    };
    Table::new()
        .column("corners", |(set, _): &(&SolutionSet, usize)| {
            Cell::text(corners(set.outline))
        })
        .column("seed", |(set, run)| Cell::text(set.solutions[*run].seed))
        .column("settled", |(set, run)| {
            Cell::text(set.solutions[*run].settled())
        })
        .column("error over side", |(set, run)| {
            Cell::fixed(set.solutions[*run].error, 6)
        })
        .column("opening, deg", |(set, run)| {
            Cell::fixed(set.solutions[*run].opening_deg, 4)
        })
        .column("family", |(set, run)| {
            let family = set.families.iter().position(|family| family.contains(run));
            Cell::text(family.map_or(0, |family| family + 1))
        })
        .column("component 1", component(0))
        .column("component 2", component(1))
        .csv(&runs)
}
