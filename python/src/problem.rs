//! A prepared design problem: its scene is read once, its solves start from the last state.

use crate::{
    arrays::{Argument, Array, Numbers, Plain, finite, list, plain, rows, shaped, tuple},
    deployment::{Deployment, State},
    errors,
    flat_sheet::Sheet,
    waiting::{unlocked, while_polling},
};
use design::{
    DesignError, DesignProblem, DesignVector, Evaluation, SearchMethod, SearchState,
    equilibrium::warm_start::WarmStart,
    objective::response::{Conditions, Response, ResponseCotangent},
    optimise,
};
use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
    types::PyDict,
};
use rayon::prelude::*;
use scene::{
    Level, Scene, SceneConfig,
    design_run::{design_of_run, stored_design},
    run_inputs::scene_file,
};
use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
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

/// What the next solves start from.
#[derive(Default)]
struct Warm {
    path: Known,
    state: Known,
}

/// One of many equilibria, or why there is none.
#[derive(IntoPyObject)]
enum Answer {
    Found(State),
    Missing(PyErr),
}

/// The gradient of a function of the equilibrium, as a dict.
#[derive(IntoPyObject)]
struct Pullback {
    design: Array,
    loads: Array,
    thickness: Option<f64>,
    stress: Option<f64>,
}

/// Load steps that are known, and how many solves have been corrected from one another since the
/// last followed path.
#[derive(Default)]
struct Known {
    path: Option<Arc<WarmStart>>,
    corrected: usize,
}

impl Known {
    /// The path to start from; none when the next one is to be followed from the flat sheet.
    fn usable(&self, follow_every: usize) -> Option<Arc<WarmStart>> {
        self.path.clone().filter(|_| self.corrected + 1 < follow_every)
    }

    fn keep(&mut self, deployment: &design::Deployment) {
        self.corrected = if deployment.followed { 0 } else { self.corrected + 1 };
        self.path = Some(Arc::new(deployment.warm_start()));
    }
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
        let mut end = 0;
        for (name, length) in ["z", "ell", "omega", "opening"].into_iter().zip(lengths) {
            let Range { start, end: stop } = end..end + length;
            end = stop;
            let slice = py.import("builtins")?.call_method1("slice", (start, stop))?;
            blocks.set_item(name, slice)?;
        }
        Ok(blocks)
    }

    /// Panels along x and y.
    #[getter]
    fn panels(&self) -> (usize, usize) {
        (self.problem.grid.m, self.problem.grid.n)
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
        Ok(Deployment::new(problem, deployment))
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

    /// The equilibrium at full load alone: deployed corners, reactions, load factor. It costs a
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
    ) -> PyResult<Vec<Answer>> {
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
                Ok(response) => Ok(Answer::Found(State(response))),
                Err(error) if strict => Err(errors::of_element(i, error)),
                Err(error) => Ok(Answer::Missing(error)),
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
        let corners = shaped(corners, "corners", &[problem.grid.panel_count(), 4, 2])?;
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
        // From logarithms to mm and to the factor.
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
        let grid = self.problem.grid;
        format!("Problem({:?}, {} x {} panels)", self.scene.config.title, grid.m, grid.n)
    }
}

impl Problem {
    /// The result of `solve`, without the GIL; Ctrl-C ends the path that it follows, and is raised.
    fn solved<T: Send>(&self, solve: impl FnOnce() -> T + Send) -> PyResult<T> {
        self.stop.store(false, Ordering::Relaxed);
        while_polling(&self.stop, solve)
    }

    fn mechanics(&self) -> PyResult<&design::Mechanics> {
        let mechanics = self.problem.model.mechanics();
        mechanics.ok_or_else(|| errors::design(DesignError::NoMechanics))
    }

    fn warm(&self) -> MutexGuard<'_, Warm> {
        self.warm.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn known(&self, warm: bool, part: impl Fn(&Warm) -> &Known) -> Option<Arc<WarmStart>> {
        let follow_every = self.scene.config.solver.follow_every;
        part(&self.warm()).usable(follow_every).filter(|_| warm)
    }

    fn design_of(&self, x: &Argument) -> PyResult<DesignVector> {
        Ok(self.start.with_flat(&shaped(x, "x", &[self.size()])?))
    }

    fn by_panel(&self, argument: &Argument, name: &'static str) -> PyResult<Vec<[f64; 3]>> {
        let given = shaped(argument, name, &[self.problem.grid.panel_count(), 3])?;
        Ok(given.as_chunks::<3>().0.to_vec())
    }

