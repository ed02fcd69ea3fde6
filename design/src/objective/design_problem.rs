//! The forward chain theta -> pattern -> sheet -> equilibria -> objective, and its gradient by the
//! same chain in reverse: lines 2-7 of Algorithm 1.

use crate::{
    equilibrium::{
        adjoint::SingularTangent,
        hinged_sheet::HingedSheet,
        load_step::{DescentEnd, LoadStep, Status, residual_in_words},
        solver::EquilibriumSolver,
        warm_start::WarmStart,
    },
    hinge_law::{Contact, DamageMeasure, HingeLaw, PreparedLaw},
    objective::{
        loss::{Objective, ObjectiveValue, TermValues},
        term::Deployed,
    },
    pattern::{
        cut_pattern::{CutPattern, Outline},
        design_vector::{DesignVector, WidthChart},
    },
    sheet::{
        cut_sheet::{Sheet, SheetOptions},
        ideal_deployment::{check_opening, ideal_deployment},
        kinematics::deployed,
        topology::{PanelCorner, Topology},
    },
};
use hinge::TrainingDomain;
use serde::Serialize;
use std::sync::{Arc, atomic::AtomicBool};
use support::{Fault, Point, ensure, fault, verbose};

/// Why a design has no objective value.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum DesignError {
    #[error(transparent)]
    Fault(#[from] Fault),
    #[error(
        "no equilibrium was found beyond load factor {reached:.4} ({}){}",
        residual_in_words(*residual),
        end.map(|end| format!(": {end}")).unwrap_or_default()
    )]
    NoEquilibrium { reached: f64, residual: f64, end: Option<DescentEnd> },
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
    /// Hinge law, supports and loads of equilibria.
    pub fn mechanics(&self) -> Option<&Mechanics> {
        match self {
            Self::Ideal { .. } => None,
            Self::Equilibrium(mechanics) => Some(mechanics),
        }
    }

    /// The same; an error if all hinges are pins.
    pub fn equilibrium(&self) -> Result<&Mechanics, Fault> {
        self.mechanics().ok_or_else(|| {
            fault!("the level `pin` has no equilibrium: set level = \"linear\" or \"standard\"")
        })
    }

    /// The training domain of the hinge law, if it has one.
    pub fn domain(&self) -> Option<&TrainingDomain> {
        self.mechanics()?.law.domain()
    }
}

/// A design problem: everything that is constant during the design.
pub struct DesignProblem {
    /// Panels and hinges.
    pub topology: Arc<Topology>,
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
#[derive(Clone)]
pub struct Deployment {
    /// The cut pattern of the design.
    pub pattern: CutPattern,
    /// The flat sheet that the pattern defines.
    pub sheet: Sheet,
    /// One entry per load step; a single entry for the ideal deployment.
    pub path: Vec<LoadStep>,
    /// Whether the path was followed from the flat sheet; `false` if it was corrected from the path
    /// of a design near it.
    pub followed: bool,
}

/// The gradient of L with respect to quantities that are constant during the design.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Sensitivities {
    /// Gradient in the outline's corners, at fixed r and tau.
    pub outline: [Point; 4],
    /// Gradient in (F_x, F_y, M) of each panel at full load; empty without equilibrium.
    pub loads: Vec<[f64; 3]>,
    /// Gradient in (k_a, k_s, k_theta) of each hinge; empty without equilibrium, zero unless
    /// the law is (11).
    pub constants: Vec<[f64; 3]>,
}

/// The objective and the gradient of a design, with its deployment.
#[derive(Clone)]
pub struct Evaluation {
    /// L of (16).
    pub loss: f64,
    /// The unweighted terms of L.
    pub terms: TermValues,
    /// dL/dtheta
    pub gradient: DesignVector,
    /// The gradient with respect to the constants of the design problem.
    pub sensitivities: Sensitivities,
    /// The deployment of the design.
    pub deployment: Deployment,
    /// Maximum componentwise backward error of the adjoint solves.
    pub adjoint_residual: f64,
}

impl Deployment {
    /// The path, from which the paths of designs near this one can be corrected.
    pub fn warm_start(&self) -> WarmStart {
        WarmStart { designs: self.sheet.designs(), steps: self.path.clone() }
    }

