//! Drafts: the sheet at full load, next to the last one, as it is shown while something is dragged
//! and in every step of a search.

use crate::full_analysis::milliseconds;
use design::equilibrium::warm_start::WarmStart;
use design::optimise::outer_loop::SearchState;
use design::{Deployment, DesignError, DesignProblem, DesignVector};
use output::run_page::{History, SheetData};
use scene::Scene;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Time between two steps of a search that are shown.
const SHOW_EVERY: Duration = Duration::from_millis(80);

/// What a draft shows.
#[derive(Serialize)]
pub(crate) struct Draft<'a> {
    sheet: SheetData<'a>,
    ms: f64,
}

/// A step of a search.
#[derive(Serialize)]
pub(crate) struct Step<'a> {
    step: usize,
    of: usize,
    /// Time that the other steps will take at most (s); `None` at the first one.
    seconds_left: Option<f64>,
    history: History,
    draft: Option<Draft<'a>>,
}

impl<'a> Draft<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
        begin: Instant,
    ) -> Self {
        Self { sheet: SheetData::new(scene, problem, deployment), ms: milliseconds(begin) }
    }
}

/// The steps of a search that are shown: not more than the page can draw.
#[derive(Default)]
pub(crate) struct Steps {
    /// When the first step of this session was made, and which.
    first: Option<(Instant, usize)>,
    last: Option<Instant>,
    known: Option<WarmStart>,
}

impl Steps {
    pub(crate) fn step<'a>(
        &mut self,
        scene: &'a Scene,
        problem: &DesignProblem,
        search: &SearchState,
    ) -> Option<Step<'a>> {
        if self.last.is_some_and(|last| last.elapsed() < SHOW_EVERY) {
            return None;
        }
        let begin = Instant::now();
        let (step, of) = (search.last().step, scene.config.optimiser.steps);
        let (first, first_step) = *self.first.get_or_insert((begin, step));
        let made = step.saturating_sub(first_step);
        let left = of.saturating_sub(step) as f64 * first.elapsed().as_secs_f64() / made as f64;
        let deployment = draft(problem, search.last_design(), self.known.as_ref()).ok();
        self.known = deployment.as_ref().map(Deployment::warm_start);
        self.last = Some(Instant::now());
        Some(Step {
            step,
            of,
            seconds_left: (made > 0).then_some(left),
            history: History::new(&problem.objective, &search.history),
            draft: deployment.map(|deployment| Draft::new(scene, problem, &deployment, begin)),
        })
    }
}

/// A draft of the sheet at full load.
pub(crate) fn draft(
    problem: &DesignProblem,
    design: &DesignVector,
    known: Option<&WarmStart>,
) -> Result<Deployment, DesignError> {
    let deployment = match problem.model.mechanics() {
        Some(_) => problem.draft(design, known)?.deployment,
        None => problem.deploy(design)?,
    };
    deployment.at_full_load()?;
    Ok(deployment)
}
