//! A deployed sheet that is unloaded, and the gradient of a function of the shape that stays.
//!
//! With g the gradient of the function in the configuration v without loads, H the tangent there, f
//! = K (x - r) the forces of a released hinge and B its rates,
//!
//! ```text
//! H lambda = g,    y = B lambda,    dL = -sum_h y . df,    df = dK (x - r) - K dr
//! ```
//!
//! r and K follow from the state under load and its forces: what their derivatives lead to is a
//! gradient in the state of each hinge at full load, with which the adjoint (20) of the path under
//! load begins.

use crate::equilibrium::adjoint::{PathGradient, adjoint};
use crate::equilibrium::load_step::{LoadStep, Status};
use crate::equilibrium::solver::EquilibriumError;
use crate::equilibrium::unloading::ReleasedSheet;
use crate::hinge_law::{DesignGradient, HingeGradient, Order, PreparedLaw, ReleasedLaw};
use crate::objective::design_problem::{Deployment, DesignError, DesignProblem, Mechanics};
use crate::sheet::cut_sheet::{Sheet, SheetGradient};
use crate::sheet::kinematics::HingeMotion;
use crate::sheet::panel_vectors::at_hinge;
use hinge::ReleasedHinge;
use std::array::from_fn;
use surrogate::ByReleased;

impl DesignProblem {
    /// Takes the loads off a deployed sheet with these hinges.
    pub fn unload(
        &self,
        deployment: &Deployment,
        hinges: Vec<ReleasedHinge>,
    ) -> Result<ReleasedSheet, DesignError> {
        let mechanics = self.model.mechanics().ok_or(DesignError::NoMechanics)?;
        Ok(mechanics.unload(&deployment.sheet, deployment.at_full_load()?, hinges)?)
    }
}

impl Mechanics {
    /// Takes the loads off a sheet in the configuration of a load step, with these hinges.
    fn unload(
        &self,
        sheet: &Sheet,
        step: &LoadStep,
        hinges: Vec<ReleasedHinge>,
    ) -> Result<ReleasedSheet, EquilibriumError> {
        let law = ReleasedLaw(&hinges);
        let hinged = self.hinged(sheet, &law, false);
        let path = self.solver.unload(hinged, step.configuration.clone())?;
        Ok(ReleasedSheet { hinges, path })
    }

    /// The sheet at the end of a path by its prepared law after it was unloaded, if the target is
    /// for the unloaded sheet; `None` too if the path has not reached full load.
    pub(super) fn released(
        &self,
        law: &dyn PreparedLaw,
        sheet: &Sheet,
        path: &[LoadStep],
    ) -> Result<Option<ReleasedSheet>, DesignError> {
        let loaded = path.last().filter(|step| step.status != Status::Diverged);
        let Some((release, step)) = self.release.as_ref().zip(loaded) else {
            return Ok(None);
        };
        let hinges = release.hinges(law, &sheet.designs(), &step.deformations);
        Ok(Some(self.unload(sheet, step, hinges)?))
    }

    /// The gradient, in the state and the design of every hinge at full load, of a function with
    /// the gradient `by_free` in the configuration of the released sheet; that in the flat sheet is
    /// added to `by_sheet`. With the backward error of the adjoint solve.
    pub(super) fn released_pullback(
        &self,
        law: &dyn PreparedLaw,
        deployment: &Deployment,
        released: &ReleasedSheet,
        by_free: Vec<[f64; 3]>,
        by_sheet: &mut SheetGradient,
    ) -> Result<(Vec<HingeGradient>, f64), DesignError> {
        let release = self.release.as_ref().expect("the sheet was unloaded by it");
        let (sheet, loaded, free) = (&deployment.sheet, deployment.final_step(), released.last());
        let released_law = ReleasedLaw(&released.hinges);
        let sums = adjoint(
            &self.solver.unloaded(sheet)?,
            self.hinged(sheet, &released_law, false),
            std::slice::from_ref(free),
            PathGradient {
                by_states: &vec![vec![HingeGradient::default()]; sheet.hinges.len()],
                by_load_factor: 0.0,
                by_last: by_free,
                by_reactions: None,
            },
            by_sheet,
        )?;
        let motions = HingeMotion::all(sheet, &free.configuration);
        let designs = sheet.designs();
        let energies = law.energies(&loaded.deformations, Order::Design);
        let by_hinge = |h: usize| -> HingeGradient {
            let hinge = &released.hinges[h];
            let y = motions[h].rates(at_hinge(&sheet.hinges[h], &sums.virtual_motion));
            let [at, rest] = [free.deformations[h], hinge.rest].map(|state| state.to_array());
            let by = ByReleased {
                rest: from_fn(|j| (0..3).map(|i| y[i] * hinge.stiffness[i][j]).sum()),
                stiffness: from_fn(|i| from_fn(|j| -y[i] * (at[j] - rest[j]))),
            };
            let energy = &energies[h];
            let found = release.pullback(&designs[h], &loaded.deformations[h], &energy.forces, &by);
            let by_force = |rates: &dyn Fn(usize) -> f64| -> f64 {
                (0..3).map(|i| found.forces[i] * rates(i)).sum()
            };
            HingeGradient {
                state: from_fn(|c| found.reached[c] + by_force(&|i| energy.tangent[i][c])),
                design: DesignGradient {
                    w_lig: found.w_lig + by_force(&|i| energy.mixed[i].w_lig),
                    alpha: found.alpha + by_force(&|i| energy.mixed[i].alpha),
                    hole: by_force(&|i| energy.mixed[i].hole),
                },
            }
        };
        let by_states = (0..sheet.hinges.len()).map(by_hinge).collect();
        Ok((by_states, sums.residual))
    }
}
