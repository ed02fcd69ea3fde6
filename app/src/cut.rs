//! The cut files of a designed sheet: for a person, for paper and for machines.

use crate::{chosen::Chosen, run_folder};
use anyhow::{Context, Result, ensure};
use design::objective::design_problem::Deployment;
use output::{
    cut_file::{
        CutDrawing, CutLines, Features, Machine, Machines, SheetDrawing, Tiling, Totals,
        attachment_list, cut_list, cut_summary, dxf, mark_errors, svg, tiles_pdf,
    },
    report::{Warning, warnings},
};
use scene::{Paper, Scene};
use serde::Serialize;
use std::{
    fmt::{self, Display, Formatter},
    path::{Path, PathBuf},
};
use support::{Joined, nearest::unknown, severity::Severity};

/// A design that may be cut.
pub struct CheckedCut {
    scene: Scene,
    /// What the design is.
    named: String,
    deployment: Deployment,
    cuts: CutLines,
    /// The errors of a design whose files are forced.
    errors: Vec<String>,
}

/// The files of a sheet.
pub struct SheetFiles {
    /// Length of the cuts and number of parts.
    pub totals: Totals,
    /// The tiles, if a paper was given.
    pub tiling: Option<Tiling>,
    /// The files.
    pub written: Written,
}

/// Writes tiles for a paper, besides the usual files, in the run in a folder.
pub fn tiles_of_run(run: &Path, paper: &str) -> Result<Written> {
    let paper = self::paper(paper).map_err(anyhow::Error::msg)?;
    let run = CheckedCut::new(Chosen { scene: run, design: None }, false)?;
    Ok(run.cut(Some(paper), None)?.written)
}

/// Writes the file of a machine in the run in a folder.
pub fn machine_file_of_run(run: &Path, name: &str) -> Result<(Written, Vec<Verdict>)> {
    let machines = Machines::shipped();
    let machine = machine_named(&machines, name)?;
    let run = CheckedCut::new(Chosen { scene: run, design: None }, false)?;
    let file = run.cut_for(&machines, machine, None, false)?;
    Ok((file.written, file.verdicts))
}

impl CheckedCut {
    /// Reads and deploys the design; an error if it has errors, unless it is forced.
    pub fn new(chosen: Chosen, force: bool) -> Result<Self> {
        let (scene, design, named) = chosen.read_run()?;
        let deployment = scene.problem()?.deploy(&design)?;
        let cuts = CutLines::of(&scene, &deployment);
        let found = warnings(&scene, &deployment, &cuts);
        let errors = found.iter().filter(|it| it.severity == Severity::Error);
        let errors: Vec<String> = errors.map(Warning::to_string).collect();
        let cuts = cuts?;
        ensure!(
            force || errors.is_empty(),
            "no cut file: {}; --force writes one",
            errors.join("; ")
        );
        Ok(Self { scene, named, deployment, cuts, errors })
    }

    /// Writes the cut files, and tiles.
    pub fn cut(&self, paper: Option<Paper>, out: Option<&Path>) -> Result<SheetFiles> {
        let Self { scene, cuts, .. } = self;
        let sheet = &self.deployment.sheet;
        let mut whole = SheetDrawing::new(cuts, sheet, &scene.material);
        let mut annotated = whole.annotated();
        for drawing in [&mut annotated, &mut whole.numbered] {
            mark_errors(drawing, &self.errors);
        }
        let tiling = paper.map(|paper| Tiling::new(paper, whole.numbered.bounds())).transpose()?;
        let out = self.out_or(out, "cut");
        let _held = run_folder::hold(&out)?;
        remove_earlier(&out)?;
        let mut written = Written::to(&out)?;
        written.drawing(&annotated)?;
        written.file("cut-list.csv", &cut_list(sheet, cuts))?;
        written.file("attachments.csv", &attachment_list(cuts, None))?;
        written.file("cut-summary.csv", &cut_summary(cuts, &whole.totals))?;
        if let Some((paper, tiling)) = paper.zip(tiling.as_ref()) {
            let title = &scene.config.title;
            let pdf = tiles_pdf(&whole.numbered, tiling, title, &whole.notes);
            written.file(&tiles_name(paper), &pdf)?;
        }
        Ok(SheetFiles { totals: whole.totals, tiling, written })
    }

