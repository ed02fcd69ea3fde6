//! `kirigami-studies calibration`: a sheet that is cut by a cutter and from a material that the scene does not know, measured,
//! calibrated, designed again and cut again.

use crate::designed::designed;
use anyhow::Result;
use clap::Args;
use design::analysis::actuation_curve::ActuationCurve;
use design::analysis::calibrated_scene::write_calibrated;
use design::analysis::calibration::{Quantity, calibrate};
use design::analysis::marks::MeasuredPoint;
use design::analysis::measurements::Measurements;
use design::analysis::real_sheet::RealSheet;
use design::analysis::sheet_residuals::CutAndMeasured;
use design::analysis::simulated_measurements::{StandardErrors, equal_parts};
use design::objective::scores::outline_error;
use design::pattern::design_vector::DesignVector;
use design::scene::{Scene, SceneConfig};
use design::sheet::deviation::Deviation;
use design::sheet::kinematics::deployed_corners;
use kirigami::ui::run_folder;
use output::calibration::CalibrationReport;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fmt::Write;
use std::path::PathBuf;
use support::statistics::{normal, rms_and_maximum};
use support::table::{Cell, Table};

/// Number of readings of displacement and load.
const READINGS: u32 = 10;

/// Cut a design with another kerf, thickness and stress, measure it, calibrate, design and cut again
///
/// The sheets are computed, with errors of every ligament and of the measurements. Writes calibration.md, the measurements, the
/// calibrated scene and its run. Example: kirigami-studies calibration configs/scenes/pet-3x3.toml
#[derive(Args)]
pub struct CalibrationStudy {
    /// Scene (TOML)
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// What the cutter removes more than the scene says (mm)
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 0.1,
        allow_negative_numbers = true
    )]
    kerf: f64,
    /// What the sheet is thicker (mm)
    #[arg(long, value_name = "MM", default_value_t = -0.01, allow_negative_numbers = true)]
    thickness: f64,
    /// What its stresses are larger, relative
    #[arg(long, value_name = "FRACTION", default_value_t = -0.08, allow_negative_numbers = true)]
    stress: f64,
    /// Standard deviation of every ligament by itself (mm)
    #[arg(long, value_name = "MM", default_value_t = 0.2)]
    ligament: f64,
    /// Standard error of a coordinate (mm)
    #[arg(long, value_name = "MM", default_value_t = 0.2)]
    point_error: f64,
    /// Standard error of a reading (% of the largest)
    #[arg(long, value_name = "PERCENT", default_value_t = 2.0)]
    reading_error: f64,
    /// Seed of all errors
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// Folder for the page, the measurements and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-calibration")]
    out: PathBuf,
}

/// A cut sheet beside its prediction.
struct Row {
    name: &'static str,
    /// Distance of the panel corners from the prediction: root mean square and maximum (mm).
    corners: [f64; 2],
    /// Outline error, predicted and of the cut sheet (mm).
    outline: [f64; 2],
    /// Load at the end, predicted and of the cut sheet.
    load: Option<[f64; 2]>,
}

