//! What a design run says at its end: the objective before and after, every hinge, what to mind.

mod estimate;
mod warning;

pub use estimate::Estimate;
pub use warning::{Concern, Warning};

use crate::fabrication::{CutLines, FabricationError};
use crate::gradient::Deployment;
use crate::hinge_law::DamageMeasure;
use crate::inverse_design::{Designed, Ended};
use crate::localisation::gamma;
use crate::polygon::edges;
use crate::scene::Scene;
use crate::scores::{Scores, shown};
use crate::sheet::{Hinge, Sheet};
use serde::Serialize;
use std::fmt;

/// The report of a run, for people (`Display`) and programs (JSON).
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    pub title: String,
    pub ended: Ended,
    /// Steps made, the start not counted.
    pub steps: usize,
    /// Steps that had to be halved because a design had no value.
    pub setbacks: usize,
    pub before: Scores,
    /// Of the best design.
    pub after: Scores,
    /// How far the networks of the scene's ensemble disagree on the best design's path, if there are several.
    pub estimate: Option<Estimate>,
    pub hinges: Vec<HingeRow>,
    pub warnings: Vec<Warning>,
}

/// One hinge of the best design, deployed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HingeRow {
    pub hinge: usize,
    /// A and B.
    pub panels: [usize; 2],
    /// mm
    pub w_lig: f64,
    pub alpha_deg: f64,
    pub theta_deg: f64,
    pub eta_a: f64,
    pub eta_s: f64,
    /// Maximum D along the path, the mean damage of the ligament; none where it is not known: the hinge law
    /// predicts none, or was not made for a state of the path.
    pub damage: Option<f64>,
    /// The same of D_peak: at 1 the ligament tears.
    pub damage_peak: Option<f64>,
    /// Whether the hinge law was made for every state of the path.
    pub inside: bool,
    /// (21), with the shortest edge of the two panels.
    pub gamma: f64,
}

impl Report {
    /// Of a run of `scene`, whose best design has the given cut lines.
    pub fn new(
        scene: &Scene,
        designed: &Designed,
        cuts: &Result<CutLines, FabricationError>,
    ) -> Self {
        let deployment = &designed.best.deployment;
        let hinges: Vec<HingeRow> = (0..deployment.sheet.hinges.len())
            .map(|h| HingeRow::new(scene, deployment, h))
            .collect();
        Self {
            title: scene.config.title.clone(),
            ended: designed.ended.clone(),
            steps: designed.history.len() - 1,
            setbacks: designed
                .history
                .iter()
                .filter(|record| record.setback.is_some())
                .count(),
            before: Scores::of(scene, &designed.start),
            after: Scores::of(scene, &designed.best),
            estimate: Estimate::of(&scene.networks(), deployment),
            warnings: warning::all(scene, deployment, cuts, &hinges),
            hinges,
        }
    }
}

impl HingeRow {
    fn new(scene: &Scene, deployment: &Deployment, h: usize) -> Self {
        let sheet = &deployment.sheet;
        let hinge = &sheet.hinges[h];
        let last = deployment.final_step().deformations[h];
        let [eta_a, eta_s] = last.eta(hinge.w_lig);
        Self {
            hinge: h,
            panels: [hinge.panel_a(), hinge.panel_b()],
            w_lig: hinge.w_lig,
            alpha_deg: hinge.alpha.to_degrees(),
            theta_deg: last.theta.to_degrees(),
            eta_a,
            eta_s,
            damage: deployment.damage_max(DamageMeasure::Mean, h),
            damage_peak: deployment.damage_max(DamageMeasure::Peak, h),
            inside: deployment.path.iter().all(|step| step.inside[h]),
            gamma: gamma(&scene.material, hinge.w_lig, shortest_edge(sheet, hinge)),
        }
    }
}

/// The shortest edge of the two panels of a hinge (mm).
fn shortest_edge(sheet: &Sheet, hinge: &Hinge) -> f64 {
    [hinge.panel_a(), hinge.panel_b()]
        .iter()
        .flat_map(|&panel| edges(&sheet.panels[panel].corners))
        .map(|(p, q)| f64::hypot(q[0] - p[0], q[1] - p[1]))
        .fold(f64::INFINITY, f64::min)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { before, after, .. } = self;
        writeln!(f, "{}", self.title)?;
        match &self.ended {
            Ended::Completed => writeln!(f, "{} steps", self.steps)?,
            Ended::Stopped => {
                writeln!(f, "stopped after {} steps; run again to go on", self.steps)?
            }
            Ended::Settled => writeln!(
                f,
                "settled after {} steps: none lowers the loss any more",
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
                "\nstandard deviation of {} networks on the path inside: energy {}, forces {}, D_peak {}",
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
            "D and D_peak: maxima along the path of the mean damage of the ligament and of its most strained\n\
             1 %, which tears at 1; ? not known, as the hinge left the states its law was trained on"
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
