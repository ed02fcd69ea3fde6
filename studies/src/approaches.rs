//! `kirigami-studies approaches`: ways to keep a cut pattern valid during the search; section 3.1.

use crate::designed::designed;
use crate::drawing::{Column, side_by_side};
use crate::free_panels::{Enforcement, FreePanels};
use crate::tessellation::{Defects, Tessellation};
use anyhow::{Context, Result};
use clap::Args;
use design::geometry::chamfer::Precision;
use design::optimise::search::SearchMethod;
use design::scene::design_run::forget;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::{picture, run_folder};
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

/// Compare free panel corners, with and without penalties on validity, with the charts
///
/// Four approaches to one target from one start with the same number of steps, each at the better of two
/// learning rates; then the charts alone until L-BFGS converges. Writes approaches.csv, approaches.md and a
/// picture. Example: kirigami-studies approaches configs/scenes/pin-7x7.toml
#[derive(Args)]
pub struct ApproachStudy {
    /// Scene (TOML) with hinge = "pin"
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Steps of each approach
    #[arg(long, value_name = "N", default_value_t = 150)]
    steps: usize,
    /// Folder for the table, the picture and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-approaches")]
    out: PathBuf,
}

/// Learning rates: of corners relative to the sheet's side, and of chart coordinates.
const FREE_RATES: [f64; 2] = [0.005, 0.02];
const CHART_RATES: [f64; 2] = [0.05, 0.1];
/// Maximum number of steps until the charts have converged.
const CONVERGED_STEPS: usize = 3000;
/// Weights of the coverage for which the charts are converged.
const COVERAGES: [f64; 3] = [0.5, 0.1, 0.02];

/// The result of one approach.
struct Outcome {
    name: String,
    paper: &'static str,
    coordinates: usize,
    rate: f64,
    steps: usize,
    /// L (mm^2), by which the learning rate is selected.
    loss: f64,
    /// Root mean square distance from the target (mm).
    outline_error: f64,
    defects: Defects,
    opening_deg: f64,
    tessellation: Tessellation,
    target: Vec<[f64; 2]>,
    seconds: f64,
}

impl ApproachStudy {
    pub fn run(&self) -> Result<()> {
        let config: SceneConfig = support::toml_file::read(&self.scene)?;
        let _held = run_folder::hold(&self.out)?;
        // Radius of a circle with the area of the target.
        let radius =
            (Scene::new(config.clone(), &self.scene)?.target.area() / std::f64::consts::PI).sqrt();
        let mut outcomes = Vec::new();
        for (name, enforcement, paper) in [
            ("free corners", Enforcement::Nothing, "gap 7.8 %"),
            (
                "closed hinges",
                Enforcement::Projection,
                "no gap, no overlap, voids",
            ),
            (
                "closed hinges, no voids",
                Enforcement::Tiling,
                "half the void, a worse match",
            ),
        ] {
            for rate in FREE_RATES {
                outcomes.push(self.free(&config, name, paper, enforcement, rate)?);
            }
        }
        for rate in CHART_RATES {
            let mut config = config.clone();
            config.optimiser.steps = self.steps;
            config.optimiser.learning_rate = rate;
            outcomes.push(self.chart(config, "charts", "boundary 0.47 %, else 0")?);
        }
        let better = |pair: &[Outcome]| usize::from(pair[1].loss < pair[0].loss);
        let drawn: Vec<usize> = (outcomes.chunks(2).enumerate())
            .map(|(k, pair)| 2 * k + better(pair))
            .collect();
        for coverage in COVERAGES {
            let mut config = config.clone();
            config.objective.coverage = coverage;
            config.objective.precision = Precision::Curve;
            config.optimiser.steps = CONVERGED_STEPS;
            config.optimiser.method = SearchMethod::Lbfgs;
            let name = format!("charts until L-BFGS settles, coverage {coverage}");
            outcomes.push(self.chart(config, &name, "")?);
        }
        let page = page(&outcomes, &drawn, self.steps, radius)?;
        run_folder::write(&self.out, "approaches.md", &page)?;
        run_folder::write(&self.out, "approaches.csv", &csv(&outcomes, radius)?)?;
        let columns: Vec<_> = drawn.iter().map(|k| outcomes[*k].column(radius)).collect();
        picture::save(&side_by_side(&columns), &self.out.join("approaches"), 2400)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn free(
        &self,
        config: &SceneConfig,
        name: &str,
        paper: &'static str,
        enforcement: Enforcement,
        rate: f64,
    ) -> Result<Outcome> {
        let began = Instant::now();
        let scene = Scene::new(config.clone(), &self.scene)?;
        let (problem, start) = (scene.problem()?, scene.start());
        let opening = start
            .opening
            .context("the scene has no opening angle: set hinge = \"pin\"")?;
        let panels = FreePanels::new(&problem, &start, opening, enforcement)?;
        let found = panels.search(self.steps, rate);
        Ok(Outcome {
            name: name.to_owned(),
            paper,
            coordinates: panels.coordinates(),
            rate,
            steps: self.steps,
            loss: found.losses.iter().copied().fold(f64::INFINITY, f64::min),
            outline_error: found.outline_error,
            defects: found.tessellation.defects(),
            opening_deg: found.opening.to_degrees(),
            tessellation: found.tessellation,
            target: problem.objective.target.clone(),
            seconds: began.elapsed().as_secs_f64(),
        })
    }

    fn chart(&self, mut config: SceneConfig, name: &str, paper: &'static str) -> Result<Outcome> {
        let began = Instant::now();
        let rate = config.optimiser.learning_rate;
        let folder = format!("{}-{rate}", name.replace([' ', ','], "-"));
        config.output = std::path::absolute(&self.out)?.join("runs").join(folder);
        let scene = Scene::new(config, &self.scene)?;
        forget(&scene)?;
        let designed = designed(&scene, &mut |_| {})?;
        let tessellation = Tessellation::of(&scene, &designed.best.deployment);
        let pattern = &designed.design.pattern;
        let opening = designed.design.opening.unwrap_or_default();
        let best = (designed.history.iter()).min_by(|x, y| x.scores.loss.total_cmp(&y.scores.loss));
        Ok(Outcome {
            name: name.to_owned(),
            paper,
            coordinates: pattern.z.len() + pattern.ell.iter().map(Vec::len).sum::<usize>() + 1,
            rate,
            steps: designed.history.len() - 1,
            loss: designed.best.loss,
            outline_error: best.map_or(f64::NAN, |step| step.scores.outline_error),
            defects: tessellation.defects(),
            opening_deg: opening.to_degrees(),
            tessellation,
            target: scene.target.points().to_vec(),
            seconds: began.elapsed().as_secs_f64(),
        })
    }
}

impl Outcome {
    fn column(&self, radius: f64) -> Column<'_> {
        let Defects {
            gap, overlap, void, ..
        } = self.defects;
        let percents = [gap[0], gap[1], overlap[0], overlap[1], void].map(percent);
        let [gap_flat, gap_open, overlap_flat, overlap_open, void] = percents;
        let lines = vec![
            format!(
                "boundary error {:.2} % of the radius",
                100.0 * self.outline_error / radius
            ),
            format!("gaps at hinges {gap_flat} %, deployed {gap_open} %"),
            format!("overlap {overlap_flat} %, deployed {overlap_open} %"),
            format!("uncovered {void} %"),
        ];
        Column {
            title: &self.name,
            lines,
            tessellation: &self.tessellation,
            target: &self.target,
        }
    }
}

