//! Meshes the window of a hinge design with gmsh, and checks the mesh.

use crate::geo;
use crate::gmsh::Gmsh;
use crate::mesh::WindowMesh;
use crate::msh::{MshError, read_msh};
use crate::quality::MeshDefect;
use crate::tier::MeshRecipe;
use crate::window::Window;
use hinge::{HingeDesign, InvalidDesign};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::program::{self, ToolError};

/// Why no mesh was generated.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum MeshError {
    #[error(transparent)]
    Design(#[from] InvalidDesign),
    #[error("thickness = {0} mm violates thickness > 0")]
    Thickness(f64),
    #[error(transparent)]
    Gmsh(#[from] ToolError),
    #[error("gmsh did not write a usable mesh: {0}")]
    Read(#[from] MshError),
    #[error(
        "the mesh for w_lig = {w_lig} mm, alpha = {alpha_deg} deg is rejected: {defect}; \
         try a finer mesh tier"
    )]
    Defect {
        w_lig: f64,
        alpha_deg: f64,
        defect: MeshDefect,
    },
    #[error("{path}: {source}", path = .path.display())]
    File {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Meshes the window of `design`. The script, log and mesh of gmsh are written to `scratch`.
///
/// gmsh is terminated after `limit`, and soon after `stop` becomes true.
pub fn mesh_window(
    design: &HingeDesign,
    thickness: f64,
    recipe: &MeshRecipe,
    scratch: &Path,
    gmsh: &Gmsh,
    limit: Duration,
    stop: &AtomicBool,
) -> Result<WindowMesh, MeshError> {
    design.validate()?;
    if !(thickness.is_finite() && thickness > 0.0) {
        return Err(MeshError::Thickness(thickness));
    }
    let script = geo::script(&Window(design), &recipe.plane);
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| MeshError::File { path, source }
    };
    let geo = scratch.join("window.geo");
    std::fs::write(&geo, script).map_err(at(&geo))?;
    let msh = scratch.join("window.msh");
    program::remove_stale(&msh).map_err(at(&msh))?;
    gmsh.mesh(scratch, limit, stop)?;
    let bytes = match std::fs::read(&msh) {
        // gmsh exited with status zero but wrote no mesh: the reader reports what is missing.
        Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
        read => read.map_err(at(&msh))?,
    };
    let mesh = WindowMesh::extrude(
        *design,
        thickness,
        *recipe,
        read_msh(&bytes, recipe.element())?,
    );
    match mesh.quality() {
        Ok(_) => Ok(mesh),
        Err(defect) => Err(MeshError::Defect {
            w_lig: design.w_lig,
            alpha_deg: design.alpha.to_degrees(),
            defect,
        }),
    }
}
