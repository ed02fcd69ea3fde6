//! Deployed sheets: a path of load steps, or only the state at full load.

use crate::{
    arrays::{Array, Plain, array, plain, quadrilaterals, rows},
    errors,
    flat_sheet::Sheet,
};
use design::{
    DesignProblem, equilibrium::load_step::LoadStep, hinge_law::HingeDamage,
    objective::response::Response, sheet::kinematics::deployed_corners,
};
use pyo3::prelude::*;
use std::sync::Arc;

/// A deployed sheet with its path. All arrays begin with the load steps; with pins there is a
/// single one.
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct Deployment {
    pub(crate) problem: Arc<DesignProblem>,
    pub(crate) deployment: design::Deployment,
}

/// The equilibrium at full load.
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct State(pub(crate) Response);

impl Deployment {
    /// An error if there is no equilibrium at full load.
    pub(crate) fn at_full_load(&self) -> PyResult<&LoadStep> {
        self.deployment.at_full_load().map_err(errors::design)
    }

    fn by_step<T, R: IntoIterator<Item = T>>(
        &self,
        shape: &[usize],
        of: impl Fn(&LoadStep) -> R,
    ) -> Array<T> {
        let path = &self.deployment.path;
        array(path.iter().flat_map(of), &[&[path.len()], shape])
    }

    fn hinges(&self) -> usize {
        self.deployment.sheet.hinges.len()
    }

    fn damaged(&self, of: impl Fn(&HingeDamage) -> Option<f64>) -> Array {
        let hinges = self.hinges();
        self.by_step(&[hinges], |step| {
            let known = |h: usize| step.damage.get(h).and_then(&of).filter(|_| step.inside[h]);
            (0..hinges).map(|h| known(h).unwrap_or(f64::NAN)).collect::<Vec<_>>()
        })
    }
}

#[pymethods]
impl Deployment {
    /// How each load step ended: `converged`, `left-domain` (with hinges outside the training
    /// domain), `almost`, `limit-point` (the sheet jumped to another branch) or `diverged` (no
    /// equilibrium was found: the path ends).
    #[getter]
    fn status(&self) -> Vec<Plain> {
        self.deployment.path.iter().map(|step| plain(&step.status)).collect()
    }

    /// Whether the path was followed from the flat sheet; False if it was corrected from a path
    /// near it.
    #[getter]
    fn followed(&self) -> bool {
        self.deployment.followed
    }

    /// zeta of every load step.
    #[getter]
    fn load_factor(&self) -> Array {
        self.by_step(&[], |step| [step.load_factor])
    }

    /// Maximum unbalanced force over the maximum force, per load step.
    #[getter]
    fn residual(&self) -> Array {
        self.by_step(&[], |step| [step.residual])
    }

    /// Pi of (10) (N mm), per load step.
    #[getter]
    fn potential(&self) -> Array {
        self.by_step(&[], |step| [step.potential])
    }

    /// Motions (u_x, u_y, phi) of the panels (mm, mm, rad), shape (steps, panels, 3).
    #[getter]
    fn configuration(&self) -> Array {
        let panels = self.deployment.sheet.panels.len();
        self.by_step(&[panels, 3], |step| step.configuration.as_flattened().to_vec())
    }

    /// Corners SW, SE, NE, NW of the panels (mm), shape (steps, panels, 4, 2).
    #[getter]
    fn corners(&self) -> Array {
        let sheet = &self.deployment.sheet;
        self.by_step(&[sheet.panels.len(), 4, 2], |step| {
            deployed_corners(sheet, &step.configuration).concat().concat()
        })
    }

    /// (a, s, theta) of the hinges (mm, mm, rad), shape (steps, hinges, 3).
    #[getter]
    fn deformation(&self) -> Array {
        self.by_step(&[self.hinges(), 3], |step| {
            step.deformations.iter().flat_map(|eps| eps.to_array()).collect::<Vec<_>>()
        })
    }

