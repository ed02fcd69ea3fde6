//! Meshes the window of a hinge design, or a whole sheet, with gmsh, and checks the mesh.

use crate::element::ElementKind;
use crate::geo;
use crate::gmsh::Gmsh;
use crate::mesh::WindowMesh;
use crate::msh::{MshError, PlaneMesh, read_msh};
use crate::quality::MeshDefect;
use crate::sheet_mesh::SheetMesh;
use crate::sheet_shape::{InvalidSheet, SheetShape};
use crate::tier::MeshRecipe;
use crate::window::Window;
use hinge::{HingeDesign, InvalidDesign};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::file_error::FileError;
use support::program::{self, ToolError};

/// Why no mesh was generated.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
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
    Defect { w_lig: f64, alpha_deg: f64, defect: MeshDefect },
    #[error(transparent)]
    Sheet(#[from] InvalidSheet),
    #[error("the mesh of the sheet is rejected: {0}; try a finer mesh tier")]
    SheetDefect(MeshDefect),
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
        check_thickness(self.thickness)?;
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
            Err(defect) => Err(MeshError::Defect {
                w_lig: self.design.w_lig,
                alpha_deg: self.design.alpha.to_degrees(),
                defect,
            }),
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
        for window in &self.windows {
            window.design.validate()?;
        }
        check_thickness(self.thickness)?;
        let script = geo::sheet_script(self)?;
        generate(&script, folder, SHEET, gmsh, limit, stop)?;
        let kinds = [ElementKind::Brick, ElementKind::Wedge];
        let plane = read_plane(folder, SHEET, &kinds)?;
        SheetMesh::new(self, plane).map_err(MeshError::SheetDefect)
    }
}

fn check_thickness(thickness: f64) -> Result<(), MeshError> {
    match thickness {
        t if t.is_finite() && t > 0.0 => Ok(()),
        t => Err(MeshError::Thickness(t)),
    }
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
    Ok(read_msh(&bytes, kinds)?)
}

/// Names of gmsh's files, without their extensions.
const WINDOW: &str = "window";
const SHEET: &str = "sheet";
