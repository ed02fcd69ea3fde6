//! `kirigami-studies capacity`: the load that a cut pattern carries before its deployment fails; section 3.2.

mod capacity_page;
mod readings;
mod starts;

use crate::charts::{self, CapacityCurve};
use crate::designed::designed;
use crate::shape_alone::shape_alone;
use crate::stop::refuse_stop;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use design::analysis::degeneration::{Degeneration, last_jump};
use design::analysis::further_load::FurtherLoad;
use design::objective::design_problem::Deployment;
use design::objective::scores::outline_error;
use design::optimise::outer_loop::Ended;
use design::pattern::design_vector::DesignVector;
use design::scene::{HingeModel, PinConfig, Scene, SceneConfig};
use kirigami::ui::progress::Progress;
use kirigami::ui::{interrupt, picture, run_folder};
use output::drawing;
use readings::READINGS;
use std::path::PathBuf;

/// Compare the load capacity of a sheet under a pull and a transverse load, for four ways to design it
///
/// The first load of the scene is constant and the second is rho times the scene's. With both loads applied
/// together, every rho is a separate deployment from the flat sheet; the interval of rho about 1, the load of the designs,
/// at which the sheet is deployed is found by bisection. A search ends when the scene's number of steps lowers its minimum
/// loss by less than 1 %. With the second load applied after the first, in its own and in the opposite
/// direction, its stroke is prescribed until the sheet reaches its first limit. The capacity of the uniform sheet is
/// also computed in other readings of the paper. Writes capacity.csv, paths.csv,
/// capacity.md and pictures. Example: kirigami-studies capacity
#[derive(Args)]
pub struct CapacityStudy {
    /// Scene (TOML) with the two loads, the second with its value at rho = 1
    #[arg(value_name = "SCENE", default_value = "configs/scenes/capacity.toml")]
    scene: PathBuf,
    /// Maximum rho of both loads together
    #[arg(long, value_name = "RHO", default_value_t = 6.0)]
    to: f64,
    /// Number of random starts from which each pattern is searched again; the figures of one pattern are of the scene's start
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=1000))]
    starts: u64,
    /// Folder for the tables, the pictures and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-capacity")]
    out: PathBuf,
}

/// Spacing of rho in the sweep.
const SPACING: f64 = 0.25;
/// Number of bisections of the interval that contains the capacity.
const HALVINGS: usize = 8;
/// Relative fall of the minimum loss in a round of the scene's steps below which a search has settled.
const SETTLED: f64 = 0.01;
/// Maximum number of rounds.
const ROUNDS: usize = 30;
/// rho of the designs.
const DESIGN_LOAD: f64 = 1.0;
/// Opening angle at the start of the kinematic search (deg).
const OPENING_DEG: f64 = 70.0;
/// Maximum stroke of the second load, relative to the width of the target.
const MAX_STROKE: f64 = 0.2;
/// The paper's capacities.
const PAPER: [f64; 4] = [1.66, 1.80, 1.29, 2.95];

/// A way to design a pattern.
struct Strategy {
    name: &'static str,
    /// The scene of the search; `None` leaves the sheet uniform.
    search: Option<SceneConfig>,
}

/// A deployment at one rho.
struct Point {
    rho: f64,
    /// Mean and minimum opening (deg).
    opening_deg: [f64; 2],
    /// Root mean square distance of the outline from the target, relative to the target's width (%).
    boundary: f64,
    degeneration: Option<Degeneration>,
    last_jump: Option<f64>,
}

/// The interval of rho at which a sheet is deployed: that about the load of the designs or, if it is not deployed there, the
/// one that begins at 0.
struct Carried {
    /// The minimum; 0 if the sheet is deployed down to there.
    from: f64,
    /// The maximum, and the deployment just above it; `None` if all tested loads above `from` are carried.
    to: Option<(f64, Point)>,
}

/// The load capacity of the pattern of a strategy.
struct Capacity {
    name: &'static str,
    /// Steps after which the search had settled.
    steps: usize,
    points: Vec<Point>,
    carried: Carried,
    /// The second load after the first, in the direction of the scene and in the opposite direction.
    after: [FurtherLoad; 2],
}