    /// Energies of the hinges, contact included (N mm), shape (steps, hinges).
    #[getter]
    fn energy(&self) -> Array {
        self.by_step(&[self.hinges()], |step| step.energies.clone())
    }

    /// D of the hinges, shape (steps, hinges); nan where it is unknown: outside the training
    /// domain, or without a learned law.
    #[getter]
    fn damage(&self) -> Array {
        self.damaged(|damage| Some(damage.d))
    }

    /// D_peak of the hinges, shape (steps, hinges): a ligament tears at 1; nan where it is not
    /// known.
    #[getter]
    fn damage_peak(&self) -> Array {
        self.damaged(|damage| damage.d_peak)
    }

    /// Whether each hinge is inside the training domain, shape (steps, hinges).
    #[getter]
    fn inside(&self) -> Array<bool> {
        self.by_step(&[self.hinges()], |step| step.inside.clone())
    }

    /// Forces (F_x, F_y, M) by which the supports hold the panels at full load (N, N, N mm), shape
    /// (panels, 3); zero where a panel is free.
    #[getter]
    fn reactions(&self) -> PyResult<Array> {
        let last = self.at_full_load()?;
        let mechanics = self.problem.model.equilibrium().map_err(errors::design)?;
        let sheet = &self.deployment.sheet;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(sheet, &*law, false);
        Ok(rows(mechanics.solver.reactions(hinged, &last.configuration)))
    }

    /// The flat sheet.
    #[getter]
    fn sheet(&self) -> Sheet {
        Sheet(Arc::new(self.deployment.sheet.clone()))
    }

    fn __len__(&self) -> usize {
        self.deployment.path.len()
    }

    fn __repr__(&self) -> String {
        let steps = self.deployment.path.len();
        format!("Deployment({steps} load steps; {})", self.deployment.final_step())
    }
}

#[pymethods]
impl State {
    /// Deployed corners SW, SE, NE, NW of the panels (mm), shape (panels, 4, 2).
    #[getter]
    fn corners(&self) -> Array {
        quadrilaterals(&self.0.corners())
    }

    /// Forces (F_x, F_y, M) by which the supports hold the panels (N, N, N mm), shape (panels, 3);
    /// zero where a panel is free.
    #[getter]
    fn reactions(&self) -> Array {
        rows(self.0.reactions.clone())
    }

    /// zeta: 1 under dead loads; under a prescribed stroke the load over the load of the scene.
    #[getter]
    fn load_factor(&self) -> f64 {
        self.0.state().load_factor
    }

    /// Motions (u_x, u_y, phi) of the panels (mm, mm, rad), shape (panels, 3).
    #[getter]
    fn configuration(&self) -> Array {
        rows(self.0.state().configuration.clone())
    }

    /// (a, s, theta) of the hinges (mm, mm, rad), shape (hinges, 3).
    #[getter]
    fn deformation(&self) -> Array {
        rows(self.0.state().deformations.iter().map(|eps| eps.to_array()))
    }

    /// How the state was found, as in `Deployment.status`.
    #[getter]
    fn status(&self) -> Plain {
        plain(&self.0.state().status)
    }

    /// Whether the path to the state was followed from the flat sheet; False if the state was
    /// corrected from one near it.
    #[getter]
    fn followed(&self) -> bool {
        self.0.deployment.followed
    }

    /// The flat sheet.
    #[getter]
    fn sheet(&self) -> Sheet {
        Sheet(Arc::new(self.0.deployment.sheet.clone()))
    }

    fn __repr__(&self) -> String {
        format!("State({})", self.0.state())
    }
}

/// One of many equilibria, or why there is none.
#[derive(IntoPyObject)]
#[expect(clippy::large_enum_variant, reason = "each is moved to Python once")]
pub(crate) enum BatchElement {
    Found(State),
    Missing(PyErr),
}
