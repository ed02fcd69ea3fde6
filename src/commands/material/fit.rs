//! `kirigami material fit`: from the files of a testing machine to a material file.

use anyhow::{Result, ensure};
use app::{
    charts::tensile_test,
    fit_report::{doubtful_moduli, notes, tables},
    output_file, picture, run_folder,
    shell_word::shell_word,
};
use clap::Args;
use hinge::SheetMaterial;
use std::path::{Path, PathBuf};
use tensile::{FitOptions, MaterialFit, Quantity, RecordOptions, SpecimenOptions, material_file};

/// Fit a material to tensile tests: modulus, yield, hardening, fracture strain
///
/// Files as the testing machine exports them, of one specimen or several. Columns, units,
/// separators, decimal signs and the dimensions above a table are recognised, or given by
/// --columns, --units, --width and --gauge-length. Slack and toe are removed (ISO 527-1, ASTM
/// D638), and unloading loops and rows after the break are dropped. Beyond a yield peak with a draw
/// plateau the curve of the material is constructed from the work of the machine; docs/MATERIALS.md
/// states the rules. Writes the material file and a picture of all curves. Example: kirigami
/// material fit strip-*.csv --name film --thickness 0.5 --density-kg-m3 1390
#[derive(Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct FitCommand {
    /// Records of the specimens: tables as text, such as CSV
    #[arg(value_name = "TEST", required = true)]
    tests: Vec<PathBuf>,
    /// Name of the material and of the files written
    #[arg(long, value_name = "NAME")]
    name: String,
    /// Thickness of the sheet and of the specimens (mm)
    #[arg(long, value_name = "MM")]
    thickness: f64,
    /// Density (kg/m^3)
    #[arg(long, value_name = "DENSITY")]
    density_kg_m3: f64,
    /// Poisson's ratio [default: 0.35, noted as assumed]
    #[arg(long, value_name = "RATIO")]
    poisson: Option<f64>,
    /// Folder for the material file and the picture
    #[arg(long, value_name = "FOLDER", default_value = "runs/material")]
    out: PathBuf,
    /// Overwrite an existing material file
    #[arg(long)]
    replace: bool,
    /// Print JSON instead of tables
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    columns: ColumnArgs,
    #[command(flatten)]
    evaluation: EvaluationArgs,
}

/// How the files are read.
#[derive(Args)]
#[command(next_help_heading = "Files")]
struct ColumnArgs {
    /// Columns by number or name, such as strain=3,stress=Load; quantities: force, stress,
    /// true-stress, extension, strain, true-strain
    #[arg(long, value_name = "QUANTITY=COLUMN,...", value_delimiter = ',', value_parser = assignment)]
    columns: Vec<(Quantity, String)>,
    /// Units, such as strain=%,force=kN, instead of those in the names of the columns
    #[arg(long, value_name = "QUANTITY=UNIT,...", value_delimiter = ',', value_parser = assignment)]
    units: Vec<(Quantity, String)>,
    /// Initial gauge length, for an extension (mm); one for all files, or one a file
    #[arg(long, value_name = "MM,...", value_delimiter = ',')]
    gauge_length: Vec<f64>,
    /// Width of the specimen, for a force (mm); one for all files, or one a file
    #[arg(long, value_name = "MM,...", value_delimiter = ',')]
    width: Vec<f64>,
}

/// How the curves are evaluated.
#[derive(Args)]
#[command(next_help_heading = "Evaluation")]
struct EvaluationArgs {
    /// Young's modulus (MPa), if it is known better than from these records; the compliance of the
    /// machine is removed, but not from a strain whose slope is within a quarter of it, which is an
    /// extensometer's
    #[arg(long, value_name = "MPA")]
    young: Option<f64>,
    /// Natural draw ratio, measured on the neck: initial over drawn section [default: where the
    /// stress rises again]
    #[arg(long, value_name = "RATIO")]
    draw_ratio: Option<f64>,
    /// True plastic strain at fracture, measured on the broken section: ln(A0 / A) [default: from
    /// the records]
    #[arg(long, value_name = "STRAIN")]
    fracture_strain: Option<f64>,
}

