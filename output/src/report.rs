//! The report of a design run: the objective before and after, all hinges, warnings.

mod budget;
mod creep_and_springback;
mod estimate;
mod fact_sheet;
mod hinge_row;
pub(crate) mod numbers;
mod rules;
mod self_weight;
mod text;
mod warning;

pub(crate) use budget::BUDGET_HEADING;
pub(crate) use estimate::force_spreads;
pub(crate) use fact_sheet::{extent, miss};
pub(crate) use numbers::rounded;
pub(crate) use text::worst_first;

pub use budget::Budget;
pub use creep_and_springback::{CreepAndSpringback, Released};
pub use estimate::Estimate;
pub use fact_sheet::{FactSheet, Reached, SpotCheckFacts, WeightFacts};
pub use hinge_row::HingeRow;
pub use self_weight::{Lying, SelfWeight};
pub use warning::{Concern, Warning};

use crate::cut_file::{CutLines, FabricationError};
use crate::report::rules::{RuleInput, RunContext};
use design::objective::design_problem::Deployment;
use design::objective::scores::Scores;
use design::optimise::outer_loop::Ended;
use analysis::design_checks::DesignChecks;
use analysis::error_budget::ErrorBudget;
use scene::design_run::Designed;
use scene::{CoarseSearch, Level, LevelDifference, Scene};
use serde::Serialize;
use support::severity::Severity;

/// The report of a run, for people (`Display`) and programs (JSON).
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Title of the scene.
    pub title: String,
    /// Why the run ended.
    pub ended: Ended,
    /// The searches at coarser levels that found the start, if there were any.
    pub coarse_searches: Vec<CoarseSearch>,
    /// Number of steps after the start.
    pub steps: usize,
    /// Number of steps that were halved because a design had no objective value.
    pub setbacks: usize,
    /// The terms of the scores in words, with their units.
    #[serde(skip)]
    pub terms: Vec<String>,
    /// Scores of the start.
    pub before: Scores,
    /// Scores of the best design.
    pub after: Scores,
    /// Standard deviations of the scene's ensemble on the path of the best design, if there is an
    /// ensemble.
    pub estimate: Option<Estimate>,
    /// By how much each cause of errors moves the best design; `None` without a learned hinge law
    /// or without an equilibrium.
    pub budget: Option<Budget>,
    /// What the sheet is made of, how far it opens under which load, and what the hinge law rests
    /// on.
    pub facts: FactSheet,
    /// Whether a cut file was written.
    pub cut_file: bool,
    /// All hinges of the best design.
    pub hinges: Vec<HingeRow>,
    /// All warnings about the best design, the most severe first.
    pub warnings: Vec<Warning>,
    /// What was measured of the best design after the search.
    pub checks: DesignChecks,
}

/// All warnings about a deployed design with the given cut lines, the most severe first.
pub fn warnings(
    scene: &Scene,
    deployment: &Deployment,
    cuts: &Result<CutLines, FabricationError>,
) -> Vec<Warning> {
    rules::warnings(&RuleInput {
        scene,
        deployment,
        cuts,
        hinges: &HingeRow::all(scene, deployment),
        run: None,
    })
}

impl Report {
    /// The errors, for which no cut file is written unless forced.
    pub fn errors(&self) -> impl Iterator<Item = &Warning> {
        let warnings = self.warnings.iter();
        warnings.filter(|warning| warning.severity == Severity::Error)
    }

