//! Charts of the studies, one file per kind.

mod capacity;
mod contours;
mod convergence;
mod costs;
mod damage_front;
mod front;
mod hinge_paths;
mod rays;
mod solutions;
mod taylor;

pub use capacity::{CapacityCurve, capacity};
pub use contours::PlaneValues;
pub use convergence::{StudyPanel, studies};
pub use costs::{CostPanel, costs};
pub use damage_front::{DamageLine, damage_front};
pub use front::{FrontPanel, front};
pub use hinge_paths::{PathPanel, hinge_paths};
pub use rays::{Curve, against_rays};
pub use solutions::{SolutionChart, solutions};
pub use taylor::{TaylorLine, taylor};
