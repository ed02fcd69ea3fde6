//! What moves a sheet along its path, how far, and against which load.
//!
//! ```text
//! displacement  c . q,    c = f / F      load  zeta F                 moved by loads f of total magnitude F
//! displacement  zeta D                   load  R . U / D              moved by supports, by U of total magnitude D
//! ```
//!
//! In both cases the area below the curve is the work done on the sheet; for one force it is the displacement of
//! its panel along the force. F and D are sums of the magnitudes of forces or translations, or, if there are none, of
//! couples or rotations.

use crate::equilibrium::load_step::LoadStep;
use crate::equilibrium::solver::EquilibriumSolver;
use crate::hinge_law::Order;
use crate::objective::design_problem::{Deployment, Mechanics};
use crate::sheet::cut_sheet::Sheet;
use crate::sheet::kinematics::HingeMotion;
use crate::sheet::panel_vectors::add_at_hinge;

/// What moves the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mover {
    /// Dead loads, or their prescribed stroke.
    Loads,
    /// Supports with a prescribed motion.
    Supports,
}

/// Load against displacement along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuationCurve {
    /// What moves the sheet.
    pub mover: Mover,
    /// Whether forces or translations move it; otherwise displacements are angles and loads are couples.
    pub translational: bool,
    /// (displacement, load) of the flat sheet and of every load step: mm and N, or rad and N mm.
    pub points: Vec<[f64; 2]>,
}

impl ActuationCurve {
    /// The curve of a deployment by `mechanics`; `None` if nothing moves the sheet.
    pub fn new(mechanics: &Mechanics, deployment: &Deployment) -> Option<Self> {
        let solver = &mechanics.solver;
        let (mover, direction) = match magnitude(&solver.loads) {
            Some(_) => (Mover::Loads, solver.loads.to_vec()),
            None => (Mover::Supports, prescribed(solver)),
        };
        let (size, translational) = magnitude(&direction)?;
        let point = |step: &LoadStep| {
            let zeta = step.load_factor;
            match mover {
                Mover::Loads => [work(&direction, &step.configuration) / size, zeta * size],
                Mover::Supports => {
                    let forces = holding_forces(mechanics, &deployment.sheet, step);
                    [zeta * size, work(&direction, &forces) / size]
                }
            }
        };
        let flat = std::iter::once([0.0; 2]);
        Some(Self {
            mover,
            translational,
            points: flat.chain(deployment.path.iter().map(point)).collect(),
        })
    }

    /// Units of displacement and load.
    pub fn units(&self) -> [&'static str; 2] {
        match self.translational {
            true => ["mm", "N"],
            false => ["rad", "N mm"],
        }
    }
}

/// The forces and couples (F_x, F_y, M) on every panel that hold the sheet in a state: the loads on free degrees of
/// freedom, the reactions at supported ones (N, N mm).
pub fn holding_forces(mechanics: &Mechanics, sheet: &Sheet, step: &LoadStep) -> Vec<[f64; 3]> {
    let law = mechanics.law.prepare(&sheet.designs());
    let hinged = mechanics.hinged(sheet, &*law, false);
    let energies = hinged.energies(&step.deformations, Order::Forces);
    let mut forces = vec![[0.0; 3]; sheet.panels.len()];
    for (h, (hinge, energy)) in std::iter::zip(&sheet.hinges, energies).enumerate() {
        let motion = HingeMotion::new(sheet, h, &step.configuration);
        add_at_hinge(&mut forces, hinge, motion.forces(energy.forces));
    }
    forces
}

/// The motions (u_x, u_y, phi) of the panels that the supports prescribe at full load.
fn prescribed(solver: &EquilibriumSolver) -> Vec<[f64; 3]> {
    let mut motions = vec![[0.0; 3]; solver.loads.len()];
    for support in &solver.supports {
        motions[support.panel][support.dof.index()] = support.value;
    }
    motions
}

/// The sum of the magnitudes of the translational components, or of the rotational ones if the former are zero, and
/// whether it is the former; `None` if all are zero.
fn magnitude(by_panel: &[[f64; 3]]) -> Option<(f64, bool)> {
    let along: f64 = by_panel.iter().map(|[x, y, _]| x.hypot(*y)).sum();
    let about: f64 = by_panel.iter().map(|[_, _, m]| m.abs()).sum();
    match (along > 0.0, about > 0.0) {
        (true, _) => Some((along, true)),
        (false, true) => Some((about, false)),
        (false, false) => None,
    }
}

fn work(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    std::iter::zip(a.as_flattened(), b.as_flattened())
        .map(|(a, b)| a * b)
        .sum()
}
