//! Equilibrium of the sheet under dead loads (10), along the load factors zeta_i = i/N:
//!
//! ```text
//! min over q of  Pi(q) = sum_h W(eps_h(q); g_h) - zeta sum_k (F_k . u_k + M_k phi_k)
//! ```
//!
//! by Newton's method on the sparse tangent. A tangent that is not positive definite is shifted until
//! it is; steps are cut until Pi falls; load increments are halved until the path can be followed;
//! a stationary point that is no minimum is left along a direction of negative curvature.

use crate::actuation::{Dof, Load, Support};
use crate::grid::Grid;
use crate::hinge_law::{Contact, HingeDamage, HingeEnergy, Order, PreparedLaw};
use crate::kinematics::{Configuration, hinge_deformations};
use crate::newton::{Minimum, Potential, State};
use crate::sheet::{Panel, Sheet};
use crate::tangent::{Factor, TangentPattern};
use hinge::HingeDeformation;

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
    #[error("{0} load steps: use at least 1")]
    NoSteps(usize),
    #[error(
        "solver settings {0:?} violate 0 < tolerance <= loose_tolerance < 1, max_iterations >= 1, \
         max_halvings <= 30, max_jump > 0"
    )]
    Settings(SolverSettings),
}

/// How hard to try.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverSettings {
    /// Residual of a converged state, relative to the greatest force.
    pub tolerance: f64,
    /// Residual of an almost converged state.
    pub loose_tolerance: f64,
    /// Newton iterations per load increment.
    pub max_iterations: usize,
    /// How often a load step is halved.
    pub max_halvings: u32,
    /// Largest rotation (rad) in one increment across an unstable stretch that still counts as
    /// following the path.
    pub max_jump: f64,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            tolerance: 1e-10,
            loose_tolerance: 1e-6,
            max_iterations: 60,
            max_halvings: 6,
            max_jump: 0.35,
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
            && self.max_jump > 0.0
    }
}

/// How a load step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// A stable equilibrium, inside the hinge law's domain.
    Converged,
    /// A stable equilibrium, with hinges in states that the hinge law was not made for.
    LeftDomain,
    /// The residual stopped falling between the two tolerances, or the state is stationary and the
    /// tangent singular.
    Almost,
    /// The path ended on the way here and the sheet jumped to this stable equilibrium.
    LimitPoint,
    /// No equilibrium was found: this is the last one before, and the path ends.
    Diverged,
}

