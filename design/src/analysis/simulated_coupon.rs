//! The calibration of a coupon that is computed, for tests and to say what a real one will find.

use crate::analysis::calibration::{Calibration, CalibrationError, Quantity, calibrate};
use crate::analysis::coupon::Specimen;
use crate::analysis::measurements::Measurements;
use crate::analysis::real_sheet::RealSheet;
use crate::analysis::sheet_residuals::CutAndMeasured;
use crate::objective::design_problem::{DesignError, DesignProblem};
use crate::scene::SceneError;
use crate::sheet::deviation::Deviation;

/// Why a computed coupon is not calibrated.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SimulationError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Design(#[from] DesignError),
    #[error("no specimen bears its lightest weight: the plate is softer than a coupon is for")]
    TooSoft,
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
}

/// A coupon that is cut from a sheet and read.
pub struct SimulatedCoupon<'a> {
    /// The specimens as drawn.
    pub specimens: &'a [Specimen],
    /// What is cut.
    pub cut: &'a Deviation,
    /// Standard error of a reading, relative to the largest of its specimen.
    pub error: f64,
}

impl SimulatedCoupon<'_> {
    /// The fit of `quantities` to the readings, the others being `known`; `read` adds the errors of the readings to exact ones.
    pub fn calibrate(
        &self,
        quantities: &[Quantity],
        known: &Deviation,
        mut read: impl FnMut(Measurements, &RealSheet) -> Measurements,
    ) -> Result<Calibration, SimulationError> {
        let scenes = self.specimens.iter().map(|of| &of.loaded.scene);
        let problems = scenes.clone().map(|scene| scene.problem());
        let problems: Vec<DesignProblem> = problems.collect::<Result<_, _>>()?;
        let sheets = scenes
            .zip(&problems)
            .map(|(scene, problem)| RealSheet::new(scene, problem, &scene.start()));
        let sheets: Vec<RealSheet> = sheets.collect::<Result<_, _>>()?;
        let data = std::iter::zip(self.specimens, &sheets).map(|(of, sheet)| {
            let exact = of.loaded.exact(sheet, self.cut, self.error);
            exact.map(|exact| read(exact, sheet))
        });
        let data: Vec<Option<Measurements>> = data.collect();
        let measured: Vec<CutAndMeasured> = (problems.iter().zip(&sheets).zip(&data))
            .filter_map(|((problem, sheet), data)| {
                Some(CutAndMeasured {
                    problem,
                    sheet,
                    data: data.as_ref()?,
                })
            })
            .collect();
        if measured.is_empty() {
            return Err(SimulationError::TooSoft);
        }
        Ok(calibrate(&measured, quantities, known, &mut || ())?)
    }
}
