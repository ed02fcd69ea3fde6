//! Charts of the studies, one file per kind.

mod convergence;
mod damage_front;
mod front;
mod hinge_paths;
mod rays;

pub use convergence::{StudyPanel, studies};
pub use damage_front::{DamageLine, damage_front};
pub use front::{FrontPanel, front};
pub use hinge_paths::{PathPanel, hinge_paths};
pub use rays::{Curve, against_rays};
