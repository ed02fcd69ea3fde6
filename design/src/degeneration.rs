//! How the deployment of a sheet under load comes to an end; section 3.2, load capacity.
//!
//! A sheet is deployed while every void is open at full load. Where the load path jumps past a limit
//! point and a part of the sheet stays shut, or is pressed shut, the edges of its voids touch and the
//! barrier on the void angles alone keeps the panels apart; the path may also end.

use crate::equilibrium::{LoadStep, Status};
use crate::gradient::Deployment;
use std::f64::consts::PI;
use std::fmt;

/// Why a sheet under load is no longer deployed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Degeneration {
    /// Panel edges touch at this many hinges at full load.
    Contact { hinges: usize },
    /// No equilibrium was found beyond this load factor.
    NoEquilibrium { reached: f64 },
}

impl Degeneration {
    /// `None` of a sheet with every void open; the last state of a deployment is that at full load.
    pub fn of(last: &LoadStep) -> Option<Self> {
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

/// The load factor of the last jump past a limit point on the way to full load, if there was one.
pub fn last_jump(deployment: &Deployment) -> Option<f64> {
    let mut back = deployment.path.iter().rev();
    let jump = back.find(|step| step.status == Status::LimitPoint)?;
    Some(jump.load_factor)
}

impl fmt::Display for Degeneration {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Contact { hinges: 1 } => write!(f, "a void shut at one hinge"),
            Self::Contact { hinges } => write!(f, "voids shut at {hinges} hinges"),
            Self::NoEquilibrium { reached } => {
                write!(f, "no equilibrium beyond load factor {reached:.3}")
            }
        }
    }
}
