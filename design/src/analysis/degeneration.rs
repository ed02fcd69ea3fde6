//! The failure modes of a deployment under load; section 3.2, load capacity.
//!
//! A sheet counts as deployed if every void is open at full load. If the equilibrium path jumps past a limit
//! point and a part of the sheet stays closed or is pressed closed, the edges of its voids touch, and only the
//! barrier on the void angles keeps the panels apart. The path may also end.

use crate::equilibrium::load_step::{LoadStep, Status};
use crate::objective::design_problem::Deployment;
use std::f64::consts::PI;
use std::fmt;

/// Why a sheet under load is not deployed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Degeneration {
    /// Panel edges touch at full load.
    Contact {
        /// Number of hinges whose void is closed.
        hinges: usize,
    },
    /// No equilibrium was found at full load.
    NoEquilibrium {
        /// The last load factor with an equilibrium.
        reached: f64,
    },
}

impl Degeneration {
    /// `None` for a sheet with every void open; `last` is the last state of a deployment, at full load if
    /// that was reached.
    pub fn new(last: &LoadStep) -> Option<Self> {
        if last.status == Status::Diverged {
            let reached = last.load_factor;
            return Some(Self::NoEquilibrium { reached });
        }
        let is_shut = |theta: f64| theta <= 0.0 || theta >= PI;
        let shut = last
            .deformations
            .iter()
            .filter(|state| is_shut(state.theta));
        let hinges = shut.count();
        (hinges > 0).then_some(Self::Contact { hinges })
    }
}

/// The load factor of the last jump past a limit point before full load, if there was one.
pub fn last_jump(deployment: &Deployment) -> Option<f64> {
    let mut back = deployment.path.iter().rev();
    let jump = back.find(|step| step.jumps > 0)?;
    Some(jump.load_factor)
}

impl fmt::Display for Degeneration {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Contact { hinges: 1 } => write!(f, "a closed void at one hinge"),
            Self::Contact { hinges } => write!(f, "closed voids at {hinges} hinges"),
            Self::NoEquilibrium { reached } => {
                write!(f, "no equilibrium above load factor {reached:.3}")
            }
        }
    }
}
