//! The shapes of a sheet from flat to full load, interpolated between load steps.
//!
//! The motions (u, phi) of the panels are linear in the position on the path between two load steps.

use design::equilibrium::load_step::Status;
use design::objective::design_problem::{Deployment, DesignProblem, Model};
use design::sheet::cut_sheet::Sheet;
use design::sheet::ideal_deployment::ideal_deployment;
use design::sheet::kinematics::Configuration;

/// Number of states of an ideal deployment, whose path has no load steps.
const IDEAL_STATES: u32 = 40;

/// One state of a sheet on its path.
#[derive(Debug)]
pub struct PathShape {
    /// zeta; for an ideal deployment the fraction of the opening angle.
    pub load_factor: f64,
    /// The motion of every panel.
    pub configuration: Configuration,
}

/// A sheet and its shapes, the flat one first.
#[derive(Debug)]
pub struct ShapePath<'a> {
    /// The flat sheet.
    pub sheet: &'a Sheet,
    /// The shapes in the order of the path.
    pub shapes: Vec<PathShape>,
}

impl<'a> ShapePath<'a> {
    /// The flat sheet and the load steps of a deployment that converged; for an ideal deployment,
    /// equal steps of the opening angle.
    pub fn new(problem: &DesignProblem, deployment: &'a Deployment) -> Self {
        let sheet = &deployment.sheet;
        let mut path = Self::flat(sheet);
        match problem.model {
            Model::Ideal { .. } => {
                let theta = deployment.final_step().deformations.first();
                let theta = theta.map_or(0.0, |deformation| deformation.theta);
                path.shapes.extend((1..=IDEAL_STATES).map(|i| {
                    let load_factor = f64::from(i) / f64::from(IDEAL_STATES);
                    let configuration = ideal_deployment(sheet, load_factor * theta);
                    PathShape { load_factor, configuration }
                }));
            }
            Model::Equilibrium(_) => {
                let steps = deployment.path.iter();
                let reached = steps.filter(|step| step.status != Status::Diverged);
                path.shapes.extend(reached.map(|step| PathShape {
                    load_factor: step.load_factor,
                    configuration: step.configuration.clone(),
                }));
            }
        }
        path
    }

    /// Only the flat sheet.
    pub fn flat(sheet: &'a Sheet) -> Self {
        let flat =
            PathShape { load_factor: 0.0, configuration: vec![[0.0; 3]; sheet.panels.len()] };
        Self { sheet, shapes: vec![flat] }
    }

    /// The position of the last shape; the flat sheet is at 0.
    pub fn end(&self) -> f64 {
        (self.shapes.len() - 1) as f64
    }

    /// The shape at a position between 0 and [`end`](Self::end).
    pub fn at(&self, position: f64) -> PathShape {
        let before = (position as usize).min(self.shapes.len() - 1);
        let after = (before + 1).min(self.shapes.len() - 1);
        let (from, to) = (&self.shapes[before], &self.shapes[after]);
        let fraction = position - before as f64;
        let between = |a: f64, b: f64| a + fraction * (b - a);
        let motions = std::iter::zip(&from.configuration, &to.configuration);
        PathShape {
            load_factor: between(from.load_factor, to.load_factor),
            configuration: motions
                .map(|(a, b)| std::array::from_fn(|d| between(a[d], b[d])))
                .collect(),
        }
    }
}
