//! Meshes the window of a hinge design, or a whole sheet, with gmsh, and checks the mesh.

use crate::{
    ElementKind, MeshRecipe, PlaneMesh, SheetMesh, SheetShape, Window, WindowMesh, geo, read_msh,
};
use hinge::HingeDesign;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::program::{self, Tool, ToolError, ToolKind};
use support::{Fault, FileError, ensure, said};

/// Why no mesh was generated.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The design, the sheet or its thickness is impossible.
    #[error(transparent)]
    Invalid(#[from] Fault),
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
        let script = geo::sheet_script(self)?;
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
) -> Result<(), Fault> {
    for design in designs {
        design.validate_coupon().map_err(said)?;
    }
    ensure!(
        thickness.is_finite() && thickness > 0.0,
        "thickness = {thickness} mm violates thickness > 0"
    );
    Ok(())
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

// The gmsh process: generates a second-order plane mesh from a script.

/// How to find gmsh.
pub static GMSH: ToolKind = ToolKind {
    name: "gmsh",
    variable: "KIRIGAMI_GMSH",
    version_flag: "--version",
    version_statuses: &[0],
    version_in: version,
    install: "apt-get install gmsh",
};

/// A line that is a version: `4.8.4`, `4.13.1-git-a1b2c3`. Warnings may stand before it.
fn version(printed: &str) -> Option<&str> {
    let is_version = |line: &&str| {
        let number = line.split('-').next().unwrap_or_default();
        number.contains('.') && number.split('.').all(|part| part.parse::<u32>().is_ok())
    };
    printed.lines().map(str::trim).find(is_version)
}

/// Maximum time limit: gmsh meshes a window in milliseconds and a sheet in seconds, so a longer run
/// hangs.
const LIMIT: Duration = Duration::from_secs(60);

/// The gmsh program.
#[derive(Debug)]
pub struct Gmsh(pub Tool);

impl Gmsh {
    /// Finds gmsh by `KIRIGAMI_GMSH` or on PATH.
    pub fn find() -> Result<Self, ToolError> {
        Tool::find(&GMSH).map(Self)
    }

    /// The program at a path.
    pub fn at(program: &Path) -> Result<Self, ToolError> {
        Tool::at(&GMSH, program).map(Self)
    }

    /// Meshes `folder/<name>.geo` with 8-node quadrilaterals, to `folder/<name>.msh`.
    pub(crate) fn mesh(
        &self,
        folder: &Path,
        name: &str,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<(), ToolError> {
        let log = folder.join("gmsh.log");
        let [msh, geo] = ["msh", "geo"].map(|kind| format!("{name}.{kind}"));
        let arguments = [
            "-2",
            // Errors only: the end of the log says why there is no mesh.
            "-v",
            "1",
            "-order",
            "2",
            "-setnumber",
            "Mesh.SecondOrderIncomplete",
            "1",
            "-nt",
            "1",
            "-format",
            "msh22",
            "-o",
            &msh,
            &geo,
        ];
        let limit = limit.min(LIMIT);
        let run = self.0.run(&arguments, folder, &log, limit, stop)?;
        self.0.expect_success(run, &log)
    }
}

#[cfg(test)]
mod tests {
    use super::version;

    #[test]
    fn only_a_line_that_is_a_version_is_one() {
        assert_eq!(version("4.8.4"), Some("4.8.4"));
        assert_eq!(version("Warning: 2 fonts\n4.13.1-git-a1b2\n"), Some("4.13.1-git-a1b2"));
        for other in ["", "4", "  File \"gmsh\", line 4, in <module>", "Python 3.11.2", "4.x.1"] {
            assert_eq!(version(other), None, "{other}");
        }
    }
}
