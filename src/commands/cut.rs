//! `kirigami cut`: the cut files of a designed sheet, and tiles of paper.

use crate::commands::inspect::scene_args::{DESIGN_OF_RUN, Inspected};
use crate::ui::run_folder;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::objective::design_problem::Deployment;
use design::pattern::design_vector::DesignVector;
use design::scene::{Paper, Scene};
use output::cut_file::{
    CutDrawing, CutLines, Features, Machine, Machines, OVERLAP, Service, SheetDrawing, Tiling,
    attachment_list, cut_list, cut_summary, dxf, mark_errors, svg, tiles_pdf,
};
use output::report::{Warning, warnings};
use serde::Serialize;
use serde_json::json;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};
use support::nearest::nearest;
use support::severity::Severity;

/// Write the cut files of a designed sheet, or tiles for hand cutting
///
/// Writes DXF, SVG and cut list of the design in the run folder of a scene, with the cutting settings of the scene.
/// With --paper also a PDF at 1:1 on pages that overlap. docs/CUTTING.md describes the files. With --for the file holds what one kind of machine or service accepts. Examples:
/// kirigami cut configs/scenes/demo.toml --paper a4;
/// kirigami cut configs/scenes/a4-plate.toml --for laser-service
#[derive(Args)]
#[command(mut_arg("design", |arg| arg.help(DESIGN_OF_RUN)))]
pub struct CutCommand {
    #[command(flatten)]
    designed: Inspected,
    /// Folder of the files [default: `cut` in the run folder of the scene; with --for `cut/MACHINE`]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Write tiles for this paper: a5 to a0, letter or tabloid
    #[arg(long, value_name = "PAPER", value_parser = paper)]
    paper: Option<Paper>,
    /// Write one DXF and one SVG for this machine: laser-service, lightburn, knife, plain or one of --machines; for a service
    /// list which refuse the sheet, and why. With --design start before the search
    #[arg(long = "for", value_name = "MACHINE", conflicts_with = "paper")]
    machine: Option<String>,
    /// Table of machines and services (TOML) [default: the shipped configs/machines.toml]
    #[arg(long, value_name = "FILE", requires = "machine")]
    machines: Option<PathBuf>,
    /// Write the files even if the design has errors
    #[arg(long)]
    force: bool,
    /// Print totals and files as JSON; with --for the smallest features, and what services refuse
    #[arg(long)]
    json: bool,
}

/// What is written of a sheet.
struct Pieces {
    whole: SheetDrawing,
    /// The whole sheet with marks and notes, for a machine.
    annotated: CutDrawing,
    list: String,
    attachments: String,
    summary: String,
    tiling: Option<Tiling>,
}

impl CutCommand {
    /// Writes tiles for a paper, besides the usual files, in the run in a folder.
    #[cfg(feature = "pipeline")]
    pub(crate) fn tiles_of_run(run: &Path, paper: &str) -> Result<Written> {
        let paper = Some(self::paper(paper).map_err(anyhow::Error::msg)?);
        let (_, written) = (Self {
            paper,
            ..Self::of_run(run)
        })
        .cut()?;
        Ok(written)
    }

    /// Writes the file of a machine in the run in a folder.
    #[cfg(feature = "pipeline")]
    pub(crate) fn machine_file_of_run(run: &Path, name: &str) -> Result<(Written, Vec<Verdict>)> {
        let machines = Machines::read(None)?;
        let machine = machine(&machines, name)?;
        let file = Self::of_run(run).cut_one_for(machine, services(&machines, machine))?;
        Ok((file.written, file.verdicts))
    }

    #[cfg(feature = "pipeline")]
    fn of_run(run: &Path) -> Self {
        Self {
            designed: Inspected {
                scene: run.to_owned(),
                design: None,
                weights: None,
            },
            out: None,
            paper: None,
            machine: None,
            machines: None,
            force: false,
            json: false,
        }
    }

    pub(crate) fn run(&self) -> Result<()> {
        if let Some(name) = &self.machine {
            return self.cut_for(name);
        }
        let (pieces, written) = self.cut()?;
        self.print(&pieces, &written.folder)
    }

    /// Writes the cut files, and tiles.
    fn cut(&self) -> Result<(Pieces, Written)> {
        let (scene, design, _) = self.designed.read_run()?;
        let pieces = self.pieces(&scene, &design)?;
        let out = match &self.out {
            Some(out) => out.clone(),
            None => scene.output().join("cut"),
        };
        let _held = run_folder::hold(&out)?;
        remove_earlier(&out)?;
        let mut written = Written::to(&out)?;
        self.write(&pieces, &scene.config.title, &mut written)?;
        Ok((pieces, written))
    }

