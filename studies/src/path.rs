//! `kirigami-studies path`: the error of reading energy and damage from the state alone; section 5.2.

use crate::charts::{self, SeparationChart};
use crate::power_law::PowerLaw;
use anyhow::{Result, ensure};
use clap::Args;
use design::scene::Scene;
use design::scene::design_run::design_of_run;
use fe_driver::{KeptSolution, KeptSolve};
use hinge::SheetMaterial;
use kirigami::replays::kept_solves::SolveArgs;
use kirigami::replays::routes::{HingeRoute, hinge_routes};
use kirigami::ui::{picture, run_folder};
use mesher::Tier;
use std::fmt::Write;
use std::path::PathBuf;

/// Measure path dependence: hinges solved along their paths in a sheet, and straight to the same end
///
/// The sheet of each scene is deployed with the best design of its run, or with the start design if there is
/// no run. Some of the hinge paths are solved twice by finite elements. Writes path.csv,
/// path.md, tradeoff.md and a chart. Example: kirigami-studies path configs/scenes/demo.toml
#[derive(Args)]
pub struct PathStudy {
    /// Scenes (TOML) whose sheets are deployed
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    /// Number of paths to solve, spread from the largest to the smallest separation from the ray
    #[arg(long, value_name = "N", default_value_t = 20)]
    routes: usize,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Default)]
    tier: Tier,
    /// Folder for the tables, the chart and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-path")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// Separation (ligament widths) below which path and ray are the same to the solver.
const RESOLUTION: f64 = 0.002;

/// A path solved along its states and along the ray to its end.
struct Pair {
    scene: String,
    route: HingeRoute,
    separation: f64,
    /// W and D at the end of the path, and of the ray.
    ends: [[f64; 2]; 2],
}

impl PathStudy {
    pub fn run(&self) -> Result<()> {
        ensure!(self.routes > 0, "--routes must be at least 1");
        let _held = run_folder::hold(&self.out)?;
        let mut routes = Vec::new();
        for path in &self.scenes {
            let scene = Scene::read(path)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            for route in deployed(&scene)? {
                routes.push((
                    route.separation().whole,
                    name.to_string(),
                    scene.material.clone(),
                    route,
                ));
            }
        }
        routes.sort_by(|x, y| y.0.total_cmp(&x.0));
        let all: Vec<f64> = routes.iter().map(|route| route.0).collect();
        let chosen = spread_over(routes.len(), self.routes);
        let chosen: Vec<_> = chosen.into_iter().map(|i| &routes[i]).collect();
        let solves: Vec<[KeptSolve; 2]> = chosen
            .iter()
            .map(|(_, _, material, route)| self.windows(route, material))
            .collect::<Result<_>>()?;
        let outcomes = self
            .solve
            .solve(&solves.iter().flatten().collect::<Vec<_>>(), &self.out)?;
        let (mut pairs, mut failures) = (Vec::new(), String::new());
        for ((separation, scene, _, route), legs) in chosen.into_iter().zip(outcomes.chunks(2)) {
            match legs {
                [Ok(recorded), Ok(straight)] => pairs.push(Pair {
                    scene: scene.clone(),
                    route: route.clone(),
                    separation: *separation,
                    ends: [recorded, straight].map(end),
                }),
                legs => {
                    for reason in legs.iter().filter_map(|leg| leg.as_ref().err()) {
                        writeln!(failures, "* {scene}, hinge {}: {reason}", route.hinge)?;
                    }
                }
            }
        }
        ensure!(!pairs.is_empty(), "no pair was solved:\n{failures}");
        self.report(&pairs, &all, &failures)
    }

    fn windows(&self, route: &HingeRoute, material: &SheetMaterial) -> Result<[KeptSolve; 2]> {
        Ok([
            route.recorded(material, self.tier)?,
            route.straight(material, self.tier),
        ])
    }

