//! The hinge window: geometry, mesh tiers, the gmsh process and the checks a mesh must pass.
//!
//! The window is the half-disc of sheet assigned to one hinge (section 2.4). gmsh makes its plane
//! mesh from a script of transfinite patches that moves smoothly with (w_lig, alpha); this crate
//! extrudes it to layers of 20-node bricks, bakes in the imperfection that starts the buckle, and
//! refuses a mesh that a solver should not see.

mod element;
mod geo;
mod gmsh;
mod mesh;
mod msh;
mod quality;
mod svg;
mod tier;
pub mod tool;
mod window;

pub use gmsh::{GMSH, Gmsh};
pub use mesh::{MeshError, WindowMesh, mesh_window};
pub use msh::{Boundary, MshError, PlaneMesh, read_msh};
pub use quality::{MeshDefect, MeshQuality};
pub use svg::plane_mesh_svg;
pub use tier::{MeshRecipe, Tier};
pub use window::{Side, Window};