    /// Writes the files of a machine, and prints what services refuse.
    fn cut_for(&self, name: &str) -> Result<()> {
        let machines = Machines::read(self.machines.as_deref())?;
        let machine = machine(&machines, name)?;
        ensure!(
            Path::new(name).file_name().is_some_and(|file| file == name),
            "the machine {name} cannot name a folder: give it a name without slashes"
        );
        let file = self.cut_one_for(machine, services(&machines, machine))?;
        self.print_file(machine, &file);
        Ok(())
    }

    fn cut_one_for(&self, machine: &Machine, services: &[Service]) -> Result<MachineFile> {
        let (scene, design, named) = self.designed.read_run()?;
        let (_, cuts, errors) = self.checked(&scene, &design)?;
        let mut drawing = machine.drawing(&cuts)?;
        mark_errors(&mut drawing, &errors);
        let out = match &self.out {
            Some(out) => out.clone(),
            None => scene.output().join("cut").join(&machine.name),
        };
        let _held = run_folder::hold(&out)?;
        let mut written = Written::to(&out)?;
        written.drawing("cut", &drawing)?;
        let features = cuts.features();
        let verdicts = services.iter().map(|service| Verdict {
            name: service.name.clone(),
            source: service.source.clone(),
            refuses: service.refusals(&features, scene.material.thickness),
        });
        Ok(MachineFile {
            verdicts: verdicts.collect(),
            features,
            named,
            written,
        })
    }

    fn print_file(&self, machine: &Machine, file: &MachineFile) {
        let MachineFile {
            named,
            features,
            verdicts,
            written,
        } = file;
        if self.json {
            let value = json!({
                "machine": machine.name, "features": features, "services": verdicts, "folder": written.folder,
            });
            println!("{value:#}");
            return;
        }
        println!("{}: {}; {named}\n{features}", machine.name, machine.says);
        for Verdict { name, refuses, .. } in verdicts {
            println!("{name}: {}", verdict(refuses));
        }
        println!("written to {}", written.folder.display());
    }

    /// The deployed sheet and its cuts, with the errors of the design; an error if it has any, unless it is forced.
    fn checked(
        &self,
        scene: &Scene,
        design: &DesignVector,
    ) -> Result<(Deployment, CutLines, Vec<String>)> {
        let deployment = scene.problem()?.deploy(design)?;
        let cuts = CutLines::of(scene, &deployment);
        let found = warnings(scene, &deployment, &cuts);
        let cuts = cuts?;
        let errors = found.iter().filter(|it| it.severity == Severity::Error);
        let errors: Vec<String> = errors.map(Warning::to_string).collect();
        ensure!(
            self.force || errors.is_empty(),
            "no cut file: {}; --force writes one",
            errors.join("; ")
        );
        Ok((deployment, cuts, errors))
    }

    /// The drawings of a design.
    fn pieces(&self, scene: &Scene, design: &DesignVector) -> Result<Pieces> {
        let (deployment, cuts, errors) = self.checked(scene, design)?;
        let sheet = &deployment.sheet;
        let mut whole = SheetDrawing::new(&cuts, sheet, &scene.material);
        let mut annotated = whole.annotated();
        mark_errors(&mut annotated, &errors);
        mark_errors(&mut whole.numbered, &errors);
        let tiling = (self.paper)
            .map(|paper| Tiling::new(paper, whole.numbered.bounds()))
            .transpose()?;
        Ok(Pieces {
            list: cut_list(sheet, &cuts),
            attachments: attachment_list(&cuts),
            summary: cut_summary(&cuts, &whole.totals),
            whole,
            annotated,
            tiling,
        })
    }

    fn write(&self, pieces: &Pieces, title: &str, written: &mut Written) -> Result<()> {
        written.drawing("cut", &pieces.annotated)?;
        written.file("cut-list.csv", &pieces.list)?;
        written.file("attachments.csv", &pieces.attachments)?;
        written.file("cut-summary.csv", &pieces.summary)?;
        if let (Some(paper), Some(tiling)) = (self.paper, &pieces.tiling) {
            let whole = &pieces.whole;
            let tiles = tiles_pdf(&whole.numbered, tiling, title, &whole.notes);
            written.file(&tiles_name(paper), &tiles)?;
        }
        Ok(())
    }

    fn print(&self, pieces: &Pieces, out: &Path) -> Result<()> {
        let tiling = &pieces.tiling;
        if self.json {
            let value = json!({
                "totals": pieces.whole.totals,
                "tiles": tiling.as_ref().map(Tiling::pages),
                "folder": out,
            });
            println!("{}", serde_json::to_string_pretty(&value)?);
            return Ok(());
        }
        println!("{}", pieces.whole.totals);
        if let Some(Tiling {
            counts: [rows, columns],
            ..
        }) = tiling
        {
            println!(
                "{} pages: {rows} rows x {columns} columns, which overlap by {OVERLAP} mm, and an overview",
                rows * columns + 1
            );
        }
        println!("written to {}", out.display());
        Ok(())
    }
}