    /// The problem with other loads, another thickness (mm) and other stresses than the scene has.
    fn under(
        &self,
        loads: Option<&Argument>,
        thickness: Option<f64>,
        stress: f64,
    ) -> PyResult<Arc<DesignProblem>> {
        let loads = loads.map(|loads| self.by_panel(loads, "loads"));
        let conditions = Conditions {
            loads: loads.transpose()?,
            thickness: match thickness {
                Some(thickness) => finite("thickness", thickness)? / self.thickness(),
                None => 1.0,
            },
            stress: finite("stress", stress)?,
        };
        if conditions == Conditions::default() {
            return Ok(Arc::clone(&self.problem));
        }
        Ok(Arc::new(self.problem.under(&conditions).map_err(errors::design)?))
    }

    fn evaluated(&self, x: &Argument, warm: bool) -> PyResult<Evaluation> {
        let design = self.design_of(x)?;
        let known = self.known(warm, |warm| &warm.path);
        let evaluation = self.solved(|| self.problem.evaluate_near(&design, known.as_deref()))?;
        let evaluation = evaluation.map_err(errors::design)?;
        self.warm().path.keep(&evaluation.deployment);
        Ok(evaluation)
    }

    /// The inputs of many solves.
    fn many(
        &self,
        x: &Argument,
        loads: Option<&Argument>,
        thickness: Option<&Argument>,
        stress: Option<&Argument>,
    ) -> PyResult<Vec<(DesignVector, Conditions)>> {
        let read = |argument: Option<&Argument>, name, one: &[usize]| {
            let numbers = argument.map(|argument| Numbers::read(argument, name)).transpose()?;
            Ok::<_, PyErr>((numbers, one.to_vec()))
        };
        let given = [
            read(Some(x), "x", &[self.size()])?,
            read(loads, "loads", &[self.problem.grid.panel_count(), 3])?,
            read(thickness, "thickness", &[])?,
            read(stress, "stress", &[])?,
        ];
        let mut count = None;
        for (numbers, one) in &given {
            let Some(numbers) = numbers.as_ref().filter(|numbers| numbers.shape != *one) else {
                continue;
            };
            match numbers.shape.split_first() {
                Some((many, rest)) if rest == one && count.is_none_or(|count| count == *many) => {
                    count = Some(*many);
                }
                _ => {
                    let n = count.map_or("n".to_owned(), |count| count.to_string());
                    let expected = format!("{} or ({n}, ...) of these", tuple(one));
                    return Err(numbers.wrong_shape(&expected));
                }
            }
        }
        let [x, loads, thickness, stress] = given.map(|(numbers, one)| {
            let length: usize = one.iter().product();
            move |i: usize| -> Option<Vec<f64>> {
                let values = &numbers.as_ref()?.values;
                let first = if values.len() == length { 0 } else { i * length };
                Some(values[first..first + length].to_vec())
            }
        });
        let inputs = (0..count.unwrap_or(1)).map(|i| {
            let design = self.start.with_flat(&x(i).unwrap_or_default());
            let conditions = Conditions {
                loads: loads(i).map(|loads| loads.as_chunks::<3>().0.to_vec()),
                thickness: thickness(i).map_or(1.0, |mm| mm[0] / self.thickness()),
                stress: stress(i).map_or(1.0, |factor| factor[0]),
            };
            (design, conditions)
        });
        Ok(inputs.collect())
    }
}

/// The scene with the keys of a dict.
fn scene_of(keys: &Bound<PyDict>, folder: &Path) -> PyResult<Scene> {
    let py = keys.py();
    let text: String = py.import("kirigami.files")?.call_method1("_json", (keys,))?.extract()?;
    let path = folder.join("scene (dict)");
    let keys: toml::Value = serde_json::from_str(&text).map_err(errors::scene)?;
    let text = toml::to_string(&keys).map_err(errors::scene)?;
    let config: SceneConfig = support::toml_file::parse(&text, &path).map_err(errors::scene)?;
    unlocked(|| Scene::new(config, &path))?.map_err(errors::scene)
}

fn read_level(name: &str) -> PyResult<Level> {
    Level::named(name).ok_or_else(|| {
        let names = Level::ALL.map(Level::name).join(", ");
        PyValueError::new_err(format!("`level` is \"{name}\", expected one of {names}"))
    })
}

fn read_method(name: &str) -> PyResult<SearchMethod> {
    match name {
        "adam" => Ok(SearchMethod::Adam),
        "lbfgs" => Ok(SearchMethod::Lbfgs),
        _ => Err(PyValueError::new_err(format!(
            "`method` is \"{name}\", expected \"adam\" or \"lbfgs\""
        ))),
    }
}
