//! One hinge in the report.

use analysis::{flanks::flank_gap, path_separation::path_separation};
use design::{hinge_law::DamageMeasure, objective::design_problem::Deployment};
use hinge::HingeDesign;
use scene::Scene;
use serde::Serialize;
use support::Extremes;
use surrogate::Surrogate;

/// One hinge of the best design in the deployed sheet.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct HingeRow {
    /// Index of the hinge.
    pub hinge: usize,
    /// Panels A and B.
    pub panels: [usize; 2],
    /// Ligament width (mm).
    pub w_lig: f64,
    /// Cut angle (deg).
    pub alpha_deg: f64,
    /// Opening in the last state of the path (deg).
    pub theta_deg: f64,
    /// a / w_lig in the last state of the path.
    pub eta_a: f64,
    /// s / w_lig in the last state of the path.
    pub eta_s: f64,
    /// Maximum along the path of D, the mean damage of the ligament; `None` if it is unknown: the
    /// hinge law does not predict it, or a state of the path is outside its training domain.
    pub damage: Option<f64>,
    /// Maximum along the path of D_peak; at 1 the ligament tears.
    pub damage_peak: Option<f64>,
    /// Whether every state of the path is inside the training domain of the hinge law.
    pub inside: bool,
    /// Maximum distance of the path from the ray to its end, in ligament widths; see
    /// [`path_separation()`].
    pub path_separation: f64,
    /// Minimum along the path of the distance of the flanks of the cut where they come nearest
    /// (mm): see [`flank_gap`](analysis::flanks::flank_gap).
    pub flank_gap: f64,
}

impl HingeRow {
    pub(crate) fn all(scene: &Scene, deployment: &Deployment) -> Vec<Self> {
        let hinges = 0..deployment.sheet.hinges.len();
        let designs = deployment.sheet.designs();
        hinges.map(|h| Self::new(scene, deployment, &designs, h)).collect()
    }

    fn new(scene: &Scene, deployment: &Deployment, designs: &[HingeDesign], h: usize) -> Self {
        let sheet = &deployment.sheet;
        let hinge = &sheet.hinges[h];
        let last = deployment.final_step().deformations[h];
        let [eta_a, eta_s] = last.eta(hinge.w_lig);
        let regime = scene.material.regime(hinge.w_lig);
        let curvature = scene.surrogate().map_or(0.0, Surrogate::ray_curvature);
        let states: Vec<_> = (deployment.path.iter()).map(|step| step.deformations[h]).collect();
        Self {
            hinge: h,
            panels: hinge.panels(),
            w_lig: hinge.w_lig,
            alpha_deg: hinge.alpha.to_degrees(),
            theta_deg: last.theta.to_degrees(),
            eta_a,
            eta_s,
            damage: deployment.damage_max(DamageMeasure::Mean, h),
            damage_peak: deployment.damage_max(DamageMeasure::Peak, h),
            inside: deployment.path.iter().all(|step| step.inside[h]),
            path_separation: path_separation(hinge.w_lig, curvature, &states),
            flank_gap: (states.iter().map(|state| flank_gap(&designs[h], state, regime)))
                .smallest(),
        }
    }
}