/// Files that were written.
pub(crate) struct Written {
    folder: PathBuf,
    names: Vec<String>,
}

impl Written {
    /// No file yet, in a folder that exists.
    fn to(folder: &Path) -> Result<Self> {
        Ok(Self {
            folder: folder.canonicalize()?,
            names: Vec::new(),
        })
    }

    fn file(&mut self, name: &str, contents: &(impl AsRef<[u8]> + ?Sized)) -> Result<()> {
        run_folder::write(&self.folder, name, contents)?;
        self.names.push(name.to_owned());
        Ok(())
    }

    /// The DXF and the SVG of a drawing.
    fn drawing(&mut self, name: &str, drawing: &CutDrawing) -> Result<()> {
        write_drawing(&self.folder, name, drawing)?;
        let names = ["dxf", "svg"].map(|kind| format!("{name}.{kind}"));
        self.names.extend(names);
        Ok(())
    }
}

impl Display for Written {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} in {}", self.names.join(", "), self.folder.display())
    }
}

/// What a service says of a sheet.
#[derive(Clone, Serialize)]
pub(crate) struct Verdict {
    name: String,
    source: String,
    refuses: Vec<String>,
}

/// The file of a machine, and what services say of it.
struct MachineFile {
    /// The design.
    named: String,
    features: Features,
    verdicts: Vec<Verdict>,
    written: Written,
}

/// The services whose limits count for the files of a machine.
fn services<'a>(machines: &'a Machines, machine: &Machine) -> &'a [Service] {
    match machine.services {
        true => &machines.service,
        false => &[],
    }
}

/// The machine with a name.
pub(crate) fn machine<'a>(machines: &'a Machines, name: &str) -> Result<&'a Machine> {
    let machine = machines.machine.iter().find(|machine| machine.name == name);
    machine.with_context(|| {
        let known = machines.machine.iter().map(|machine| &*machine.name);
        let known: Vec<&str> = known.collect();
        let near = nearest(name, known.iter().copied());
        let near = near.map_or(String::new(), |near| format!("; did you mean {near}?"));
        format!("unknown machine {name}: use {}{near}", known.join(", "))
    })
}

/// Writes the DXF and the SVG of a drawing.
pub(crate) fn write_drawing(out: &Path, name: &str, drawing: &CutDrawing) -> Result<()> {
    run_folder::write(out, &format!("{name}.dxf"), &dxf(drawing))?;
    run_folder::write(out, &format!("{name}.svg"), &svg(drawing))
}

/// What a service says of a sheet.
fn verdict(refuses: &[String]) -> String {
    match refuses.is_empty() {
        true => "no published limit is broken".to_owned(),
        false => format!("refuses {}", refuses.join("; ")),
    }
}

/// Removes tiles of an earlier call, which may be of another design.
fn remove_earlier(folder: &Path) -> Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        if entry.file_type()?.is_file() && is_tiles(&entry.file_name().to_string_lossy()) {
            std::fs::remove_file(&path)
                .with_context(|| format!("cannot remove {}", path.display()))?;
        }
    }
    Ok(())
}

/// Whether a file with this name is written with --paper.
fn is_tiles(name: &str) -> bool {
    let paper = (name.strip_prefix("tiles-")).and_then(|rest| rest.strip_suffix(".pdf"));
    paper
        .and_then(|paper| self::paper(paper).ok())
        .is_some_and(|paper| name == tiles_name(paper))
}

fn tiles_name(paper: Paper) -> String {
    format!("tiles-{paper}.pdf")
}

fn paper(name: &str) -> Result<Paper, String> {
    let refused = |_| "must be a5, a4, a3, a2, a1, a0, letter or tabloid".into();
    name.parse().map_err(refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_that_a_cut_writes_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let own = ["tiles-of-mine.pdf", "tiles-a4.pdf.bak", "cut.dxf"];
        let ours = ["tiles-a3.pdf", "tiles-letter.pdf"];
        for name in own.iter().chain(&ours) {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join("tiles-a5.pdf")).unwrap();
        remove_earlier(folder.path()).unwrap();
        for name in own.iter().chain(&["tiles-a5.pdf"]) {
            assert!(folder.path().join(name).exists(), "{name}");
        }
        for name in ours {
            assert!(!folder.path().join(name).exists(), "{name}");
        }
    }
}
