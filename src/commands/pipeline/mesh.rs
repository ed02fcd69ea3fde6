//! `kirigami mesh`: the finite-element mesh of one hinge window.

use crate::{commands::pipeline::window_args::WindowArgs, ui::interrupt};
use anyhow::Result;
use app::{picture, run_folder};
use clap::Args;
use mesher::{Gmsh, Tier, WindowShape, plane_mesh_svg, vtk_grid};
use std::{path::PathBuf, time::Duration};

/// Mesh one hinge window and draw it
///
/// Writes gmsh's script and mesh, mesh.vtu for ParaView and meshio, and a picture of the plane
/// mesh; prints the size and quality of the mesh. Example: kirigami mesh --w-lig 18 --alpha-deg 60
/// --tier default
#[derive(Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct MeshCommand {
    #[command(flatten)]
    window: WindowArgs,
    /// Mesh tier: tiny, small, default, fine, reference or paper; for plates plate-tiny, plate or
    /// plate-reference
    #[arg(long, value_name = "TIER", default_value_t = Tier::Default)]
    tier: Tier,
    /// Sheet thickness (mm)
    #[arg(long, value_name = "MM", default_value_t = 0.5)]
    thickness: f64,
    /// Folder for the script, the mesh and the picture
    #[arg(long, value_name = "FOLDER", default_value = "runs/mesh")]
    out: PathBuf,
}

impl MeshCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let design = self.window.design()?;
        let _held = run_folder::hold(&self.out)?;
        let gmsh = Gmsh::find()?;
        let shape =
            WindowShape { design: &design, thickness: self.thickness, recipe: &self.tier.recipe() };
        let mesh = shape.mesh(&self.out, &gmsh, Duration::MAX, interrupt::stop_flag()?)?;
        let quality = mesh.quality()?;
        let pictures = picture::save(&plane_mesh_svg(&mesh), &self.out.join("mesh"), 1600)?;
        run_folder::write(&self.out, "mesh.vtu", &vtk_grid(&mesh).to_vtu())?;
        println!(
            "{} tier: {} elements ({}), {} nodes, {} layers through {} mm",
            self.tier,
            mesh.elements.len(),
            mesh.recipe.element().name(),
            mesh.nodes.len(),
            mesh.recipe.layers,
            self.thickness
        );
        println!(
            "area {:.2} mm^2 (error {:.1e}), minimum Jacobian ratio {:.2}, maximum edge ratio {:.1}",
            quality.area, quality.area_error, quality.jacobian_ratio, quality.aspect
        );
        println!("picture: {}", pictures[1].display());
        Ok(())
    }
}