impl CalibrationStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let scene = self.scene(&self.scene, "before")?;
        let before = designed(&scene, &mut |_| ())?;
        let real = [
            scene.config.process.kerf + self.kerf,
            scene.material.thickness + self.thickness,
            (1.0 + self.stress) * scene.material.young,
        ];
        let sheet = RealSheet::new(&scene, &before.problem, &before.design)?;
        let cut = self.cut(
            &scene,
            real,
            sheet.designed().sheet.hinges.len(),
            &mut random,
        );
        let first = row("as designed", &scene, &before.design, &cut)?;
        let errors = StandardErrors {
            point: self.point_error,
            reading: 0.01 * self.reading_error,
        };
        let parts = equal_parts(READINGS);
        let data =
            Measurements::exact(&sheet, &cut, &parts, errors)?.with_errors(&sheet, &mut random);
        self.write(&data, "first")?;
        let measured = CutAndMeasured {
            problem: &before.problem,
            sheet: &sheet,
            data: &data,
        };
        let known = Deviation::default();
        let found = calibrate(&[measured], &Quantity::ALL, &known, &mut || ())?;
        let report = CalibrationReport::new(&scene, "the first design".into(), Vec::new(), found);
        let deviation = report.calibration.deviation();
        let folder = self.out.join("calibrated");
        let file = write_calibrated(&scene, &deviation, &folder, &report.comment())?;
        let scene = Scene::read(&file)?;
        let after = designed(&scene, &mut |_| ())?;
        let cut = self.cut(&scene, real, cut.widths.len(), &mut random);
        let second = row("designed again", &scene, &after.design, &cut)?;
        let sheet = RealSheet::new(&scene, &after.problem, &after.design)?;
        let again = Measurements::exact(&sheet, &cut, &parts, errors)?;
        self.write(&again.with_errors(&sheet, &mut random), "second")?;
        let page = self.page(real, &[first, second], &report);
        run_folder::write(&self.out, "calibration.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    /// The scene with its run in a folder of the study.
    fn scene(&self, file: &std::path::Path, run: &str) -> Result<Scene> {
        let mut config: SceneConfig = support::toml_file::read(file)?;
        config.output = std::path::absolute(self.out.join(run))?;
        Ok(Scene::new(config, file)?)
    }

    /// A sheet of the real kerf (mm), thickness (mm) and modulus (MPa), with errors of its ligaments.
    fn cut(
        &self,
        scene: &Scene,
        [kerf, thickness, young]: [f64; 3],
        hinges: usize,
        random: &mut ChaCha8Rng,
    ) -> Deviation {
        Deviation {
            widths: (0..hinges)
                .map(|_| self.ligament * normal([random.random(), random.random()]))
                .collect(),
            kerf: kerf - scene.config.process.kerf,
            thickness: thickness - scene.material.thickness,
            stress: young / scene.material.young - 1.0,
        }
    }

    /// The tables that `kirigami compare` and `calibrate` read, of the first or the second sheet.
    fn write(&self, data: &Measurements, sheet: &str) -> Result<()> {
        let mut text = "panel,corner,x,y\n".to_owned();
        for MeasuredPoint { mark, position } in data.points.iter().flat_map(|data| &data.points) {
            let (corner, [x, y]) = (mark.corner.unwrap_or_default(), position);
            writeln!(text, "{},{corner},{x:.2},{y:.2}", mark.panel)?;
        }
        run_folder::write(&self.out, &format!("{sheet}-points.csv"), &text)?;
        let mut text = "displacement_mm,load_N\n".to_owned();
        for [displacement, load] in data.loads.iter().flat_map(|data| &data.readings) {
            writeln!(text, "{displacement:.2},{load:.3}")?;
        }
        run_folder::write(&self.out, &format!("{sheet}-readings.csv"), &text)
    }

    fn page(
        &self,
        [kerf, thickness, young]: [f64; 3],
        rows: &[Row],
        report: &CalibrationReport,
    ) -> String {
        let sheets = Table::new()
            .column("sheet", |row: &Row| Cell::text(row.name))
            .column("corners off the prediction, rms (mm)", |row| {
                Cell::fixed(row.corners[0], 2)
            })
            .column("largest (mm)", |row| Cell::fixed(row.corners[1], 2))
            .column("outline error, predicted (mm)", |row| {
                Cell::fixed(row.outline[0], 2)
            })
            .column("outline error, cut (mm)", |row| {
                Cell::fixed(row.outline[1], 2)
            })
            .column("load, predicted (N)", |row| {
                Cell::known(row.load.map(|[own, _]| Cell::fixed(own, 2)), "-")
            })
            .column("load, cut (N)", |row| {
                Cell::known(row.load.map(|[_, cut]| Cell::fixed(cut, 2)), "-")
            });
        format!(
            "# A sheet, measured, calibrated and cut again\n\n\
             `{}`; the cutter removes {kerf:.2} mm, the sheet is {thickness:.2} mm thick with a modulus of {young:.0} MPa, and every ligament is \
             off by {} mm. Corners measured to {} mm, readings to {} %. Everything is computed: no sheet was cut. `kirigami-studies calibration`.\n\n{}\n```\n{report}```\n",
            self.scene.display(),
            self.ligament,
            self.point_error,
            self.reading_error,
            sheets.markdown(rows)
        )
    }
}

/// A cut sheet of a design beside its prediction.
fn row(name: &'static str, scene: &Scene, design: &DesignVector, cut: &Deviation) -> Result<Row> {
    let problem = scene.problem()?;
    let sheet = RealSheet::new(scene, &problem, design)?;
    let (real, mechanics) = sheet.deployed(cut)?;
    let own = sheet.designed();
    let corners =
        [own, &real].map(|of| deployed_corners(&of.sheet, &of.final_step().configuration).concat());
    let distances = std::iter::zip(&corners[0], &corners[1]);
    let load = |of| Some(ActuationCurve::new(&mechanics, of)?.points.last()?[1]);
    let predicted = problem
        .model
        .mechanics()
        .and_then(|mechanics| Some(ActuationCurve::new(mechanics, own)?.points.last()?[1]));
    Ok(Row {
        name,
        corners: rms_and_maximum(distances.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))),
        outline: [own, &real].map(|of| outline_error(&problem.objective, of)),
        load: predicted.zip(load(&real)).map(|(own, cut)| [own, cut]),
    })
}
