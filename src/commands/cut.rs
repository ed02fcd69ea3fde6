//! `kirigami cut`: the cut files of a designed sheet, and tiles of paper.

use crate::commands::inspect::scene_args::Inspected;
use anyhow::Result;
use app::cut::{CheckedCut, MachineFile, SheetFiles, machine_named, paper};
use clap::Args;
use output::cut_file::{Machine, Machines, OVERLAP, Tiling};
use scene::Paper;
use serde_json::json;
use std::path::PathBuf;

/// Write the cut files of a designed sheet, or tiles for hand cutting
///
/// Writes DXF, SVG and cut list of the design in the run folder of a scene, with the cutting
/// settings of the scene. With --paper also a PDF at 1:1 on pages that overlap. docs/CUTTING.md
/// describes the files. With --for the file holds what one kind of machine or service accepts.
/// Examples: kirigami cut configs/scenes/demo.toml --paper a4; kirigami cut
/// configs/scenes/a4-plate-service.toml --for laser-service
#[derive(Args)]
pub struct CutCommand {
    #[command(flatten)]
    designed: Inspected,
    /// Folder of the files [default: `cut` in the run folder of the scene; with --for
    /// `cut/MACHINE`]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Write tiles for this paper: a5 to a0, letter or tabloid
    #[arg(long, value_name = "PAPER", value_parser = paper)]
    paper: Option<Paper>,
    /// Write one DXF and one SVG for this machine: laser-service, ponoko, lightburn, knife or
    /// plain; for a service list which refuse the sheet, and why. With --design start before the
    /// search
    #[arg(long = "for", value_name = "MACHINE", conflicts_with = "paper")]
    machine: Option<String>,
    /// Write the files even if the design has errors
    #[arg(long)]
    force: bool,
    /// Print totals and files as JSON; with --for the smallest features, and what services refuse
    #[arg(long)]
    json: bool,
}

impl CutCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (machines, out) = (Machines::shipped(), self.out.as_deref());
        let machine = self.machine.as_deref();
        let machine = machine.map(|name| machine_named(&machines, name)).transpose()?;
        let checked = CheckedCut::new(self.designed.chosen(), self.force)?;
        match machine {
            None => self.print(&checked.cut(self.paper, out)?),
            Some(machine) => {
                self.print_file(machine, &checked.cut_for(&machines, machine, out, self.force)?);
            }
        }
        Ok(())
    }

    fn print(&self, files: &SheetFiles) {
        let SheetFiles { totals, tiling, written } = files;
        if self.json {
            let value = json!({
                "totals": totals, "tiles": tiling.as_ref().map(Tiling::pages), "folder": written.folder,
            });
            println!("{value:#}");
            return;
        }
        println!("{totals}");
        if let Some(tiling) = tiling {
            let [rows, columns] = tiling.counts;
            println!(
                "{} pages: {rows} rows x {columns} columns, which overlap by {OVERLAP} mm, and an overview",
                rows * columns + 1
            );
        }
        println!("written to {}", written.folder.display());
    }

    fn print_file(&self, machine: &Machine, file: &MachineFile) {
        let MachineFile { named, features, verdicts, written } = file;
        if self.json {
            let value = json!({
                "machine": machine.name, "features": features, "services": verdicts, "folder": written.folder,
            });
            println!("{value:#}");
            return;
        }
        println!("{}: {}; {named}\n{features}", machine.name, machine.says);
        verdicts.iter().for_each(|verdict| println!("{verdict}"));
        println!("written to {}", written.folder.display());
    }
}