    fn report(&self, pairs: &[Pair], all: &[f64], failures: &str) -> Result<()> {
        let differences = |quantity: usize| -> Vec<(f64, f64)> {
            let of = |pair: &Pair| (pair.separation, pair.difference(quantity));
            pairs.iter().map(of).collect()
        };
        let (energy, damage) = (differences(0), differences(1));
        let fits = [&energy, &damage].map(|points| PowerLaw::fit(resolved(points)));
        let mut page = format!(
            "# Path dependence\n\n{}",
            summary(pairs, all, fits, self.tier)?
        );
        page += "\n| scene | hinge | w_lig, mm | separation | W, path | W, ray | difference | D, path | D, ray \
                 | difference |\n|---|---|---|---|---|---|---|---|---|---|\n";
        let mut csv = "scene,hinge,w_lig_mm,separation,w_route,w_ray,d_route,d_ray\n".to_owned();
        for pair in pairs {
            let Pair {
                scene,
                route,
                separation,
                ends: [[w, d], [w_ray, d_ray]],
            } = pair;
            let (hinge, w_lig) = (route.hinge, route.design.w_lig);
            let [dw, dd] = [0, 1].map(|i| 100.0 * pair.difference(i));
            writeln!(
                page,
                "| {scene} | {hinge} | {w_lig:.1} | {separation:.4} | {w:.3} | {w_ray:.3} | {dw:.3} % \
                 | {d:.6} | {d_ray:.6} | {dd:.2} % |"
            )?;
            writeln!(
                csv,
                "{scene},{hinge},{w_lig:.4},{separation:.6},{w:.6},{w_ray:.6},{d:.8},{d_ray:.8}"
            )?;
        }
        if !failures.is_empty() {
            write!(page, "\nNot solved:\n\n{failures}")?;
        }
        run_folder::write(&self.out, "path.md", &page)?;
        run_folder::write(&self.out, "path.csv", &csv)?;
        let tradeoff = format!(
            "## Path dependence\n\n{}",
            summary(pairs, all, fits, self.tier)?
        );
        run_folder::write(&self.out, "tradeoff.md", &tradeoff)?;
        let chart = |pairs, fit, quantity| SeparationChart {
            pairs,
            fit,
            all,
            quantity,
        };
        let charts = [
            chart(&energy, fits[0], "energy W"),
            chart(&damage, fits[1], "damage D"),
        ];
        picture::save(&charts::separations(&charts)?, &self.out.join("path"), 1600)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }
}

impl Pair {
    /// Difference of the path from the ray, relative to the ray: of W (0) or D (1).
    fn difference(&self, quantity: usize) -> f64 {
        let [route, ray] = self.ends.map(|end| end[quantity]);
        (route - ray).abs() / ray.max(f64::MIN_POSITIVE)
    }
}

/// The hinge paths of a scene's sheet, with the best design of its run if there is one.
fn deployed(scene: &Scene) -> Result<Vec<HingeRoute>> {
    let design = design_of_run(scene, false)?.unwrap_or_else(|| scene.start());
    hinge_routes(scene, &design)
}

/// W and D at the end of a solution.
fn end(solution: &KeptSolution) -> [f64; 2] {
    let last = solution.samples.last().copied().unwrap_or_default();
    [last.w, last.d]
}

/// `wanted` indices spread over `count`, including the first and the last.
fn spread_over(count: usize, wanted: usize) -> Vec<usize> {
    if wanted >= count {
        return (0..count).collect();
    }
    let step = count.saturating_sub(1) as f64 / wanted.saturating_sub(1).max(1) as f64;
    (0..wanted)
        .map(|i| (i as f64 * step).round() as usize)
        .collect()
}

/// The pairs that the solver resolves.
fn resolved(points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> {
    let points = points.iter().copied();
    points.filter(|(separation, _)| *separation > RESOLUTION)
}

fn summary(pairs: &[Pair], all: &[f64], fits: [Option<PowerLaw>; 2], tier: Tier) -> Result<String> {
    let mut sorted = all.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quantile = |fraction: f64| sorted[(fraction * (sorted.len() - 1) as f64).round() as usize];
    let mut text = format!(
        "{} of {} paths recorded from deployed sheets, each solved twice on tier {tier}: along the path, and \
         straight to the same end. The separation is the maximum distance between the two at equal fractions of \
         their arc length, in ligament widths. Over all paths: median {:.4}, 90 % below {:.4}, maximum {:.4}. \
         `kirigami-studies path`.\n\n\
         | quantity | exponent (paper: 2.3 for W) | at the median separation | median pair | pair of largest \
         separation | paper, largest separation |\n|---|---|---|---|---|---|\n",
        pairs.len(),
        all.len(),
        quantile(0.5),
        quantile(0.9),
        quantile(1.0),
    );
    let widest = pairs
        .iter()
        .max_by(|x, y| x.separation.total_cmp(&y.separation));
    let rows = [("W", "6.9 %"), ("D", "14.3 %")];
    for (i, (name, paper)) in rows.into_iter().enumerate() {
        let mut differences: Vec<_> = pairs.iter().map(|pair| pair.difference(i)).collect();
        differences.sort_by(f64::total_cmp);
        let (exponent, usual) = match fits[i] {
            Some(law) => (
                law.to_string(),
                format!("{:.4} %", 100.0 * law.at(quantile(0.5))),
            ),
            None => ("too few pairs".to_owned(), "-".to_owned()),
        };
        writeln!(
            text,
            "| {name} | {exponent} | {usual} | {:.3} % | {:.2} % | {paper} |",
            100.0 * differences[differences.len() / 2],
            100.0 * widest.map_or(f64::NAN, |pair| pair.difference(i)),
        )?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_routes_are_spread_from_the_first_to_the_last() {
        assert_eq!(spread_over(10, 4), [0, 3, 6, 9]);
        assert_eq!(spread_over(3, 20), [0, 1, 2]);
        assert_eq!(spread_over(5, 1), [0]);
        assert!(spread_over(0, 3).is_empty());
    }
}
