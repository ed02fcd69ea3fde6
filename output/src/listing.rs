//! All numbers of a design, for comparison with other programs: pattern, ideal deployment, equilibria,
//! gradient, tolerances, springback. `Serialize` writes all of them, `Display` a short table.
//!
//! Orders: vertices j (M+1) + i; panels q M + p; corners SW SE NE NW; hinges by vertex, x before x';
//! r row by row; tau on the edges bottom right top left; motions (u_x, u_y, phi); hinge
//! deformations (a, s, theta); hinge forces (F_a, F_s, M_theta). Lengths are in mm, forces in N, energies in
//! N mm, angles in rad unless the name ends in `_deg`.

mod deployment;
mod equilibrium;
mod gradient;
mod pattern;
mod springback;
mod tolerances;

pub use deployment::DeploymentListing;
pub use equilibrium::{EnergyParts, EquilibriumListing, StepListing};
pub use gradient::GradientListing;
pub use pattern::{HingeListing, PatternListing};
pub use springback::SpringbackListing;
pub use tolerances::{ToleranceListing, ToleranceQuestion};
