//! The forward chain theta -> pattern -> sheet -> equilibria -> objective, and its gradient by the same chain
//! in reverse: lines 2-7 of Algorithm 1.

use crate::equilibrium::adjoint::{SingularTangent, adjoint};
use crate::equilibrium::hinged_sheet::HingedSheet;
use crate::equilibrium::load_step::{DescentEnd, LoadStep, Status};
use crate::equilibrium::nearby_path::KnownPath;
use crate::equilibrium::solver::{EquilibriumError, EquilibriumSolver};
use crate::geometry::plane::add;
use crate::hinge_law::{Contact, DamageMeasure, HingeLaw, Order, PreparedLaw};
use crate::objective::loss::{Judgement, Objective, Terms};
use crate::objective::path_functionals::PerFunctional;
use crate::pattern::cut_pattern::{CutPattern, Outline};
use crate::pattern::design_vector::{DesignVector, WidthChart};
use crate::pattern::grid::Grid;
use crate::pattern::pattern_error::PatternError;
use crate::sheet::cut_sheet::{Sheet, SheetError, SheetGradient, SheetOptions};
use crate::sheet::ideal_deployment::{ideal_deployment, ideal_deployment_pullback};
use crate::sheet::kinematics::{deployed, deployed_pullback};
use crate::sheet::topology::PanelCorner;
use hinge::TrainingDomain;
use serde::Serialize;
use std::sync::Arc;
use support::verbose;

/// Why a design has no objective value.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum DesignError {
    #[error(transparent)]
    Pattern(#[from] PatternError),
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error(transparent)]
    Equilibrium(#[from] EquilibriumError),
    #[error("w_minus = {w_minus} mm, w_plus = {w_plus} mm violates 0 < w_minus < w_plus")]
    WidthChart { w_minus: f64, w_plus: f64 },
    #[error("hinge = \"pin\" has no equilibrium; set hinge = \"linear\" or \"surrogate\"")]
    NoMechanics,
    #[error("the target has no points")]
    EmptyTarget,
    #[error("the opening angle {0} rad is not a finite number")]
    Opening(f64),
    #[error(
        "no equilibrium was found beyond load factor {reached:.4} (relative residual {residual:.1e}){}",
        end.map(|end| format!(": {end}")).unwrap_or_default()
    )]
    NoEquilibrium {
        reached: f64,
        residual: f64,
        end: Option<DescentEnd>,
    },
    #[error(transparent)]
    SingularTangent(#[from] SingularTangent),
}

/// Hinge law, supports and loads.
pub struct Mechanics {
    /// The hinge law of all hinges.
    pub law: Arc<dyn HingeLaw>,
    /// Contact of panel edges; `None` without contact.
    pub contact: Option<Contact>,
    /// Supports, loads and load steps, with the settings of the equilibrium solver.
    pub solver: EquilibriumSolver,
}

/// How the deployed state of a sheet is computed.
pub enum Model {
    /// All hinges are pins and open by the same angle; no equilibrium and no hinge energy.
    Ideal {
        /// The opening angle of designs without their own (rad).
        opening: f64,
    },
    /// Equilibria under loads.
    Equilibrium(Box<Mechanics>),
}

impl Model {
    /// The training domain of the hinge law, if it has one.
    pub fn domain(&self) -> Option<&TrainingDomain> {
        match self {
            Self::Ideal { .. } => None,
            Self::Equilibrium(mechanics) => mechanics.law.domain(),
        }
    }
}

/// A design problem: everything that is constant during the design.
pub struct DesignProblem {
    /// Numbers of panels.
    pub grid: Grid,
    /// Outline of the flat sheet.
    pub outline: Outline,
    /// Interval of the ligament widths.
    pub widths: WidthChart,
    /// Options of the sheet that a pattern defines.
    pub options: SheetOptions,
    /// How the deployed state is computed.
    pub model: Model,
    /// The objective L of (16).
    pub objective: Objective,
}