/// A fraction in per cent with two decimals; rounding errors are shown as zero.
fn percent(fraction: f64) -> String {
    if fraction < 1e-12 {
        "0".to_owned()
    } else {
        format!("{:.2}", 100.0 * fraction)
    }
}

fn page(outcomes: &[Outcome], drawn: &[usize], steps: usize, radius: f64) -> Result<String> {
    let mut text = format!(
        "# Validity by construction\n\n\
         One target, one start, {steps} steps of Adam, each approach at two learning rates; the rate with the smaller \
         loss is in bold and in the picture. The last rows are the charts until L-BFGS converges, with the distance \
         measured to the target's curve. Boundary: root mean square distance of the free outline corners from the \
         circle, in % of its radius. Gaps are in % of the sheet's side, flat and deployed; overlaps (flat and \
         deployed), voids and the area beside the sheet in % of its area. `kirigami-studies approaches`.\n\n\
         | approach | coordinates | rate | steps | boundary | gap | deployed | overlap | deployed | void | beside | opening, deg | s | the paper |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n"
    );
    for (k, it) in outcomes.iter().enumerate() {
        let defects = it.defects;
        let mark = if drawn.contains(&k) { "**" } else { "" };
        writeln!(
            text,
            "| {mark}{}{mark} | {} | {} | {} | {:.3} | {} | {} | {} | {} | {} | {} | {:.1} | {:.1} | {} |",
            it.name,
            it.coordinates,
            it.rate,
            it.steps,
            100.0 * it.outline_error / radius,
            percent(defects.gap[0]),
            percent(defects.gap[1]),
            percent(defects.overlap[0]),
            percent(defects.overlap[1]),
            percent(defects.void),
            percent(defects.outside),
            it.opening_deg,
            it.seconds,
            it.paper,
        )?;
    }
    Ok(text)
}

fn csv(outcomes: &[Outcome], radius: f64) -> Result<String> {
    let mut text =
        "approach,coordinates,rate,steps,boundary_over_radius,gap_flat,gap_deployed,overlap_flat,\
                    overlap_deployed,void,outside,opening_deg,seconds\n"
            .to_owned();
    for it in outcomes {
        let defects = it.defects;
        writeln!(
            text,
            "\"{}\",{},{},{},{:.6},{:.3e},{:.3e},{:.3e},{:.3e},{:.3e},{:.3e},{:.3},{:.2}",
            it.name,
            it.coordinates,
            it.rate,
            it.steps,
            it.outline_error / radius,
            defects.gap[0],
            defects.gap[1],
            defects.overlap[0],
            defects.overlap[1],
            defects.void,
            defects.outside,
            it.opening_deg,
            it.seconds,
        )?;
    }
    Ok(text)
}
