//! Deployed sheets: a path of load steps, or the state at full load alone.

use crate::{
    arrays::{Doubles, array, bools, plain, triples},
    errors,
    flat_sheet::{Sheet, quadrilaterals},
};
use design::{
    DesignError, DesignProblem, equilibrium::load_step::LoadStep, hinge_law::HingeDamage,
    objective::response::Response, sheet::kinematics::deployed_corners,
};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use std::sync::Arc;

/// A deployed sheet with its path. All arrays begin with the load steps; with pins there is a
/// single one.
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct Deployment {
    problem: Arc<DesignProblem>,
    deployment: design::Deployment,
}

/// The equilibrium at full load.
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct State(pub(crate) Response);

impl Deployment {
    pub(crate) fn new(problem: Arc<DesignProblem>, deployment: design::Deployment) -> Self {
        Self { problem, deployment }
    }

    /// An error if there is no equilibrium at full load.
    pub(crate) fn at_full_load(&self) -> PyResult<&LoadStep> {
        self.deployment.at_full_load().map_err(errors::design)
    }

    fn by_step<'py, const N: usize, R: IntoIterator<Item = [f64; N]>>(
        &self,
        py: Python<'py>,
        shape: &[usize],
        of: impl Fn(&LoadStep) -> R,
    ) -> Doubles<'py> {
        let steps = self.deployment.path.iter();
        let values: Vec<f64> = steps.flat_map(of).flatten().collect();
        array(py, values, &[&[self.deployment.path.len()], shape].concat())
    }

    fn hinges(&self) -> usize {
        self.deployment.sheet.hinges.len()
    }

    fn damaged<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&HingeDamage) -> Option<f64>,
    ) -> Doubles<'py> {
        let hinges = self.hinges();
        self.by_step(py, &[hinges], |step| {
            let known = |h: usize| step.damage.get(h).and_then(&of).filter(|_| step.inside[h]);
            (0..hinges).map(|h| [known(h).unwrap_or(f64::NAN)]).collect::<Vec<_>>()
        })
    }
}

#[pymethods]
impl Deployment {
    /// How each load step ended: `converged`, `left-domain` (with hinges outside the training
    /// domain), `almost`, `limit-point` (the sheet jumped to another branch) or `diverged` (no
    /// equilibrium was found: the path ends).
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        self.deployment.path.iter().map(|step| plain(py, &step.status)).collect()
    }

    /// Whether the path was followed from the flat sheet; False if it was corrected from a path
    /// near it.
    #[getter]
    fn followed(&self) -> bool {
        self.deployment.followed
    }

    /// zeta of every load step.
    #[getter]
    fn load_factor<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        self.by_step(py, &[], |step| [[step.load_factor]])
    }

    /// Maximum unbalanced force over the maximum force, per load step.
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        self.by_step(py, &[], |step| [[step.residual]])
    }

    /// Pi of (10) (N mm), per load step.
    #[getter]
    fn potential<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        self.by_step(py, &[], |step| [[step.potential]])
    }

    /// Motions (u_x, u_y, phi) of the panels (mm, mm, rad), shape (steps, panels, 3).
    #[getter]
    fn configuration<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        let panels = self.deployment.sheet.panels.len();
        self.by_step(py, &[panels, 3], |step| step.configuration.clone())
    }

    /// Corners SW, SE, NE, NW of the panels (mm), shape (steps, panels, 4, 2).
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        let sheet = &self.deployment.sheet;
        self.by_step(py, &[sheet.panels.len(), 4, 2], |step| {
            deployed_corners(sheet, &step.configuration).concat()
        })
    }

    /// (a, s, theta) of the hinges (mm, mm, rad), shape (steps, hinges, 3).
    #[getter]
    fn deformation<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        self.by_step(py, &[self.hinges(), 3], |step| {
            step.deformations.iter().map(|eps| eps.to_array()).collect::<Vec<_>>()
        })
    }

    /// Energies of the hinges, contact included (N mm), shape (steps, hinges).
    #[getter]
    fn energy<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        self.by_step(py, &[self.hinges()], |step| {
            step.energies.iter().map(|energy| [*energy]).collect::<Vec<_>>()
        })
    }

    /// D of the hinges, shape (steps, hinges); nan where it is not known: outside the training
    /// domain, or without a learned law.
    #[getter]
    fn damage<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        self.damaged(py, |damage| Some(damage.d))
    }

    /// D_peak of the hinges, shape (steps, hinges): a ligament tears at 1; nan where it is not
    /// known.
    #[getter]
    fn damage_peak<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        self.damaged(py, |damage| damage.d_peak)
    }

    /// Whether each hinge is inside the training domain, shape (steps, hinges).
    #[getter]
    fn inside<'py>(&self, py: Python<'py>) -> Bound<'py, PyArrayDyn<bool>> {
        let path = &self.deployment.path;
        let inside = path.iter().flat_map(|step| step.inside.iter().copied());
        bools(py, inside.collect(), &[path.len(), self.hinges()])
    }

    /// Forces (F_x, F_y, M) by which the supports hold the panels at full load (N, N, N mm), shape
    /// (panels, 3); zero where a panel is free.
    #[getter]
    fn reactions<'py>(&self, py: Python<'py>) -> PyResult<Doubles<'py>> {
        let last = self.at_full_load()?;
        let mechanics = self.problem.model.mechanics();
        let mechanics = mechanics.ok_or_else(|| errors::design(DesignError::NoMechanics))?;
        let sheet = &self.deployment.sheet;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(sheet, &*law, false);
        Ok(triples(py, &mechanics.solver.reactions(hinged, &last.configuration)))
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
    fn corners<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        quadrilaterals(py, &self.0.corners())
    }

    /// Forces (F_x, F_y, M) by which the supports hold the panels (N, N, N mm), shape (panels, 3);
    /// zero where a panel is free.
    #[getter]
    fn reactions<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        triples(py, &self.0.reactions)
    }

    /// zeta: 1 under dead loads; under a prescribed stroke the load over the load of the scene.
    #[getter]
    fn load_factor(&self) -> f64 {
        self.0.state().load_factor
    }

    /// Motions (u_x, u_y, phi) of the panels (mm, mm, rad), shape (panels, 3).
    #[getter]
    fn configuration<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        triples(py, &self.0.state().configuration)
    }

    /// (a, s, theta) of the hinges (mm, mm, rad), shape (hinges, 3).
    #[getter]
    fn deformation<'py>(&self, py: Python<'py>) -> Doubles<'py> {
        let deformations = self.0.state().deformations.iter();
        triples(py, &deformations.map(|eps| eps.to_array()).collect::<Vec<_>>())
    }

    /// How the state was found, as in `Deployment.status`.
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, &self.0.state().status)
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
