//! `kirigami surrogate spot-check`: errors of weights against finite elements inside their training domain.
//!
//! The training domain is convex and contains the flat state. Draw a state x uniformly inside it; x fixes a
//! direction with the density of uniform states. With R the distance to the boundary along it and u uniform in
//! (0, 1), the state at the distance R u^(1/3) is again uniform. Several states can therefore lie on one ray.

use crate::commands::input_file;
use crate::commands::inspect::scene_args::Inspected;
use crate::commands::surrogate::errors::StateErrors;
use crate::replays::kept_solves::{Outcome, SolveArgs};
use crate::replays::routes::{hinge_routes, judging_tier, window};
use crate::ui::run_folder;
use anyhow::{Context, Result, ensure};
use clap::Args;
use dataset::{Database, Gates, Row, SplitPlan};
use fe_driver::{DeformationPath, KeptSolve, ToolVersions, Tools};
use hinge::{HingeDeformation, HingeDesign, HingeSample, SheetMaterial, TrainingDomain};
use mesher::Tier;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::PathBuf;
use surrogate::Surrogate;

/// Minimum number of rays of a database, which is split in three parts.
const MIN_RAYS: usize = 3;

/// Measure the errors of weights at states drawn uniformly inside their training domain
///
/// The states lie on no training ray. Solves them by finite elements and writes them as a database, which
/// must not be used for training, so that `surrogate test` can test other weights on it. Prints the
/// distribution of the errors and the worst states. With --scene the states are those of the hinges of a design
/// along their paths instead. Example:
/// kirigami surrogate spot-check runs/weights/surrogate.safetensors --count 40 --tier default
#[derive(Args)]
pub struct SpotCheckCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// Number of states
    #[arg(long, value_name = "N", default_value_t = 200)]
    count: usize,
    /// States per ray: more states per ray need fewer solves but cover fewer hinges
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=100))]
    states_per_ray: u16,
    /// Seed of the random states
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// Sheet material that the weights were trained on (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/materials/pet-0.5mm.toml"
    )]
    material: PathBuf,
    /// Mesh tier of the windows [default: that of the weights' database, or the finer tier that the
    /// database was corrected to]
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    #[command(flatten)]
    paths: PathArgs,
    /// Folder for the database and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/spot-check")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// The hinges of a design.
#[derive(Args)]
struct PathArgs {
    /// Use the hinges of this scene (TOML) along their paths instead, with at least COUNT of their states
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Design of the scene (JSON): the state.json of a run [default: the start design of the scene]
    #[arg(long, value_name = "FILE", requires = "scene")]
    design: Option<PathBuf>,
}

/// One window to solve, and the fractions of its path at which the weights are evaluated.
struct Probe {
    design: HingeDesign,
    path: DeformationPath,
    fractions: Vec<f64>,
}

impl SpotCheckCommand {
    pub fn run(&self) -> Result<()> {
        ensure!(self.count > 0, "--count must be at least 1");
        let surrogate = Surrogate::load(&self.weights)?;
        input_file::require(&self.material, "--material")?;
        let material = SheetMaterial::load(&self.material)?;
        let card = surrogate.card();
        ensure!(
            card.material_hash
                .as_ref()
                .is_none_or(|hash| *hash == material.law_hash()),
            "{} were trained on {}, but {} is another material law: pass the right file with --material",
            self.weights.display(),
            card.material,
            self.material.display()
        );
        let tier = judging_tier(self.tier, &surrogate)?;
        let probes = match &self.paths.scene {
            Some(_) => self.on_paths()?,
            None => self.drawn(&surrogate),
        };
        ensure!(
            probes.len() >= MIN_RAYS,
            "{} rays are too few for a database: increase --count or decrease --states-per-ray",
            probes.len()
        );
        let _held = run_folder::hold(&self.out)?;
        let solves: Vec<KeptSolve> = probes
            .iter()
            .map(|probe| window(probe.design, probe.path.clone(), &material, tier))
            .collect();
        let outcomes = self
            .solve
            .solve(&solves.iter().collect::<Vec<_>>(), &self.out)?;
        let tools = ToolVersions::of(&Tools::find()?);
        let mut rows = Vec::new();
        let mut failed = 0;
        for (ray, (probe, outcome)) in probes.iter().zip(&outcomes).enumerate() {
            let found = probe.rows(outcome, ray, &material, tier, &tools);
            failed += probe.fractions.len() - found.len();
            rows.extend(found);
        }
        ensure!(
            !rows.is_empty(),
            "no state was solved; see {}",
            self.out.display()
        );
        let database = Database::collect(rows, &Gates::default(), &SplitPlan::default())?;
        let path = self.out.join("spot-check.parquet");
        database.write(&path, true)?;
        println!(
            "{} states of {} rays on tier {tier}; {failed} states not reached by the solver",
            database.rows().len(),
            probes.len()
        );
        println!("{}", StateErrors::new(&surrogate, database.rows()));
        println!("written to {}", path.display());
        Ok(())
    }

