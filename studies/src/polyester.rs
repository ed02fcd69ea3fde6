//! `kirigami-studies polyester`: the sheet of section 4.3, designed with and without the objectives on
//! the hinges' paths; its monitored hinge is solved by finite elements; Fig. 9.

mod objective_front;
mod polyester_page;

use crate::designed::designed;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::analysis::force_transmission::{ForceTransmission, TransmissionShares};
use design::analysis::threshold::least_passing;
use design::hinge_law::DamageMeasure;
use design::objective::design_problem::Deployment;
use design::objective::scores::outline_error;
use design::scene::design_run::Designed;
use design::scene::{HingeModel, Scene, SceneConfig};
use design::sheet::cut_sheet::HingePoint;
use fe_driver::{Solved, WindowSolve};
use hinge::HingeSample;
use kirigami::commands::solve_args::{SolveArgs, task_error};
use kirigami::ui::run_folder;
use mesher::Tier;
use output::run_results::write_results;
use std::cmp::Ordering;
use std::path::PathBuf;
use surrogate::Surrogate;
use verification::{RecordedPath, judging_tier, paths_of};

/// Design one sheet for its shape alone, and with objectives on damage and compression of its hinges
///
/// The loads are first scaled until the hinge of the start design that opens most has the given opening angle. Both
/// hinge points are used; for each, the hinge with the largest damage in the design for shape alone is solved by
/// finite elements. At the tip, further objectives and weights are tried from four random starts each. Writes polyester.csv, polyester.md, pictures, and the designs with their cut
/// files. Example: kirigami-studies polyester configs/scenes/pet-3x3.toml --tier tiny
#[derive(Args)]
pub struct PolyesterStudy {
    /// Scene (TOML) with the learned hinge law
    #[arg(value_name = "SCENE", default_value = "configs/scenes/pet-3x3.toml")]
    scene: PathBuf,
    /// Weights to use instead of the scene's
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// Maximum hinge opening of the start design, which sets the load (deg)
    #[arg(long, value_name = "DEG", default_value_t = 35.0)]
    opening_deg: f64,
    /// Mesh tier of the finite-element solves [default: that of the weights' database, or the finer tier that it
    /// was corrected to]
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    /// Folder for the tables, the pictures and the designs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-polyester")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// Relative accuracy of the load.
const RESOLUTION: f64 = 1e-4;

/// One design, deployed.
struct Row {
    point: HingePoint,
    objective: &'static str,
    /// The run folder of the design.
    folder: PathBuf,
    /// Factor on all loads of the scene.
    load: f64,
    paths: Vec<RecordedPath>,
    /// Outline error before and after the design (mm).
    outline: [f64; 2],
    /// Areas of the panels relative to those of the start.
    areas: Vec<f64>,
    w_lig: Vec<f64>,
    shares: TransmissionShares,
    /// f_n and the magnitude of the force at each interface (N).
    forces: Vec<[f64; 2]>,
    share_inside: f64,
    /// Maximum D of each hinge along its path, relative to D_s; `None` if the path leaves the training domain.
    damage: Vec<Option<f64>>,
    /// Maximum D_peak of each hinge along its path, likewise.
    peaks: Vec<Option<f64>>,
    /// W, M_theta, D, D_peak of the monitored hinge at full load: by the surrogate, and by finite elements.
    monitored: usize,
    learned: [f64; 4],
    replayed: Option<[f64; 4]>,
}

impl PolyesterStudy {
    pub fn run(&self) -> Result<()> {
        let base = self.base()?;
        let _held = run_folder::hold(&self.out)?;
        let mut rows = Vec::new();
        for point in [HingePoint::CutTip, HingePoint::Corner] {
            let mut config = base.clone();
            config.hinge_point = Some(point);
            let load = self.load(&config)?;
            config.scale_loads(load);
            let mut alone = config.clone();
            (alone.objective.damage, alone.objective.compression) = (0.0, 0.0);
            for (objective, config) in [("shape alone", alone), ("with the hinges' paths", config)]
            {
                eprintln!("{point:?}, {objective}");
                let folder = format!("{point:?}-{objective}").replace([' ', '\''], "-");
                let (scene, designed) = self.design(config, &folder)?;
                write_results(&scene, &designed, false)?;
                rows.push(Row::new(&scene, &designed, point, objective, load)?);
            }
        }
        // The hinge with the largest damage in the first design of a pair is evaluated in both.
        for pair in rows.chunks_mut(2) {
            let worst = worst(&pair[0].damage);
            pair.iter_mut().for_each(|row| row.monitored = worst);
        }
        let surrogate = self.surrogate(&base)?;
        let tier = judging_tier(self.tier, &surrogate)?;
        self.replay(&mut rows, &surrogate, &base, tier)?;
        let mut config = base;
        config.hinge_point = Some(HingePoint::CutTip);
        let load = rows[0].load;
        config.scale_loads(load);
        let front = objective_front::front(self, &config, load)?;
        polyester_page::write(&self.out, &rows, &surrogate, tier, &front)
    }