/// A deployed design.
pub struct Deployment {
    /// The cut pattern of the design.
    pub pattern: CutPattern,
    /// The flat sheet that the pattern defines.
    pub sheet: Sheet,
    /// One entry per load step; a single entry for the ideal deployment.
    pub path: Vec<LoadStep>,
    /// Whether the path was followed from the flat sheet; `false` if it was corrected from that of a design near it.
    pub followed: bool,
}

/// The gradient of L with respect to quantities that are constant during the design.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Sensitivities {
    /// With respect to the outline's corners, at fixed r and tau.
    pub outline: [[f64; 2]; 4],
    /// With respect to (F_x, F_y, M) of each panel at full load; empty without equilibrium.
    pub loads: Vec<[f64; 3]>,
    /// With respect to (k_a, k_s, k_theta) of each hinge; empty without equilibrium, zero unless the law is (11).
    pub constants: Vec<[f64; 3]>,
}

/// The objective and the gradient of a design, with its deployment.
pub struct Evaluation {
    /// L of (16).
    pub loss: f64,
    /// The unweighted terms of L.
    pub terms: Terms,
    /// dL/dtheta
    pub gradient: DesignVector,
    /// The gradient with respect to the constants of the design problem.
    pub sensitivities: Sensitivities,
    /// The deployment of the design.
    pub deployment: Deployment,
    /// Maximum componentwise backward error of the adjoint solves.
    pub adjoint_residual: f64,
}

/// The partial derivatives of a function of a deployment.
struct Partials<'a> {
    /// The load steps on which the function depends, the last one among them.
    path: &'a [LoadStep],
    /// In the deployed positions of the outline points.
    by_outline: &'a [[f64; 2]],
    /// In (a, s, theta, w_lig, alpha) per hinge and step of `path`.
    by_path: &'a [Vec<[f64; 5]>],
    /// In the flat corners of every panel; `None` if all are zero.
    by_corners: Option<&'a [[[f64; 2]; 4]]>,
}

/// The gradient of a function of a deployment in the design and in the constants of the problem.
struct Pulled {
    gradient: DesignVector,
    sensitivities: Sensitivities,
    /// See [`Evaluation::adjoint_residual`].
    adjoint_residual: f64,
}

impl Deployment {
    /// The path, from which those of designs near this one can be corrected.
    pub fn known_path(&self) -> KnownPath {
        KnownPath {
            designs: self.sheet.designs(),
            steps: self.path.clone(),
        }
    }

    /// The state at full load.
    pub fn final_step(&self) -> &LoadStep {
        self.path.last().expect("a path has at least one step")
    }

    /// The state at full load, or an error if it was not reached.
    pub fn at_full_load(&self) -> Result<&LoadStep, DesignError> {
        let last = self.final_step();
        match last.status {
            Status::Diverged => Err(DesignError::NoEquilibrium {
                reached: last.load_factor,
                residual: last.residual,
                end: last.descent_end,
            }),
            _ => Ok(last),
        }
    }

    /// Deployed positions of panel corners at the last step (mm).
    pub fn outline(&self, corners: &[PanelCorner]) -> Vec<[f64; 2]> {
        let configuration = &self.final_step().configuration;
        let deployed = |&(panel, corner): &PanelCorner| {
            let flat = self.sheet.panels[panel].corners[corner];
            deployed(&self.sheet.panels[panel], configuration[panel], flat)
        };
        corners.iter().map(deployed).collect()
    }

    /// Maximum damage of a hinge along the path; `None` if the hinge law does not predict damage, or if a state of
    /// the path is outside its training domain.
    pub fn damage_max(&self, measure: DamageMeasure, hinge: usize) -> Option<f64> {
        self.path.iter().try_fold(0.0, |maximum: f64, step| {
            let known = measure.known(step.damage.get(hinge)?);
            Some(maximum.max(known.filter(|_| step.inside[hinge])?))
        })
    }

