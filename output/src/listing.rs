//! All numbers of a design, for comparison with other programs: equilibria, gradient. JSON has all
//! of them, the text is a short table.
//!
//! Orders: vertices j (M+1) + i; panels q M + p; corners SW SE NE NW; hinges by vertex, x before
//! x'; r row by row; tau on the edges bottom right top left; motions (u_x, u_y, phi); hinge
//! deformations (a, s, theta); hinge forces (F_a, F_s, M_theta). Lengths are in mm, forces in N,
//! energies in N mm, angles in rad unless the name ends in `_deg`.

mod equilibrium;
mod gradient;

pub use equilibrium::equilibrium;
pub use gradient::gradient;

use serde::Serialize;
use serde_json::Value;
use std::fmt;
use support::document::Document;

/// The numbers of a stage of a design: `Serialize` writes all of them, `Display` a short table.
#[derive(Clone, Debug, Serialize)]
pub struct Listing {
    /// All numbers.
    #[serde(flatten)]
    pub numbers: Value,
    #[serde(skip)]
    document: Document,
}

impl fmt::Display for Listing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.document.fmt(f)
    }
}
