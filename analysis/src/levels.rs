//! Cost of each level of a scene, and its difference to the finest one.

use crate::error_budget::{Contribution, ErrorBudget, ErrorCause};
use crate::level_difference::{AtLevel, deployed};
use design::optimise::outer_loop::optimise;
use design::pattern::design_vector::DesignVector;
use scene::design_run::BegunRun;
use scene::{Level, LevelDifference, Scene};
use serde::{Deserialize, Serialize};
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use support::Fault;
use support::document::Document;
use support::table::{Cell, Table};

/// Steps of a search that are timed: one whose path is followed, and those up to the next one.
const TIMED: usize = 10;
/// Steps of a search of a scene that has none, such as a run that evaluates a design.
const USUAL: usize = 100;

/// A level of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LevelCost {
    /// The level.
    pub level: Level,
    /// Seconds of a step of its search, the mean of the first ten; `None` if there is no search.
    pub step: Option<f64>,
    /// Seconds of all steps of the scene, or of 100 if it has none, at that rate.
    pub search: Option<f64>,
    /// Load at the end of the path (N, or N mm), where the motion is prescribed.
    pub load: Option<f64>,
    /// The largest D_peak of a hinge along the path.
    pub damage: Option<f64>,
    /// The difference of the design to the finest level; `None` for that one.
    pub difference: Option<LevelDifference>,
    /// Why the design has no state at the level.
    pub failure: Option<String>,
}

/// The levels of a scene at one design.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Levels {
    /// The levels, from the cheapest to the finest.
    pub levels: Vec<LevelCost>,
    /// What no level buys: the causes of errors of the finest level other than its networks.
    pub others: Vec<Contribution>,
}

impl Levels {
    /// The table, and what it leaves out.
    pub fn document(&self) -> Document {
        let mut table = Table::new([
            "level",
            "step\ns",
            "search\ns",
            "corners, rms\nmm",
            "largest\nmm",
            "load\n%",
            "D_peak\n",
        ]);
        self.levels.iter().for_each(|level| table.row(level.cells()));
        let finest = self.levels.last().map_or("", |level| level.level.name());
        let mut page = Document::default();
        page.table(table);
        page.text(format!(
            "step, search: of the search, at the speed of its first ten steps; corners, load, D_peak: differences to `{finest}`"
        ));
        page.list(self.levels.iter().filter_map(|level| {
            let failure = level.failure.as_ref()?;
            Some(format!("{}: {failure}", level.level))
        }));
        page.list(self.others.iter().map(|other| {
            let corners = other
                .effect
                .as_ref()
                .map_or("not known".into(), |effect| format!("{:.3} mm", effect.corners[1]));
            format!("no level lowers: {}, {corners}", other.cause.name())
        }));
        page
    }
}

impl LevelCost {
    fn cells(&self) -> [Cell; 7] {
        let difference = self.difference.as_ref();
        [
            Cell::text(self.level.name()),
            Cell::fixed(self.step, 4),
            Cell::fixed(self.search, 1),
            Cell::fixed(difference.map(|found| found.corners[0]), 3),
            Cell::fixed(difference.map(|found| found.corners[1]), 3),
            Cell::fixed(difference.and_then(|found| found.load).map(|x| 100.0 * x), 2),
            Cell::fixed(difference.and_then(|found| found.damage), 4),
        ]
    }
}

/// Measures every level that a scene has networks for, and those below. `progress` is called with
/// each before it is measured.
pub fn levels(
    scene: &Scene,
    design: &DesignVector,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(Level),
) -> Result<Levels, Fault> {
    let scenes = Level::ALL.into_iter();
    let scenes: Vec<Scene> = scenes.filter_map(|level| scene.at_level(level).ok()).collect();
    let finest = scenes.last().unwrap_or(scene);
    progress(finest.config.level);
    let (problem, deployment) = deployed(finest, design)?;
    let reference = AtLevel::new(finest.config.level, &problem, &deployment);
    let mut found = Vec::new();
    for scene in &scenes {
        let level = scene.config.level;
        progress(level);
        let mut design = design.clone();
        if level == Level::Pin {
            design.opening.get_or_insert(deployment.final_step().mean_opening());
        }
        let step = seconds(scene, stop);
        let is_finest = level == finest.config.level;
        let at = match is_finest {
            true => Ok(reference.clone()),
            false => deployed(scene, &design).map(|(of, to)| AtLevel::new(level, &of, &to)),
        };
        let known = at.as_ref().ok();
        let search = step.map(|step| step * steps(scene) as f64);
        found.push(LevelCost {
            level,
            step,
            search,
            load: known.and_then(|at| at.load),
            damage: known.and_then(|at| at.damage_peak),
            difference: (known.filter(|_| !is_finest)).map(|at| at.difference(&reference)),
            failure: at.as_ref().err().map(ToString::to_string),
        });
    }
    let budget = ErrorBudget::new(finest, &problem, &deployment, None);
    let others = budget.into_iter().flat_map(|budget| budget.contributions);
    Ok(Levels {
        levels: found,
        others: others.filter(|part| part.cause != ErrorCause::Network).collect(),
    })
}

fn steps(scene: &Scene) -> usize {
    match scene.config.optimiser.steps {
        0 => USUAL,
        steps => steps,
    }
}

/// Seconds of a step of the search from the start of a scene; `None` if that has no search.
fn seconds(scene: &Scene, stop: &AtomicBool) -> Option<f64> {
    let begin = Instant::now();
    let run = BegunRun::new(scene.clone(), None).ok()?;
    let (mut search, last) = (run.begun(), TIMED.min(steps(scene)) - 1);
    let Ok(_) = optimise::<Infallible>(&run.problem, &mut search, last, stop, &mut |_| Ok(()));
    Some(begin.elapsed().as_secs_f64() / search.history.len() as f64)
}
