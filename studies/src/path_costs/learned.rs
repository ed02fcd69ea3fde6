//! The scenes with learned hinges.

use crate::path_costs::{effort, jumps, timed};
use anyhow::Result;
use design::equilibrium::nearby_path::KnownPath;
use design::hinge_law::{DamageMeasure, HingeDamage, HingeEnergy, HingeLaw, Order, PreparedLaw};
use design::objective::design_problem::{DesignProblem, Model};
use design::pattern::design_vector::DesignVector;
use design::scene::{Scene, SceneConfig};
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use support::table::{Cell, Table};

/// The scenes, their designs and the standard deviation of their coordinates.
pub const SCENES: [&str; 4] = ["pet-3x3", "a4-polyester", "pet-7x7", "pet-bell-16x22"];
const SEEDS: [u64; 3] = [1, 2, 3];
const NOISE: f64 = 0.5;
/// Maximum change of a coordinate to the design near it.
const NEAR: f64 = 0.02;

/// A hinge law that counts the evaluations of all hinges, by their order.
struct Counted {
    law: Arc<dyn HingeLaw>,
    counts: Arc<[AtomicUsize; 4]>,
}

struct CountedHinges<'a> {
    law: Box<dyn PreparedLaw + 'a>,
    counts: &'a [AtomicUsize; 4],
}

impl HingeLaw for Counted {
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        let (law, counts) = (self.law.prepare(designs), &*self.counts);
        Box::new(CountedHinges { law, counts })
    }

    fn damage_scale(&self, measure: DamageMeasure) -> Option<f64> {
        self.law.damage_scale(measure)
    }

    fn domain(&self) -> Option<&TrainingDomain> {
        self.law.domain()
    }
}

impl PreparedLaw for CountedHinges<'_> {
    fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy> {
        self.counts[order as usize].fetch_add(1, Relaxed);
        self.law.energies(deformations, order)
    }

    fn damage(&self, deformations: &[HingeDeformation], with_gradient: bool) -> Vec<HingeDamage> {
        self.law.damage(deformations, with_gradient)
    }

    fn resolution(&self) -> f64 {
        self.law.resolution()
    }

    fn inside(&self, deformations: &[HingeDeformation]) -> Vec<bool> {
        self.law.inside(deformations)
    }
}

/// What is counted along a path.
const COUNTS: [&str; 8] = [
    "corrections",
    "factorisations",
    "increments",
    "rejected",
    "jumps",
    "forces",
    "tangents",
    "design gradients",
];

/// One row of the table.
pub struct Row {
    name: String,
    pub panels: usize,
    seed: u64,
    /// Whether the design is the one near the random design.
    pub near: bool,
    followed: bool,
    steps: usize,
    /// [`COUNTS`]
    counts: [usize; COUNTS.len()],
    /// CPU time of path and gradient (s).
    pub seconds: f64,
    loss: f64,
}

/// The rows of a scene, three for each random design: the design, and one near it whose path is followed and corrected from that of
/// the first.
pub fn measured(name: &str) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for seed in SEEDS {
        let (problem, counts, start) = problem(name, seed)?;
        let mut row =
            |near: bool, design: &DesignVector, known: Option<&KnownPath>| -> Result<KnownPath> {
                counts.iter().for_each(|count| count.store(0, Relaxed));
                let (evaluation, seconds) = timed(1, || Ok(problem.evaluate_near(design, known)?))?;
                let path = &evaluation.deployment.path;
                let effort = effort(path);
                let [_, forces, tangents, designs] = &*counts;
                let [forces, tangents, designs] =
                    [forces, tangents, designs].map(|count| count.load(Relaxed));
                rows.push(Row {
                    name: name.to_owned(),
                    panels: problem.grid.panel_count(),
                    seed,
                    near,
                    followed: evaluation.deployment.followed,
                    steps: path.len(),
                    counts: [
                        effort.iterations,
                        effort.factorisations,
                        effort.increments,
                        effort.rejected,
                        jumps(path),
                        forces,
                        tangents,
                        designs,
                    ],
                    seconds,
                    loss: evaluation.loss,
                });
                Ok(evaluation.deployment.known_path())
            };
        let known = row(false, &start, None)?;
        let beside: Vec<f64> = std::iter::zip(start.to_flat(), 0..)
            .map(|(coordinate, i)| coordinate + NEAR * f64::from(i).sin())
            .collect();
        let near = start.with_flat(&beside);
        row(true, &near, None)?;
        row(true, &near, Some(&known))?;
    }
    Ok(rows)
}

/// The problem of a scene, with the counts of the evaluations of all its hinges, and a random design.
fn problem(name: &str, seed: u64) -> Result<(DesignProblem, Arc<[AtomicUsize; 4]>, DesignVector)> {
    let path = Path::new("configs/scenes")
        .join(name)
        .with_extension("toml");
    let mut config: SceneConfig = support::toml_file::read(&path)?;
    config.optimiser.seed = seed;
    config.optimiser.start_noise = NOISE;
    let scene = Scene::new(config, &path)?;
    let mut problem = scene.problem()?;
    let counts = Arc::new([0; 4].map(AtomicUsize::new));
    if let Model::Equilibrium(mechanics) = &mut problem.model {
        mechanics.law = Arc::new(Counted {
            law: mechanics.law.clone(),
            counts: counts.clone(),
        });
    }
    Ok((problem, counts, scene.start()))
}

pub fn table(rows: &[Row]) -> String {
    let mut table = Table::new()
        .column("scene", |row: &Row| Cell::text(&row.name))
        .column("design", |row| {
            let near = if row.near { ", near" } else { "" };
            Cell::text(format!("{}{near}", row.seed))
        })
        .column("path", |row| {
            Cell::text(if row.followed {
                "followed"
            } else {
                "corrected"
            })
        })
        .column("load steps", |row| Cell::text(row.steps));
    for (k, count) in COUNTS.into_iter().enumerate() {
        table = table.column(count, move |row| Cell::text(row.counts[k]));
    }
    table
        .column("CPU s", |row| Cell::fixed(row.seconds, 4))
        .column("loss, mm^2", |row| Cell::scientific(row.loss, 10))
        .markdown(rows)
}
