//! `kirigami cut --stock`: several designs, each one or several times, on sheets of one stock.

use crate::commands::cut::nest_args::{PLACES, PLAN};
use crate::commands::cut::{CutCommand, remove_earlier, verdict};
use crate::commands::inspect::scene_args::Inspected;
use crate::ui::progress::Progress;
use crate::ui::run_folder;
use crate::ui::table::table;
use anyhow::{Context, Result, ensure};
use design::geometry::polygon::area;
use design::scene::{Scene, Stock};
use output::cut_file::{
    CutLines, Machine, NestedDesign, NestedSheet, NestingStock, Place, Service, cut_list, dxf,
    mark_errors, nest, nested_cut_list, nesting_plan, svg_on_page,
};
use serde_json::json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A design that is read, and the errors with which its files are forced.
struct Read {
    name: String,
    scene: Scene,
    cuts: CutLines,
    list: String,
    errors: Vec<String>,
}

impl CutCommand {
    /// Writes one file a sheet of stock for a machine, and prints what lies where.
    pub(super) fn nest(&self, stock: Stock, machine: &Machine, services: &[Service]) -> Result<()> {
        let read = self.read_all()?;
        alike(&read, machine)?;
        let copies = self.nesting.copies_of(read.len())?;
        let pieces = copies.iter().sum();
        let designs = std::iter::zip(&read, copies)
            .map(|(read, copies)| {
                Ok(NestedDesign {
                    name: read.name.clone(),
                    copies,
                    paths: machine.paths(&read.cuts)?,
                    reach: machine.reach(&read.cuts),
                    kerf: read.cuts.kerf,
                    area: area(&read.cuts.outline),
                })
            })
            .collect::<Result<Vec<_>>>()?;
        let margins = read.iter().map(|read| read.cuts.cutting.margin);
        let stock = NestingStock {
            size: stock.size(),
            margin: self.nesting.margin.unwrap_or(margins.fold(0.0, f64::max)),
            gap: self.nesting.gap,
            turns: !self.nesting.no_turn,
        };
        let progress = Progress::new(pieces, "pieces");
        progress.show(0, None, "are laid, and their cuts ordered");
        let sheets = nest(&designs, &stock);
        progress.finish();
        let mut sheets = sheets?;
        for sheet in &mut sheets {
            let here: BTreeSet<usize> = sheet.places.iter().map(|place| place.design).collect();
            let errors = here.into_iter().flat_map(|design| {
                let Read { name, errors, .. } = &read[design];
                errors.iter().map(move |error| format!("{name}: {error}"))
            });
            mark_errors(&mut sheet.drawing, &errors.collect::<Vec<_>>());
        }
        let out = match &self.out {
            Some(out) => out.clone(),
            // The files belong to none of the runs: beside the first of them.
            None => (read[0].scene.output().parent().unwrap_or(Path::new("")))
                .join("nest")
                .join(&machine.name),
        };
        let _held = run_folder::hold(&out)?;
        remove_earlier(&out)?;
        for (i, sheet) in sheets.iter().enumerate() {
            let [low, high] = sheet.drawing.bounds();
            let low = low.map(|x| x.min(0.0));
            let high = [0, 1].map(|axis| f64::max(high[axis], stock.size[axis]));
            let (name, drawing) = (file(i), &sheet.drawing);
            run_folder::write(&out, &format!("{name}.dxf"), &dxf(drawing))?;
            let page = svg_on_page(drawing, [low, high]);
            run_folder::write(&out, &format!("{name}.svg"), &page)?;
        }
        let lists = read.iter().map(|read| (&*read.name, read.list.clone()));
        run_folder::write(&out, "cut-list.csv", &nested_cut_list(lists))?;
        run_folder::write(&out, PLACES, &place_list(&designs, &sheets))?;
        run_folder::write(&out, PLAN, &nesting_plan(&designs, &stock, &sheets))?;
        let out = out.canonicalize()?;
        let nested = Nested {
            machine,
            designs: &designs,
            stock,
            sheets: &sheets,
            refusals: (services.iter())
                .map(|service| (service, refusals(service, &read)))
                .collect(),
            out: &out,
        };
        match self.json {
            true => nested.print_json(),
            false => nested.print(),
        }
        Ok(())
    }

    /// The designs in the order of the command line.
    fn read_all(&self) -> Result<Vec<Read>> {
        let scenes: Vec<&PathBuf> = std::iter::once(&self.designed.scene)
            .chain(&self.nesting.others)
            .collect();
        let progress = Progress::new(scenes.len(), "designs");
        let mut read: Vec<Read> = Vec::with_capacity(scenes.len());
        for (i, path) in scenes.into_iter().enumerate() {
            let name = path.components().collect::<PathBuf>().display().to_string();
            progress.show(i, None, &name);
            ensure!(
                read.iter().all(|other| other.name != name),
                "{name} is named twice: name it once, and give the number of its pieces with --copies"
            );
            let inspected = Inspected {
                scene: path.clone(),
                design: self.designed.design.clone(),
                weights: self.designed.weights.clone(),
            };
            let (scene, design, _) = inspected.read_run()?;
            let (deployment, cuts, errors) = self
                .checked(&scene, &design)
                .with_context(|| name.clone())?;
            read.push(Read {
                name,
                scene,
                list: cut_list(&deployment.sheet, &cuts),
                cuts,
                errors,
            });
        }
        progress.finish();
        Ok(read)
    }
}

