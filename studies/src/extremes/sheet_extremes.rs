//! Sheets at the limits of loads, ligaments, cut angles, thickness, size and solver settings.

use super::{Checked, kept, one_line};
use crate::extremes::ratios::Ratios;
use anyhow::{Result, anyhow};
use design::equilibrium::load_step::{LoadStep, Status};
use design::hinge_law::DamageMeasure;
use design::objective::design_problem::Deployment;
use design::objective::target::TargetShape;
use design::scene::{EdgeLoadConfig, Scene, SceneConfig, SheetEdge};
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// A scene with one extreme input.
pub(super) struct Extreme<'a> {
    name: String,
    config: SceneConfig,
    path: &'a Path,
    promise: Promise,
}

/// What must hold besides [`sound`].
#[derive(Clone, Copy)]
enum Promise {
    /// Each state has a status that is true.
    Stated,
    /// The sheet stays flat.
    Flat,
    /// Full load is reached.
    Reached,
    /// The root mean square rotation of the hinges is this one (rad).
    Opened(f64),
    /// The scene is refused before anything is computed.
    Refused,
}

/// Rotation (rad) below which a hinge is flat: the rounding of coordinates of metres.
const FLAT: f64 = 1e-12;
/// Relative difference of the rotations of two sheets that rounding and the solver's tolerance may cause.
const SAME: f64 = 1e-6;

impl Promise {
    fn text(self) -> &'static str {
        match self {
            Self::Stated => "-",
            Self::Flat => "the sheet stays flat",
            Self::Reached => "full load is reached",
            Self::Opened(_) => "the rotations of the sheet itself",
            Self::Refused => "refused with a reason",
        }
    }

    fn is_kept(self, outcome: &Result<Deployment, String>, tolerance: f64) -> bool {
        let Ok(deployment) = outcome else {
            return matches!(self, Self::Refused);
        };
        sound(deployment, tolerance)
            && match self {
                Self::Stated => true,
                Self::Flat => deployment.final_step().opening() < FLAT,
                Self::Reached => deployment.at_full_load().is_ok(),
                Self::Opened(expected) => {
                    (deployment.final_step().opening() / expected - 1.0).abs() < SAME
                }
                Self::Refused => false,
            }
    }
}

/// The extremes of a learned scene, and of a linear one.
pub(super) fn all<'a>(
    [learned, linear]: [(&SceneConfig, &'a Path); 2],
    panels: usize,
) -> Result<Vec<Extreme<'a>>> {
    let mut of_learned = Extremes::new(learned);
    let mut of_linear = Extremes::new(linear);
    of_learned.loads("");
    of_linear.loads("linear, ");
    of_learned.cuts();
    of_learned.settings()?;
    of_linear.stiffnesses();
    let name = format!("{panels} x {panels} panels, pulled at one");
    of_learned.add(name, Promise::Stated, |config| enlarged(config, panels));
    let name = format!("{panels} x {panels} panels, pulled along two edges");
    of_learned.add(name, Promise::Stated, |config| {
        enlarged(config, panels);
        pulled_along_edges(config, panels);
    });
    Ok(of_learned.list.into_iter().chain(of_linear.list).collect())
}

/// The extremes of one scene.
struct Extremes<'s, 'a> {
    base: &'s SceneConfig,
    path: &'a Path,
    list: Vec<Extreme<'a>>,
}

impl<'s, 'a> Extremes<'s, 'a> {
    fn new((base, path): (&'s SceneConfig, &'a Path)) -> Self {
        let list = Vec::new();
        Self { base, path, list }
    }

    fn add(&mut self, name: String, promise: Promise, edit: impl FnOnce(&mut SceneConfig)) {
        let (mut config, path) = (self.base.clone(), self.path);
        edit(&mut config);
        self.list.push(Extreme {
            name,
            config,
            path,
            promise,
        });
    }

    fn loads(&mut self, prefix: &str) {
        use Promise::{Flat, Reached, Refused, Stated};
        for (factor, promise) in [
            (0.0, Flat),
            (1e-9, Reached),
            (1e-6, Reached),
            (1e-3, Reached),
            (1.0, Reached),
            (10.0, Stated),
            (1e3, Stated),
            (1e6, Refused),
            (-1.0, Stated),
            (-1e3, Stated),
        ] {
            self.add(format!("{prefix}load x {factor:e}"), promise, |config| {
                config.scale_loads(factor);
            });
        }
    }

