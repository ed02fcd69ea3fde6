//! `kirigami-studies optimisers`: Adam, L-BFGS and Gauss-Newton at equal cost.

use crate::designed::designed;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::geometry::chamfer::Precision;
use design::optimise::outer_loop::{Ended, StepRecord};
use design::optimise::search::SearchMethod;
use design::scene::design_run::forget;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::progress::Progress;
use kirigami::ui::run_folder;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use support::processes::cpu_seconds;

/// Compare Adam, L-BFGS and Gauss-Newton on scenes at an equal number of evaluations of the loss and its gradient
///
/// The distance of the outline is measured to the samples of the target, as in the paper, and to the curve
/// through them. Writes optimisers.csv and optimisers.md. Example: kirigami-studies optimisers
/// configs/scenes/linear-7x7.toml configs/scenes/pin-7x7.toml configs/scenes/shield-16x22.toml
#[derive(Args)]
pub struct OptimiserStudy {
    /// Scenes (TOML)
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    /// Number of evaluations, as a multiple of the steps of each scene
    #[arg(long, value_name = "FACTOR", default_value_t = 1)]
    times: usize,
    /// Folder for the table and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-optimisers")]
    out: PathBuf,
}

const NO_TIME: &str = "the operating system does not report the CPU time of this process";
const METHODS: [SearchMethod; 3] = [
    SearchMethod::Adam,
    SearchMethod::Lbfgs,
    SearchMethod::GaussNewton,
];

/// One search of a scene.
struct Searched {
    scene: String,
    precision: Precision,
    method: SearchMethod,
    evaluations: usize,
    /// Minimum loss after a quarter, a half and all of the evaluations.
    losses: [f64; 3],
    /// Outline error of the best design (mm).
    outline_error: f64,
    /// CPU time of all threads for an evaluation, with that of the step from it (s).
    seconds: f64,
    /// Minimum loss after each number of evaluations.
    progress: Vec<(usize, f64)>,
    settled: bool,
}