    /// Fraction of the hinge states of the path that lie inside the training domain of the hinge law.
    pub fn share_inside(&self) -> f64 {
        let inside = || self.path.iter().flat_map(|step| &step.inside);
        inside().filter(|inside| **inside).count() as f64 / inside().count() as f64
    }
}

impl DesignProblem {
    /// Lines 2-4 of Algorithm 1: cut pattern and flat sheet.
    pub fn cut(&self, design: &DesignVector) -> Result<(CutPattern, Sheet), DesignError> {
        let WidthChart { w_minus, w_plus } = self.widths;
        if !(w_minus > 0.0 && w_minus < w_plus && w_plus.is_finite()) {
            return Err(DesignError::WidthChart { w_minus, w_plus });
        }
        let pattern = CutPattern::new(self.grid, self.outline, &design.pattern)?;
        let w_lig: Vec<f64> = (design.omega.iter())
            .map(|&omega| self.widths.width(omega))
            .collect();
        let sheet = Sheet::new(&pattern, &w_lig, self.options)?;
        Ok((pattern, sheet))
    }

    /// Lines 2-5 of Algorithm 1. A path that diverges ends early; see [`LoadStep::status`].
    pub fn deploy(&self, design: &DesignVector) -> Result<Deployment, DesignError> {
        Ok(self.deploy_prepared(design, false, None)?.0)
    }

    /// The deployment, its damage with or without `gradient`, and the hinge law prepared for its sheet. The path is
    /// corrected from the `known` one of another design if that is near enough.
    fn deploy_prepared(
        &self,
        design: &DesignVector,
        gradient: bool,
        known: Option<&KnownPath>,
    ) -> Result<(Deployment, Option<Box<dyn PreparedLaw + '_>>), DesignError> {
        let (pattern, sheet) = self.cut(design)?;
        let (path, followed, law) = match &self.model {
            Model::Ideal { opening } => {
                let theta = design.opening.unwrap_or(*opening);
                if !theta.is_finite() {
                    return Err(DesignError::Opening(theta));
                }
                let ideal = LoadStep::ideal(&sheet, ideal_deployment(&sheet, theta));
                (vec![ideal], true, None)
            }
            Model::Equilibrium(mechanics) => {
                mechanics.solver.check_supports(&sheet)?;
                let law = mechanics.law.prepare(&sheet.designs());
                let hinged = mechanics.hinged(&sheet, &*law, gradient);
                let near = known.and_then(|known| mechanics.solver.path_near(hinged, known));
                let followed = near.is_none();
                let path = near.unwrap_or_else(|| mechanics.solver.path(hinged));
                path.iter()
                    .for_each(|step| verbose::note(|| step.to_string()));
                (path, followed, Some(law))
            }
        };
        let deployment = Deployment {
            pattern,
            sheet,
            path,
            followed,
        };
        Ok((deployment, law))
    }

    /// L(theta) and its gradient.
    pub fn evaluate(&self, design: &DesignVector) -> Result<Evaluation, DesignError> {
        self.evaluate_near(design, None)
    }

    /// L(theta) and its gradient, with the path corrected from the `known` path of another design if that is near
    /// enough; otherwise it is followed from the flat sheet, as in [`evaluate`](Self::evaluate).
    pub fn evaluate_near(
        &self,
        design: &DesignVector,
        known: Option<&KnownPath>,
    ) -> Result<Evaluation, DesignError> {
        let by_damage = self.objective.weights.damage != 0.0;
        let (deployment, law) = self.deploy_prepared(design, by_damage, known)?;
        let outline = self.objective.outline.of(&deployment.sheet);
        let judgement = self.judge(&deployment, &outline)?;
        let partials = Partials {
            path: &deployment.path,
            by_outline: &judgement.by_outline,
            by_path: &judgement.by_path,
            by_corners: Some(&judgement.by_corners),
        };
        let pulled = self.pull_back(design, &deployment, law.as_deref(), &outline, &partials)?;
        Ok(Evaluation {
            loss: judgement.loss,
            terms: judgement.terms,
            gradient: pulled.gradient,
            sensitivities: pulled.sensitivities,
            deployment,
            adjoint_residual: pulled.adjoint_residual,
        })
    }

