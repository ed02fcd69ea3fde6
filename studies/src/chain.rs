//! `kirigami-studies chain`: one task, from windows to the deployed sheet, with the choices of the
//! chain varied one at a time.
//!
//! Each choice is compared twice with the reference, which takes the most accurate option of every choice.
//! *Prediction*: the design of the reference is deployed with the choice. *Design*: the design made with the
//! choice is deployed with the reference, as a cut sheet would be.

mod chain_page;

use crate::choices::{Choice, Choices, own_weights, step_seconds};
use crate::designed::designed;
use anyhow::{Context, Result, ensure};
use clap::Args;
use dataset::Database;
use design::analysis::force_transmission::ForceTransmission;
use design::hinge_law::DamageMeasure;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::objective::scores::outline_error;
use design::pattern::design_vector::DesignVector;
use design::scene::{HingeModel, Scene, SceneConfig};
use design::sheet::cut_sheet::HingePoint;
use design::sheet::kinematics::deployed_corners;
use kirigami::ui::{interrupt, run_folder};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use support::statistics::root_mean_square;
use surrogate::Surrogate;

/// Measure cost and error of every choice of the chain on one sheet
///
/// Each of the given networks replaces the scene's in turn; a network of another mesh tier than the
/// reference's is listed as another window tier. Then every other choice is varied with the scene's own
/// network. Writes chain.csv, chain.md, tradeoff.md and a chart. Example:
/// kirigami-studies chain configs/scenes/pet-3x3.toml --reference paper.safetensors small.safetensors
#[derive(Args)]
pub struct ChainStudy {
    /// Scene (TOML) with the learned hinge law
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Networks to compare with the reference
    #[arg(value_name = "WEIGHTS")]
    networks: Vec<PathBuf>,
    /// The most accurate network, used as the reference
    #[arg(long, value_name = "WEIGHTS")]
    reference: PathBuf,
    /// Databases that the networks were trained on, for the cost of their windows
    #[arg(long, value_name = "DATABASE", num_args = 1..)]
    databases: Vec<PathBuf>,
    /// Folder for the tables, the chart and the designs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-chain")]
    out: PathBuf,
}

/// Solver tolerance and load steps of the reference.
const TOLERANCE: f64 = 1e-12;
const LOAD_STEPS: usize = 40;

const NETWORK: &str = "network";
const WINDOW_TIER: &str = "window tier";

/// A choice with its cost and errors.
struct Row {
    kind: &'static str,
    choice: String,
    /// CPU time of the windows that the network was trained on (s), if known.
    windows_s: Option<f64>,
    /// Training time of the network (s), if known.
    training_s: Option<f64>,
    /// CPU time of one design step, equilibria and gradient (s).
    step_s: f64,
    prediction: Difference,
    /// Root mean square distance from the target (mm): predicted with the choice, and with the reference.
    outline: [f64; 2],
    /// Maximum damage of any hinge of its design, by the reference.
    damage: f64,
}

/// Difference of the reference's design deployed with a choice from the same design deployed with the reference.
struct Difference {
    /// Root mean square over the panel corners (mm), and relative to the side of a square with the sheet's area.
    shape: [f64; 2],
    /// Root mean square over the rotations of the hinges (deg).
    rotation_deg: f64,
    /// Root mean square relative to that of the reference: of (F_a, F_s), and of D if it is predicted.
    force: f64,
    damage: Option<f64>,
}

/// The compared numbers of a deployed sheet.
struct Deployed {
    corners: Vec<[f64; 2]>,
    rotations: Vec<f64>,
    forces: Vec<f64>,
    /// Maximum of each hinge along the path; empty if damage is not predicted.
    damage: Vec<f64>,
    outline: f64,
}

/// The reference option of every choice, its design and the sheet that it deploys to.
struct Reference {
    problem: DesignProblem,
    design: DesignVector,
    deployed: Deployed,
    /// Side of a square with the area of the sheet (mm).
    side: f64,
}

