//! `kirigami-studies gradient`: Taylor test of the design gradient; section 5.3.
//!
//! ```text
//! R_1(h) = |L(theta + h v) - L(theta)|,   R_2(h) = |L(theta + h v) - L(theta) - h dL/dtheta . v|      (23)
//! ```
//!
//! for random unit directions v. R_2 decreases as h^2 until rounding and the solver's tolerance dominate.

use crate::charts::{self, TaylorLine};
use anyhow::{Result, ensure};
use clap::Args;
use design::analysis::taylor::TaylorRemainders;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::progress::Progress;
use kirigami::ui::{picture, run_folder};
use std::path::PathBuf;
use support::table::{Cell, Table};

/// Measure the Taylor remainders of the design gradient of scenes
///
/// At the start design of each scene plus noise, which avoids special points, the loss is evaluated along
/// random unit directions of the whole design: z, ell and omega. Writes gradient.csv, gradient.md and a chart.
/// Example: kirigami-studies gradient configs/scenes/linear-7x7.toml configs/scenes/demo.toml
#[derive(Args)]
pub struct GradientStudy {
    /// Scenes (TOML)
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    /// Number of random directions that the remainders are averaged over
    #[arg(long, value_name = "N", default_value_t = 8)]
    directions: usize,
    /// Relative residual of a converged equilibrium, instead of the scenes'
    #[arg(long, value_name = "FRACTION")]
    tolerance: Option<f64>,
    /// Folder for the tables and the chart
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-gradient")]
    out: PathBuf,
}

/// The largest step, and the number of halvings.
const FIRST: f64 = 0.125;
const STEPS: usize = 20;
/// Standard deviation of the noise on the design at which the gradient is tested.
const NOISE: f64 = 0.2;

/// The remainders of one scene, averaged over the directions.
struct Verified {
    name: String,
    loss: f64,
    steps: Vec<f64>,
    remainders: Vec<f64>,
}

impl GradientStudy {
    pub fn run(&self) -> Result<()> {
        ensure!(self.directions > 0, "--directions must be at least 1");
        let _held = run_folder::hold(&self.out)?;
        let bar = Progress::new(self.scenes.len() * self.directions, "directions");
        let mut verified = Vec::new();
        for path in &self.scenes {
            let mut config: SceneConfig = support::toml_file::read(path)?;
            if let Some(tolerance) = self.tolerance {
                config.solver.tolerance = tolerance;
            }
            let scene = Scene::new(config, path)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            verified.push(self.verify(&scene, &name, &bar, verified.len())?);
        }
        bar.finish();
        let page = page(&verified, self.directions);
        run_folder::write(&self.out, "gradient.md", &page)?;
        run_folder::write(&self.out, "gradient.csv", &csv(&verified))?;
        let lines: Vec<_> = verified
            .iter()
            .map(|it| TaylorLine {
                name: &it.name,
                points: std::iter::zip(&it.steps, &it.remainders)
                    .map(|(h, r)| (*h, r / it.loss.abs()))
                    .collect(),
            })
            .collect();
        picture::save(&charts::taylor(&lines)?, &self.out.join("gradient"), 1200)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn verify(&self, scene: &Scene, name: &str, bar: &Progress, before: usize) -> Result<Verified> {
        let design = noisy(scene, NOISE, 0)?;
        let problem = scene.problem()?;
        let evaluation = problem.evaluate(&design)?;
        let (x, gradient) = (design.to_flat(), evaluation.gradient.to_flat());
        let (mut steps, mut remainders) = (Vec::new(), vec![0.0; STEPS]);
        for k in 0..self.directions {
            let far = noisy(scene, 1.0, 1 + k as u64)?.to_flat();
            let centre = noisy(scene, 0.0, 0)?.to_flat();
            let mut direction: Vec<_> = std::iter::zip(far, centre).map(|(x, y)| x - y).collect();
            let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
            direction.iter_mut().for_each(|d| *d /= length);
            let loss = |x: &[f64]| problem.loss(&design.with_flat(x));
            let taylor = TaylorRemainders::new(loss, &x, &gradient, &direction, FIRST, STEPS)?;
            for (sum, remainder) in remainders.iter_mut().zip(&taylor.remainders) {
                *sum += remainder / self.directions as f64;
            }
            steps = taylor.steps;
            bar.show(before * self.directions + k + 1, None, name);
        }
        Ok(Verified {
            name: name.to_owned(),
            loss: evaluation.loss,
            steps,
            remainders,
        })
    }
}

/// The start design of a scene with seeded noise.
fn noisy(
    scene: &Scene,
    noise: f64,
    seed: u64,
) -> Result<design::pattern::design_vector::DesignVector> {
    let mut scene = scene.clone();
    scene.config.optimiser.start_noise = noise;
    scene.config.optimiser.seed = seed;
    Ok(scene.start())
}

impl Verified {
    /// The order over the longest run of steps between which the remainder decreases by more than the square root
    /// of 8, an order of 1.5. Larger steps show higher orders, smaller steps rounding.
    fn order(&self) -> Option<f64> {
        let orders: Vec<f64> = (self.remainders.windows(2))
            .map(|pair| (pair[0] / pair[1]).log2())
            .collect();
        let runs = orders.split(|order| !(1.5..2.5).contains(order));
        let longest = runs.max_by_key(|run| run.len())?;
        let sum: f64 = longest.iter().sum();
        (!longest.is_empty()).then(|| sum / longest.len() as f64)
    }