    /// Widths and angles of the ligaments.
    fn cuts(&mut self) {
        use Promise::{Refused, Stated};
        let widths = [
            (0.6, Stated),
            (2.0, Stated),
            (36.0, Stated),
            (100.0, Refused),
        ];
        for (w_lig, promise) in widths {
            self.add(format!("ligaments of {w_lig} mm"), promise, |config| {
                config.ligament.start = w_lig;
                config.ligament.range = [0.9 * w_lig, 1.1 * w_lig];
                config.process.kerf = config.process.kerf.min(0.02 * w_lig);
            });
        }
        for angle_deg in [25.0, 150.0] {
            self.add(format!("cuts at {angle_deg} deg"), Stated, |config| {
                let [width, height] = config.sheet.size.unwrap_or_default();
                let (sin, cos) = f64::to_radians(angle_deg).sin_cos();
                let (x, y) = (height * cos, height * sin);
                config.sheet.corners = Some([[0.0; 2], [width, 0.0], [width + x, y], [x, y]]);
                config.sheet.size = None;
            });
        }
    }

    /// What must not change the opening of the sheet: its scale, the load steps, the tolerance.
    fn settings(&mut self) -> Result<()> {
        let own = deployment(self.base, self.path).map_err(|reason| anyhow!(reason))?;
        let own = Promise::Opened(own.final_step().opening());
        let thickness = Scene::new(self.base.clone(), self.path)?.material.thickness;
        for factor in [0.05, 8.0] {
            self.add(format!("all lengths x {factor}"), own, |config| {
                scaled(config, thickness, factor);
            });
        }
        for steps in [1, 1000] {
            self.add(format!("{steps} load steps"), own, |config| {
                config.load_steps = steps;
            });
        }
        for tolerance in [1e-14, 0.1] {
            let name = format!("tolerance {tolerance:e}");
            self.add(name, Promise::Reached, |config| {
                config.solver.tolerance = tolerance;
            });
        }
        Ok(())
    }

    fn stiffnesses(&mut self) {
        use Promise::{Reached, Refused};
        for (k_a, k_theta, promise) in [
            (1e6, 1e-3, Refused),
            (1e6, 1.0, Reached),
            (1e-3, 1e6, Reached),
        ] {
            let name = format!("linear, k_a = k_s = {k_a:e}, k_theta = {k_theta:e}");
            self.add(name, promise, |config| {
                if let Some(linear) = &mut config.linear {
                    (linear.k_a, linear.k_s, linear.k_theta) = (k_a, k_a, k_theta);
                }
            });
        }
    }
}

/// All lengths of the scene multiplied by `factor`: the same sheet by similarity. `thickness` is that of the sheet (mm).
fn scaled(config: &mut SceneConfig, thickness: f64, factor: f64) {
    let ratios = Ratios {
        thickness: factor,
        size: factor,
        young: 1.0,
    };
    ratios.apply(config);
    config.thickness = Some(factor * thickness);
    config.process.kerf *= factor;
    around(config);
}

/// Makes the target a circle as long as the outline of the sheet: the sheet is deployed, not designed.
fn around(config: &mut SceneConfig) {
    let [width, height] = config.sheet.size.unwrap_or_default();
    config.target = TargetShape::Circle {
        centre: [0.5 * width, 0.5 * height],
        radius: (width + height) / PI,
    };
}

/// Side of a panel of the large sheet (mm): windows need 280 mm, and a sheet may be 20 m long.
const PITCH: f64 = 281.0;

/// Force on every panel of an edge that opens hinges beyond 30 degrees (N).
const EDGE_PULL: f64 = 20.0;

/// A sheet of `n` by `n` square panels, held in the middle of its left edge and pulled in that of its right.
fn enlarged(config: &mut SceneConfig, n: usize) {
    config.sheet.size = Some([PITCH * n as f64; 2]);
    config.sheet.panels = [n, n];
    around(config);
    for support in &mut config.supports {
        support.panel = [0, n / 2];
    }
    for load in &mut config.loads {
        load.panel = [n - 1, n / 2];
    }
}

