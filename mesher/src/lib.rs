//! The hinge window and the sheet of windows and panels: geometry, mesh tiers, the gmsh process and
//! the checks that a mesh must pass.
//!
//! The window is the half-disc of sheet assigned to one hinge (section 2.4). gmsh generates its
//! plane mesh from a script, either from transfinite patches that move smoothly with (w_lig,
//! alpha), or from free triangles as in the paper. This crate extrudes the plane mesh to layers of
//! solid elements, adds the imperfection that initiates buckling, and rejects a mesh that is
//! unsuitable for the solver. In a whole sheet ([`SheetShape`]) every hinge has the mesh of its
//! window; a panel is rigid, or meshed between its windows and its edges.
//!
//! ```no_run
//! use hinge::HingeConstants;
//! use mesher::{Gmsh, Tier, WindowShape};
//! use std::path::Path;
//! use std::sync::atomic::AtomicBool;
//! use std::time::Duration;
//!
//! let hinge = HingeConstants::PAPER.hinge(18.0, 60f64.to_radians());
//! let shape = WindowShape { design: &hinge, thickness: 0.5, recipe: &Tier::Default.recipe() };
//! let (limit, stop) = (Duration::from_secs(60), AtomicBool::new(false));
//! let mesh = shape.mesh(Path::new("runs/mesh"), &Gmsh::find()?, limit, &stop)?;
//! println!("{} nodes", mesh.nodes.len());
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod element;
mod extrusion;
mod geo;
mod mesh;
mod meshing;
mod msh;
mod sheet_mesh;
mod sheet_shape;
mod tier;
mod window;

pub(crate) use extrusion::{Extrusion, NodeLevels};
pub(crate) use mesh::{MAX_AREA_ERROR, check_elements, wrong_area};
pub(crate) use msh::sides;
pub(crate) use window::{cross, dot, minus, polar_angle, unit};

pub use element::ElementKind;
pub use mesh::{MeshQuality, WindowMesh, plane_mesh_svg, vtk_grid};
pub use meshing::{GMSH, Gmsh, MeshError, WindowShape};
pub use msh::{Boundary, PlaneMesh, read_msh};
pub use sheet_mesh::{MeshPart, SheetMesh};
pub use sheet_shape::{Frame, PanelPolygon, Panels, PlacedWindow, SheetShape};
pub use tier::{Imperfection, MeshRecipe, PlaneRecipe, Structured, Tier, Unstructured};
pub use window::{Side, Window};
