//! The report of a design run: the objective before and after, all hinges, warnings.

mod budget;
mod deployed;
mod facts;
mod findings;
mod force_spreads;
mod hinge_row;
pub(crate) mod numbers;
mod reached;
mod text;

pub(crate) use budget::BUDGET_HEADING;
pub(crate) use deployed::{extent, miss};
pub(crate) use facts::{mounting_step, open_by_hand};
pub(crate) use force_spreads::force_spreads;
pub(crate) use numbers::rounded;
pub(crate) use text::worst_first;

pub use budget::Budget;
pub use facts::Fact;
pub use findings::{Rule, Warning, rules};
pub use hinge_row::HingeRow;
pub use reached::Reached;

use crate::{
    cut_file::CutLines,
    report::{
        deployed::{DeployedDesign, FinishedRun, left_out},
        facts::facts,
        findings::findings,
    },
};
use analysis::{
    design_checks::DesignChecks, error_budget::ErrorBudget, mounting::Mounting, what_if::what_if,
};
use design::{
    objective::{design_problem::Deployment, scores::Scores},
    optimise::outer_loop::Ended,
};
use scene::{CoarseSearch, Level, Scene, design_run::Designed, placement::seen};
use serde::Serialize;
use support::{Fault, severity::Severity};

/// The report of a run, for people (`Display`) and programs (JSON).
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Title of the scene.
    pub title: String,
    /// Why the run ended.
    pub ended: Ended,
    /// The searches at coarser levels before, if there were any.
    pub coarse_searches: Vec<CoarseSearch>,
    /// Number of steps after the start, without the searches at coarser levels.
    pub steps: usize,
    /// The terms of the scores in words, with their units.
    #[serde(skip)]
    pub terms: Vec<String>,
    /// Scores of the start.
    pub before: Scores,
    /// Scores of the best design.
    pub after: Scores,
    /// Area in common of what one sees of the opened panels, gaps closed, and the target, over the
    /// area of both.
    pub seen: f64,
    /// How far each cause of errors moves the best design; `None` without a learned hinge law
    /// or without an equilibrium.
    pub budget: Option<Budget>,
    /// What the sheet is made of, how far it opens under which load, and what the hinge law rests
    /// on.
    pub facts: Vec<Fact>,
    /// How the sheet is mounted on a board; `None` if it is not.
    #[serde(skip)]
    pub mounting: Option<Mounting>,
    /// Load and stroke at the end of the path; `None` without equilibrium, of a mounted sheet, and if
    /// nothing moves the sheet.
    #[serde(skip)]
    pub reached: Option<Reached>,
    /// How much of the hinges is modelled.
    #[serde(skip)]
    level: Level,
    /// How much of its target the sheet shows, which is the first that a person asks.
    #[serde(skip)]
    pub miss: String,
    /// Whether the hinge law has a training domain.
    #[serde(skip)]
    has_domain: bool,
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
    cuts: &Result<CutLines, Fault>,
) -> Vec<Warning> {
    let hinges = HingeRow::all(scene, deployment);
    findings(&DeployedDesign { scene, deployment, cuts, hinges, run: None, severities: Vec::new() })
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

    /// How the search ended.
    pub fn end_of_search(&self) -> String {
        let coarse = self.coarse_searches.iter().map(CoarseSearch::steps);
        let steps = coarse.sum::<usize>() + self.steps;
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
        cuts: &Result<CutLines, Fault>,
        checks: DesignChecks,
        force: bool,
    ) -> Self {
        let (deployment, problem) = (&designed.best.deployment, &designed.problem);
        let mounting = Mounting::new(scene, problem, deployment);
        // A mean over fasteners says nothing of one.
        let reached =
            mounting.is_none().then(|| Reached::new(scene, problem, deployment)).flatten();
        let run = FinishedRun {
            designed,
            after: Scores::new(&problem.objective, &designed.best),
            seen: seen(scene, deployment),
            checks,
            mounting,
            changes: what_if(scene, problem, &designed.search.best, deployment),
            reached,
        };
        let hinges = HingeRow::all(scene, deployment);
        let mut deployed = DeployedDesign {
            scene,
            deployment,
            cuts,
            hinges,
            run: Some(&run),
            severities: Vec::new(),
        };
        let warnings = findings(&deployed);
        deployed.severities = warnings.iter().map(|found| found.severity).collect();
        let facts = facts(&deployed, &run);
        let miss = miss(run.seen, run.after.outline_error, deployed.flat_size());
        let hinges = deployed.hinges;
        let coarse_searches = &designed.coarse_searches;
        let last = coarse_searches.last().filter(|search| search.finer == Level::Final);
        let residual = last.map(|search| search.difference.corners[1]);
        let errors = ErrorBudget::new(scene, problem, deployment, residual);
        let dead_loads = scene.config.has_loads() && scene.config.drive.is_none();
        let mut report = Self {
            cut_file: false,
            title: scene.config.title.clone(),
            ended: designed.ended.clone(),
            coarse_searches: coarse_searches.clone(),
            steps: designed.search.last().step,
            terms: problem.objective.labels(),
            before: Scores::new(&problem.objective, &designed.start),
            after: run.after,
            budget: errors.map(|errors| Budget::new(errors, left_out(scene), dead_loads)),
            facts,
            reached: run.reached,
            level: scene.config.level,
            seen: run.seen,
            miss,
            has_domain: scene.surrogate().is_some(),
            warnings,
            checks: run.checks,
            mounting: run.mounting,
            hinges,
        };
        report.cut_file = cuts.is_ok() && (force || report.errors().next().is_none());
        report
    }
}
