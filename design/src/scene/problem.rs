//! From a scene to the design problem it poses and the design its search starts from.

use super::hinge_model::LoadedHinge;
use super::{Scene, SceneError};
use crate::actuation::{Dof, Load, Support};
use crate::chamfer::Chamfer;
use crate::design_vector::{DesignVector, WidthChart};
use crate::equilibrium::{EquilibriumSolver, SolverSettings};
use crate::gradient::{DesignProblem, Mechanics, Model};
use crate::grid::Grid;
use crate::hinge_law::{HingeLaw, SurrogateLaw};
use crate::objective::Objective;
use crate::path_functionals::PerFunctional;
use crate::pattern::Outline;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Temperatures of the path extrema, a tenth of the D / D_s, eta_a and eta_s that matter.
const TEMPERATURES: PerFunctional = PerFunctional {
    damage: 0.1,
    compression: 0.01,
    shear: 0.01,
};

impl Scene {
    pub fn grid(&self) -> Grid {
        self.config.sheet.grid()
    }

    /// Everything that is fixed before the design begins.
    pub fn problem(&self) -> Result<DesignProblem, SceneError> {
        let [width, height] = self.config.sheet.size;
        let [w_minus, w_plus] = self.config.ligament.range;
        Ok(DesignProblem {
            grid: self.grid(),
            outline: Outline::rectangle(width, height),
            widths: WidthChart { w_minus, w_plus },
            options: self.sheet_options(),
            model: self.model()?,
            objective: self.objective(),
        })
    }

    /// The uniform sheet at the starting width, with the seeded noise that the scene asks for.
    pub fn start(&self) -> DesignVector {
        let mut design = DesignVector::uniform(self.grid());
        let [w_minus, w_plus] = self.config.ligament.range;
        let share = (self.config.ligament.start - w_minus) / (w_plus - w_minus);
        design.omega.fill((share / (1.0 - share)).ln());
        if let LoadedHinge::Pin { opening } = self.hinge {
            design.opening = Some(opening);
        }
        let optimiser = &self.config.optimiser;
        let mut random = ChaCha8Rng::seed_from_u64(optimiser.seed);
        let pattern = &mut design.pattern;
        let coordinates = pattern.z.iter_mut().chain(pattern.ell.iter_mut().flatten());
        for coordinate in coordinates.chain(&mut design.omega) {
            // Uniform numbers of the standard deviation asked for.
            let half_width = 3f64.sqrt() * optimiser.start_noise;
            *coordinate += half_width * random.random_range(-1.0..1.0);
        }
        design
    }

    /// Area of the sheet over its panels (mm^2): what the weights of the objective are relative to.
    pub fn mean_panel_area(&self) -> f64 {
        let [width, height] = self.config.sheet.size;
        width * height / self.grid().panel_count() as f64
    }

    fn objective(&self) -> Objective {
        let (config, area) = (&self.config.objective, self.mean_panel_area());
        let ideal = matches!(self.hinge, LoadedHinge::Pin { .. });
        let centre = if ideal { self.target.mean() } else { [0.0; 2] };
        Objective {
            target: self
                .target
                .points()
                .iter()
                .map(|[x, y]| [x - centre[0], y - centre[1]])
                .collect(),
            chamfer: Chamfer {
                coverage_weight: config.coverage,
                smoothing: 0.0,
            },
            outline: config.outline,
            // A sheet on pins is held nowhere.
            centred: ideal,
            weights: PerFunctional {
                damage: config.damage * area,
                compression: config.compression * area,
                shear: config.shear * area,
            },
            temperatures: TEMPERATURES,
        }
    }

    fn model(&self) -> Result<Model, SceneError> {
        let (law, contact): (Box<dyn HingeLaw>, _) = match &self.hinge {
            LoadedHinge::Pin { opening } => return Ok(Model::Ideal { opening: *opening }),
            LoadedHinge::Linear { law, contact } => (Box::new(law.clone()), Some(*contact)),
            LoadedHinge::Surrogate(surrogate) => {
                (Box::new(SurrogateLaw::new((**surrogate).clone())), None)
            }
        };
        let solver = EquilibriumSolver::new(
            self.grid(),
            &self.supports(),
            &self.loads(),
            self.config.load_steps,
            SolverSettings::default(),
        )
        .map_err(|error| SceneError::Value {
            path: self.path.clone(),
            reason: error.to_string(),
        })?;
        Ok(Model::Equilibrium(Mechanics {
            law,
            contact,
            solver,
        }))
    }

    fn supports(&self) -> Vec<Support> {
        let mut supports = Vec::new();
        for support in &self.config.supports {
            let panel = self.panel(support.panel);
            for (dof, held) in Dof::ALL.into_iter().zip(support.kind.holds()) {
                if held {
                    let value = 0.0;
                    supports.push(Support { panel, dof, value });
                }
            }
        }
        supports
    }

    fn loads(&self) -> Vec<Load> {
        let mut loads = Vec::new();
        for load in &self.config.loads {
            let panel = self.panel(load.panel);
            let values = [load.force[0], load.force[1], load.couple];
            for (dof, value) in Dof::ALL.into_iter().zip(values) {
                if value != 0.0 {
                    loads.push(Load { panel, dof, value });
                }
            }
        }
        loads
    }

    fn panel(&self, [column, row]: [usize; 2]) -> usize {
        self.grid().panel(column, row)
    }
}
