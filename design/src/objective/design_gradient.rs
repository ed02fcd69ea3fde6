//! The objective and its gradient in the design by the forward chain in reverse: lines 6-7 of
//! Algorithm 1.

use crate::{
    equilibrium::{
        adjoint::{PathGradient, adjoint},
        load_step::LoadStep,
        warm_start::WarmStart,
    },
    hinge_law::{HingeGradient, PreparedLaw},
    objective::design_problem::{
        Deployment, DesignError, DesignProblem, Evaluation, Mechanics, Sensitivities,
    },
    pattern::{coordinates::PatternCoordinates, design_vector::DesignVector},
    sheet::{
        cut_sheet::{Sheet, SheetGradient},
        ideal_deployment::ideal_deployment_pullback,
        kinematics::{Motion, deployed_pullback},
        topology::PanelCorner,
    },
};
use std::iter::zip;
use support::{Point, vectors};

/// The partial derivatives of a function of a deployment.
pub(super) struct Partials<'a> {
    /// The load steps on which the function depends, the last one among them.
    pub path: &'a [LoadStep],
    /// The panel corners whose deployed positions the function depends on.
    pub outline: &'a [PanelCorner],
    /// Gradient in their deployed positions.
    pub by_outline: &'a [Point],
    /// Gradient in each hinge at each step of `path`.
    pub by_states: &'a [Vec<HingeGradient>],
    /// Gradient in the load factor of the last step.
    pub by_load_factor: f64,
    /// Gradient in the flat sheet, at fixed states and designs of its hinges.
    pub by_sheet: SheetGradient,
    /// Gradient in the forces of the supports in the last step; `None` if all are zero.
    pub by_reactions: Option<Vec<Motion>>,
}

/// The gradient of a function of a deployment.
pub(super) struct Gradient {
    /// Gradient in the design.
    pub design: DesignVector,
    /// Gradient in the constants of the problem.
    pub sensitivities: Sensitivities,
    /// [`AdjointSums::virtual_motion`](crate::equilibrium::adjoint::AdjointSums::virtual_motion);
    /// empty without equilibrium.
    pub virtual_motion: Vec<Motion>,
    /// [`Evaluation::adjoint_residual`].
    pub adjoint_residual: f64,
}

impl DesignProblem {
    /// L(theta) and its gradient.
    pub fn evaluate(&self, design: &DesignVector) -> Result<Evaluation, DesignError> {
        self.evaluate_near(design, None)
    }

    /// L(theta) and its gradient, with the path corrected from the `known` path of another design
    /// if that is near enough; otherwise it is followed from the flat sheet, as in
    /// [`evaluate`](Self::evaluate).
    pub fn evaluate_near(
        &self,
        design: &DesignVector,
        known: Option<&WarmStart>,
    ) -> Result<Evaluation, DesignError> {
        let by_damage = self.objective.needs_damage_gradient();
        let (deployment, law) = self.deploy_prepared(design, by_damage, known)?;
        let law = self.model.mechanics().zip(law.as_deref());
        let outline = deployment.sheet.free_outline_corners();
        let value = self.evaluate_deployed(&deployment, &outline)?;
        let partials = Partials {
            path: &deployment.path,
            outline: &outline,
            by_outline: &value.gradient.by_outline,
            by_states: &value.gradient.by_states,
            by_load_factor: 0.0,
            by_sheet: value.gradient.by_sheet,
            by_reactions: None,
        };
        let gradient = self.design_gradient(design, &deployment, law, partials)?;
        Ok(Evaluation {
            loss: value.loss,
            terms: value.terms,
            gradient: gradient.design,
            sensitivities: gradient.sensitivities,
            deployment,
            adjoint_residual: gradient.adjoint_residual,
        })
    }

    /// The gradient of a function of the deployment.
    pub(super) fn design_gradient(
        &self,
        design: &DesignVector,
        deployment: &Deployment,
        law: Option<(&Mechanics, &dyn PreparedLaw)>,
        partials: Partials,
    ) -> Result<Gradient, DesignError> {
        let sheet = &deployment.sheet;
        let Partials { outline, by_outline, mut by_sheet, .. } = partials;
        let outline = zip(outline, by_outline);
        let by_compared = outline_pullback(sheet, deployment.final_step(), outline, &mut by_sheet);
        let (mut by_opening, mut adjoint_residual) = (None, 0.0);
        let mut virtual_motion = Vec::new();
        let mut sensitivities = Sensitivities::default();
        match (self.opening(design), law) {
            (Some(theta), _) => {
                let slope = ideal_deployment_pullback(sheet, theta, &by_compared, &mut by_sheet);
                by_opening = design.opening.map(|_| slope);
            }
            (None, law) => {
                let (mechanics, law) = law.expect("a law without an opening angle");
                let sums = adjoint(
                    &mechanics.solver,
                    mechanics.hinged(sheet, law, true),
                    partials.path,
                    PathGradient {
                        by_states: partials.by_states,
                        by_load_factor: partials.by_load_factor,
                        by_last: by_compared,
                        by_reactions: partials.by_reactions,
                    },
                    &mut by_sheet,
                )?;
                adjoint_residual = sums.residual;
                sensitivities.loads = sums.loads;
                sensitivities.constants = sums.constants;
                virtual_motion = sums.virtual_motion;
            }
        }
        let (by_points, by_width) = sheet.pullback(&by_sheet);
        let (by_pattern, by_outline) = deployment.pattern.pullback(&by_points);
        sensitivities.outline = by_outline;
        // The shapes of trimmed panels are for their cuts, which stay: all coordinates are zero.
        let stays = || PatternCoordinates::uniform(self.topology.grid);
        let design = DesignVector {
            pattern: if self.topology.is_full() { by_pattern } else { stays() },
            omega: zip(&design.omega, by_width)
                .map(|(&omega, by_width)| by_width * self.widths.slope(omega))
                .collect(),
            opening: by_opening,
        };
        Ok(Gradient { design, sensitivities, virtual_motion, adjoint_residual })
    }
}

/// The gradient, in the configuration that is compared with the target, of a function of the
/// outline points there; its gradient with respect to the flat sheet is added to `by_sheet`.
fn outline_pullback<'a>(
    sheet: &Sheet,
    compared: &LoadStep,
    outline: impl Iterator<Item = (&'a PanelCorner, &'a Point)>,
    by_sheet: &mut SheetGradient,
) -> Vec<Motion> {
    let mut by_compared = vec![[0.0; 3]; sheet.panels.len()];
    for (&(panel, corner), &gradient) in outline {
        let flat = sheet.panels[panel].boundary[corner];
        let (by_motion, by_flat, by_reference) =
            deployed_pullback(&sheet.panels[panel], compared.configuration[panel], flat, gradient);
        vectors::add(&mut by_compared[panel], &by_motion, 1.0);
        let by_corners = sheet.panels[panel].corner_pullback(corner, by_flat);
        for (sum, by_corner) in zip(&mut by_sheet.corners[panel], by_corners) {
            *sum += by_corner;
        }
        by_sheet.references[panel] += by_reference;
    }
    by_compared
}