    /// Writes the file of a machine.
    pub fn cut_for(
        &self,
        machines: &Machines,
        machine: &Machine,
        out: Option<&Path>,
        force: bool,
    ) -> Result<MachineFile> {
        let mut drawing = machine.drawing(&self.cuts)?;
        mark_errors(&mut drawing, &self.errors);
        let features = self.cuts.features();
        let services = machines.service.iter().filter(|it| it.machine == machine.name);
        let verdicts: Vec<Verdict> = services
            .map(|service| Verdict {
                name: service.name.clone(),
                source: service.source.clone(),
                refuses: service.refusals(&features, self.scene.material.thickness),
            })
            .collect();
        let accepted = verdicts.iter().any(|verdict| verdict.refuses.is_empty());
        let said = verdicts.iter().map(Verdict::to_string).joined("; ");
        ensure!(
            force || accepted || verdicts.is_empty(),
            "no service cuts this sheet: {said}; --force writes the file"
        );
        let out = self.out_or(out, &format!("cut/{}", machine.name));
        let _held = run_folder::hold(&out)?;
        let mut written = Written::to(&out)?;
        written.drawing(&drawing)?;
        Ok(MachineFile { verdicts, features, named: self.named.clone(), written })
    }

    /// The folder of the files: by default one in the run folder of the scene.
    fn out_or(&self, out: Option<&Path>, folder: &str) -> PathBuf {
        out.map_or_else(|| self.scene.output().join(folder), Path::to_owned)
    }
}

/// Files that were written.
#[derive(derive_more::Display)]
#[display("{} in {}", names.join(", "), folder.display())]
pub struct Written {
    /// Their folder.
    pub folder: PathBuf,
    names: Vec<String>,
}

impl Written {
    /// No file yet, in a folder that exists.
    fn to(folder: &Path) -> Result<Self> {
        Ok(Self { folder: folder.canonicalize()?, names: Vec::new() })
    }

    fn file(&mut self, name: &str, contents: &(impl AsRef<[u8]> + ?Sized)) -> Result<()> {
        run_folder::write(&self.folder, name, contents)?;
        self.names.push(name.to_owned());
        Ok(())
    }

    /// The DXF and the SVG of a drawing.
    fn drawing(&mut self, drawing: &CutDrawing) -> Result<()> {
        write_drawing(&self.folder, "cut", drawing)?;
        self.names.extend(["cut.dxf", "cut.svg"].map(str::to_owned));
        Ok(())
    }
}

/// The answer of a service to a sheet.
#[derive(Serialize)]
pub struct Verdict {
    name: String,
    source: String,
    refuses: Vec<String>,
}

impl Display for Verdict {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match &self.refuses[..] {
            [] => write!(f, "{}: no published limit is broken", self.name),
            refuses => write!(f, "{} refuses {}", self.name, refuses.join(", ")),
        }
    }
}

/// The file of a machine, and the answers of services to it.
pub struct MachineFile {
    /// The design.
    pub named: String,
    /// The smallest features of the cuts.
    pub features: Features,
    /// The answers of the services that take the file.
    pub verdicts: Vec<Verdict>,
    /// The files.
    pub written: Written,
}

/// The machine with a name.
pub fn machine_named<'a>(machines: &'a Machines, name: &str) -> Result<&'a Machine> {
    let machine = machines.machine.iter().find(|machine| machine.name == name);
    let known = machines.machine.iter().map(|machine| &*machine.name);
    machine.with_context(|| unknown("machine", name, known))
}

/// Writes the DXF and the SVG of a drawing.
pub fn write_drawing(out: &Path, name: &str, drawing: &CutDrawing) -> Result<()> {
    run_folder::write(out, &format!("{name}.dxf"), &dxf(drawing))?;
    run_folder::write(out, &format!("{name}.svg"), &svg(drawing))
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
    paper.and_then(|paper| self::paper(paper).ok()).is_some_and(|paper| name == tiles_name(paper))
}

fn tiles_name(paper: Paper) -> String {
    format!("tiles-{paper}.pdf")
}

/// The paper with a name.
pub fn paper(name: &str) -> Result<Paper, String> {
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