impl CapacityStudy {
    pub fn run(&self) -> Result<()> {
        // The boundary errors of the patterns are compared at rho = 1.
        ensure!(
            (1.0..=1e3).contains(&self.to),
            "--to must be between 1 and 1000"
        );
        let config: SceneConfig = support::toml_file::read(&self.scene)?;
        let [pull, second] = &config.loads[..] else {
            bail!(
                "{}: the scene needs exactly two [[loads]]",
                self.scene.display()
            );
        };
        ensure!(
            pull.force != [0.0; 2] && second.force != [0.0; 2],
            "{}: both loads must have a force",
            self.scene.display()
        );
        ensure!(
            config.drive.is_none()
                && config.edge_loads.is_empty()
                && config.opening_couples.is_empty(),
            "{}: no other actuation is allowed: remove drive, edge_loads and opening_couples",
            self.scene.display()
        );
        let _held = run_folder::hold(&self.out)?;
        let strategies = strategies(&config);
        let mut designs = Vec::new();
        for (i, strategy) in strategies.iter().enumerate() {
            let Some(search) = &strategy.search else {
                designs.push((self.scene_of(&config)?.start(), 0));
                continue;
            };
            let mut search = search.clone();
            search.output = std::path::absolute(&self.out)?.join(format!("runs/{i}"));
            let settled = self.settled(search, strategy.name)?;
            designs.push(settled.with_context(|| not_settled(strategy.name, &config))?);
        }
        let mut capacities: Vec<Capacity> = Vec::new();
        for (i, (strategy, (design, steps))) in std::iter::zip(&strategies, designs).enumerate() {
            let points = self.sweep(&config, &design, strategy.name)?;
            let carried = self.carried(&config, &design, &points)?;
            if let Some((_, above)) = &carried.to {
                let (scene, deployment) = self.deploy(&config, &design, above.rho)?;
                let svg = drawing::deployed(&scene, &deployment);
                picture::save(&svg, &self.out.join(format!("above-{}", i + 1)), 1600)?;
            }
            capacities.push(Capacity {
                name: strategy.name,
                steps,
                carried,
                after: self.after(&config, &design)?,
                points,
            });
        }
        let curves: Vec<CapacityCurve> = capacities.iter().map(Capacity::curve).collect();
        picture::save(
            &charts::capacity(&curves)?,
            &self.out.join("capacity"),
            2000,
        )?;
        run_folder::write(&self.out, "capacity.csv", &capacity_page::csv(&capacities))?;
        run_folder::write(&self.out, "paths.csv", &capacity_page::paths(&capacities))?;
        let readings = self.readings(&config)?;
        let mut page = capacity_page::page(&capacities, &readings, &self.scene, self.to);
        page += "\nThe patterns searched from random starts, median and range; a capacity above the largest rho of the sweep counts as that:\n\n";
        page += &starts::table(&self.several_starts(&config, &strategies)?, self.to);
        run_folder::write(&self.out, "capacity.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    /// The best design of a search and its number of steps; `None` if it has not settled after all rounds.
    fn settled(
        &self,
        mut search: SceneConfig,
        name: &str,
    ) -> Result<Option<(DesignVector, usize)>> {
        let round = search.optimiser.steps;
        let bar = Progress::new(ROUNDS * round, "design steps, at most");
        for done in 1..=ROUNDS {
            search.optimiser.steps = done * round;
            let scene = self.scene_of(&search)?;
            let found = designed(&scene, &mut |step| bar.show(step.step, None, name))?;
            let least = |steps: usize| {
                let losses = found
                    .history
                    .iter()
                    .take(steps + 1)
                    .map(|step| step.scores.loss);
                losses.fold(f64::INFINITY, f64::min)
            };
            let [before, now] = [(done - 1) * round, done * round].map(least);
            let settled = done > 1 && now > (1.0 - SETTLED) * before;
            if settled || found.ended == Ended::Settled {
                bar.finish();
                let design = DesignVector {
                    opening: None,
                    ..found.design
                };
                return Ok(Some((design, found.history.len() - 1)));
            }
        }
        Ok(None)
    }

    /// What the uniform sheet carries in every reading.
    fn readings(&self, config: &SceneConfig) -> Result<Vec<Carried>> {
        let carried = READINGS.iter().map(|reading| {
            let mut config = config.clone();
            (reading.change)(&mut config);
            let uniform = self.scene_of(&config)?.start();
            let points = self.sweep(&config, &uniform, reading.name)?;
            self.carried(&config, &uniform, &points)
        });
        carried.collect()
    }

    /// The deployments of a design at all values of rho.
    fn sweep(&self, config: &SceneConfig, design: &DesignVector, name: &str) -> Result<Vec<Point>> {
        let stop = interrupt::stop_flag()?;
        let values = self.values();
        let bar = Progress::new(values.len(), "deployments");
        let mut points = Vec::new();
        for rho in values {
            refuse_stop(stop)?;
            points.push(self.point(config, design, rho)?);
            bar.show(points.len(), None, name);
        }
        bar.finish();
        Ok(points)
    }

    /// The values of rho of the sweep.
    fn values(&self) -> Vec<f64> {
        (0..)
            .map(|i| SPACING * f64::from(i))
            .take_while(|rho| *rho <= self.to)
            .collect()
    }

    fn scene_of(&self, config: &SceneConfig) -> Result<Scene> {
        Ok(Scene::new(config.clone(), &self.scene)?)
    }

    /// The deployment of a design at one rho, from the flat sheet.
    fn deploy(
        &self,
        config: &SceneConfig,
        design: &DesignVector,
        rho: f64,
    ) -> Result<(Scene, Deployment)> {
        let mut config = shape_alone(config);
        config.loads[1].scale(rho);
        let scene = self.scene_of(&config)?;
        let deployment = scene.problem()?.deploy(design)?;
        Ok((scene, deployment))
    }

    /// The second load in the direction of the scene and in the opposite direction, after the first is applied.
    fn after(&self, config: &SceneConfig, design: &DesignVector) -> Result<[FurtherLoad; 2]> {
        let (scene, opened) = self.deploy(config, design, 0.0)?;
        let problem = scene.problem()?;
        let way = MAX_STROKE * scene.target.width();
        let led = |sign: f64| -> Result<FurtherLoad> {
            let mut second = config.clone();
            second.loads.remove(0);
            second.scale_loads(sign);
            let loads = self.scene_of(&second)?.actuation().boundary_loads();
            Ok(problem.further_load(&opened, &loads, way)?)
        };
        Ok([led(1.0)?, led(-1.0)?])
    }

    fn point(&self, config: &SceneConfig, design: &DesignVector, rho: f64) -> Result<Point> {
        let (scene, deployment) = self.deploy(config, design, rho)?;
        let states = &deployment.final_step().deformations;
        let openings = || states.iter().map(|state| state.theta.to_degrees());
        Ok(Point {
            rho,
            opening_deg: [
                openings().sum::<f64>() / states.len() as f64,
                openings().fold(f64::INFINITY, f64::min),
            ],
            boundary: 100.0 * outline_error(&scene.problem()?.objective, &deployment)
                / scene.target.width(),
            degeneration: Degeneration::new(deployment.final_step()),
            last_jump: last_jump(&deployment),
        })
    }

    /// The interval in which the sheet is deployed, with its ends by bisection between the points of the sweep.
    fn carried(
        &self,
        config: &SceneConfig,
        design: &DesignVector,
        points: &[Point],
    ) -> Result<Carried> {
        let fails = |point: &Point| point.degeneration.is_some();
        let at_design = (points.iter()).position(|point| point.rho == DESIGN_LOAD && !fails(point));
        let inside = at_design.unwrap_or(0);
        let below = points[..inside].iter().rposition(fails);
        let from = match below {
            Some(below) => {
                self.limit(config, design, points[below + 1].rho, points[below].rho)?
                    .0
            }
            None => 0.0,
        };
        let above = points[inside..].iter().position(fails);
        let to = above.map(|above| {
            let above = inside + above;
            self.limit(
                config,
                design,
                points[above.saturating_sub(1)].rho,
                points[above].rho,
            )
        });
        let to = to.transpose()?;
        Ok(Carried { from, to })
    }

    /// The last rho that is carried between one that is and one that is not, and the deployment just beyond it.
    fn limit(
        &self,
        config: &SceneConfig,
        design: &DesignVector,
        mut carried: f64,
        failed: f64,
    ) -> Result<(f64, Point)> {
        let mut beyond = self.point(config, design, failed)?;
        for _ in 0..HALVINGS {
            let point = self.point(config, design, 0.5 * (carried + beyond.rho))?;
            if point.degeneration.is_some() {
                beyond = point;
            } else {
                carried = point.rho;
            }
        }
        Ok((carried, beyond))
    }
}

fn not_settled(name: &str, config: &SceneConfig) -> String {
    let steps = ROUNDS * config.optimiser.steps;
    format!("{name}: the search has not settled after {steps} steps")
}

/// The four ways to design of section 3.2.
fn strategies(config: &SceneConfig) -> [Strategy; 4] {
    let mut kinematic = shape_alone(config);
    kinematic.hinge = HingeModel::Pin;
    kinematic.pin = Some(PinConfig {
        opening_deg: OPENING_DEG,
        held: false,
    });
    kinematic.supports.clear();
    kinematic.loads.clear();
    let searches = [
        None,
        Some(kinematic),
        Some(shape_alone(config)),
        Some(config.clone()),
    ];
    let names = [
        "uniform sheet",
        "shape by kinematics alone",
        "shape through equilibrium",
        "with compression and shear",
    ];
    let mut searches = searches.into_iter();
    names.map(|name| Strategy {
        name,
        search: searches.next().flatten(),
    })
}

impl Carried {
    /// The maximum of the interval; `None` if all tested loads above its minimum are carried.
    fn maximum(&self) -> Option<f64> {
        self.to.as_ref().map(|(maximum, _)| *maximum)
    }

    /// The ends of the interval beyond which the sheet is not deployed.
    fn limits(&self) -> Vec<f64> {
        let minimum = Some(self.from).filter(|from| *from > 0.0);
        minimum.into_iter().chain(self.maximum()).collect()
    }
}

impl Capacity {
    fn curve(&self) -> CapacityCurve<'_> {
        CapacityCurve {
            name: self.name,
            limits: self.carried.limits(),
            openings: self
                .points
                .iter()
                .map(|it| (it.rho, it.opening_deg[1]))
                .collect(),
            errors: self.points.iter().map(|it| (it.rho, it.boundary)).collect(),
            ways: self.after.each_ref().map(|load| load.curve.clone()),
        }
    }

    /// The boundary error at rho = 1 (%).
    fn boundary(&self) -> Option<f64> {
        boundary(&self.points)
    }
}

/// The boundary error of a sweep at rho = 1 (%).
fn boundary(points: &[Point]) -> Option<f64> {
    let point = points.iter().find(|point| point.rho == DESIGN_LOAD)?;
    Some(point.boundary)
}