    /// What is said about the cut files unless they were written without errors.
    pub fn about_cut_files(&self) -> Option<&'static str> {
        match (self.cut_file, self.errors().next()) {
            (false, _) => Some("NO CUT FILE"),
            (true, Some(_)) => Some("CUT FILE FORCED"),
            (true, None) => None,
        }
    }

    /// How far the outline is from the target, which is the first that a person asks.
    pub fn miss(&self) -> String {
        miss(self.after.outline_error, self.facts.flat_size)
    }

    /// The searches at coarser levels: the error of each, measured by the next finer one.
    pub fn coarse_search_lines(&self) -> Vec<String> {
        let searches = self.coarse_searches.iter().map(|search| {
            let percent = |load| format!(", the load by {} %", rounded(100.0 * load, 2));
            let peak = |peak| format!(", D_peak by {}", rounded(peak, 2));
            let LevelDifference {
                corners,
                load,
                damage,
            } = search.difference;
            let reference = match search.finer {
                Level::Final => "finite elements of every hinge".to_owned(),
                finer => format!("`{finer}`"),
            };
            format!(
                "searched at the level `{}` in {} steps: its corners differ from {reference} by {} mm at most{}{}; tolerance: {} mm",
                search.level,
                search.steps,
                rounded(corners[1], 2),
                load.map_or(String::new(), percent),
                damage.map_or(String::new(), peak),
                rounded(search.tolerance, 3)
            )
        });
        let mut lines: Vec<String> = searches.collect();
        if self.coarse_searches.last().is_some_and(|last| !last.suffices()) {
            lines.push(match self.steps {
                _ if self.facts.level == Level::Final => {
                    "not converged: all rounds of finite elements were made".into()
                }
                0 => "that is less than the mesh of the windows is known to: see its row of the error budget".into(),
                _ => format!(
                    "searched on at `{}`, and no level is finer: `kirigami verify --equilibrium` compares with finite elements",
                    self.facts.level
                ),
            });
        }
        lines
    }

    /// How the search ended.
    pub fn end_of_search(&self) -> String {
        let steps = self.steps;
        match &self.ended {
            Ended::Completed => format!("{steps} steps"),
            Ended::Stopped if steps == 0 => "not begun".to_owned(),
            Ended::Stopped => format!("stopped after {steps} steps; run again to continue"),
            Ended::Settled => {
                format!("settled after {steps} steps: no further step lowers the loss")
            }
            Ended::Stuck { reason } => format!("stuck after {steps} steps: {reason}"),
        }
    }

    /// The report of a run of `scene`, whose best design has the given cut lines. The cut files are
    /// written if there are no errors, or if `force`; `checks` are of that design.
    pub fn new(
        scene: &Scene,
        designed: &Designed,
        cuts: &Result<CutLines, FabricationError>,
        checks: DesignChecks,
        force: bool,
    ) -> Self {
        let deployment = &designed.best.deployment;
        let hinges = HingeRow::all(scene, deployment);
        let facts = FactSheet::new(scene, &designed.problem, deployment, &hinges);
        let last = designed.coarse_searches.last();
        let by_elements = last.filter(|search| search.finer == Level::Final);
        let residual = by_elements.map(|search| search.difference.corners[1]);
        let errors = ErrorBudget::new(scene, &designed.problem, deployment, residual);
        let dead_loads = scene.config.has_loads() && scene.config.drive.is_none();
        let budget = errors.map(|errors| Budget::new(errors, &facts.self_weight, dead_loads));
        let after = Scores::new(&designed.problem.objective, &designed.best);
        let warnings = rules::warnings(&RuleInput {
            scene,
            deployment,
            cuts,
            hinges: &hinges,
            run: Some(RunContext { designed, facts: &facts, after: &after, checks: &checks }),
        });
        let mut report = Self {
            cut_file: false,
            title: scene.config.title.clone(),
            ended: designed.ended.clone(),
            coarse_searches: designed.coarse_searches.clone(),
            steps: designed.search.last().step,
            setbacks: designed
                .search
                .history
                .iter()
                .filter(|record| record.setback.is_some())
                .count(),
            terms: designed.problem.objective.labels(),
            before: match designed.coarse_searches.first() {
                Some(first) => first.start.clone(),
                None => Scores::new(&designed.problem.objective, &designed.start),
            },
            after,
            estimate: Estimate::new(scene.networks(), deployment),
            budget,
            facts,
            warnings,
            checks,
            hinges,
        };
        report.cut_file = cuts.is_ok() && (force || report.errors().next().is_none());
        report
    }
}