/// An error unless one sheet of stock and one tool are right for all designs.
fn alike(read: &[Read], machine: &Machine) -> Result<()> {
    let of = |read: &Read| {
        let material = &read.scene.material;
        format!(
            "{} is of {}, {} mm thick",
            read.name, material.name, material.thickness
        )
    };
    let [first, others @ ..] = read else {
        return Ok(());
    };
    for other in others {
        let [one, two] = [first, other].map(|read| &read.scene.material);
        ensure!(
            one.name == two.name && one.thickness == two.thickness,
            "{}, and {}: a sheet of stock has one material and one thickness. Nest them on sheets of their own",
            of(first),
            of(other)
        );
        ensure!(
            !machine.cuts_lines() || first.cuts.kerf == other.cuts.kerf,
            "{} has a kerf of {} mm, and {} of {} mm: one tool cuts all slits. Use the same process.kerf, or a machine that cuts slots",
            first.name,
            first.cuts.kerf,
            other.name,
            other.cuts.kerf
        );
    }
    Ok(())
}

/// What a service refuses of the designs, each with its name.
fn refusals(service: &Service, read: &[Read]) -> Vec<String> {
    let of_design = |read: &Read| {
        let refuses = service.refusals(&read.cuts.features(), read.scene.material.thickness);
        (!refuses.is_empty()).then(|| format!("{}: {}", read.name, refuses.join("; ")))
    };
    read.iter().filter_map(of_design).collect()
}

/// The name of the files of a sheet, counted from 0.
fn file(sheet: usize) -> String {
    format!("stock-{}", sheet + 1)
}

/// One row a piece: its sheet, its design, and the rectangle of its paths from the lower left corner of the stock.
fn place_list(designs: &[NestedDesign], sheets: &[NestedSheet]) -> String {
    let mut text = "sheet,design,copy,turned,x_mm,y_mm,width_mm,height_mm\n".to_owned();
    for (i, sheet) in sheets.iter().enumerate() {
        for place in &sheet.places {
            let Place {
                copy,
                turned,
                corner: [x, y],
                size: [width, height],
                ..
            } = place;
            let name = designs[place.design].name.replace('"', "\"\"");
            text += &format!(
                "{},\"{name}\",{copy},{turned},{x:.3},{y:.3},{width:.3},{height:.3}\n",
                i + 1
            );
        }
    }
    text
}

/// What is printed.
struct Nested<'a> {
    machine: &'a Machine,
    designs: &'a [NestedDesign],
    stock: NestingStock,
    sheets: &'a [NestedSheet],
    refusals: Vec<(&'a Service, Vec<String>)>,
    out: &'a Path,
}

impl Nested<'_> {
    /// The fraction of a sheet of stock that its pieces take.
    fn used(&self, sheet: &NestedSheet) -> f64 {
        let pieces = sheet
            .places
            .iter()
            .map(|place| self.designs[place.design].area);
        pieces.sum::<f64>() / self.stock.size.iter().product::<f64>()
    }

    fn print(&self) {
        let mut rows = table([
            "piece",
            "sheet",
            "x (mm)",
            "y (mm)",
            "width (mm)",
            "height (mm)",
            "turned",
        ]);
        for (i, sheet) in self.sheets.iter().enumerate() {
            for place in &sheet.places {
                let design = &self.designs[place.design];
                let [x, y] = place.corner;
                let [width, height] = place.size;
                rows.add_row([
                    format!("{} #{}", design.name, place.copy),
                    (i + 1).to_string(),
                    format!("{x:.1}"),
                    format!("{y:.1}"),
                    format!("{width:.1}"),
                    format!("{height:.1}"),
                    if place.turned { "yes" } else { "no" }.to_owned(),
                ]);
            }
        }
        println!("{}: {}\n\n{rows}\n", self.machine.name, self.machine.says);
        let [width, height] = self.stock.size;
        let pieces: usize = self.designs.iter().map(|design| design.copies).sum();
        for (i, sheet) in self.sheets.iter().enumerate() {
            println!(
                "sheet {} of {}, {width} x {height} mm: {} of {pieces} pieces, {:.0} % of its area used",
                i + 1,
                self.sheets.len(),
                sheet.places.len(),
                100.0 * self.used(sheet)
            );
        }
        for (service, refuses) in &self.refusals {
            println!("{}: {}", service.name, verdict(refuses));
        }
        println!("written to {}", self.out.display());
    }

    fn print_json(&self) {
        let piece = |place: &Place| {
            json!({
                "design": self.designs[place.design].name, "copy": place.copy, "turned": place.turned,
                "corner": place.corner, "size": place.size,
            })
        };
        let sheets = self.sheets.iter().enumerate().map(|(i, sheet)| {
            json!({
                "file": file(i), "used": self.used(sheet),
                "pieces": sheet.places.iter().map(piece).collect::<Vec<_>>(),
            })
        });
        let services = self.refusals.iter().map(|(service, refuses)| {
            json!({ "name": service.name, "source": service.source, "refuses": refuses })
        });
        let value = json!({
            "machine": self.machine.name,
            "stock": { "size": self.stock.size, "margin": self.stock.margin, "gap": self.stock.gap },
            "sheets": sheets.collect::<Vec<_>>(),
            "services": services.collect::<Vec<_>>(),
            "folder": self.out,
        });
        println!("{value:#}");
    }
}