impl ChainStudy {
    pub fn run(&self) -> Result<()> {
        let base: SceneConfig = support::toml_file::read(&self.scene)?;
        ensure!(
            base.hinge == HingeModel::Surrogate,
            "{}: the study needs the learned hinge law: set hinge = \"surrogate\"",
            self.scene.display()
        );
        let _held = run_folder::hold(&self.out)?;
        let databases = self.databases.iter().map(|path| Database::read(path));
        let databases: Vec<Database> = databases.collect::<Result<_, _>>()?;
        let reference = self.reference(&base)?;
        let (mut rows, mut failures) = (Vec::new(), String::new());
        let stop = interrupt::stop_flag()?;
        for choice in self.choices(&base)? {
            let (kind, name) = (choice.kind, choice.name.clone());
            eprintln!("{kind}: {name}");
            match self.row(choice, &reference, &databases) {
                Ok(row) => rows.push(row),
                Err(error) if stop.load(Ordering::Relaxed) => return Err(error),
                // A choice without a result is reported, not an error.
                Err(error) => writeln!(failures, "* {kind}, {name}: {error:#}")?,
            }
        }
        chain_page::write(&self.out, reference.deployed.outline, &rows, &failures)
    }

    fn reference(&self, base: &SceneConfig) -> Result<Reference> {
        let mut config = with_weights(base, &self.reference)?;
        config.solver.tolerance = TOLERANCE;
        config.load_steps = LOAD_STEPS;
        let scene = self.scene_of(config, "reference")?;
        let (problem, design) = (scene.problem()?, design(&scene, "reference")?);
        Ok(Reference {
            deployed: Deployed::new(&problem, &design)?,
            side: problem.outline.area().sqrt(),
            problem,
            design,
        })
    }

    fn row(&self, choice: Choice, reference: &Reference, databases: &[Database]) -> Result<Row> {
        let Choice { kind, name, config } = choice;
        let scene = self.scene_of(config, &format!("{kind}-{name}"))?;
        let design = design(&scene, &name)?;
        let problem = scene.problem()?;
        let predicted = Deployed::new(&problem, &reference.design)?;
        let by_choice = Deployed::new(&problem, &design)?;
        let by_reference = Deployed::new(&reference.problem, &design)?;
        let network = scene.surrogate();
        Ok(Row {
            kind,
            choice: name,
            windows_s: network.and_then(|network| windows_s(network, databases)),
            training_s: network.and_then(|network| network.card().training_s),
            step_s: step_seconds(&problem, &reference.design)?,
            prediction: predicted.difference(&reference.deployed, reference.side),
            outline: [by_choice.outline, by_reference.outline],
            damage: by_reference.damage.iter().copied().fold(0.0, f64::max),
        })
    }

    /// The scene of a choice; its designs are stored in a folder of this study.
    fn scene_of(&self, mut config: SceneConfig, name: &str) -> Result<Scene> {
        let folder = name.replace(|c: char| !c.is_ascii_alphanumeric() && c != '.', "-");
        config.output = std::path::absolute(self.out.join("designs").join(folder))?;
        Ok(Scene::new(config, &self.scene)?)
    }

    fn choices(&self, base: &SceneConfig) -> Result<Vec<Choice>> {
        let mut choices = Choices::new(base);
        let judging = Surrogate::load(&self.reference)?.card().tier.clone();
        for path in &self.networks {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let known = choices.list.iter().any(|choice| choice.name == name);
            ensure!(
                !known,
                "two networks are called {name}: rename one of the files"
            );
            let same_tier = Surrogate::load(path)?.card().tier == judging;
            let kind = if same_tier { NETWORK } else { WINDOW_TIER };
            let config = with_weights(base, path)?;
            choices.vary(kind, name, |choice| *choice = config);
        }
        for tolerance in [1e-10, 1e-6, 1e-3] {
            choices.vary("tolerance", format!("{tolerance:.0e}"), |config| {
                config.solver.tolerance = tolerance;
            });
        }
        for steps in [20, 10, 5] {
            choices.vary("load steps", steps.to_string(), |config| {
                config.load_steps = steps;
            });
        }
        let weights = own_weights(base, &self.scene)?;
        for secant_deg in [20.0, 0.0] {
            let name = format!("linear, secant at {secant_deg} deg");
            choices.springs("hinge law", &name, &weights, secant_deg, HingePoint::CutTip);
        }
        choices.vary("hinge point", "corner", |config| {
            config.hinge_point = Some(HingePoint::Corner);
        });
        Ok(choices.list)
    }
}

