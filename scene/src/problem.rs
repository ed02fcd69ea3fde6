//! From a scene to its design problem and its start design.

use crate::{
    checked_scene::Scene, keys::SceneConfig, loaded_hinge::HingeBehaviour,
    sheet_config::StartConfig,
};
use design::{
    equilibrium::solver::EquilibriumSolver,
    objective::{
        design_problem::{DesignProblem, Mechanics, Model},
        loss::Objective,
        terms::TermContext,
    },
    pattern::{
        design_vector::{DesignVector, WidthChart},
        grid::Grid,
    },
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use support::{Fault, at};

impl Scene {
    /// Numbers of panels.
    pub fn grid(&self) -> Grid {
        self.config.sheet.grid()
    }

    /// The design problem: everything that is constant during the design.
    pub fn problem(&self) -> Result<DesignProblem, Fault> {
        let model = self.model()?;
        Ok(DesignProblem {
            topology: self.topology.clone(),
            outline: self.config.sheet.outline(),
            widths: self.width_chart(),
            options: self.sheet_options(),
            objective: self.objective(&model),
            model,
        })
    }

    /// The keys of the scene whose search starts at a design.
    pub fn starting_at(&self, design: &DesignVector) -> SceneConfig {
        let widths = self.width_chart();
        // Further out a width rounds to its bound, and a start lies between the bounds.
        let w_lig = (design.omega.iter()).map(|omega| widths.width(omega.clamp(-20.0, 20.0)));
        let mut config = self.config.clone();
        config.start = StartConfig::at(&design.pattern, w_lig.collect());
        config.optimiser.start_noise = 0.0;
        if let (Some(opening), Some(pin)) = (design.opening, &mut config.pin) {
            pin.opening_deg = opening.to_degrees();
        }
        config
    }

    fn width_chart(&self) -> WidthChart {
        let [w_minus, w_plus] = self.config.ligament.range;
        WidthChart { w_minus, w_plus }
    }

    /// The start design, with the seeded noise of the scene.
    pub fn start(&self) -> DesignVector {
        let (start, grid, widths) = (&self.config.start, self.grid(), self.width_chart());
        let uniform = vec![self.config.ligament.start; self.topology.hinge_count()];
        let w_lig = start.w_lig.as_ref().unwrap_or(&uniform);
        let mut design = DesignVector {
            pattern: start.pattern(grid).expect("the scene has been checked"),
            omega: w_lig.iter().map(|w| widths.omega(*w)).collect(),
            opening: self.hinge.free_opening(),
        };
        let optimiser = &self.config.optimiser;
        let mut random = ChaCha8Rng::seed_from_u64(optimiser.seed);
        let pattern = &mut design.pattern;
        let coordinates = pattern.z.iter_mut().chain(pattern.ell.iter_mut().flatten());
        for coordinate in coordinates.chain(&mut design.omega) {
            // Uniformly distributed numbers with the required standard deviation.
            let half_width = 3f64.sqrt() * optimiser.start_noise;
            *coordinate += half_width * random.random_range(-1.0..1.0);
        }
        design
    }

    fn objective(&self, model: &Model) -> Objective {
        self.config.objective.objective(&TermContext {
            target: &self.target.points,
            law: model.mechanics().map(|mechanics| &*mechanics.law),
            mean_panel_area: self.config.sheet.mean_panel_area(),
            r_win: self.config.process.r_win,
            attachments: self.actuation().attachments,
        })
    }

    fn model(&self) -> Result<Model, Fault> {
        let (law, contact) = match &self.hinge.behaviour {
            HingeBehaviour::Pinned { opening, .. } => {
                return Ok(Model::Ideal { opening: *opening });
            }
            HingeBehaviour::Elastic { law, contact } => (law.clone(), *contact),
        };
        let solver = self.solver().map_err(at(self.path.display()))?;
        Ok(Model::Equilibrium(Box::new(Mechanics { law, contact: Some(contact), solver })))
    }

    fn solver(&self) -> Result<EquilibriumSolver, Fault> {
        let level = self.config.level;
        let settings = level.solver(self.config.solver);
        let actuation = self.actuation();
        let (supports, loads) = (actuation.boundary_supports(), actuation.boundary_loads());
        let steps = level.load_steps(self.config.load_steps);
        let solver =
            EquilibriumSolver::new(self.topology.clone(), &supports, &loads, steps, settings)?;
        let solver =
            solver.attached_at(actuation.attachments).with_weight(self.weight_by_area())?;
        match self.config.drive {
            Some(drive) => solver.driven(drive.stroke),
            None => Ok(solver),
        }
    }
}
