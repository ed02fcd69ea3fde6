//! `kirigami init`

mod size_args;

use crate::commands::init::size_args::{length, part, size, stock};
use anyhow::Result;
use app::new_project::NewProject;
use clap::Args;
use scene::Stock;
use std::path::PathBuf;

/// Create a folder with material, campaign, training and scene for a sheet of your own
///
/// Ligament widths, windows, number of panels, stroke and target are scaled to the thickness and
/// the size of the sheet. A sheet that is large for its thickness has wide ligaments that fold, and
/// is held flat; from 1 mm on, others have ligaments narrower than the thickness, and bend in their
/// plane. The files run as they are: with a material that has weights, `design` at once; with
/// another, after its campaign and training. README.md in the folder lists the commands. With
/// --stock the sheet is as large as its cuts fit on a sheet of that stock. Examples: kirigami init
/// my-sheet --thickness 3 --size 210x297; kirigami init first --stock a4 --margin 5; kirigami init
/// film --thickness 0.1; kirigami init leaf --thickness 2 --size 300x300 --target
/// configs/targets/leaf.svg
#[derive(Args, Clone)]
pub struct InitCommand {
    /// Folder to create
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Sheet material (TOML) [default: configs/materials/polypropylene-3mm.toml, below 1 mm of
    /// thickness pet-0.5mm.toml]
    #[arg(long, value_name = "FILE")]
    material: Option<PathBuf>,
    /// Thickness of the sheet (mm) [default: the thickness in the material file]
    #[arg(long, value_name = "MM")]
    thickness: Option<f64>,
    /// Width and height of the sheet (mm) [default: 210x297 for plates up to 3 mm and films up to
    /// 0.1 mm, larger in proportion to the thickness]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<[f64; 2]>,
    /// The stock that the sheet is cut from: a5 to a0, letter, tabloid, or width and height (mm).
    /// The sheet is smaller by twice the margin, the over-run and half a kerf, so that its cuts fit
    #[arg(long, value_name = "STOCK", value_parser = stock, conflicts_with = "size")]
    stock: Option<Stock>,
    /// Border of the stock that the machine cannot cut (mm) [default: 0]
    #[arg(long, value_name = "MM", value_parser = length, requires = "stock")]
    margin: Option<f64>,
    /// Drawing that the sheet opens onto (SVG or DXF, with holes; FILE#2 is its second largest
    /// contour; PNG and JPEG are traced), in any position and of any size: an even pattern of square
    /// panels is laid over it and trimmed to it [default: the opened sheet's rectangle]
    #[arg(long, value_name = "FILE")]
    target: Option<PathBuf>,
    /// Where a PNG or JPEG is traced: the difference from the colour of its border, over the largest
    /// one [default: between the colours of border and shape]
    #[arg(long, value_name = "PART", value_parser = part, requires = "target")]
    threshold: Option<f64>,
    /// Side of the panels (mm): larger ones are fewer, and show less of the drawing [default: the
    /// smallest that has room for its hinges, 2.25 window radii]
    #[arg(long, value_name = "MM", value_parser = length, requires = "target")]
    panel_side: Option<f64>,
    /// Make the sheet although less than 75 % of the target is seen
    #[arg(long, requires = "target")]
    anyway: bool,
    /// Service that cuts the sheet, such as SendCutSend: holes, slits and material next to them are as
    /// wide as it wants. configs/machines.toml lists services and their limits
    #[arg(long = "for", value_name = "SERVICE")]
    service: Option<String>,
    /// Weights for this material [default: those for it among the shipped ones]
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
}

impl InitCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let Self {
            folder,
            material,
            thickness,
            size,
            stock,
            margin,
            target,
            threshold,
            panel_side,
            anyway,
            service,
            weights,
        } = self.clone();
        let project = NewProject {
            folder,
            material,
            thickness,
            size,
            stock,
            margin,
            target,
            threshold,
            panel_side,
            weights,
            service,
            any_width: false,
            anyway,
        };
        print!("{}", project.create()?);
        Ok(())
    }
}