    /// The load steps of only the weight; none without weight.
    pub fn weight_steps(&self) -> &[LoadStep] {
        let partial = self.path.iter().take_while(|step| step.weight < 1.0).count();
        match partial {
            0 => &[],
            partial => &self.path[..(partial + 1).min(self.path.len())],
        }
    }

    /// The state at full load.
    pub fn final_step(&self) -> &LoadStep {
        self.path.last().expect("a path has at least one step")
    }

    /// The state at full load, or an error if it was not reached.
    pub fn at_full_load(&self) -> Result<&LoadStep, DesignError> {
        converged(self.final_step())
    }

    /// Positions of panel corners at full load (mm).
    pub fn outline(&self, corners: &[PanelCorner]) -> Vec<Point> {
        self.outline_at(self.final_step(), corners)
    }

    /// Positions of panel corners in a state of the sheet (mm).
    pub(crate) fn outline_at(&self, step: &LoadStep, corners: &[PanelCorner]) -> Vec<Point> {
        let configuration = &step.configuration;
        let deployed = |&(panel, corner): &PanelCorner| {
            let flat = self.sheet.panels[panel].boundary[corner];
            deployed(&self.sheet.panels[panel], configuration[panel], flat)
        };
        corners.iter().map(deployed).collect()
    }

    /// Maximum damage of a hinge along the path; `None` if the hinge law does not predict damage,
    /// or if a state of the path is outside its training domain.
    pub fn damage_max(&self, measure: DamageMeasure, hinge: usize) -> Option<f64> {
        self.path.iter().try_fold(0.0, |maximum: f64, step| {
            let known = measure.known(step.damage.get(hinge)?);
            Some(maximum.max(known.filter(|_| step.inside[hinge])?))
        })
    }

    /// Fraction of the hinge states of the path that lie inside the training domain of the hinge
    /// law.
    pub fn share_inside(&self) -> f64 {
        let inside = || self.path.iter().flat_map(|step| &step.inside);
        inside().filter(|inside| **inside).count() as f64 / inside().count() as f64
    }

    /// Number of hinges that are outside the training domain of the hinge law in the last state.
    pub fn hinges_outside(&self) -> usize {
        let inside = &self.final_step().inside;
        inside.iter().filter(|inside| !**inside).count()
    }
}

impl DesignProblem {
    /// The opening angle of all hinges of a design, if they are pins (rad).
    pub fn opening(&self, design: &DesignVector) -> Option<f64> {
        match self.model {
            Model::Ideal { opening } => Some(design.opening.unwrap_or(opening)),
            Model::Equilibrium(_) => None,
        }
    }

    /// Ends the paths that are followed at the increment during which `stop` becomes true: they
    /// have no equilibrium at full load.
    pub fn stop_by(&mut self, stop: Arc<AtomicBool>) {
        if let Model::Equilibrium(mechanics) = &mut self.model {
            mechanics.solver.stop_by(stop);
        }
    }

    /// Lines 2-4 of Algorithm 1: cut pattern and flat sheet.
    pub fn cut(&self, design: &DesignVector) -> Result<(CutPattern, Sheet), DesignError> {
        let pattern = CutPattern::new(self.topology.grid, self.outline, &design.pattern)?;
        let w_lig: Vec<f64> =
            (design.omega.iter()).map(|&omega| self.widths.width(omega)).collect();
        let sheet = self.sheet(&pattern, &w_lig)?;
        Ok((pattern, sheet))
    }

    /// The sheet of a pattern with the given ligament widths (mm), held and pulled where the
    /// problem's sheet is.
    pub(crate) fn sheet(&self, pattern: &CutPattern, w_lig: &[f64]) -> Result<Sheet, Fault> {
        let sheet = Sheet::of_cells(pattern, self.topology.clone(), w_lig, self.options)?;
        Ok(match self.model.mechanics() {
            Some(mechanics) => sheet.attached_at(mechanics.solver.attachment_points()),
            None => sheet,
        })
    }

    /// Lines 2-5 of Algorithm 1. A path that diverges ends early; see [`LoadStep::status`].
    pub fn deploy(&self, design: &DesignVector) -> Result<Deployment, DesignError> {
        self.deploy_near(design, None)
    }

    /// The same, with the path corrected from the `known` one of another design if that is near
    /// enough.
    pub fn deploy_near(
        &self,
        design: &DesignVector,
        known: Option<&WarmStart>,
    ) -> Result<Deployment, DesignError> {
        Ok(self.deploy_prepared(design, false, known)?.0)
    }