/// Maximum number of rows of the hardening table.
const ROWS: usize = 30;
/// Poisson's ratio if none is given.
const ASSUMED_POISSON: f64 = 0.35;
/// Width of the picture (px).
const PICTURE_WIDTH: u32 = 1800;

impl FitCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let records = self.records()?;
        let name = format!("{}.toml", self.name);
        let file = self.out.join(&name);
        if !self.replace {
            output_file::refuse_existing(&file)?;
        }
        let fit = MaterialFit::new(&records, &self.options()?)?;
        let material = fit.material(SheetMaterial {
            name: self.name.clone(),
            thickness: self.thickness,
            poisson: self.poisson.unwrap_or(ASSUMED_POISSON),
            density_kg_m3: self.density_kg_m3,
            ..SheetMaterial::default()
        })?;
        let _held = run_folder::hold(&self.out)?;
        let text = material_file(&fit, &material, self.poisson.is_none());
        run_folder::write(&self.out, &name, &text)?;
        let chart = tensile_test(&fit, &self.name)?;
        let pictures = picture::save(&chart, &self.out.join(&self.name), PICTURE_WIDTH)?;
        if self.json {
            let json = serde_json::json!({
                "file": file,
                "picture": pictures[1],
                "material": material,
                "law_hash": material.law_hash(),
                "fit": fit,
                "notes": notes(&fit),
                "warnings": doubtful_moduli(&fit),
            });
            println!("{json:#}");
            return Ok(());
        }
        for table in tables(&fit) {
            println!("{table}\n");
        }
        for note in notes(&fit) {
            println!("note: {note}");
        }
        for warning in doubtful_moduli(&fit) {
            println!("warning: {warning}");
        }
        println!("\nmaterial: {} (law {})", file.display(), material.law_hash());
        println!("picture:  {}", pictures[1].display());
        println!("next:     kirigami material check {}", shell_word(&file));
        Ok(())
    }

    /// Each file with what it does not say about itself.
    fn records(&self) -> Result<Vec<(PathBuf, RecordOptions)>> {
        let named =
            Path::new(&self.name).file_name().is_some_and(|name| name == self.name.as_str());
        ensure!(named, "--name {:?} is not a file name", self.name);
        let files = self.tests.len();
        let each = |option: &str, values: &[f64], file: usize| match values {
            [] => Ok(None),
            [one] => Ok(Some(*one)),
            values if values.len() == files => Ok(Some(values[file])),
            values => Err(anyhow::anyhow!(
                "--{option} has {} values for {files} files: give one for all, or one a file",
                values.len()
            )),
        };
        let record = |(file, path): (usize, &PathBuf)| {
            let columns = &self.columns;
            let record = RecordOptions {
                columns: columns.columns.clone(),
                units: columns.units.clone(),
                gauge_length: each("gauge-length", &columns.gauge_length, file)?,
                width: each("width", &columns.width, file)?,
                thickness: Some(self.thickness),
            };
            Ok((path.clone(), record))
        };
        self.tests.iter().enumerate().map(record).collect()
    }

    fn options(&self) -> Result<FitOptions> {
        let EvaluationArgs { young, draw_ratio, fracture_strain } = self.evaluation;
        let within = |option: &str, value: Option<f64>, [min, max]: [f64; 2]| match value {
            Some(value) if !(min..=max).contains(&value) => {
                Err(anyhow::anyhow!("--{option} {value} violates {min} <= {option} <= {max}"))
            }
            _ => Ok(()),
        };
        within("young", young, [10.0, 1e6])?;
        within("draw-ratio", draw_ratio, [1.001, 50.0])?;
        within("fracture-strain", fracture_strain, [1e-3, 10.0])?;
        Ok(FitOptions {
            specimen: SpecimenOptions { young, draw_ratio },
            fracture_strain,
            rows: ROWS,
        })
    }
}

/// A pair such as `strain=3`.
fn assignment(text: &str) -> Result<(Quantity, String), String> {
    let (quantity, value) = text.split_once('=').ok_or("write QUANTITY=VALUE, such as strain=3")?;
    Ok((quantity.trim().parse()?, value.trim().to_owned()))
}
