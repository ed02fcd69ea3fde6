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
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::file_error::FileError;
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
    #[error(transparent)]
    File(#[from] FileError),
}

/// What determines the mesh of a window.
#[derive(Clone, Copy, Debug)]
pub struct WindowShape<'a> {
    /// The hinge design.
    pub design: &'a HingeDesign,
    /// Sheet thickness (mm).
    pub thickness: f64,
    /// How the mesh is generated.
    pub recipe: &'a MeshRecipe,
}

impl WindowShape<'_> {
    /// Meshes the window. The script, log and mesh of gmsh are written to `folder`.
    ///
    /// gmsh is terminated after `limit`, and soon after `stop` becomes true.
    pub fn mesh(
        &self,
        folder: &Path,
        gmsh: &Gmsh,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<WindowMesh, MeshError> {
        self.design.validate()?;
        if !(self.thickness.is_finite() && self.thickness > 0.0) {
            return Err(MeshError::Thickness(self.thickness));
        }
        let script = geo::script(&Window(self.design), &self.recipe.plane);
        let geo = folder.join("window.geo");
        std::fs::write(&geo, script).map_err(FileError::at(&geo))?;
        let msh = folder.join(MESH_FILE);
        program::remove_stale(&msh).map_err(FileError::at(&msh))?;
        gmsh.mesh(folder, limit, stop)?;
        self.read(folder)
    }

    /// Reads the mesh that gmsh has written to `folder`.
    pub fn read(&self, folder: &Path) -> Result<WindowMesh, MeshError> {
        let msh = folder.join(MESH_FILE);
        let bytes = match std::fs::read(&msh) {
            // gmsh exited with status zero but wrote no mesh: the reader reports what is missing.
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            read => read.map_err(FileError::at(&msh))?,
        };
        let plane = read_msh(&bytes, self.recipe.element())?;
        let mesh = WindowMesh::extrude(*self.design, self.thickness, *self.recipe, plane);
        match mesh.quality() {
            Ok(_) => Ok(mesh),
            Err(defect) => Err(MeshError::Defect {
                w_lig: self.design.w_lig,
                alpha_deg: self.design.alpha.to_degrees(),
                defect,
            }),
        }
    }
}

/// The file of gmsh's mesh.
const MESH_FILE: &str = "window.msh";