/// Pulls the left and the right edge apart, so that all hinges open.
fn pulled_along_edges(config: &mut SceneConfig, n: usize) {
    for support in &mut config.supports {
        support.panel = [n / 2, n / 2];
    }
    config.loads.clear();
    config.edge_loads = [(SheetEdge::Left, -1.0), (SheetEdge::Right, 1.0)]
        .map(|(edge, sign)| EdgeLoadConfig {
            edge,
            traction: [sign * EDGE_PULL / PITCH, 0.0],
        })
        .into();
}

impl Extreme<'_> {
    fn deployment(&self) -> Result<Deployment, String> {
        deployment(&self.config, self.path)
    }
}

/// The start design of a scene, deployed, or why it cannot be.
fn deployment(config: &SceneConfig, path: &Path) -> Result<Deployment, String> {
    let scene = Scene::new(config.clone(), path).map_err(|error| error.to_string())?;
    let problem = scene.problem().map_err(|error| error.to_string())?;
    let deployment = problem.deploy(&scene.start());
    deployment.map_err(|error| error.to_string())
}

/// One row for each extreme; `progress` is called with the number of finished rows and the next one.
pub(super) fn table(extremes: &[Extreme], progress: impl Fn(usize, &str)) -> Result<Checked> {
    let mut text = String::from(
        "# At the extremes: sheets\n\n\
         Promised of every row: finite numbers; a state called an equilibrium is stable and its residual is below the tolerance \
         or its own rounding; without a jump before it, it says whether hinges are outside the training domain; no damage is \
         known of such hinges.\n\n\
         | extreme | further promise | outcome | |\n|---|---|---|---|\n",
    );
    let mut broken = 0;
    for (done, extreme) in extremes.iter().enumerate() {
        progress(done, &extreme.name);
        let begun = Instant::now();
        let outcome = extreme.deployment();
        let promise = extreme
            .promise
            .is_kept(&outcome, extreme.config.solver.tolerance);
        broken += usize::from(!promise);
        let outcome = match outcome {
            Ok(deployment) => shown(&deployment, begun.elapsed().as_secs_f64()),
            Err(reason) => one_line(&reason),
        };
        let (name, further) = (&extreme.name, extreme.promise.text());
        writeln!(
            text,
            "| {name} | {further} | {outcome} | {} |",
            kept(promise)
        )?;
    }
    Ok(Checked { text, broken })
}

/// Whether all numbers are finite, every state called an equilibrium is one, stable and to the tolerance, and no damage is
/// known where a hinge is outside the training domain.
fn sound(deployment: &Deployment, tolerance: f64) -> bool {
    let hinges = 0..deployment.sheet.hinges.len();
    let outside = |hinge: &usize| deployment.path.iter().any(|step| !step.inside[*hinge]);
    let mut unknown = hinges.filter(outside);
    deployment
        .path
        .iter()
        .all(|step| sound_step(step, tolerance))
        && unknown.all(|hinge| deployment.damage_max(DamageMeasure::Peak, hinge).is_none())
}

fn sound_step(step: &LoadStep, tolerance: f64) -> bool {
    let motions = step.configuration.as_flattened().iter();
    let finite = motions
        .chain(&step.energies)
        .all(|number| number.is_finite());
    let equilibrium = matches!(
        step.status,
        Status::Converged | Status::LeftDomain | Status::LimitPoint
    );
    let outside = step.inside.iter().any(|inside| !inside);
    finite
        && (!equilibrium
            || (step.negative_pivots == 0 && step.residual <= tolerance.max(step.rounding)))
        && (step.status != Status::Converged || !outside)
}

fn shown(deployment: &Deployment, seconds: f64) -> String {
    let end = deployment.final_step();
    let residual = deployment
        .path
        .iter()
        .map(|step| step.residual)
        .fold(0.0, f64::max);
    let jumps: usize = deployment.path.iter().map(|step| step.jumps).sum();
    format!(
        "{} at load factor {:.3}, {jumps} jumps, residual {residual:.0e}, opened by {:.3} deg, {:.0} % inside, {seconds:.2} s",
        status(end.status),
        end.load_factor,
        end.opening().to_degrees(),
        100.0 * deployment.share_inside(),
    )
}

fn status(status: Status) -> &'static str {
    match status {
        Status::Converged => "equilibrium",
        Status::LeftDomain => "equilibrium outside the domain",
        Status::Almost => "almost an equilibrium",
        Status::LimitPoint => "equilibrium after a jump",
        Status::Diverged => "no equilibrium",
    }
}
