//! A prepared design problem: its scene is read once, its solves start from the last state.

mod inputs;

use crate::{
    arrays::{Argument, Array, Numbers, Plain, finite, list, plain, rows, shaped},
    deployment::{BatchElement, Deployment, State},
    errors,
    flat_sheet::Sheet,
    scene_keys::{read_level, read_method, scene_of},
    waiting::{unlocked, while_polling},
    warm::Warm,
};
use design::{
    DesignError, DesignProblem, DesignVector, SearchState,
    objective::response::{Response, ResponseCotangent},
    optimise,
};
use output::run_results::{remove_run, write_results};
use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
    types::{PyDict, PySlice},
};
use rayon::prelude::*;
use scene::{
    Scene,
    design_run::{BegunRun, Earlier, design_of_run, stored_design},
    run_inputs::{holds_a_run, scene_file},
};
use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
};

/// A design problem: sheet, material, supports, loads, target and objective of a scene.
///
/// Problem(scene, folder=None)
///
/// scene: the file of a scene (TOML), the folder of a run, or a dict with the keys of a scene
/// (docs/KEYS.md), whose paths are relative to `folder`, by default the working folder. A design is
/// a vector x of `size` numbers; `blocks` names its parts. Units are mm, N, N mm and rad.
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct Problem {
    scene: Scene,
    problem: Arc<DesignProblem>,
    start: DesignVector,
    warm: Mutex<Warm>,
    /// Ends the paths that are followed, at Ctrl-C.
    stop: Arc<AtomicBool>,
}

