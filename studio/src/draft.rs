//! Drafts: the sheet at full load, next to the last one, as it is shown while something is dragged
//! and in every step of a search.

use crate::full_analysis::milliseconds;
use design::{
    Deployment, DesignError, DesignProblem, DesignVector, equilibrium::warm_start::WarmStart,
    optimise::outer_loop::SearchState,
};
use output::run_page::{history, sheet_data};
use scene::Scene;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Time between two steps of a search that are shown.
const SHOW_EVERY: Duration = Duration::from_millis(80);

/// What a draft shows.
pub(crate) fn draft_data(
    scene: &Scene,
    problem: &DesignProblem,
    deployment: &Deployment,
    begin: Instant,
) -> Value {
    json!({ "sheet": sheet_data(scene, problem, deployment), "ms": milliseconds(begin) })
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
    /// A step of a search, if it is shown.
    pub(crate) fn step(
        &mut self,
        scene: &Scene,
        problem: &DesignProblem,
        search: &SearchState,
    ) -> Option<Value> {
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
        Some(json!({
            "step": step,
            "of": of,
            // Time that the other steps will take at most (s); null at the first one.
            "seconds_left": (made > 0).then_some(left),
            "history": history(&problem.objective, &search.history),
            "draft": deployment.map(|deployment| draft_data(scene, problem, &deployment, begin)),
        }))
    }
}

/// A draft of the sheet at full load.
pub(crate) fn draft(
    problem: &DesignProblem,
    design: &DesignVector,
    known: Option<&WarmStart>,
) -> Result<Deployment, DesignError> {
    let deployment = match problem.model.mechanics() {
        Some(_) => {
            let drafted = problem.draft(design, known);
            drafted.or_else(|_| problem.draft(design, None))?.deployment
        }
        None => problem.deploy(design)?,
    };
    deployment.at_full_load()?;
    Ok(deployment)
}