impl OptimiserStudy {
    pub fn run(&self) -> Result<()> {
        ensure!(self.times > 0, "--times must be at least 1");
        let _held = run_folder::hold(&self.out)?;
        let bar = Progress::new(2 * METHODS.len() * self.scenes.len(), "searches");
        let mut searched = Vec::new();
        for path in &self.scenes {
            for precision in [Precision::Samples, Precision::Curve] {
                for method in METHODS {
                    searched.push(self.search(path, precision, method)?);
                    bar.show(searched.len(), None, "");
                }
            }
        }
        bar.finish();
        let page = page(&searched)?;
        run_folder::write(&self.out, "optimisers.md", &page)?;
        run_folder::write(&self.out, "optimisers.csv", &csv(&searched)?)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn search(&self, path: &Path, precision: Precision, method: SearchMethod) -> Result<Searched> {
        let mut config: SceneConfig = support::toml_file::read(path)?;
        let name = path.file_stem().unwrap_or_default();
        let name = name.to_string_lossy().into_owned();
        config.objective.precision = precision;
        config.optimiser.method = method;
        config.optimiser.steps *= self.times;
        let budget = config.optimiser.steps + 1;
        config.output = std::path::absolute(&self.out)?
            .join("runs")
            .join(format!("{name}-{precision:?}-{method:?}").to_lowercase());
        let scene = Scene::new(config, path)?;
        // The time is that of a whole search.
        forget(&scene)?;
        let process = std::process::id();
        let began = cpu_seconds(process).context(NO_TIME)?;
        let designed = designed(&scene, &mut |_| {})?;
        let spent = cpu_seconds(process).context(NO_TIME)? - began;
        let seconds = spent / cost(&designed.history) as f64;
        let within = |budget| afforded(&designed.history, budget);
        let best = |budget: usize| {
            let steps = within(budget).iter();
            steps.min_by(|x, y| x.scores.loss.total_cmp(&y.scores.loss))
        };
        let loss = |budget| best(budget).map_or(f64::NAN, |step| step.scores.loss);
        let affordable = within(budget);
        Ok(Searched {
            scene: name,
            precision,
            method,
            evaluations: cost(affordable),
            losses: [budget / 4, budget / 2, budget].map(loss),
            outline_error: best(budget).map_or(f64::NAN, |step| step.scores.outline_error),
            seconds,
            progress: progress(affordable),
            settled: designed.ended == Ended::Settled && affordable.len() == designed.history.len(),
        })
    }
}

/// The first steps, as many as `budget` evaluations allow.
fn afforded(history: &[StepRecord], budget: usize) -> &[StepRecord] {
    let count = (1..=history.len()).take_while(|count| cost(&history[..*count]) <= budget);
    &history[..count.last().unwrap_or(0)]
}

/// Number of evaluations of the loss and its gradient.
fn cost(steps: &[StepRecord]) -> usize {
    steps.iter().map(|step| 1 + step.halvings as usize).sum()
}

/// Number of evaluations up to each step, and the minimum loss so far.
fn progress(steps: &[StepRecord]) -> Vec<(usize, f64)> {
    let next = |(evaluations, minimum): &mut (usize, f64), step: &StepRecord| {
        *evaluations += cost(std::slice::from_ref(step));
        *minimum = minimum.min(step.scores.loss);
        Some((*evaluations, *minimum))
    };
    steps.iter().scan((0, f64::INFINITY), next).collect()
}

/// Number of evaluations after which a search has the final loss of L-BFGS on the same problem.
fn as_lbfgs(it: &Searched, searched: &[Searched]) -> Option<usize> {
    let final_loss = searched.iter().find(|other| {
        (&other.scene, other.precision) == (&it.scene, it.precision)
            && other.method == SearchMethod::Lbfgs
    });
    let [.., goal] = final_loss?.losses;
    let mut progress = it.progress.iter();
    progress
        .find(|(_, loss)| *loss <= goal)
        .map(|(cost, _)| *cost)
}

fn page(searched: &[Searched]) -> Result<String> {
    let mut text = "# Adam, L-BFGS or Gauss-Newton\n\n\
        The minimum loss after a quarter, a half and all of an equal number of evaluations of the loss and its \
        gradient, from the scene's start; halvings of a step are counted. Losses to samples and to the curve are \
        different functions: compare within three rows. As L-BFGS: evaluations until the loss is the final one of L-BFGS. \
        CPU ms: of an evaluation with the step from it, all threads. Settled: no step lowered the loss further; the attempts \
        that showed this are not counted. `kirigami-studies optimisers`.\n\n\
        | scene | distance to | method | evaluations | loss at 1/4, mm^2 | at 1/2 | at the end | outline error, mm | \
        as L-BFGS | CPU ms | |\n|---|---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for it in searched {
        let [quarter, half, end] = it.losses;
        writeln!(
            text,
            "| {} | {} | {} | {} | {quarter:.1} | {half:.1} | {end:.1} | {:.2} | {} | {:.1} | {} |",
            it.scene,
            format!("{:?}", it.precision).to_lowercase(),
            named(it.method),
            it.evaluations,
            it.outline_error,
            as_lbfgs(it, searched).map_or("-".into(), |cost| cost.to_string()),
            1e3 * it.seconds,
            if it.settled { "settled" } else { "" },
        )?;
    }
    Ok(text)
}

fn named(method: SearchMethod) -> &'static str {
    match method {
        SearchMethod::Adam => "Adam",
        SearchMethod::Lbfgs => "L-BFGS",
        SearchMethod::GaussNewton => "Gauss-Newton",
    }
}

fn csv(searched: &[Searched]) -> Result<String> {
    let mut text =
        "scene,precision,method,evaluations,loss_quarter,loss_half,loss,outline_error,as_lbfgs,\
                    cpu_ms,settled\n"
            .to_owned();
    for it in searched {
        let [quarter, half, end] = it.losses;
        writeln!(
            text,
            "{},{:?},{},{},{quarter:.4},{half:.4},{end:.4},{:.4},{},{:.2},{}",
            it.scene,
            it.precision,
            named(it.method),
            it.evaluations,
            it.outline_error,
            as_lbfgs(it, searched).map_or(String::new(), |cost| cost.to_string()),
            1e3 * it.seconds,
            it.settled,
        )?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use design::objective::scores::Scores;

    #[test]
    fn halvings_count_as_evaluations() {
        let step = |halvings| StepRecord {
            step: 0,
            scores: Scores::default(),
            followed: true,
            halvings,
            setback: None,
        };
        let history = [step(0), step(2), step(1)];
        assert_eq!(cost(&history), 6);
        for (budget, count) in [(0, 0), (1, 1), (3, 1), (4, 2), (5, 2), (6, 3)] {
            assert_eq!(afforded(&history, budget).len(), count);
        }
    }
}