    /// Gradients in the design whose products with themselves, v v^T, add up to the second derivative of the Chamfer
    /// distance at a deployment, but for the curvature of the deployment itself (Gauss-Newton).
    pub fn shape_curvature(
        &self,
        design: &DesignVector,
        deployment: &Deployment,
    ) -> Result<Vec<Vec<f64>>, DesignError> {
        let sheet = &deployment.sheet;
        let outline = self.objective.outline.of(sheet);
        let mut last = deployment.final_step().clone();
        let mut law = None;
        if let Model::Equilibrium(mechanics) = &self.model {
            let prepared = mechanics.law.prepare(&sheet.designs());
            if last.order != Order::Design {
                // Evaluated here once, and not by the adjoint of every vector.
                let hinged = mechanics.hinged(sheet, &*prepared, true);
                last.hinges = hinged.energies(&last.deformations, Order::Design);
                last.order = Order::Design;
            }
            law = Some(prepared);
        }
        let by_path = vec![vec![[0.0; 5]]; sheet.hinges.len()];
        let vectors = (self.objective).shape_curvature(&deployment.outline(&outline));
        let pulled = vectors.iter().map(|by_outline| {
            let partials = Partials {
                path: std::slice::from_ref(&last),
                by_outline,
                by_path: &by_path,
                by_corners: None,
            };
            let pulled = self.pull_back(design, deployment, law.as_deref(), &outline, &partials)?;
            Ok(pulled.gradient.to_flat())
        });
        pulled.collect()
    }

    /// The gradient in the design, and in the constants of the problem, of a function of the deployment.
    fn pull_back(
        &self,
        design: &DesignVector,
        deployment: &Deployment,
        law: Option<&dyn PreparedLaw>,
        outline: &[PanelCorner],
        partials: &Partials,
    ) -> Result<Pulled, DesignError> {
        let (sheet, last) = (&deployment.sheet, deployment.final_step());
        let mut by_sheet = SheetGradient::zeros(self.grid);
        if let Some(by_corners) = partials.by_corners {
            by_sheet.corners.copy_from_slice(by_corners);
        }
        let by_last = outline_pullback(sheet, last, outline, partials.by_outline, &mut by_sheet);
        let (mut by_opening, mut adjoint_residual) = (None, 0.0);
        let mut sensitivities = Sensitivities::default();
        match &self.model {
            Model::Ideal { opening } => {
                let theta = design.opening.unwrap_or(*opening);
                let slope = ideal_deployment_pullback(sheet, theta, &by_last, &mut by_sheet);
                by_opening = design.opening.map(|_| slope);
            }
            Model::Equilibrium(mechanics) => {
                let law = law.ok_or(DesignError::NoMechanics)?;
                let sums = adjoint(
                    &mechanics.solver,
                    mechanics.hinged(sheet, law, true),
                    partials.path,
                    partials.by_path,
                    by_last,
                    &mut by_sheet,
                )?;
                adjoint_residual = sums.residual;
                sensitivities.loads = sums.loads;
                sensitivities.constants = sums.constants;
            }
        }
        let (by_points, by_width) = sheet.pullback(&by_sheet);
        let (by_pattern, by_outline) = deployment.pattern.pullback(&by_points);
        sensitivities.outline = by_outline;
        let gradient = DesignVector {
            pattern: by_pattern,
            omega: std::iter::zip(&design.omega, by_width)
                .map(|(&omega, by_width)| by_width * self.widths.slope(omega))
                .collect(),
            opening: by_opening,
        };
        Ok(Pulled {
            gradient,
            sensitivities,
            adjoint_residual,
        })
    }

    /// L(theta) without its gradient.
    pub fn loss(&self, design: &DesignVector) -> Result<f64, DesignError> {
        let deployment = self.deploy(design)?;
        let outline = self.objective.outline.of(&deployment.sheet);
        Ok(self.judge(&deployment, &outline)?.loss)
    }