    /// The smallest remainder relative to the loss, at which rounding and the solver's tolerance dominate.
    fn floor(&self) -> f64 {
        let minimum = self
            .remainders
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        minimum / self.loss.abs()
    }
}

fn page(verified: &[Verified], directions: usize) -> String {
    let table = Table::new()
        .column("scene", |scene: &Verified| Cell::text(&scene.name))
        .column("loss", |scene| Cell::fixed(scene.loss, 6))
        .column("order of R_2", |scene| {
            Cell::known(scene.order().map(|order| Cell::fixed(order, 3)), "none")
        })
        .column("floor", |scene| Cell::scientific(scene.floor(), 1));
    format!(
        "# Verification of the gradient\n\n\
         Taylor remainders R_2 of (23) at the start design of each scene with noise {NOISE}, averaged over \
         {directions} random unit directions of the whole design. The order is that over the steps between which R_2 \
         decreases with a power between 1.5 and 2.5; the floor is the smallest remainder relative to the loss. \
         `kirigami-studies gradient`.\n\n{}",
        table.markdown(verified)
    )
}

/// One row per step.
fn csv(verified: &[Verified]) -> String {
    let rows: Vec<_> = verified
        .iter()
        .flat_map(|scene| {
            let steps = std::iter::zip(&scene.steps, &scene.remainders);
            steps.map(|(h, remainder)| (scene.name.as_str(), *h, *remainder))
        })
        .collect();
    Table::new()
        .column("scene", |row: &(&str, f64, f64)| Cell::text(row.0))
        .column("h", |row| Cell::scientific(row.1, 2))
        .column("remainder", |row| Cell::scientific(row.2, 2))
        .csv(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verified(remainder: impl Fn(f64) -> f64) -> Verified {
        let steps: Vec<f64> = (0..STEPS).map(|k| FIRST * 0.5f64.powi(k as i32)).collect();
        Verified {
            name: "case".to_owned(),
            loss: 2.0,
            remainders: steps.iter().map(|h| remainder(*h)).collect(),
            steps,
        }
    }

    #[test]
    fn the_order_is_found_between_higher_orders_and_rounding() {
        let exact = verified(|h| h * h + 50.0 * h.powi(4) + 1e-12);
        assert!(
            (exact.order().unwrap() - 2.0).abs() < 0.05,
            "{:?}",
            exact.order()
        );
        assert!((exact.floor() - 0.5e-12).abs() < 0.5e-12);
        let wrong = verified(|h| 0.1 * h);
        assert_eq!(wrong.order(), None);
    }
}
