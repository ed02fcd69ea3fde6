//! The sheets that were cut and measured: one, or the specimens of a coupon.

use crate::commands::calibrate::coupon_folder::{CouponFolder, is_coupon};
use crate::commands::calibrate::fit_args::FitArgs;
use crate::commands::calibrate::readings_file::ReadingsFile;
use crate::commands::inspect::scene_args::Inspected;
use crate::commands::points_file::PointsFile;
use anyhow::{Context, Error, Result, ensure};
use design::analysis::calibration::CalibrationError;
use design::analysis::data_error::DataError;
use design::analysis::measurements::{Measurements, PointData};
use design::analysis::real_sheet::RealSheet;
use design::analysis::sheet_residuals::CutAndMeasured;
use design::objective::design_problem::DesignProblem;
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;

/// Sheets that were cut from one plate, and measured.
pub(super) struct Measured {
    /// The scene that is calibrated.
    pub scene: Scene,
    /// What was measured.
    pub name: String,
    sheets: Vec<MeasuredSheet>,
}

struct MeasuredSheet {
    /// The name of a specimen.
    specimen: Option<String>,
    scene: Scene,
    problem: DesignProblem,
    design: DesignVector,
    points: Option<PointsFile>,
    readings: Option<ReadingsFile>,
    data: Measurements,
}

impl Measured {
    pub fn read(args: &FitArgs, designed: &Inspected) -> Result<Self> {
        if is_coupon(&designed.scene) {
            return Self::coupon(args, designed);
        }
        let (scene, design, name) = designed.read_run()?;
        let points = args.points.as_ref().map(|file| args.read.read(file));
        let (points, scale) = points.transpose()?.unzip();
        let readings = args.readings.as_ref().map(|file| ReadingsFile::read(file));
        let readings = readings.transpose()?;
        let data = Measurements {
            points: points.as_ref().zip(scale).map(|(file, scale)| PointData {
                points: file.points.clone(),
                scale,
                error: args.point_error,
            }),
            loads: (readings.as_ref()).map(|file| file.data(0.01 * args.reading_error)),
        };
        let sheet = MeasuredSheet {
            specimen: None,
            problem: scene.problem()?,
            scene: scene.clone(),
            design,
            points,
            readings,
            data,
        };
        Ok(Self {
            scene,
            name,
            sheets: vec![sheet],
        })
    }

    fn coupon(args: &FitArgs, designed: &Inspected) -> Result<Self> {
        let folder = &designed.scene;
        ensure!(
            args.points.is_none() && designed.design.is_none() && designed.weights.is_none(),
            "a coupon is fitted to its readings, with the weights of its scene: leave out --points, --design and --weights"
        );
        let coupon = CouponFolder::read(folder)?;
        let file = args.readings.clone().unwrap_or_else(|| coupon.readings());
        let read = ReadingsFile::read_specimens(&file, &coupon.names)?;
        let sheet = |(specimen, readings): (usize, ReadingsFile)| -> Result<MeasuredSheet> {
            let name = &coupon.names[specimen];
            let scene = coupon.specimen(name)?;
            Ok(MeasuredSheet {
                specimen: Some(name.clone()),
                problem: scene.problem()?,
                design: scene.start(),
                scene,
                points: None,
                data: Measurements {
                    points: None,
                    loads: Some(readings.data(0.01 * args.reading_error)),
                },
                readings: Some(readings),
            })
        };
        let sheets: Vec<MeasuredSheet> = read.into_iter().map(sheet).collect::<Result<_>>()?;
        let names: Vec<&str> = (sheets.iter())
            .filter_map(|sheet| sheet.specimen.as_deref())
            .collect();
        let name = format!(
            "coupon {}, specimens {}",
            folder.display(),
            names.join(", ")
        );
        Ok(Self {
            name,
            sheets,
            scene: coupon.scene,
        })
    }

    /// The names of the specimens; empty for a sheet.
    pub fn specimens(&self) -> Vec<String> {
        let names = self.sheets.iter().map(|sheet| sheet.specimen.clone());
        names.flatten().collect()
    }

    /// What `of` makes of the sheets as they were drawn.
    pub fn with_sheets<T>(&self, of: impl FnOnce(&[CutAndMeasured]) -> Result<T>) -> Result<T> {
        let drawn = self.sheets.iter().map(|sheet| {
            let drawn = RealSheet::new(&sheet.scene, &sheet.problem, &sheet.design);
            drawn.with_context(|| sheet.specimen.clone().unwrap_or_else(|| self.name.clone()))
        });
        let drawn: Vec<RealSheet> = drawn.collect::<Result<_>>()?;
        let measured: Vec<CutAndMeasured> = std::iter::zip(&self.sheets, &drawn)
            .map(|(sheet, drawn)| CutAndMeasured {
                problem: &sheet.problem,
                sheet: drawn,
                data: &sheet.data,
            })
            .collect();
        of(&measured)
    }

    /// The error with the file, the line and the specimen that it is about.
    pub fn located(&self, error: CalibrationError) -> Error {
        let CalibrationError::Data { sheet, error } = error else {
            return error.into();
        };
        let sheet = &self.sheets[sheet];
        let error = match (error, &sheet.points, &sheet.readings) {
            (DataError::Points(error), Some(file), _) => file.located(error),
            (error @ (DataError::Reading { .. } | DataError::OtherUnits(_)), _, Some(file)) => {
                file.located(&error)
            }
            (error, ..) => error.into(),
        };
        match &sheet.specimen {
            Some(name) => error.context(format!("specimen {name}")),
            None => error,
        }
    }
}
