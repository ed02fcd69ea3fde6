//! The report of a design run: the objective before and after, all hinges, warnings.

mod estimate;
mod hinge_row;
mod warning;

pub use estimate::Estimate;
pub use hinge_row::HingeRow;
pub use warning::{Concern, Severity, Warning};

use crate::objective::design_problem::Deployment;
use crate::objective::scores::{Scores, shown};
use crate::optimise::outer_loop::Ended;
use crate::output::cut_file::{CutLines, FabricationError};
use crate::scene::Scene;
use crate::scene::design_run::Designed;
use serde::Serialize;
use std::fmt;

/// The report of a run, for people (`Display`) and programs (JSON).
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Title of the scene.
    pub title: String,
    /// Why the run ended.
    pub ended: Ended,
    /// Number of steps after the start.
    pub steps: usize,
    /// Number of steps that were halved because a design had no objective value.
    pub setbacks: usize,
    /// Scores of the start.
    pub before: Scores,
    /// Scores of the best design.
    pub after: Scores,
    /// Standard deviations of the scene's ensemble on the path of the best design, if there is an ensemble.
    pub estimate: Option<Estimate>,
    /// Whether a cut file was written.
    pub cut_file: bool,
    /// All hinges of the best design.
    pub hinges: Vec<HingeRow>,
    /// All warnings about the best design, the most severe first.
    pub warnings: Vec<Warning>,
}

/// All warnings about a deployed design with the given cut lines, the most severe first.
pub fn warnings(
    scene: &Scene,
    deployment: &Deployment,
    cuts: &Result<CutLines, FabricationError>,
) -> Vec<Warning> {
    let hinges = 0..deployment.sheet.hinges.len();
    let hinges: Vec<HingeRow> = hinges
        .map(|h| HingeRow::new(scene, deployment, h))
        .collect();
    warning::all(scene, deployment, cuts, &hinges)
}

impl Report {
    /// The errors, for which no cut file is written unless forced.
    pub fn errors(&self) -> impl Iterator<Item = &Warning> {
        let warnings = self.warnings.iter();
        warnings.filter(|warning| warning.severity == Severity::Error)
    }

    /// The report of a run of `scene`, whose best design has the given cut lines. The cut files are written if there
    /// are no errors, or if `force`.
    pub fn new(
        scene: &Scene,
        designed: &Designed,
        cuts: &Result<CutLines, FabricationError>,
        force: bool,
    ) -> Self {
        let deployment = &designed.best.deployment;
        let hinges: Vec<HingeRow> = (0..deployment.sheet.hinges.len())
            .map(|h| HingeRow::new(scene, deployment, h))
            .collect();
        let mut report = Self {
            cut_file: false,
            title: scene.config.title.clone(),
            ended: designed.ended.clone(),
            steps: designed.history.len() - 1,
            setbacks: designed
                .history
                .iter()
                .filter(|record| record.setback.is_some())
                .count(),
            before: Scores::of(&designed.problem.objective, &designed.start),
            after: Scores::of(&designed.problem.objective, &designed.best),
            estimate: Estimate::of(&scene.networks(), deployment),
            warnings: warning::all(scene, deployment, cuts, &hinges),
            hinges,
        };
        report.cut_file = cuts.is_ok() && (force || report.errors().next().is_none());
        report
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { before, after, .. } = self;
        writeln!(f, "{}", self.title)?;
        if !self.cut_file {
            writeln!(f, "NO CUT FILE")?;
        } else if self.errors().next().is_some() {
            writeln!(f, "CUT FILE FORCED")?;
        }
        self.errors()
            .try_for_each(|error| writeln!(f, "- {error}"))?;
        match &self.ended {
            Ended::Completed => writeln!(f, "{} steps", self.steps)?,
            Ended::Stopped => writeln!(
                f,
                "stopped after {} steps; run again to continue",
                self.steps
            )?,
            Ended::Settled => writeln!(
                f,
                "settled after {} steps: no further step lowers the loss",
                self.steps
            )?,
            Ended::Stuck { reason } => writeln!(f, "stuck after {} steps: {reason}", self.steps)?,
        }
        writeln!(f, "\n{:<24}{:>12}{:>12}", "", "start", "best")?;
        let rows = |of: &Scores| {
            let mut rows = vec![("outline error (mm)", of.outline_error)];
            rows.extend(of.terms());
            rows.push(("loss (mm^2)", of.loss));
            rows.push(("inside domain (%)", 100.0 * of.share_inside));
            rows
        };
        for ((name, before), (_, after)) in std::iter::zip(rows(before), rows(after)) {
            writeln!(f, "{name:<24}{:>12}{:>12}", shown(before), shown(after))?;
        }
        if let Some(estimate) = &self.estimate {
            let percent = |x: f64| format!("{:.1} %", 100.0 * x);
            writeln!(
                f,
                "\nstandard deviation of {} networks on the path, inside the domain: energy {}, forces {}, D_peak {}",
                estimate.networks,
                percent(estimate.energy),
                percent(estimate.forces),
                estimate.damage_peak.map_or("-".into(), percent)
            )?;
        }
        writeln!(
            f,
            "\nhinge  panels    w_lig  alpha  theta   eta_a   eta_s       D  D_peak  domain    Gamma\n\
             {:>20} {:>6} {:>6}",
            "mm", "deg", "deg"
        )?;
        for row in &self.hinges {
            let panels = format!("{}-{}", row.panels[0], row.panels[1]);
            let unknown = if row.inside { "-" } else { "?" };
            let [damage, peak] = [row.damage, row.damage_peak]
                .map(|damage| damage.map_or(unknown.into(), |damage| format!("{damage:.4}")));
            writeln!(
                f,
                "{:>5}  {panels:>6} {:>8.2} {:>6.1} {:>6.1} {:>7.3} {:>7.3} {damage:>7} {peak:>7}  {:<6} {:>8.3e}",
                row.hinge,
                row.w_lig,
                row.alpha_deg,
                row.theta_deg,
                row.eta_a,
                row.eta_s,
                if row.inside { "inside" } else { "left" },
                row.gamma,
            )?;
        }
        writeln!(
            f,
            "D and D_peak: maximum along the path of the mean damage of the ligament and of its most strained 1 %,\n\
             which tears at 1; ?: not known, since the hinge left the training domain of its law"
        )?;
        if self.warnings.is_empty() {
            return writeln!(f, "\nno warnings");
        }
        writeln!(f, "\nwarnings")?;
        self.warnings
            .iter()
            .try_for_each(|warning| writeln!(f, "- {warning}"))
    }
}
