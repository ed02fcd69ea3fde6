//! The tables of the solution set.

use super::{CONVERGED, NEGLIGIBLE, Solution, SolutionSet};
use anyhow::Result;
use design::objective::shape::OutlinePoints;
use std::fmt::Write;

/// The name of a point set P.
pub fn corners(outline: OutlinePoints) -> &'static str {
    match outline {
        OutlinePoints::Free => "free",
        OutlinePoints::All => "all",
    }
}

pub fn page(sets: &[SolutionSet]) -> Result<String> {
    let mut text = format!(
        "# The solution set\n\n\
         {} runs from random patterns with the free outline corners compared with the circle, and as many with all. A run \
         has settled if no step lowers the loss; the gradient is the maximum over the runs of its norm at the end, relative \
         to that at the start. Families are the runs with an outline error below {:.0} % of the side, \
         grouped by opening; errors are in % of the side. `kirigami-studies solutions`.\n\n\
         | family | runs | settled | gradient | opening, deg | from | to | median error, % | minimum error, % |\n\
         |---|---|---|---|---|---|---|---|---|\n",
        sets.first().map_or(0, |set| set.solutions.len()),
        100.0 * CONVERGED,
    );
    for set in sets {
        for (k, family) in set.families.iter().enumerate() {
            let runs = || family.iter().map(|&i| &set.solutions[i]);
            let openings = || runs().map(|run| run.opening_deg);
            writeln!(
                text,
                "| {}, {} | {} | {} | {:.0e} | {:.1} | {:.1} | {:.1} | {:.3} | {:.3} |",
                corners(set.outline),
                k + 1,
                family.len(),
                runs().filter(|run| run.settled()).count(),
                runs().map(Solution::gradient).fold(0.0, f64::max),
                openings().sum::<f64>() / family.len() as f64,
                openings().fold(f64::INFINITY, f64::min),
                openings().fold(f64::NEG_INFINITY, f64::max),
                100.0 * set.solutions[family[family.len() / 2]].error,
                100.0 * set.solutions[family[0]].error,
            )?;
        }
    }
    write!(
        text,
        "\nThe Hessian of the loss at the best design of the largest family, in the chart coordinates of the pattern and \
         the opening: its eigenvalues above {NEGLIGIBLE:.0e} of the largest, below minus that, and between. Moving: the \
         number of independent motions of the compared corners; along all other directions no corner moves at all. \
         Distance: the mean distance of two designs from different ones of the two largest families divided by that of two \
         designs of the same family, in (r, tau) (paper: 9.40). Plane: the fraction of the variance of starts and \
         solutions in the plane of the picture.\n\n\
         | corners | directions | positive | negative | negligible | below 1e-4 | moving | distance | plane, % |\n\
         |---|---|---|---|---|---|---|---|---|\n"
    )?;
    for set in sets {
        let count =
            |within: &dyn Fn(f64) -> bool| set.spectrum.iter().filter(|it| within(**it)).count();
        let distance = match &set.families[..] {
            [first, second, ..] => {
                let [within, between] = distances(&set.solutions, first, second);
                format!("{:.2}", between / within)
            }
            _ => "one family".to_owned(),
        };
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {distance} | {:.0} |",
            corners(set.outline),
            set.spectrum.len(),
            count(&|it| it > NEGLIGIBLE),
            count(&|it| it < -NEGLIGIBLE),
            count(&|it| it.abs() <= NEGLIGIBLE),
            count(&|it| it.abs() <= 1e-4),
            set.rank,
            100.0 * (set.plane.shares[0] + set.plane.shares[1]),
        )?;
    }
    write!(
        text,
        "\nThe root of the minimum loss at a fixed opening, in % of the side, the best of four searches from random \
         patterns:\n\n| opening, deg | free | all |\n|---|---|---|\n"
    )?;
    if let [free, all] = sets {
        for ([opening, free], [_, all]) in std::iter::zip(&free.profile, &all.profile) {
            writeln!(
                text,
                "| {opening} | {:.3} | {:.3} |",
                100.0 * free,
                100.0 * all
            )?;
        }
    }
    Ok(text)
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
pub fn csv(sets: &[SolutionSet]) -> Result<String> {
    let mut text =
        "corners,seed,settled,error_over_side,opening_deg,family,component_1,component_2\n"
            .to_owned();
    for set in sets {
        for (i, solution) in set.solutions.iter().enumerate() {
            let family = set.families.iter().position(|family| family.contains(&i));
            let [x, y] = set.plane.place(&solution.end);
            writeln!(
                text,
                "{},{},{},{:.6},{:.4},{},{x:.6},{y:.6}",
                corners(set.outline),
                solution.seed,
                solution.settled(),
                solution.error,
                solution.opening_deg,
                family.map_or(0, |family| family + 1),
            )?;
        }
    }
    Ok(text)
}
