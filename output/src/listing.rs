//! All numbers of a design as JSON, for comparison with other programs: equilibria, gradient.
//!
//! Orders: vertices j (M+1) + i; panels q M + p; corners SW SE NE NW; hinges by vertex, x before
//! x'; r row by row; tau on the edges bottom right top left; motions (u_x, u_y, phi); hinge
//! deformations (a, s, theta); hinge forces (F_a, F_s, M_theta). Lengths are in mm, forces in N,
//! energies in N mm, angles in rad unless the name ends in `_deg`.

mod equilibrium;
mod gradient;

pub use equilibrium::equilibrium;
pub use gradient::gradient;
