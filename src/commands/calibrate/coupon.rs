//! `kirigami calibrate coupon`: the cut file of test pieces for the plate of a sheet, and how they are measured.

use crate::commands::calibrate::coupon_folder::{self, READINGS};
use crate::commands::calibrate::instructions::{Expected, instructions};
use crate::commands::cut::{machine as machine_of, write_drawing};
use crate::ui::progress::Progress;
use crate::ui::run_folder;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::analysis::coupon::{SPECIMENS, Specimen, specimens};
use design::scene::Scene;
use design::scene::run_inputs::scene_file;
use output::cut_file::{CouponPiece, CutDrawing, CutLines, Machine, Machines, coupon_drawing};
use std::fmt::Write;
use std::path::PathBuf;

/// Write test pieces to cut from the plate before its sheet, and how to measure them
///
/// Six specimens of 2 x 2 panels: ligaments of three widths, each with square panels (A) and with panels of 60 degrees (B). Each hangs
/// from a hook; weights open it. The folder holds the cut file (cut.dxf, cut.svg), coupon.md with the masses to hang, the distances to
/// expect and what to photograph, and readings.csv, the table to fill in. `kirigami calibrate FOLDER` then finds kerf and stresses. For
/// plates; a film is calibrated on its sheet. `kirigami init` writes a scene for a material. Examples: kirigami calibrate coupon
/// configs/scenes/a4-plate.toml --out runs/coupon;
/// kirigami calibrate coupon my-sheet/scene.toml --for lightburn --out my-sheet/coupon
#[derive(Args)]
pub struct CouponCommand {
    /// Scene (TOML) of the sheet that is cut from the same plate: its material, thickness, [process], weights and ligament range
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Write the cut file for this machine, as `kirigami cut --for` [default: as `kirigami cut`, with the names of the specimens]
    #[arg(long = "for", value_name = "MACHINE")]
    machine: Option<String>,
    /// Table of machines (TOML) [default: the shipped configs/machines.toml]
    #[arg(long, value_name = "FILE", requires = "machine")]
    machines: Option<PathBuf>,
    /// Folder of the coupon
    #[arg(long, value_name = "FOLDER", default_value = "runs/coupon")]
    out: PathBuf,
    /// Replace a coupon whose readings were filled in
    #[arg(long)]
    force: bool,
    /// Print specimens, masses and distances as JSON
    #[arg(long)]
    json: bool,
}

impl CouponCommand {
    pub(super) fn run(&self) -> Result<()> {
        let path = scene_file(&self.scene)?;
        let scene = Scene::read(&path)?;
        let machines = Machines::read(self.machines.as_deref())?;
        let machine = self.machine.as_deref();
        let machine = machine
            .map(|name| machine_of(&machines, name))
            .transpose()?;
        let table = self.out.join(READINGS);
        ensure!(
            self.force || !std::fs::read_to_string(&table).is_ok_and(|text| is_filled(&text)),
            "{} holds readings: choose another folder with --out, or replace them with --force",
            table.display()
        );
        let bar = Progress::new(SPECIMENS, "specimens");
        let specimens = specimens(&scene, &self.out, &mut |done| bar.show(done, None, ""));
        bar.finish();
        let specimens = specimens?;
        let drawing = drawing(&scene, &specimens, machine)?;
        let expected = Expected::of(&specimens)?;
        let empty = empty_table(&specimens);
        let _held = run_folder::hold(&self.out)?;
        for specimen in &specimens {
            let text = specimen.loaded.scene.config.to_toml()?;
            run_folder::write(&self.out, &format!("{}.toml", specimen.name), &text)?;
        }
        write_drawing(&self.out, "cut", &drawing)?;
        let text = instructions(&scene, &specimens, &expected, &self.out);
        run_folder::write(&self.out, "coupon.md", &text)?;
        run_folder::write(&self.out, READINGS, &empty)?;
        // Last: a folder with this file is a coupon.
        let names = specimens.iter().map(|of| of.name.clone()).collect();
        let (file, contents) = coupon_folder::contents(&path, names)?;
        run_folder::write(&self.out, file, &contents)?;
        if self.json {
            let listed: Vec<_> = specimens.iter().map(json).collect();
            println!("{:#}", serde_json::Value::from(listed));
            return Ok(());
        }
        for of in &specimens {
            println!(
                "{}: ligaments {} mm, corner {} deg, up to {} g",
                of.name,
                of.loaded.scene.config.ligament.start,
                of.corner_deg,
                of.loaded.masses_g[of.loaded.masses_g.len() - 1]
            );
        }
        println!(
            "{expected}\nwritten to {}: begin with coupon.md",
            self.out.display()
        );
        Ok(())
    }
}

/// The cut file of all specimens.
fn drawing(scene: &Scene, specimens: &[Specimen], machine: Option<&Machine>) -> Result<CutDrawing> {
    let pieces = specimens.iter().map(|of| {
        let scene = &of.loaded.scene;
        let deployment = scene.problem()?.deploy(&scene.start())?;
        let cuts = CutLines::of(scene, &deployment);
        let panels = &deployment.sheet.panels;
        Ok(CouponPiece {
            name: of.name.clone(),
            number: of.number,
            panels: [panels[0].centroid, panels[3].centroid],
            cuts: cuts.with_context(|| format!("specimen {} cannot be cut", of.name))?,
        })
    });
    let pieces: Vec<CouponPiece> = pieces.collect::<Result<_>>()?;
    Ok(coupon_drawing(&pieces, &scene.material, machine)?)
}

/// The table of the readings, to be filled in.
fn empty_table(specimens: &[Specimen]) -> String {
    let mut text = "# Distance between the facing edges of the two hook holes (mm) under each mass (g), hooks included.\n\
         # Write the mass that hung if it is another one. Leave out what was not read.\n\
         specimen,mass_g,distance_mm\n"
        .to_owned();
    for of in specimens {
        for mass in std::iter::once(&0.0).chain(&of.loaded.masses_g) {
            let _ = writeln!(text, "{},{mass},", of.name);
        }
    }
    text
}

/// Whether a row of the table after its header is more than a specimen and a mass.
fn is_filled(table: &str) -> bool {
    let rows = table
        .lines()
        .filter(|line| !line.trim_start().starts_with('#'));
    let mut rows = rows.skip(1).map(str::trim).filter(|row| !row.is_empty());
    rows.any(|row| !row.ends_with([',', ';']))
}

fn json(of: &Specimen) -> serde_json::Value {
    serde_json::json!({
        "name": of.name, "w_lig": of.loaded.scene.config.ligament.start, "corner_deg": of.corner_deg,
        "masses_g": of.loaded.masses_g, "distance_mm": of.loaded.distance, "displacements_mm": of.loaded.displacements, "opening_deg": of.loaded.opening.to_degrees(),
    })
}