    fn drawn(&self, surrogate: &Surrogate) -> Vec<Probe> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let each = usize::from(self.states_per_ray);
        let mut probes = Vec::new();
        let mut left = self.count;
        while left > 0 {
            let states = each.min(left);
            let hinge = &surrogate.card().hinge;
            probes.push(draw(surrogate.domain(), hinge, states, &mut random));
            left -= states;
        }
        probes
    }

    fn on_paths(&self) -> Result<Vec<Probe>> {
        let PathArgs { scene, design } = &self.paths;
        let scene = scene.clone().context("no scene")?;
        let (scene, design) = Inspected::new(scene, design.clone()).read()?;
        let routes = hinge_routes(&scene, &design)?;
        let states = routes.first().map_or(1, |route| route.states.len());
        let wanted = self.count.div_ceil(states).max(MIN_RAYS).min(routes.len());
        (0..wanted)
            .map(|i| {
                let route = routes[i * routes.len() / wanted].scaled(scene.scale().recip());
                let path = DeformationPath::through(&route.states)
                    .with_context(|| format!("hinge {} has no states", route.hinge))?;
                let count = route.states.len();
                Ok(Probe {
                    design: route.design,
                    path,
                    fractions: (1..=count).map(|k| k as f64 / count as f64).collect(),
                })
            })
            .collect()
    }
}

/// A random ray inside the training domain with `states` uniformly distributed states on it.
fn draw(
    domain: &TrainingDomain,
    constants: &hinge::HingeConstants,
    states: usize,
    random: &mut ChaCha8Rng,
) -> Probe {
    let mut between = |[from, to]: [f64; 2]| from + (to - from) * random.random::<f64>();
    let design = constants.hinge(
        between(domain.w_lig.map(f64::ln)).exp(),
        between(domain.alpha),
    );
    let bounds = domain.bounds();
    let direction = loop {
        let [eta_a, eta_s, theta] = bounds.map(&mut between);
        let state = HingeDeformation::from_eta(eta_a, eta_s, theta, design.w_lig);
        if domain.contains(&design, &state) {
            break state;
        }
    };
    let edge = edge(domain, &design, &direction);
    let mut radii: Vec<f64> = (0..states).map(|_| between([0.0, 1.0]).cbrt()).collect();
    radii.sort_by(f64::total_cmp);
    let outermost = radii[states - 1];
    Probe {
        design,
        path: DeformationPath::straight(direction.at(edge * outermost)),
        fractions: radii.iter().map(|radius| radius / outermost).collect(),
    }
}

/// The largest factor by which a state can be scaled without leaving the domain.
fn edge(domain: &TrainingDomain, design: &HingeDesign, state: &HingeDeformation) -> f64 {
    let inside = |factor: f64| domain.contains(design, &state.at(factor));
    let mut outside = 2.0;
    while inside(outside) {
        outside *= 2.0;
    }
    let mut edge = 0.5 * outside;
    for _ in 0..40 {
        let middle = 0.5 * (edge + outside);
        *(if inside(middle) {
            &mut edge
        } else {
            &mut outside
        }) = middle;
    }
    edge
}

impl Probe {
    /// The states that the solver reached.
    fn rows(
        &self,
        outcome: &Outcome,
        ray: usize,
        material: &SheetMaterial,
        tier: Tier,
        tools: &ToolVersions,
    ) -> Vec<Row> {
        let Ok(solution) = outcome else {
            return Vec::new();
        };
        let reached = |fraction: &f64| HingeSample::at(&solution.samples, *fraction);
        let samples = self.fractions.iter().filter_map(reached);
        samples
            .map(|sample| Row {
                job: format!("spot-{ray:04}"),
                design: self.design,
                sample,
                failure: String::new(),
                material: material.name.clone(),
                material_hash: material.law_hash(),
                settings_hash: String::new(),
                tier: tier.to_string(),
                solved_tier: tier.to_string(),
                gmsh: tools.gmsh.clone(),
                ccx: tools.ccx.clone(),
                cpu_s: solution.cpu_seconds.unwrap_or(0.0),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeConstants;

    #[test]
    fn states_are_uniform_inside_the_domain() {
        let state = [[-0.8, 0.2], [-0.4, 0.4], [-0.1, 1.3]];
        let domain = TrainingDomain::of_box(state, [5.0, 25.0], [0.8, 2.3]);
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut counts = [0; 4];
        let mut all = 0;
        for _ in 0..500 {
            let probe = draw(&domain, &HingeConstants::PAPER, 4, &mut random);
            assert_eq!(probe.fractions.last(), Some(&1.0));
            for fraction in &probe.fractions {
                let state = probe.path.at(*fraction);
                assert!(domain.contains(&probe.design, &state));
                let [eta_a, eta_s] = state.eta(probe.design.w_lig);
                // Counts in halves of the domain.
                counts[0] += usize::from(eta_a > -0.3);
                counts[1] += usize::from(eta_s > 0.0);
                counts[2] += usize::from(state.theta > 0.6);
                counts[3] += usize::from(probe.design.w_lig > 125f64.sqrt());
                all += 1;
            }
        }
        for count in counts {
            let fraction = f64::from(u32::try_from(count).unwrap()) / f64::from(all);
            // Four standard deviations of 500 independent rays.
            assert!((fraction - 0.5).abs() < 0.09, "{fraction}");
        }
    }
}