/// The state at one load factor.
#[derive(Clone, Debug)]
pub struct LoadStep {
    /// zeta
    pub load_factor: f64,
    pub configuration: Configuration,
    /// (8) per hinge.
    pub deformations: Vec<HingeDeformation>,
    /// W + contact per hinge (N mm).
    pub energies: Vec<f64>,
    /// The predicted damage (12) per hinge; empty where the law predicts none.
    pub damage: Vec<HingeDamage>,
    /// Pi of (10) (N mm).
    pub potential: f64,
    pub status: Status,
    /// Greatest unbalanced force over the greatest force.
    pub residual: f64,
    /// Newton iterations, all increments together.
    pub iterations: usize,
    /// Pivots of the tangent that are not positive: 0 in a stable state, and where `pivot_ratio` is 0.
    pub negative_pivots: usize,
    /// Smallest pivot of the tangent over its diagonal entry: small near a singular tangent, 0 where
    /// it could not be factored.
    pub pivot_ratio: f64,
    /// Per hinge, whether the hinge law was made for the state.
    pub inside: Vec<bool>,
    /// H at the configuration and its factors, for the adjoint.
    pub(crate) tangent: Option<(Vec<f64>, Factor)>,
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
    grid: Grid,
    settings: SolverSettings,
    steps: usize,
    /// Numbers of the free degrees of freedom, three per panel.
    free: Vec<Option<usize>>,
    /// Prescribed motions at full load.
    supports: Vec<Support>,
    /// (F_x, F_y, M) per panel at full load.
    loads: Vec<[f64; 3]>,
    /// Boxed: large beside the rest.
    pattern: Box<TangentPattern>,
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
        let mut numbers = 0..;
        let free: Vec<Option<usize>> = supported
            .as_flattened()
            .iter()
            .map(|&supported| if supported { None } else { numbers.next() })
            .collect();
        Ok(Self {
            grid,
            settings,
            steps,
            pattern: Box::new(TangentPattern::new(grid, &free)),
            free,
            supports: supports.to_vec(),
            loads: total,
        })
    }

    /// Follows the load path from the flat sheet. The path ends early where a step diverges.
    ///
    /// # Panics
    /// If the sheet has another grid than the solver.
    pub fn path(&self, sheet: HingedSheet) -> Vec<LoadStep> {
        assert_eq!(
            self.grid, sheet.sheet.grid,
            "the solver's grid is the sheet's"
        );
        let mut path: Vec<LoadStep> = Vec::with_capacity(self.steps);
        let mut configuration = vec![[0.0; 3]; self.grid.panel_count()];
        for i in 1..=self.steps {
            let [from, to] = [i - 1, i].map(|i| i as f64 / self.steps as f64);
            let step = self.advance(sheet, configuration, from, to);
            configuration = step.configuration.clone();
            let diverged = step.status == Status::Diverged;
            path.push(step);
            if diverged {
                break;
            }
        }
        path
    }

    /// The load step between two load factors, in as many increments as it takes.
    fn advance(
        &self,
        sheet: HingedSheet,
        mut configuration: Configuration,
        from: f64,
        to: f64,
    ) -> LoadStep {
        let (mut reached, mut increment) = (from, to - from);
        let least = increment * 0.5_f64.powi(self.settings.max_halvings as i32);
        let (mut iterations, mut jumped) = (0, false);
        loop {
            // The last increment ends exactly, so that rounding leaves no sliver of load behind.
            let target = if to - reached < 1.5 * increment {
                to
            } else {
                reached + increment
            };
            let potential = self.potential(sheet, target);
            let start = self.prescribed(configuration.clone(), target);
            let outcome = potential.minimise(start, &self.settings);
            iterations += match &outcome {
                Ok(minimum) => minimum.iterations,
                Err(failure) => failure.iterations,
            };
            let jumps = outcome.as_ref().is_ok_and(|minimum| {
                minimum.unstable
                    && rotation_between(&configuration, &minimum.state.configuration)
                        > self.settings.max_jump
            });
            if (jumps || outcome.is_err()) && increment > least {
                increment *= 0.5;
                continue;
            }
            jumped |= jumps;
            match outcome {
                Ok(minimum) if target == to => {
                    let status = self.status(sheet, &minimum, jumped);
                    let tangent = minimum.factor.map(|factor| (minimum.tangent, factor));
                    return LoadStep::new(sheet, to, minimum.state, tangent, status, iterations);
                }
                Ok(minimum) => {
                    configuration = minimum.state.configuration;
                    reached = target;
                    increment *= 2.0;
                }
                Err(failure) => {
                    let last = self.potential(sheet, reached).state(configuration);
                    let state = last.expect("this state has been computed before");
                    let step =
                        LoadStep::new(sheet, reached, state, None, Status::Diverged, iterations);
                    return LoadStep {
                        residual: failure.residual,
                        ..step
                    };
                }
            }
        }
    }

    fn status(&self, sheet: HingedSheet, minimum: &Minimum, jumped: bool) -> Status {
        let stable = (minimum.factor.as_ref()).is_some_and(|factor| factor.negative_pivots == 0);
        if jumped {
            Status::LimitPoint
        } else if minimum.state.residual > self.settings.tolerance || !stable {
            Status::Almost
        } else if sheet
            .law
            .inside(&minimum.state.deformations())
            .contains(&false)
        {
            Status::LeftDomain
        } else {
            Status::Converged
        }
    }

    fn potential<'a>(&'a self, sheet: HingedSheet<'a>, load_factor: f64) -> Potential<'a> {
        let area: f64 = sheet.sheet.panels.iter().map(Panel::area).sum();
        let loads = self
            .loads
            .iter()
            .map(|load| load.map(|force| load_factor * force));
        Potential {
            sheet,
            pattern: &self.pattern,
            free: &self.free,
            loads: loads.collect(),
            full_loads: &self.loads,
            panel_size: (area / sheet.sheet.panels.len() as f64).sqrt(),
        }
    }

    /// The configuration with the supports moved to where they are at this load factor.
    fn prescribed(&self, mut configuration: Configuration, load_factor: f64) -> Configuration {
        for support in &self.supports {
            configuration[support.panel][support.dof.index()] = load_factor * support.value;
        }
        configuration
    }

    /// The numbers of the free degrees of freedom, three per panel.
    pub(crate) fn free(&self) -> &[Option<usize>] {
        &self.free
    }

    pub(crate) fn pattern(&self) -> &TangentPattern {
        &self.pattern
    }
}

impl LoadStep {
    /// The ideal deployment as a path of one step: no energy, nothing unbalanced.
    pub(crate) fn ideal(sheet: &Sheet, configuration: Configuration) -> Self {
        let hinges = sheet.hinges.len();
        Self {
            load_factor: 1.0,
            deformations: hinge_deformations(sheet, &configuration),
            configuration,
            energies: vec![0.0; hinges],
            damage: Vec::new(),
            potential: 0.0,
            status: Status::Converged,
            residual: 0.0,
            iterations: 0,
            negative_pivots: 0,
            pivot_ratio: 1.0,
            inside: vec![true; hinges],
            tangent: None,
        }
    }

    fn new(
        sheet: HingedSheet,
        load_factor: f64,
        state: State,
        tangent: Option<(Vec<f64>, Factor)>,
        status: Status,
        iterations: usize,
    ) -> Self {
        let deformations = state.deformations();
        let factor = tangent.as_ref().map(|(_, factor)| factor);
        Self {
            load_factor,
            inside: sheet.law.inside(&deformations),
            damage: sheet.law.damage(&deformations),
            deformations,
            energies: state.energies.iter().map(|energy| energy.w).collect(),
            potential: state.potential,
            status,
            residual: state.residual,
            iterations,
            negative_pivots: factor.map_or(0, |factor| factor.negative_pivots),
            pivot_ratio: factor.map_or(0.0, |factor| factor.pivot_ratio),
            configuration: state.configuration,
            tangent,
        }
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

/// Greatest difference in panel rotation (rad).
fn rotation_between(from: &[[f64; 3]], to: &[[f64; 3]]) -> f64 {
    std::iter::zip(from, to)
        .map(|(from, to)| (to[2] - from[2]).abs())
        .fold(0.0, f64::max)
}
