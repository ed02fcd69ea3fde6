//! The equilibrium problem of the sheet under dead loads (10), along the load factors zeta_i = i/N:
//!
//! ```text
//! min over q of  Pi(q) = sum_h W(eps_h(q); g_h) - zeta sum_k (F_k . u_k + M_k phi_k)
//! ```
//!
//! and, of a path that follows another, less the work of the loads that are held.

use crate::actuation::{Dof, Load, Support};
use crate::grid::Grid;
use crate::hinge_law::{Contact, HingeEnergy, Order, PreparedLaw};
use crate::panel_vectors::gather;
use crate::sheet::Sheet;
use crate::stroke::Stroke;
use crate::tangent::{TangentPattern, elimination_order};
use hinge::HingeDeformation;
use serde::{Deserialize, Serialize};

pub use crate::load_step::{LoadStep, Status};

/// Supports, loads or settings that pose no equilibrium problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EquilibriumError {
    #[error("{what} on panel {panel}: the sheet has the panels 0..{panels}")]
    NoSuchPanel {
        what: &'static str,
        panel: usize,
        panels: usize,
    },
    #[error("{what} of {value} on panel {panel} is not a finite number")]
    NotFinite {
        what: &'static str,
        panel: usize,
        value: f64,
    },
    #[error("{dof:?} of panel {panel} is supported twice")]
    SupportedTwice { panel: usize, dof: Dof },
    #[error("panel {panel} is loaded in {dof:?}, where it is supported: loads act on free panels")]
    LoadOnSupport { panel: usize, dof: Dof },
    #[error(
        "the supports leave the sheet free to move as a rigid body: hold it by at least three \
         degrees of freedom, such as one clamp or a pin and a roller"
    )]
    Unsupported,
    #[error("a stroke of {0} mm is not a finite number")]
    Stroke(f64),
    #[error("a driven sheet needs a load: its stroke is the way of the loads")]
    NothingDrives,
    #[error("{0} load steps: use at least 1")]
    NoSteps(usize),
    #[error(
        "solver settings {0:?} violate 0 < tolerance <= loose_tolerance < 1, max_iterations >= 1, \
         max_halvings <= 30, least_leap > 0"
    )]
    Settings(SolverSettings),
}

/// How equilibria are sought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Method {
    /// Newton's method on the sparse tangent.
    #[default]
    Newton,
    /// Limited-memory BFGS, as the paper, with so many iterations per load increment.
    Lbfgs { max_iterations: usize },
}

/// How hard to try.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverSettings {
    pub method: Method,
    /// Residual of a converged state, relative to the greatest force, where rounding leaves no more.
    pub tolerance: f64,
    /// Residual of an almost converged state.
    pub loose_tolerance: f64,
    /// Newton iterations per load increment.
    pub max_iterations: usize,
    /// How often a load step is halved.
    pub max_halvings: u32,
    /// Least rotation (rad) that the tangents at both ends of an increment do not explain which is
    /// looked into, as it may be a jump past a limit point.
    pub least_leap: f64,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            tolerance: 1e-10,
            loose_tolerance: 1e-6,
            max_iterations: 60,
            max_halvings: 6,
            least_leap: 1e-3,
        }
    }
}

impl SolverSettings {
    fn are_valid(&self) -> bool {
        self.tolerance > 0.0
            && self.tolerance <= self.loose_tolerance
            && self.loose_tolerance < 1.0
            && self.max_iterations >= 1
            && self.max_halvings <= 30
            && self.least_leap > 0.0
    }
}

/// The sheet with the energy of its hinges.
#[derive(Clone, Copy)]
pub struct HingedSheet<'a> {
    pub sheet: &'a Sheet,
    pub law: &'a dyn PreparedLaw,
    pub contact: Option<&'a Contact>,
}

impl HingedSheet<'_> {
    /// Energies of law and contact together.
    pub fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy> {
        let mut energies = self.law.energies(deformations, order);
        if let Some(contact) = self.contact {
            contact.add(&mut energies, deformations);
        }
        energies
    }
}

/// Supports and loads of a sheet, with what depends on its topology alone.
#[derive(Debug)]
pub struct EquilibriumSolver {
    pub(crate) grid: Grid,
    pub(crate) settings: SolverSettings,
    pub(crate) steps: usize,
    /// Numbers of the free degrees of freedom, three entries a panel.
    pub(crate) free: Box<[Option<usize>]>,
    /// Prescribed motions at full load.
    pub(crate) supports: Box<[Support]>,
    /// (F_x, F_y, M) per panel at full load.
    pub(crate) loads: Box<[[f64; 3]]>,
    /// Those that act in full from the beginning of the path.
    pub(crate) held: Box<[[f64; 3]]>,
    /// Of a driven sheet, the direction of the stroke and its full length.
    pub(crate) drive: Option<(Box<Stroke>, f64)>,
    /// Boxed: large beside the rest.
    pub(crate) pattern: Box<TangentPattern>,
}

