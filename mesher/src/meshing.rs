//! Meshes the window of a hinge design, or a whole sheet, with gmsh, and checks the mesh.

use crate::geo;
use crate::{
    ElementKind, Gmsh, MeshRecipe, PlaneMesh, SheetMesh, SheetShape, Window, WindowMesh, read_msh,
};
use hinge::HingeDesign;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::fault::Fault;
use support::file_error::FileError;
use support::program::{self, ToolError};

/// Why no mesh was generated.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The design, the sheet or its thickness is impossible.
    #[error("{0}")]
    Invalid(String),
    /// gmsh gave no result.
    #[error(transparent)]
    Gmsh(#[from] ToolError),
    /// The file that gmsh wrote is damaged or missing.
    #[error("gmsh did not write a usable mesh: {0}")]
    Unread(Fault),
    /// The mesh is unsuitable for the solver.
    #[error("the mesh {0} is rejected: {1}; try a finer mesh tier")]
    Rejected(String, Fault),
    /// A file cannot be written or read.
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
        check(self.thickness, [self.design])?;
        let script = geo::script(&Window(self.design), &self.recipe.plane);
        generate(&script, folder, WINDOW, gmsh, limit, stop)?;
        self.read(folder)
    }

    /// Reads the mesh that gmsh has written to `folder`.
    pub fn read(&self, folder: &Path) -> Result<WindowMesh, MeshError> {
        let plane = read_plane(folder, WINDOW, &[self.recipe.element()])?;
        let mesh = WindowMesh::extrude(*self.design, self.thickness, *self.recipe, plane);
        match mesh.quality() {
            Ok(_) => Ok(mesh),
            Err(defect) => {
                let HingeDesign { w_lig, alpha, .. } = self.design;
                let alpha = alpha.to_degrees();
                let which = format!("for w_lig = {w_lig} mm, alpha = {alpha} deg");
                Err(MeshError::Rejected(which, defect))
            }
        }
    }
}

impl SheetShape {
    /// Meshes the sheet. The script, log and mesh of gmsh are written to `folder`.
    ///
    /// gmsh is terminated after `limit`, and soon after `stop` becomes true.
    pub fn mesh(
        &self,
        folder: &Path,
        gmsh: &Gmsh,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<SheetMesh, MeshError> {
        check(self.thickness, self.windows.iter().map(|window| &window.design))?;
        let script = geo::sheet_script(self).map_err(MeshError::Invalid)?;
        generate(&script, folder, SHEET, gmsh, limit, stop)?;
        let kinds = [ElementKind::Brick, ElementKind::Wedge];
        let plane = read_plane(folder, SHEET, &kinds)?;
        let rejected = |defect| MeshError::Rejected("of the sheet".to_owned(), defect);
        SheetMesh::new(self, plane).map_err(rejected)
    }
}

/// An error if a hinge cannot be cut, or a sheet has no thickness (mm).
fn check<'a>(
    thickness: f64,
    designs: impl IntoIterator<Item = &'a HingeDesign>,
) -> Result<(), MeshError> {
    for design in designs {
        design.validate_coupon().map_err(|error| MeshError::Invalid(error.to_string()))?;
    }
    if thickness.is_finite() && thickness > 0.0 {
        return Ok(());
    }
    Err(MeshError::Invalid(format!("thickness = {thickness} mm violates thickness > 0")))
}

/// Runs gmsh on a script in `folder`.
fn generate(
    script: &str,
    folder: &Path,
    name: &str,
    gmsh: &Gmsh,
    limit: Duration,
    stop: &AtomicBool,
) -> Result<(), MeshError> {
    let [geo, msh] = ["geo", "msh"].map(|kind| folder.join(name).with_extension(kind));
    std::fs::write(&geo, script).map_err(FileError::at(&geo))?;
    program::remove_stale(&msh).map_err(FileError::at(&msh))?;
    Ok(gmsh.mesh(folder, name, limit, stop)?)
}

/// Reads the mesh that gmsh has written to `folder`.
fn read_plane(folder: &Path, name: &str, kinds: &[ElementKind]) -> Result<PlaneMesh, MeshError> {
    let msh = folder.join(name).with_extension("msh");
    // If gmsh exited with status zero but wrote no mesh, the reader reports what is missing.
    let bytes = program::output_file(&msh).map_err(FileError::at(&msh))?;
    read_msh(&bytes, kinds).map_err(MeshError::Unread)
}

/// Names of gmsh's files, without their extensions.
const WINDOW: &str = "window";
const SHEET: &str = "sheet";
