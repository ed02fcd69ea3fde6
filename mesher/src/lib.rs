//! The hinge window: geometry, mesh tiers, the gmsh process and the checks a mesh must pass.
//!
//! The window is the half-disc of sheet assigned to one hinge (section 2.4). gmsh makes its plane
//! mesh from a script: of transfinite patches that move smoothly with (w_lig, alpha), or of free
//! triangles as in the paper. This crate extrudes it to layers of solid elements, bakes in the
//! imperfection that starts the buckle, and refuses a mesh that a solver should not see.

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

pub use element::ElementKind;
pub use gmsh::{GMSH, Gmsh};
pub use mesh::{MeshError, WindowMesh, mesh_window};
pub use msh::{Boundary, MshError, PlaneMesh, read_msh};
pub use quality::{MeshDefect, MeshQuality};
pub use svg::plane_mesh_svg;
pub use tier::{Imperfection, MeshRecipe, PlaneRecipe, Structured, Tier, Unstructured};
pub use window::{Side, Window};
