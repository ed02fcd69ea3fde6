//! `kirigami cut`: the cut files of a designed sheet, tiles of paper, and parts for a bed.

use crate::commands::inspect::scene_args::{DESIGN_OF_RUN, Inspected};
use crate::ui::run_folder;
use crate::ui::width_by_height::width_by_height;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::output::cut_file::{
    CutDrawing, CutLines, OVERLAP, Paper, SheetDrawing, Split, Tiling, cut_list, cut_summary,
    mark_errors, split, write_dxf, write_pdf, write_svg,
};
use design::output::report::{Severity, Warning, warnings};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Write the cut files of a designed sheet, PDF tiles for hand cutting, and parts for a bed or a roll
///
/// Writes DXF, SVG and cut list of the design in the run folder of a scene, with the cutting settings of the scene.
/// With --paper also a PDF at 1:1 on pages that overlap, with --bed also one DXF and SVG a part. docs/CUTTING.md
/// describes the files. Example: kirigami cut configs/scenes/demo.toml --paper a4 --bed 900x600
#[derive(Args)]
#[command(mut_arg("design", |arg| arg.help(DESIGN_OF_RUN)))]
pub struct CutCommand {
    #[command(flatten)]
    designed: Inspected,
    /// Folder of the files [default: `cut` in the run folder of the scene]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Write tiles for this paper: a4, a3 or letter
    #[arg(long, value_name = "PAPER", value_parser = paper)]
    paper: Option<(Paper, String)>,
    /// Write parts that fit on a bed of this width and height (mm); the height of a roll is inf
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = bed)]
    bed: Option<[f64; 2]>,
    /// Width of the adhesive tape on either side of a seam between parts (mm)
    #[arg(long, value_name = "MM", default_value_t = 20.0, value_parser = lap)]
    lap: f64,
    /// Write the files even if the design has errors
    #[arg(long)]
    force: bool,
    /// Print totals, parts and files as JSON
    #[arg(long)]
    json: bool,
}

impl CutCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design) = self.designed.read_run()?;
        let deployment = scene.problem()?.deploy(&design)?;
        let (pattern, sheet) = (&deployment.pattern, &deployment.sheet);
        let cuts = CutLines::new(pattern, sheet, scene.config.cutting);
        let found = warnings(&scene, &deployment, &cuts);
        let cuts = cuts?;
        let errors = found.iter().filter(|it| it.severity == Severity::Error);
        let errors: Vec<String> = errors.map(Warning::to_string).collect();
        ensure!(
            self.force || errors.is_empty(),
            "no cut file: {}; --force writes one",
            errors.join("; ")
        );

        let mut drawing = SheetDrawing::new(&cuts, sheet, &scene.material);
        let mut annotated = drawing.annotated();
        mark_errors(&mut annotated, &errors);
        mark_errors(&mut drawing.numbered, &errors);
        let tiling = (self.paper.as_ref())
            .map(|(paper, _)| Tiling::new(*paper, drawing.numbered.bounds()))
            .transpose()?;
        let mut parts = (self.bed)
            .map(|bed| split(&cuts, sheet, bed, self.lap))
            .transpose()?;
        for part in parts.iter_mut().flat_map(|split| &mut split.parts) {
            mark_errors(&mut part.drawing, &errors);
        }

        let out = match &self.out {
            Some(out) => out.clone(),
            None => scene.output().join("cut"),
        };
        let _held = run_folder::hold(&out)?;
        remove_earlier(&out)?;
        write_dxf(&out.join("cut.dxf"), &annotated)?;
        write_svg(&out.join("cut.svg"), &annotated)?;
        run_folder::write(&out, "cut-list.csv", &cut_list(sheet, &cuts))?;
        run_folder::write(
            &out,
            "cut-summary.csv",
            &cut_summary(&cuts, &drawing.totals),
        )?;
        if let (Some((_, name)), Some(tiling)) = (&self.paper, &tiling) {
            let path = out.join(format!("tiles-{name}.pdf"));
            let title = &scene.config.title;
            write_pdf(&path, &drawing.numbered, tiling, title, &drawing.notes)?;
        }
        if let Some(parts) = &parts {
            for (i, part) in parts.parts.iter().enumerate() {
                let stem = out.join(format!("part-{}", i + 1));
                write_dxf(&stem.with_extension("dxf"), &part.drawing)?;
                write_svg(&stem.with_extension("svg"), &part.drawing)?;
            }
            run_folder::write(&out, "joints.csv", &parts.joint_list())?;
        }
        if self.json {
            let value = json!({
                "totals": drawing.totals,
                "tiles": tiling.map(|tiling| tiling.pages()),
                "parts": parts.map(|split| split.parts.iter().map(|part| json!({
                    "origin": part.origin, "size": part.size, "area": part.area,
                })).collect::<Vec<_>>()),
                "folder": out,
            });
            println!("{}", serde_json::to_string_pretty(&value)?);
            return Ok(());
        }
        println!("{}", drawing.totals);
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
        if let Some(split) = &parts {
            print_parts(split, CutDrawing::extent(drawing.numbered.cuts()));
        }
        println!("written to {}", out.canonicalize()?.display());
        Ok(())
    }
}

fn print_parts(split: &Split, [low, high]: [[f64; 2]; 2]) {
    if split.parts.len() > 1 {
        println!(
            "the whole sheet takes {:.1} x {:.1} mm, with the kerf and the over-run beyond its edges",
            high[0] - low[0],
            high[1] - low[1]
        );
    }
    for (i, part) in split.parts.iter().enumerate() {
        let ([x, y], [width, height]) = (part.origin, part.size);
        println!(
            "part {}: {width:.1} x {height:.1} mm, from ({x:.1}, {y:.1}) mm of the sheet",
            i + 1
        );
    }
    let hinges = split.joints.iter().map(|(seam, _)| seam.hinge.to_string());
    let hinges: Vec<String> = hinges.collect();
    match hinges.len() {
        0 => println!("the sheet fits on the bed as a whole: no joints"),
        count => println!(
            "{count} seams, each across a panel beside a hinge, so that every ligament stays whole; tape {} mm to \
             either side. Hinges: {}",
            split.lap,
            hinges.join(", ")
        ),
    }
}

/// Removes the tiles and parts of an earlier call, which may be of another design.
fn remove_earlier(folder: &Path) -> Result<()> {
    let made = |name: &str| {
        name.starts_with("tiles-") || name.starts_with("part-") || name == "joints.csv"
    };
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path
            .file_name()
            .and_then(|name| name.to_str())
            .is_some_and(made)
        {
            std::fs::remove_file(&path)
                .with_context(|| format!("cannot remove {}", path.display()))?;
        }
    }
    Ok(())
}

fn paper(name: &str) -> Result<(Paper, String), String> {
    let name = name.to_lowercase();
    let paper = match name.as_str() {
        "a4" => Paper::A4,
        "a3" => Paper::A3,
        "letter" => Paper::Letter,
        _ => return Err("must be a4, a3 or letter".into()),
    };
    Ok((paper, name))
}

fn bed(text: &str) -> Result<[f64; 2], String> {
    width_by_height(text)
        .ok_or_else(|| "must be WIDTHxHEIGHT in mm, like 1000x600 or 1300xinf".into())
}

fn lap(text: &str) -> Result<f64, String> {
    let lap = text.parse().ok().filter(|lap| (0.0..=200.0).contains(lap));
    lap.ok_or_else(|| "must be 0 to 200 mm".into())
}
