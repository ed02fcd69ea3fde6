//! The levels as they are used: a search at each of them from the same random starts, and all its designs judged by one reference.

use crate::choices::Choice;
use crate::designed::designed;
use crate::spread::spread;
use anyhow::Result;
use design::objective::design_problem::DesignProblem;
use design::objective::scores::outline_error;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::exit::Unfinished;
use kirigami::ui::progress::Progress;
use output::run_results::remove_run;
use std::time::Instant;
use support::table::{Cell, Table};

/// Standard deviation of the coordinates of a random start.
const START_NOISE: f64 = 0.3;

/// The searches at one level.
struct Searched {
    level: String,
    /// One number a search that ended: wall time (s), outline error by its own law, outline error and loss by the reference.
    seconds: Vec<f64>,
    own: Vec<f64>,
    outline: Vec<f64>,
    loss: Vec<f64>,
    starts: u64,
}

/// The table of all levels.
pub(super) fn table(
    levels: &[Choice],
    (reference, judge): (&str, &DesignProblem),
    starts: u64,
    scene: impl Fn(SceneConfig, &str) -> Result<Scene>,
) -> Result<String> {
    let bar = Progress::new(levels.len() * starts as usize, "searches");
    let mut rows = Vec::new();
    for (i, level) in levels.iter().enumerate() {
        let mut row = Searched {
            level: level.name.clone(),
            seconds: Vec::new(),
            own: Vec::new(),
            outline: Vec::new(),
            loss: Vec::new(),
            starts,
        };
        for seed in 0..starts {
            bar.show(i * starts as usize + seed as usize, None, &level.name);
            let mut config = level.config.clone();
            (config.optimiser.start_noise, config.optimiser.seed) = (START_NOISE, seed);
            let scene = scene(config, &format!("search-{i}-{seed}"))?;
            row.add(&scene, judge)?;
        }
        rows.push(row);
    }
    bar.finish();
    Ok(format!(
        "A search at each level from {starts} random starts (standard deviation {START_NOISE} of the coordinates). Own: by the law of the level; \
         outline error and loss by {reference}, for all levels. Median, and the range in brackets; wall time on a busy machine.\n\n{}",
        columns().markdown(&rows)
    ))
}

impl Searched {
    /// Searches once. A search that is stuck, and a design that the reference cannot deploy, are counted and no more.
    fn add(&mut self, scene: &Scene, judge: &DesignProblem) -> Result<()> {
        // A search that is resumed has no time.
        remove_run(scene)?;
        let begun = Instant::now();
        let found = match designed(scene, &mut |_| ()) {
            Ok(found) => found,
            Err(error) if error.is::<Unfinished>() => return Err(error),
            Err(error) => {
                eprintln!("{}: {error:#}", self.level);
                return Ok(());
            }
        };
        let seconds = begun.elapsed().as_secs_f64();
        let Ok(judged) = judge.evaluate(&found.design) else {
            return Ok(());
        };
        self.seconds.push(seconds);
        self.own.push(outline_error(
            &found.problem.objective,
            &found.best.deployment,
        ));
        self.outline
            .push(outline_error(&judge.objective, &judged.deployment));
        self.loss.push(judged.loss);
        Ok(())
    }
}

fn columns<'a>() -> Table<'a, Searched> {
    Table::new()
        .column("level", |row: &Searched| Cell::text(&row.level))
        .column("ended", |row| {
            Cell::text(format!("{} of {}", row.outline.len(), row.starts))
        })
        .column("a search, s", |row| spread(&row.seconds, 1))
        .column("outline, own, mm", |row| spread(&row.own, 2))
        .column("outline, mm", |row| spread(&row.outline, 2))
        .column("loss, mm^2", |row| spread(&row.loss, 1))
}
