//! `kirigami study polyester`: the sheet of section 4.3, designed with and without the objectives on
//! the hinges' paths, and its monitored hinge replayed by finite elements; Fig. 9.

mod page;

use crate::kept_solves::{Outcome, SolveArgs};
use crate::routes::{HingeRoute, hinge_routes, tier_of};
use crate::run_folder;
use crate::study::designed;
use crate::surrogate::predicted;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::force_transmission::{ForceTransmission, TransmissionShares};
use design::gradient::Deployment;
use design::hinge_law::DamageMeasure;
use design::outline_error::outline_error;
use design::scene::{HingeModel, Scene, SceneConfig};
use design::sheet::{HingePoint, Panel};
use design::threshold::least_passing;
use hinge::HingeSample;
use mesher::Tier;
use std::cmp::Ordering;
use std::path::PathBuf;
use surrogate::Surrogate;

/// One sheet designed for its shape alone, and with the damage and compression of its hinges
///
/// The load is first grown until the worst hinge of the start opens by a given angle. Both hinge
/// points are tried; of each, the hinge that is damaged most by the shape alone is replayed by
/// finite elements. Writes polyester.csv, polyester.md, pictures, and the designs with their cut
/// files. Example: kirigami study polyester configs/scenes/pet-3x3.toml --tier tiny
#[derive(Args)]
pub struct PolyesterStudy {
    /// Scene (TOML) with the learned hinge law
    #[arg(value_name = "SCENE", default_value = "configs/scenes/pet-3x3.toml")]
    scene: PathBuf,
    /// Weights instead of those that the scene names
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// Opening of the worst hinge of the start that sets the load (deg)
    #[arg(long, value_name = "DEG", default_value_t = 35.0)]
    opening_deg: f64,
    /// Mesh tier of the replays, by default the one that the weights speak for
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    /// Folder for the tables, the pictures and the designs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-polyester")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// The load is found to this share.
const RESOLUTION: f64 = 1e-4;

/// One design, deployed.
struct Row {
    point: HingePoint,
    objective: &'static str,
    /// The run folder of the design.
    folder: PathBuf,
    /// Size of all loads together, as a factor of the scene's.
    load: f64,
    routes: Vec<HingeRoute>,
    /// Before and after the design (mm).
    outline: [f64; 2],
    /// Areas of the panels over those of the start.
    areas: Vec<f64>,
    w_lig: Vec<f64>,
    shares: TransmissionShares,
    /// f_n and the size of the force at each interface (N).
    forces: Vec<[f64; 2]>,
    share_inside: f64,
    /// Maximum D of each hinge along its path, over D_s; none where the path leaves the domain.
    damage: Vec<Option<f64>>,
    /// The monitored hinge at full load by the surrogate: W, M_theta, D, D_peak; and by finite elements.
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
                rows.push(self.design(config, point, objective, load)?);
            }
        }
        // The worst hinge of the first of each pair is looked at in both.
        for pair in rows.chunks_mut(2) {
            let worst = worst(&pair[0].damage);
            pair.iter_mut().for_each(|row| row.monitored = worst);
        }
        let surrogate = self.surrogate(&base)?;
        let tier = self.tier.unwrap_or_else(|| tier_of(&surrogate));
        self.replay(&mut rows, &surrogate, &base, tier)?;
        page::write(&self.out, &rows, &surrogate, tier)
    }

    fn base(&self) -> Result<SceneConfig> {
        let mut config: SceneConfig = hinge::config::read(&self.scene)?;
        ensure!(
            config.hinge == HingeModel::Surrogate && !config.loads.is_empty(),
            "{} needs the learned hinge law (hinge = \"surrogate\") and a load",
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

    /// The factor of the loads at which the worst hinge of the start opens by the given angle.
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
                "no load opens the worst hinge of the start by {} deg",
                self.opening_deg
            )
        })
    }

    fn design(
        &self,
        mut config: SceneConfig,
        point: HingePoint,
        objective: &'static str,
        load: f64,
    ) -> Result<Row> {
        let folder = format!("{point:?}-{objective}").replace([' ', '\''], "-");
        config.output = std::path::absolute(self.out.join("designs").join(folder))?;
        let folder = config.output.clone();
        let scene = Scene::new(config, &self.scene)?;
        let designed = designed(&scene, &mut |_| ())?;
        design::results::write_results(&scene, &designed)?;
        let problem = scene.problem()?;
        let (start, best) = (&designed.start.deployment, &designed.best.deployment);
        let transmission = ForceTransmission::new(&problem, best)?;
        let scale = scene.surrogate().map_or(1.0, Surrogate::damage_scale);
        let interfaces = transmission.interfaces.iter();
        Ok(Row {
            point,
            objective,
            folder,
            load,
            routes: hinge_routes(&scene, &designed.design)?,
            outline: [start, best].map(|deployment| outline_error(&scene, deployment)),
            areas: std::iter::zip(areas(best), areas(start))
                .map(|(area, before)| area / before)
                .collect(),
            w_lig: best.sheet.hinges.iter().map(|hinge| hinge.w_lig).collect(),
            shares: transmission.shares(),
            forces: interfaces.map(|it| [it.normal, it.force()]).collect(),
            share_inside: best.share_inside(),
            damage: (0..best.sheet.hinges.len())
                .map(|h| Some(best.damage_max(DamageMeasure::Mean, h)? / scale))
                .collect(),
            monitored: 0,
            learned: [0.0; 4],
            replayed: None,
        })
    }

    /// The monitored hinge of every design, by the surrogate and by finite elements.
    fn replay(
        &self,
        rows: &mut [Row],
        surrogate: &Surrogate,
        base: &SceneConfig,
        tier: Tier,
    ) -> Result<()> {
        let material = Scene::new(base.clone(), &self.scene)?.material;
        let solves: Vec<_> = rows
            .iter()
            .map(|row| row.routes[row.monitored].recorded(&material, tier))
            .collect::<Result<_>>()?;
        let outcomes = self
            .solve
            .solve(&solves.iter().collect::<Vec<_>>(), &self.out)?;
        for (row, outcome) in rows.iter_mut().zip(outcomes) {
            row.learned = learned(surrogate, &row.routes[row.monitored]);
            row.replayed = replayed(&outcome);
        }
        Ok(())
    }
}

fn areas(deployment: &Deployment) -> Vec<f64> {
    let panels = deployment.sheet.panels.iter();
    panels.map(Panel::area).collect()
}

fn worst(damage: &[Option<f64>]) -> usize {
    let indices = 0..damage.len();
    indices
        .max_by(|&i, &j| damage[i].partial_cmp(&damage[j]).unwrap_or(Ordering::Equal))
        .unwrap_or(0)
}

/// By the surrogate at the end of the route.
fn learned(surrogate: &Surrogate, route: &HingeRoute) -> [f64; 4] {
    figures(&predicted(surrogate, &[route.design], &[route.end()])[0])
}

fn replayed(outcome: &Outcome) -> Option<[f64; 4]> {
    outcome.as_ref().ok()?.samples.last().map(figures)
}

/// W, M_theta, D and D_peak.
fn figures(end: &HingeSample) -> [f64; 4] {
    [end.w, end.m_theta, end.d, end.d_peak.unwrap_or(f64::NAN)]
}
