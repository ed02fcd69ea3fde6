//! `kirigami export`: the deployment of a designed sheet for other programs.

use crate::commands::inspect::scene_args::Inspected;
use anyhow::Result;
use app::{output_file, run_folder};
use clap::Args;
use output::vtk_sheet::vtk_states;
use std::path::PathBuf;
use support::vtk;

/// Write the deployment of a designed sheet for ParaView and meshio
///
/// sheet.pvd opens in ParaView: panels and hinges at every load step, moved by the point data
/// `displacement (mm)` (filter Warp By Vector). Lengths in mm, forces in N, angles in rad unless
/// the name says deg. Example: kirigami export configs/scenes/pet-3x3.toml
#[derive(Args)]
pub struct ExportCommand {
    #[command(flatten)]
    designed: Inspected,
    /// Folder for the files
    #[arg(long, value_name = "FOLDER", default_value = "runs/export")]
    out: PathBuf,
}

impl ExportCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, _) = self.designed.chosen().read_run()?;
        let deployment = scene.problem()?.deploy(&design)?;
        let _held = run_folder::hold(&self.out)?;
        let folder = self.out.join("vtk");
        output_file::create_folder(&folder)?;
        let mut grids = Vec::new();
        for (i, state) in vtk_states(&deployment).iter().enumerate() {
            for (part, (kind, grid)) in
                [("panels", &state.panels), ("hinges", &state.hinges)].into_iter().enumerate()
            {
                let name = format!("{kind}-{i:03}.vtu");
                run_folder::write(&folder, &name, &grid.to_vtu())?;
                grids.push((state.time, part, format!("vtk/{name}")));
            }
        }
        run_folder::write(&self.out, "sheet.pvd", &vtk::collection(&grids))?;
        println!(
            "{} states of the sheet in {}",
            grids.len() / 2,
            self.out.join("sheet.pvd").display()
        );
        Ok(())
    }
}
