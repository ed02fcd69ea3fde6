//! Sheets of rigid panels joined by hinges: from a cut pattern to its deployment, and back to the
//! pattern that deploys onto a target.
//!
//! The crate solves, in the coordinates theta = (z, ell, omega) of cut pattern and ligament widths
//! (1),
//!
//! ```text
//! min over theta of  L(theta) = chamfer(outline(q_N), target) + sum_j w_j J_j(q_1 ... q_N)
//! (16)-(19) subject to         grad_q Pi(q_i; theta, zeta_i) = 0,   zeta_i = i / N,
//! (10)
//!                    Pi = sum_h W(eps_h(q); g_h) - zeta f . q
//! ```
//!
//! by gradient descent through the equilibria: Newton's method follows the equilibrium path, the
//! adjoint (20) gives dL/dtheta, and Adam or L-BFGS proposes the next design (Algorithm 1).
//!
//! | room | contents |
//! |---|---|
//! | [`geometry`] | points, polygons, distances of outlines |
//! | [`pattern`] | the cut pattern (2)-(5) and its coordinates |
//! | [`sheet`] | panels and hinges of a pattern, their kinematics (6)-(8) |
//! | [`hinge_law`] | the energy of a hinge: linear (11), learned (14), contact |
//! | [`equilibrium`] | equilibrium paths (10) and their adjoint (20) |
//! | [`objective`] | objective and gradient (16)-(20) |
//! | [`optimise`](mod@optimise) | the outer loop, Algorithm 1 |
//!
//! A room uses itself and the rooms above it. Lengths are in mm, forces in N, angles in rad.
//!
//! The main types are [`DesignProblem`], [`DesignVector`], [`Deployment`] and [`Evaluation`]. The
//! crate `scene` reads a design problem from a file. Without one:
//!
//! ```
//! use design::equilibrium::settings::SolverSettings;
//! use design::equilibrium::supports::{Dof, Load, Support};
//! use design::sheet::cut_sheet::{HingePoint, SheetOptions};
//! use design::*;
//! use hinge::HingeConstants;
//! use std::sync::Arc;
//! use std::sync::atomic::AtomicBool;
//!
//! // A square sheet of 3 x 3 panels: one held at the left, one pulled to the right by 2 N.
//! let grid = Grid { m: 3, n: 3 };
//! let clamp = Dof::ALL.map(|dof| Support { panel: grid.panel(0, 1), dof, value: 0.0 });
//! let pull = Load { panel: grid.panel(2, 1), dof: Dof::UX, value: 2.0 };
//! let solver = EquilibriumSolver::new(grid, &clamp, &[pull], 4, SolverSettings::default())?;
//! let circle = (0..100)
//!     .map(|i| 0.0628 * f64::from(i))
//!     .map(|t| [700.0 + 750.0 * t.cos(), 550.0 + 750.0 * t.sin()]);
//! let problem = DesignProblem {
//!     topology: grid.into(),
//!     outline: Outline::rectangle(1200.0, 1200.0),
//!     widths: WidthChart { w_minus: 10.0, w_plus: 26.0 },
//!     options: SheetOptions {
//!         hinge_point: HingePoint::Corner,
//!         process: HingeConstants::PAPER.into(),
//!     },
//!     model: Model::Equilibrium(Box::new(Mechanics {
//!         law: Arc::new(LinearLaw::uniform([400.0, 250.0, 300.0], grid.hinge_count())),
//!         contact: None,
//!         solver,
//!     })),
//!     objective: Objective {
//!         shape: ShapeDistance::new(circle.collect()),
//!         functionals: Vec::new(),
//!         penalties: Vec::new(),
//!     },
//! };
//!
//! // Deploy the uniform sheet; its loss and the gradient.
//! let start = DesignVector::uniform(grid);
//! let deployment = problem.deploy(&start)?;
//! assert_eq!(deployment.path.len(), 4);
//! let evaluation = problem.evaluate(&start)?;
//! assert_eq!(evaluation.gradient.omega.len(), grid.hinge_count());
//!
//! // Ten steps of Adam; the callback sees every one and may end the search by an error.
//! let mut search = SearchState::new(&problem, start, &evaluation, SearchMethod::Adam, 0.03);
//! optimise(&problem, &mut search, 10, &AtomicBool::new(false), &mut |search| {
//!     println!("{} {}", search.last().step, search.last().scores.loss);
//!     Ok::<_, std::convert::Infallible>(())
//! })?;
//! assert!(problem.loss(&search.best)? < evaluation.loss);
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

pub mod equilibrium;
pub mod geometry;
pub mod hinge_law;
pub mod objective;
pub mod optimise;
pub mod pattern;
pub mod sheet;

pub use equilibrium::solver::EquilibriumSolver;
pub use hinge_law::{HingeLaw, LinearLaw, SurrogateLaw};
pub use objective::{
    design_problem::{Deployment, DesignError, DesignProblem, Evaluation, Mechanics, Model},
    loss::Objective,
    shape::ShapeDistance,
};
pub use optimise::{
    outer_loop::{Ended, SearchState, optimise},
    search::SearchMethod,
};
pub use pattern::{
    cut_pattern::Outline,
    design_vector::{DesignVector, WidthChart},
    grid::Grid,
};
pub use sheet::cut_sheet::Sheet;