    /// Scales the weight of each path functional by the gradient of the Chamfer distance at `start`, so
    /// that at the weight 1 both gradients have the same norm. A functional with zero gradient there keeps
    /// its weight.
    pub fn balanced(mut self, start: &DesignVector) -> Result<Self, DesignError> {
        let relative = self.objective.weights;
        let panel_shape = std::mem::take(&mut self.objective.panel_shape);
        let min_panel_width = std::mem::take(&mut self.objective.min_panel_width);
        let domain = self.objective.domain.take();
        let mut gradient = |weights: PerFunctional| {
            self.objective.weights = weights;
            Ok::<_, DesignError>(self.evaluate(start)?.gradient.to_flat())
        };
        let none = PerFunctional::default();
        let shape = gradient(none)?;
        let mut balanced = |weight: f64, alone: PerFunctional| {
            if weight == 0.0 {
                return Ok(0.0);
            }
            let both = gradient(alone)?;
            let functional: Vec<f64> = std::iter::zip(both, &shape).map(|(b, s)| b - s).collect();
            let norm = norm(&functional);
            let ratio = if norm > 0.0 {
                self::norm(&shape) / norm
            } else {
                1.0
            };
            Ok::<_, DesignError>(weight * ratio)
        };
        let weights = PerFunctional {
            damage: balanced(
                relative.damage,
                PerFunctional {
                    damage: 1.0,
                    ..none
                },
            )?,
            compression: balanced(
                relative.compression,
                PerFunctional {
                    compression: 1.0,
                    ..none
                },
            )?,
            shear: balanced(relative.shear, PerFunctional { shear: 1.0, ..none })?,
        };
        self.objective.weights = weights;
        self.objective.panel_shape = panel_shape;
        self.objective.min_panel_width = min_panel_width;
        self.objective.domain = domain;
        Ok(self)
    }

    fn judge(
        &self,
        deployment: &Deployment,
        outline: &[PanelCorner],
    ) -> Result<Judgement, DesignError> {
        if self.objective.target.is_empty() {
            return Err(DesignError::EmptyTarget);
        }
        deployment.at_full_load()?;
        let points = deployment.outline(outline);
        let damage_scale = match &self.model {
            Model::Ideal { .. } => None,
            Model::Equilibrium(mechanics) => {
                mechanics.law.damage_scale(self.objective.damage_measure)
            }
        };
        // No scale is needed without damage.
        let scale = damage_scale.unwrap_or(1.0);
        Ok(self
            .objective
            .judge(&points, &deployment.sheet, &deployment.path, scale))
    }
}

impl Mechanics {
    pub(crate) fn hinged<'a>(
        &'a self,
        sheet: &'a Sheet,
        law: &'a dyn PreparedLaw,
        damage_gradient: bool,
    ) -> HingedSheet<'a> {
        HingedSheet {
            sheet,
            law,
            contact: self.contact.as_ref(),
            damage_gradient,
        }
    }
}

/// The gradient, in the last configuration, of a function of the deployed outline points; its gradient
/// with respect to the flat sheet is added to `by_sheet`.
fn outline_pullback(
    sheet: &Sheet,
    last: &LoadStep,
    outline: &[PanelCorner],
    by_outline: &[[f64; 2]],
    by_sheet: &mut SheetGradient,
) -> Vec<[f64; 3]> {
    let mut by_last = vec![[0.0; 3]; sheet.panels.len()];
    for (&(panel, corner), &gradient) in std::iter::zip(outline, by_outline) {
        let flat = sheet.panels[panel].corners[corner];
        let (by_motion, by_flat, by_centroid) = deployed_pullback(
            &sheet.panels[panel],
            last.configuration[panel],
            flat,
            gradient,
        );
        (0..3).for_each(|c| by_last[panel][c] += by_motion[c]);
        add(&mut by_sheet.corners[panel][corner], by_flat);
        add(&mut by_sheet.centroids[panel], by_centroid);
    }
    by_last
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}