/// The gradient of a function of the equilibrium, as a dict.
#[derive(IntoPyObject)]
struct Pullback {
    design: Array,
    loads: Array,
    thickness: Option<f64>,
    stress: Option<f64>,
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (scene, folder=None, level=None))]
    fn new(scene: &Argument, folder: Option<PathBuf>, level: Option<&str>) -> PyResult<Self> {
        let scene = if let Ok(keys) = scene.cast::<PyDict>() {
            scene_of(keys, &folder.unwrap_or_default())?
        } else {
            let path: PathBuf = scene.extract().map_err(|_| {
                PyTypeError::new_err(
                    "`scene` is neither a path nor a dict with the keys of a scene",
                )
            })?;
            unlocked(|| {
                let path = scene_file(&path).map_err(errors::scene)?;
                Scene::read(&path).map_err(errors::scene)
            })??
        };
        let scene = match level {
            Some(name) => scene.at_level(read_level(name)?).map_err(errors::scene)?,
            None => scene,
        };
        let mut problem = unlocked(|| scene.problem())?.map_err(errors::scene)?;
        let stop = Arc::<AtomicBool>::default();
        problem.stop_by(Arc::clone(&stop));
        Ok(Self {
            start: scene.start(),
            problem: Arc::new(problem),
            scene,
            warm: Mutex::default(),
            stop,
        })
    }

    /// Number of design variables.
    #[getter]
    fn size(&self) -> usize {
        self.start.to_flat().len()
    }

    /// The start design of the scene, shape (size,).
    #[getter]
    fn start(&self) -> Array {
        list(self.start.to_flat())
    }

    /// The parts of a design by name, as slices: `z`, the logits of the void aspect ratios; `ell`,
    /// the logits of the intervals between the cuts on the edges; `omega`, the logits of the
    /// ligament widths in their range; `opening` (rad), if it is a design variable.
    #[getter]
    fn blocks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let blocks = PyDict::new(py);
        let pattern = &self.start.pattern;
        let ell = pattern.ell.iter().map(Vec::len).sum();
        let opening = usize::from(self.start.opening.is_some());
        let lengths = [pattern.z.len(), ell, self.start.omega.len(), opening];
        let mut start = 0;
        for (name, length) in ["z", "ell", "omega", "opening"].into_iter().zip(lengths) {
            let end = start + length as isize;
            blocks.set_item(name, PySlice::new(py, start, end, 1))?;
            start = end;
        }
        Ok(blocks)
    }

    /// Panels along x and y.
    #[getter]
    fn panels(&self) -> (usize, usize) {
        (self.problem.topology.grid.m, self.problem.topology.grid.n)
    }

    /// Thickness of the sheet (mm).
    #[getter]
    fn thickness(&self) -> f64 {
        self.scene.material.thickness
    }

    /// (F_x, F_y, M) on every panel at full load (N, N, N mm), shape (panels, 3).
    #[getter]
    fn loads(&self) -> PyResult<Array> {
        Ok(rows(self.mechanics()?.solver.loads().to_vec()))
    }

    /// Names of the inputs in which the equilibrium has a derivative: the design, the loads and, if
    /// the hinge law determines them, the thickness and the stresses.
    #[getter]
    fn differentiable(&self) -> PyResult<Vec<&'static str>> {
        let [thickness, stress] = self.mechanics()?.law.scales();
        let optional = [("thickness", thickness), ("stress", stress)];
        let others = optional.into_iter().filter(|(_, known)| *known);
        Ok(["design", "loads"].into_iter().chain(others.map(|(name, _)| name)).collect())
    }

    /// The design with other ligament widths (mm), a number or an array of shape (hinges,), inside
    /// the range of the scene.
    fn with_widths(&self, x: &Argument, w_lig: &Argument) -> PyResult<Array> {
        let mut design = self.design_of(x)?;
        let hinges = design.omega.len();
        let widths = Numbers::read(w_lig, "w_lig")?.filled(&[hinges])?;
        let range = self.problem.widths;
        for (h, (omega, &width)) in design.omega.iter_mut().zip(&widths).enumerate() {
            if !(range.w_minus < width && width < range.w_plus) {
                return Err(PyValueError::new_err(format!(
                    "w_lig[{h}] = {width} mm violates {} < w_lig < {}, ligament.range of the scene",
                    range.w_minus, range.w_plus
                )));
            }
            *omega = range.omega(width);
        }
        Ok(list(design.to_flat()))
    }

    /// The flat sheet of a design.
    fn sheet(&self, x: &Argument) -> PyResult<Sheet> {
        let (_, sheet) = self.problem.cut(&self.design_of(x)?).map_err(errors::design)?;
        Ok(Sheet(Arc::new(sheet)))
    }

    /// The deployed sheet with its path, which ends early where no equilibrium is found; with pins
    /// the kinematic deployment.
    ///
    /// loads: (F_x, F_y, M) on every panel, shape (panels, 3), instead of the scene's; thickness
    /// (mm) instead of the scene's; stress: all stresses at equal strain over the stresses of the
    /// material; warm: correct the path from the last one if that is near, instead of following it
    /// from the flat sheet.
    #[pyo3(signature = (x, loads=None, thickness=None, stress=1.0, warm=true))]
    fn deploy(
        &self,
        x: &Argument,
        loads: Option<Argument>,
        thickness: Option<f64>,
        stress: f64,
        warm: bool,
    ) -> PyResult<Deployment> {
        let problem = self.under(loads.as_ref(), thickness, stress)?;
        let design = self.design_of(x)?;
        let known = self.known(warm, |warm| &warm.path);
        let deployment = self.solved(|| problem.deploy_near(&design, known.as_deref()))?;
        let deployment = deployment.map_err(errors::design)?;
        self.warm().path.keep(&deployment);
        Ok(Deployment { problem, deployment })
    }

    /// The same as `deploy`, but NoEquilibrium is raised if none was found at full load.
    #[pyo3(signature = (x, loads=None, thickness=None, stress=1.0, warm=true))]
    fn equilibrium(
        &self,
        x: &Argument,
        loads: Option<Argument>,
        thickness: Option<f64>,
        stress: f64,
        warm: bool,
    ) -> PyResult<Deployment> {
        self.mechanics()?;
        let deployment = self.deploy(x, loads, thickness, stress, warm)?;
        deployment.at_full_load()?;
        Ok(deployment)
    }

    /// Only the equilibrium at full load: deployed corners, reactions, load factor. It costs a
    /// fraction of the path.
    #[pyo3(signature = (x, loads=None, thickness=None, stress=1.0, warm=true))]
    fn solve(
        &self,
        x: &Argument,
        loads: Option<Argument>,
        thickness: Option<f64>,
        stress: f64,
        warm: bool,
    ) -> PyResult<State> {
        let problem = self.under(loads.as_ref(), thickness, stress)?;
        let design = self.design_of(x)?;
        let known = self.known(warm, |warm| &warm.state);
        let response = self.solved(|| problem.response(&design, known.as_deref()))?;
        let response = response.map_err(errors::design)?;
        self.warm().state.keep(&response.deployment);
        Ok(State(response))
    }

    /// Many equilibria at full load in one call, over all threads: x of shape (n, size) or (size,),
    /// loads of shape (n, panels, 3) or (panels, 3), thickness and stress of shape (n,) or numbers.
    /// All start from the last state of the problem.
    ///
    /// Returns a list of n states. strict: the first equilibrium that is not found is raised;
    /// otherwise its place holds the exception.
    #[pyo3(signature = (x, loads=None, thickness=None, stress=None, strict=true))]
    fn solve_many(
        &self,
        x: &Argument,
        loads: Option<&Argument>,
        thickness: Option<&Argument>,
        stress: Option<&Argument>,
        strict: bool,
    ) -> PyResult<Vec<BatchElement>> {
        let many = self.many(x, loads, thickness, stress)?;
        let known = self.known(true, |warm| &warm.state);
        let stop = AtomicBool::new(false);
        let answers = while_polling(&stop, || {
            many.par_iter()
                .map(|(design, conditions)| {
                    (!stop.load(Ordering::Relaxed)).then(|| {
                        let problem = self.problem.under(conditions)?;
                        problem.response(design, known.as_deref())
                    })
                })
                .collect::<Option<Vec<Result<Response, DesignError>>>>()
        })?;
        let answers = answers.unwrap_or_default().into_iter().enumerate();
        answers
            .map(|(i, answer)| match answer.map_err(errors::design) {
                Ok(response) => Ok(BatchElement::Found(State(response))),
                Err(error) if strict => Err(errors::of_element(i, error)),
                Err(error) => Ok(BatchElement::Missing(error)),
            })
            .collect()
    }

    /// The gradient in the inputs of a function of the equilibrium at full load, from its gradient
    /// in the outputs: the implicit derivative, by one adjoint solve.
    ///
    /// configuration: the configuration of the state that `solve` found with the same inputs;
    /// corners, reactions, load_factor: the gradient in these outputs, of their shapes. Returns a
    /// dict: `design` (size,), `loads` (panels, 3), and `thickness` (1/mm) and `stress`, which are
    /// None where the hinge law does not determine them.
    #[pyo3(signature = (x, configuration, corners, reactions, load_factor, loads=None, thickness=None, stress=1.0))]
    #[expect(
        clippy::too_many_arguments,
        reason = "inputs and outputs of the equilibrium, by keyword in Python"
    )]
    fn pullback(
        &self,
        x: &Argument,
        configuration: &Argument,
        corners: &Argument,
        reactions: &Argument,
        load_factor: f64,
        loads: Option<Argument>,
        thickness: Option<f64>,
        stress: f64,
    ) -> PyResult<Pullback> {
        let problem = self.under(loads.as_ref(), thickness, stress)?;
        let design = self.design_of(x)?;
        let configuration = self.by_panel(configuration, "configuration")?;
        let load_factor = finite("load_factor", load_factor)?;
        let corners = shaped(corners, "corners", &[problem.topology.panel_count(), 4, 2])?;
        let by = ResponseCotangent {
            corners: (corners.as_chunks::<8>().0.iter())
                .map(|row| std::array::from_fn(|c| [row[2 * c], row[2 * c + 1]]))
                .collect(),
            reactions: self.by_panel(reactions, "reactions")?,
            load_factor,
        };
        let gradient = unlocked(|| {
            let response = problem.response_at(&design, &configuration)?;
            problem.response_pullback(&design, &response, &by)
        })?;
        let gradient = gradient.map_err(errors::design)?;
        // Derivatives in mm and in the factor.
        let thickness = thickness.unwrap_or(self.thickness());
        Ok(Pullback {
            design: list(gradient.design.to_flat()),
            loads: rows(gradient.loads),
            thickness: gradient.thickness.map(|slope| slope / thickness),
            stress: gradient.stress.map(|slope| slope / stress),
        })
    }

    /// The objective (16) of the scene (mm^2) and its gradient, shape (size,).
    #[pyo3(signature = (x, warm=true))]
    fn loss_and_gradient(&self, x: &Argument, warm: bool) -> PyResult<(f64, Array)> {
        let evaluation = self.evaluated(x, warm)?;
        Ok((evaluation.loss, list(evaluation.gradient.to_flat())))
    }

    /// The terms of the objective by name, unweighted.
    #[pyo3(signature = (x, warm=true))]
    fn terms(&self, x: &Argument, warm: bool) -> PyResult<Plain> {
        Ok(plain(&self.evaluated(x, warm)?.terms))
    }

    /// The search of the scene, Algorithm 1, in memory: no file is written.
    ///
    /// callback: called after every step with a dict (step, loss, outline_error, the terms, ...);
    /// the search ends if it returns True. Ctrl-C ends it after the step. Returns (x, why it ended,
    /// the history, one dict a step).
    #[pyo3(signature = (start=None, steps=None, method=None, learning_rate=None, callback=None))]
    fn design(
        &self,
        start: Option<&Argument>,
        steps: Option<usize>,
        method: Option<&str>,
        learning_rate: Option<f64>,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<(Array, Plain, Plain)> {
        let optimiser = self.scene.config.optimiser;
        let start = start.map_or(Ok(self.start.clone()), |x| self.design_of(x))?;
        let method = match method {
            Some(name) => read_method(name)?,
            None => optimiser.method,
        };
        let rate = finite("learning_rate", learning_rate.unwrap_or(optimiser.learning_rate))?;
        let steps = steps.unwrap_or(optimiser.steps);
        let (problem, stop) = (&self.problem, AtomicBool::new(false));
        let report = |search: &SearchState| {
            Python::attach(|py| {
                py.check_signals()?;
                if let Some(callback) = &callback {
                    let ends = callback.call1(py, (plain(search.last()),))?.is_truthy(py)?;
                    stop.fetch_or(ends, Ordering::Relaxed);
                }
                Ok::<_, PyErr>(())
            })
        };
        let (search, ended) = unlocked(|| {
            let evaluation = problem.evaluate(&start).map_err(errors::design)?;
            let mut search = SearchState::new(problem, start, &evaluation, method, rate);
            report(&search)?;
            let ended = optimise(problem, &mut search, steps, &stop, &mut |search| report(search))?;
            Ok::<_, PyErr>((search, ended))
        })??;
        Ok((list(search.best.to_flat()), plain(&ended), plain(&search.history)))
    }

    /// The design of the run of this scene, or in a file (`state.json` of a run, or a design
    /// alone), shape (size,).
    #[pyo3(signature = (file=None))]
    fn stored(&self, file: Option<PathBuf>) -> PyResult<Array> {
        let design = match file {
            Some(file) => stored_design(&file, &self.scene).map_err(errors::scene)?,
            None => design_of_run(&self.scene).map_err(errors::scene)?.ok_or_else(|| {
                errors::scene(format!("there is no run in {}", self.scene.output().display()))
            })?,
        };
        Ok(list(design.to_flat()))
    }

    /// Writes a design to a folder as `kirigami design` does, with pictures as SVG alone: cut files,
    /// report, page, mounting kit. An earlier run in the folder is replaced. `force` writes the cut
    /// files even if the report has errors. Returns the report, `report.json`.
    #[pyo3(signature = (x, folder, force=false))]
    fn write(&self, x: &Argument, folder: PathBuf, force: bool) -> PyResult<Plain> {
        let mut config = self.scene.starting_at(&self.design_of(x)?);
        config.output = std::path::absolute(&folder)?;
        config.optimiser.steps = 0;
        let holds_others = std::fs::read_dir(&folder).is_ok_and(|mut files| files.next().is_some());
        if holds_others && !holds_a_run(&folder) {
            return Err(PyValueError::new_err(format!(
                "{} has files that no run has written: give another folder",
                folder.display()
            )));
        }
        let report = unlocked(|| {
            let scene = self.scene.changed(config).map_err(errors::scene)?;
            let problem = scene.problem().map_err(errors::scene)?;
            let start = problem.evaluate(&scene.start()).map_err(errors::design)?;
            if holds_a_run(&folder) {
                remove_run(&scene).map_err(errors::scene)?;
            }
            let run = BegunRun { scene: scene.clone(), problem, start };
            let designed = run
                .search(&Earlier::default(), None, &AtomicBool::new(false), &mut |_, _| {})
                .map_err(errors::scene)?;
            write_results(&scene, &designed, force).map_err(errors::scene)
        })??;
        Ok(plain(&report))
    }

    /// Forgets the last states: the next solves follow their paths from the flat sheet.
    fn forget(&self) {
        *self.warm() = Warm::default();
    }

    /// The keys of the scene with absolute paths, of which the problem is made again when it is
    /// unpickled, without its last states.
    fn __getnewargs__(&self) -> PyResult<(Plain,)> {
        let keys = self.scene.located().map_err(errors::scene)?;
        let keys = toml::Value::try_from(&keys).map_err(errors::scene)?;
        Ok((plain(&keys),))
    }

    fn __repr__(&self) -> String {
        let grid = self.problem.topology.grid;
        format!("Problem({:?}, {} x {} panels)", self.scene.config.title, grid.m, grid.n)
    }
}