    fn base(&self) -> Result<SceneConfig> {
        let mut config: SceneConfig = support::toml_file::read(&self.scene)?;
        ensure!(
            config.hinge == HingeModel::Surrogate && !config.loads.is_empty(),
            "{}: the study needs a load and the learned hinge law: set hinge = \"surrogate\"",
            self.scene.display()
        );
        if let Some(weights) = &self.weights {
            config.name_weights(weights)?;
        }
        Ok(config)
    }

    fn surrogate(&self, base: &SceneConfig) -> Result<Surrogate> {
        let scene = Scene::new(base.clone(), &self.scene)?;
        Ok(scene
            .surrogate()
            .context("the scene has no weights")?
            .clone())
    }

    /// The factor on the loads at which the maximum hinge opening of the start design is the given angle.
    fn load(&self, config: &SceneConfig) -> Result<f64> {
        let limit = self.opening_deg.to_radians();
        let reaches = |factor: f64| -> Result<bool> {
            let mut config = config.clone();
            config.scale_loads(factor);
            let scene = Scene::new(config, &self.scene)?;
            let deployment = scene.problem()?.deploy(&scene.start())?;
            let last = deployment.at_full_load()?;
            let openings = last.deformations.iter().map(|eps| eps.theta);
            Ok(openings.fold(0.0, f64::max) >= limit)
        };
        least_passing(1.0, RESOLUTION, reaches)?.with_context(|| {
            format!(
                "no load opens any hinge of the start design by {} deg",
                self.opening_deg
            )
        })
    }

    /// The scene of a configuration, with its run in a folder of this study.
    fn design(&self, mut config: SceneConfig, folder: &str) -> Result<(Scene, Designed)> {
        config.output = std::path::absolute(self.out.join("designs").join(folder))?;
        let scene = Scene::new(config, &self.scene)?;
        let designed = designed(&scene, &mut |_| ())?;
        Ok((scene, designed))
    }

    /// Evaluates the monitored hinge of every design by the surrogate and by finite elements.
    fn replay(
        &self,
        rows: &mut [Row],
        surrogate: &Surrogate,
        base: &SceneConfig,
        tier: Tier,
    ) -> Result<()> {
        let material = Scene::new(base.clone(), &self.scene)?.material;
        let windows = self.solve.service(&self.out)?;
        let versions = windows.versions();
        let solve = |row: &Row| {
            let problem = row.paths[row.monitored].problem(&material, tier)?;
            Ok(WindowSolve::new(problem, &versions))
        };
        let solves: Vec<_> = rows.iter().map(solve).collect::<Result<_>>()?;
        let solved = windows.solve(&solves);
        let solved = solved.map_err(|error| task_error(error.into()))?;
        for (row, window) in rows.iter_mut().zip(&solved) {
            row.learned = learned(surrogate, &row.paths[row.monitored]);
            row.replayed = replayed(window);
        }
        Ok(())
    }
}

impl Row {
    fn new(
        scene: &Scene,
        designed: &Designed,
        point: HingePoint,
        objective: &'static str,
        load: f64,
    ) -> Result<Self> {
        let problem = &designed.problem;
        let (start, best) = (&designed.start.deployment, &designed.best.deployment);
        let transmission = ForceTransmission::new(problem, best)?;
        let interfaces = transmission.interfaces.iter();
        let scale = scene.surrogate().map_or(1.0, Surrogate::damage_scale);
        let damages = |measure: DamageMeasure, scale: f64| {
            let hinges = 0..best.sheet.hinges.len();
            let relative = |hinge| Some(best.damage_max(measure, hinge)? / scale);
            hinges.map(relative).collect()
        };
        Ok(Self {
            point,
            objective,
            folder: scene.output(),
            load,
            paths: paths_of(best),
            outline: [start, best].map(|deployment| outline_error(&problem.objective, deployment)),
            areas: std::iter::zip(areas(best), areas(start))
                .map(|(area, before)| area / before)
                .collect(),
            w_lig: best.sheet.hinges.iter().map(|hinge| hinge.w_lig).collect(),
            shares: transmission.shares(),
            forces: interfaces.map(|it| [it.normal, it.force()]).collect(),
            share_inside: best.share_inside(),
            damage: damages(DamageMeasure::Mean, scale),
            peaks: damages(DamageMeasure::Peak, 1.0),
            monitored: 0,
            learned: [0.0; 4],
            replayed: None,
        })
    }
}

fn areas(deployment: &Deployment) -> Vec<f64> {
    let panels = deployment.sheet.panels.iter();
    panels.map(|panel| panel.area).collect()
}

fn worst(damage: &[Option<f64>]) -> usize {
    let indices = 0..damage.len();
    indices
        .max_by(|&i, &j| damage[i].partial_cmp(&damage[j]).unwrap_or(Ordering::Equal))
        .unwrap_or(0)
}

/// The prediction of the surrogate at the end of the path.
fn learned(surrogate: &Surrogate, path: &RecordedPath) -> [f64; 4] {
    figures(&surrogate.samples(&[path.design], &[path.end()])[0])
}

fn replayed(window: &Solved) -> Option<[f64; 4]> {
    window.complete().ok()?.last().map(figures)
}

/// W, M_theta, D and D_peak.
fn figures(end: &HingeSample) -> [f64; 4] {
    [end.w, end.m_theta, end.d, end.d_peak.unwrap_or(f64::NAN)]
}