fn design(scene: &Scene, name: &str) -> Result<DesignVector> {
    let designed = designed(scene, &mut |_| ());
    Ok(designed.with_context(|| format!("with {name}"))?.design)
}

fn with_weights(base: &SceneConfig, weights: &Path) -> Result<SceneConfig> {
    let mut config = base.clone();
    config.name_weights(weights)?;
    Ok(config)
}

/// CPU time of the windows of the rays that the network was trained on.
fn windows_s(network: &Surrogate, databases: &[Database]) -> Option<f64> {
    let card = network.card();
    let mut manifests = databases.iter().map(Database::manifest);
    let own = manifests.find(|manifest| manifest.hash == card.dataset_hash)?;
    Some(own.cpu_s * card.training_rays? as f64 / own.rays as f64)
}

impl Deployed {
    fn new(problem: &DesignProblem, design: &DesignVector) -> Result<Self> {
        let deployment = problem.deploy(design)?;
        let last = deployment.at_full_load()?;
        let transmission = ForceTransmission::new(problem, &deployment)?;
        Ok(Self {
            corners: deployed_corners(&deployment.sheet, &last.configuration).concat(),
            rotations: last.deformations.iter().map(|eps| eps.theta).collect(),
            forces: (transmission.interfaces.iter())
                .flat_map(|interface| [interface.normal, interface.tangential])
                .collect(),
            damage: known_damage(&deployment).unwrap_or_default(),
            outline: outline_error(&problem.objective, &deployment),
        })
    }

    fn difference(&self, reference: &Self, side: f64) -> Difference {
        let off = |one: &[f64], other: &[f64]| -> f64 {
            let differences = std::iter::zip(one, other).map(|(x, y)| x - y);
            root_mean_square(differences)
        };
        let relative =
            |one: &[f64], other: &[f64]| off(one, other) / root_mean_square(other.iter().copied());
        // The mean square over points is the sum of those of both coordinates.
        let corners = off(&self.corners.concat(), &reference.corners.concat());
        let shape = corners * f64::sqrt(2.0);
        Difference {
            shape: [shape, shape / side],
            rotation_deg: off(&self.rotations, &reference.rotations).to_degrees(),
            force: relative(&self.forces, &reference.forces),
            damage: (!self.damage.is_empty() && !reference.damage.is_empty())
                .then(|| relative(&self.damage, &reference.damage)),
        }
    }
}

/// Maximum D of every hinge; `None` unless it is known for all hinges.
fn known_damage(deployment: &Deployment) -> Option<Vec<f64>> {
    let hinges = 0..deployment.sheet.hinges.len();
    hinges
        .map(|h| deployment.damage_max(DamageMeasure::Mean, h))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn deployed(shift: f64) -> Deployed {
        Deployed {
            corners: vec![[shift, 0.0], [2.0, shift]],
            rotations: vec![0.1, 0.2 + shift],
            forces: vec![3.0, 4.0 + shift],
            damage: vec![0.01],
            outline: 0.0,
        }
    }

    #[test]
    fn differences_are_over_points_and_relative_to_the_reference() {
        let found = deployed(0.5).difference(&deployed(0.0), 5.0);
        assert!(
            (found.shape[0] - 0.5).abs() < 1e-12,
            "each corner moves by 0.5"
        );
        assert!((found.shape[1] - 0.1).abs() < 1e-12);
        assert!((found.rotation_deg - (0.5 / 2.0_f64.sqrt()).to_degrees()).abs() < 1e-12);
        assert!((found.force - 0.1).abs() < 1e-12);
        assert_eq!(found.damage, Some(0.0));
    }
}