impl EquilibriumSolver {
    /// Equilibria at the load factors i/steps, i = 1..=steps.
    pub fn new(
        grid: Grid,
        supports: &[Support],
        loads: &[Load],
        steps: usize,
        settings: SolverSettings,
    ) -> Result<Self, EquilibriumError> {
        if steps == 0 {
            return Err(EquilibriumError::NoSteps(steps));
        }
        if !settings.are_valid() {
            return Err(EquilibriumError::Settings(settings));
        }
        let check = |what, panel, value: f64| {
            let panels = grid.panel_count();
            if panel >= panels {
                return Err(EquilibriumError::NoSuchPanel {
                    what,
                    panel,
                    panels,
                });
            }
            if !value.is_finite() {
                return Err(EquilibriumError::NotFinite { what, panel, value });
            }
            Ok(())
        };
        let mut supported = vec![[false; 3]; grid.panel_count()];
        for &Support { panel, dof, value } in supports {
            check("a support", panel, value)?;
            if std::mem::replace(&mut supported[panel][dof.index()], true) {
                return Err(EquilibriumError::SupportedTwice { panel, dof });
            }
        }
        let mut total = vec![[0.0; 3]; grid.panel_count()];
        for &Load { panel, dof, value } in loads {
            check("a load", panel, value)?;
            if supported[panel][dof.index()] {
                return Err(EquilibriumError::LoadOnSupport { panel, dof });
            }
            total[panel][dof.index()] += value;
        }
        if !holds_rigid_body(grid, supports) {
            return Err(EquilibriumError::Unsupported);
        }
        let free = elimination_order(grid, supported.as_flattened());
        Ok(Self {
            grid,
            settings,
            steps,
            pattern: Box::new(TangentPattern::new(grid, &free)),
            free: free.into(),
            supports: supports.into(),
            held: vec![[0.0; 3]; total.len()].into(),
            loads: total.into(),
            drive: None,
        })
    }

    /// The same supports and loads, driven: the load factors follow from the strokes i/steps of
    /// `stroke` (mm), the work of the full loads over the sum of their forces.
    pub fn driven(mut self, stroke: f64) -> Result<Self, EquilibriumError> {
        if !stroke.is_finite() {
            return Err(EquilibriumError::Stroke(stroke));
        }
        let direction = Stroke::new(&self.loads, &gather(&self.free, &self.loads));
        let direction = direction.ok_or(EquilibriumError::NothingDrives)?;
        self.drive = Some((Box::new(direction), stroke));
        Ok(self)
    }

    /// What comes after the state `last` of this solver's path: the supports stay where they are, the
    /// loads are held, and further ones are added in so many steps. The path begins at the
    /// configuration of `last`; the adjoint is not made for it.
    pub fn followed_by(
        &self,
        last: &LoadStep,
        loads: &[Load],
        steps: usize,
    ) -> Result<Self, EquilibriumError> {
        let still = |&support: &Support| Support {
            value: 0.0,
            ..support
        };
        let supports: Vec<Support> = self.supports.iter().map(still).collect();
        let next = Self::new(self.grid, &supports, loads, steps, self.settings)?;
        let held = std::iter::zip(&self.held, &self.loads);
        Ok(Self {
            held: held
                .map(|(held, load)| std::array::from_fn(|d| held[d] + last.load_factor * load[d]))
                .collect(),
            ..next
        })
    }
}

/// Whether the supports suppress the three rigid motions of the sheet, judged on the panel grid.
fn holds_rigid_body(grid: Grid, supports: &[Support]) -> bool {
    let rows = supports.iter().map(|support| {
        let (x, y) = (support.panel % grid.m, support.panel / grid.m);
        match support.dof {
            Dof::UX => [1.0, 0.0, -(y as f64)],
            Dof::UY => [0.0, 1.0, x as f64],
            Dof::Phi => [0.0, 0.0, 1.0],
        }
    });
    let mut gram = [[0.0; 3]; 3];
    for row in rows {
        for i in 0..3 {
            for j in 0..3 {
                gram[i][j] += row[i] * row[j];
            }
        }
    }
    let minor = |i: usize, j: usize| gram[1][i] * gram[2][j] - gram[1][j] * gram[2][i];
    let determinant =
        gram[0][0] * minor(1, 2) - gram[0][1] * minor(0, 2) + gram[0][2] * minor(0, 1);
    // The entries are whole numbers: a regular matrix has a determinant of at least one.
    determinant > 0.5
}