    /// The deployment, its damage with or without `gradient`, and the hinge law prepared for its
    /// sheet. The path is corrected from the `known` one of another design if that is near enough.
    pub(super) fn deploy_prepared(
        &self,
        design: &DesignVector,
        gradient: bool,
        known: Option<&WarmStart>,
    ) -> Result<(Deployment, Option<Box<dyn PreparedLaw + '_>>), DesignError> {
        let (pattern, sheet) = self.cut(design)?;
        let (path, followed, law) = match &self.model {
            Model::Ideal { opening } => {
                let theta = design.opening.unwrap_or(*opening);
                check_opening(theta)?;
                let ideal = LoadStep::ideal(&sheet, ideal_deployment(&sheet, theta));
                (vec![ideal], true, None)
            }
            Model::Equilibrium(mechanics) => {
                mechanics.solver.check_supports(&sheet)?;
                let law = mechanics.law.prepare(&sheet.designs());
                let hinged = mechanics.hinged(&sheet, &*law, gradient);
                let (path, followed) = mechanics.path(hinged, known);
                path.iter().for_each(|step| verbose::note(|| step.to_string()));
                (path, followed, Some(law))
            }
        };
        let deployment = Deployment { pattern, sheet, path, followed };
        Ok((deployment, law))
    }

    /// L(theta) without its gradient.
    pub fn loss(&self, design: &DesignVector) -> Result<f64, DesignError> {
        let deployment = self.deploy(design)?;
        let outline = deployment.sheet.free_outline_corners();
        Ok(self.evaluate_deployed(&deployment, &outline)?.loss)
    }

    pub(super) fn evaluate_deployed(
        &self,
        deployment: &Deployment,
        outline: &[PanelCorner],
    ) -> Result<ObjectiveValue, DesignError> {
        ensure!(!self.objective.shape.target.is_empty(), "the target has no points");
        deployment.at_full_load()?;
        Ok(self.objective.evaluate(&Deployed {
            sheet: &deployment.sheet,
            path: &deployment.path,
            outline: &deployment.outline(outline),
        }))
    }
}

/// The load step, or an error if it is no equilibrium.
pub fn converged(step: &LoadStep) -> Result<&LoadStep, DesignError> {
    match step.status {
        Status::Diverged => Err(DesignError::NoEquilibrium {
            reached: step.load_factor,
            residual: step.residual,
            end: step.descent_end,
        }),
        _ => Ok(step),
    }
}

impl Mechanics {
    /// The mechanics at `thickness` times the thickness and `stress` times the stress at every
    /// strain. Its weight grows with the thickness; contact is not changed.
    pub(crate) fn scaled(&self, thickness: f64, stress: f64) -> Result<Self, Fault> {
        ensure!(
            thickness > 0.0 && stress > 0.0 && thickness.is_finite() && stress.is_finite(),
            "a sheet with these errors cannot exist: a ligament, the thickness or the stresses are not positive"
        );
        let mut similar =
            Self { law: Arc::clone(&self.law), contact: self.contact, solver: self.solver.clone() };
        if (thickness, stress) != (1.0, 1.0) {
            let law = self.law.scaled(thickness, stress);
            similar.law = law.ok_or_else(|| {
                fault!(
                    "the hinge law does not determine the hinges of a sheet of another thickness, or of a stronger \
                     material: use level = \"standard\""
                )
            })?;
            similar.solver.weight = self.solver.weight.map(|weight| thickness * weight);
        }
        Ok(similar)
    }

    /// The path of a sheet, corrected from a `known` one that is near enough, or else followed from
    /// the flat sheet, and whether it was followed.
    pub(crate) fn path(
        &self,
        hinged: HingedSheet,
        known: Option<&WarmStart>,
    ) -> (Vec<LoadStep>, bool) {
        let near = known.and_then(|known| self.solver.path_near(hinged, known));
        let followed = near.is_none();
        (near.unwrap_or_else(|| self.solver.path(hinged)), followed)
    }

    /// The sheet with its prepared hinge law and contact, as the solver reads it.
    pub fn hinged<'a>(
        &'a self,
        sheet: &'a Sheet,
        law: &'a dyn PreparedLaw,
        damage_gradient: bool,
    ) -> HingedSheet<'a> {
        HingedSheet { sheet, law, contact: self.contact.as_ref(), damage_gradient }
    }
}
