//! The report of a calibrated sheet, or of a calibrated coupon.

use design::analysis::calibration::{Calibration, GroupFit, Quantity};
use design::scene::Scene;
use serde::Serialize;
use std::fmt;

/// Standard deviations of the reduced chi^2, above 1, beyond which a group of measurements fits worse than its stated errors.
const MISFIT: f64 = 3.5;
/// Root mean square of the residuals of a specimen, over their stated errors, beyond which it is named.
const FAR: f64 = 2.5;
/// Deviation in standard deviations of what was known before, beyond which a quantity is hardly what it seems.
const UNLIKELY: f64 = 3.0;
/// Absolute correlation above which two estimates are hard to tell apart.
const ALIKE: f64 = 0.8;

/// A calibrated sheet beside its drawing.
#[derive(Clone, Debug, Serialize)]
pub struct CalibrationReport {
    /// Title of the scene.
    pub title: String,
    /// Which design was measured.
    pub design: String,
    /// The names of the specimens of a coupon, as in the misfits of the calibration; empty for a sheet.
    pub specimens: Vec<String>,
    /// The width that the cutter removes (mm).
    pub kerf: f64,
    /// The thickness of the sheet (mm).
    pub thickness: f64,
    /// The stresses at equal strain over those of the material file.
    pub stress: f64,
    /// The fit.
    pub calibration: Calibration,
    /// Kerf and thickness of the scene (mm).
    nominal: [f64; 2],
}

impl CalibrationReport {
    /// The report of a calibration of the design with the name `design`, or of the `specimens` of a coupon.
    pub fn new(
        scene: &Scene,
        design: String,
        specimens: Vec<String>,
        calibration: Calibration,
    ) -> Self {
        let deviation = calibration.deviation();
        let nominal = [scene.config.process.kerf, scene.material.thickness];
        Self {
            title: scene.config.title.clone(),
            design,
            specimens,
            kerf: nominal[0] + deviation.kerf,
            thickness: nominal[1] + deviation.thickness,
            stress: 1.0 + deviation.stress,
            calibration,
            nominal,
        }
    }

    /// The head of the calibrated scene and of its material: where their numbers are from.
    pub fn comment(&self) -> String {
        let mut text = format!(
            "# Calibrated by `kirigami calibrate`.\n# {}: {}\n",
            self.title, self.design
        );
        for line in self.quantities() {
            text += &format!("# {}\n", line.join("  "));
        }
        text
    }

    /// Name, value of the drawing, calibrated value and two standard errors.
    fn quantities(&self) -> Vec<[String; 4]> {
        let [kerf, thickness] = self.nominal;
        let row = |quantity: Quantity| -> [String; 4] {
            let (nominal, value, unit, digits) = match quantity {
                Quantity::Kerf => (kerf, self.kerf, "mm", 3),
                Quantity::Thickness => (thickness, self.thickness, "mm", 4),
                Quantity::Stress => (1.0, self.stress, "of the material's", 3),
            };
            let mut estimates = self.calibration.estimates.iter();
            let estimate = estimates.find(|estimate| estimate.quantity == quantity);
            let found = match estimate {
                Some(estimate) => format!(
                    "{value:.digits$} +- {:.digits$}",
                    2.0 * estimate.standard_error
                ),
                None if *quantity.of(&mut self.calibration.known.clone()) != 0.0 => {
                    format!("{value:.digits$}, known")
                }
                None => "as in the scene".into(),
            };
            [
                quantity.name().into(),
                format!("{nominal:.digits$}"),
                found,
                unit.into(),
            ]
        };
        Quantity::ALL.into_iter().map(row).collect()
    }

    fn write_fit(
        f: &mut fmt::Formatter,
        name: &str,
        fit: &GroupFit,
        unit: (f64, &str),
    ) -> fmt::Result {
        let (factor, unit) = unit;
        let [before, after] = fit.residual.map(|residual| factor * residual);
        let left_out = match fit.outliers {
            0 => String::new(),
            outliers => format!(", {outliers} points left out as outliers"),
        };
        writeln!(
            f,
            "{name}: root mean square of {before:.3} {unit} from the drawing, {after:.3} {unit} from the calibrated sheet ({} \
             values{left_out})",
            fit.values
        )?;
        if fit.chi_squared > 1.0 + MISFIT * (2.0 / fit.free).sqrt() {
            writeln!(
                f,
                "  that is {:.1} times the stated error: the errors are larger than stated, the measurements contradict each \
                 other, or the model is wrong in something that is not calibrated. The standard errors below are widened by it",
                fit.chi_squared.sqrt()
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for CalibrationReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{}\n{}\n", self.title, self.design)?;
        let Calibration {
            estimates,
            correlations,
            points,
            loads,
            ..
        } = &self.calibration;
        if let Some(fit) = points {
            Self::write_fit(f, "points", fit, (1.0, "mm"))?;
        }
        if let Some(fit) = loads {
            Self::write_fit(f, "readings", fit, (100.0, "% of the largest"))?;
        }
        for (name, misfit) in std::iter::zip(&self.specimens, &self.calibration.misfits) {
            if *misfit > FAR {
                writeln!(
                    f,
                    "  specimen {name}: {misfit:.1} times the stated error. A wrong name or mass, or a specimen that was opened before"
                )?;
            }
        }
        writeln!(
            f,
            "\n{:<12}{:>12}{:>22}",
            "", "drawing", "cut, +- 2 std. errors"
        )?;
        for [name, nominal, found, unit] in self.quantities() {
            writeln!(f, "{name:<12}{nominal:>12}{found:>22}  {unit}")?;
        }
        for estimate in estimates.iter().filter(|estimate| !estimate.determined) {
            writeln!(
                f,
                "{}: the measurements hardly determine it (two standard deviations were {:.3} before): it stays near the drawing's value. \
                 Measure it by itself",
                estimate.quantity.name(),
                2.0 * estimate.quantity.guess(self.nominal[1])
            )?;
        }
        for estimate in estimates {
            let guess = estimate.quantity.guess(self.nominal[1]);
            if estimate.deviation.abs() > UNLIKELY * guess {
                writeln!(
                    f,
                    "{}: {:.0} times as far from the drawing as usual. A unit, the wrong design, or something that is not calibrated",
                    estimate.quantity.name(),
                    estimate.deviation.abs() / guess
                )?;
            }
        }
        for (i, one) in estimates.iter().enumerate() {
            for (j, other) in estimates.iter().enumerate().skip(i + 1) {
                let correlation = correlations[i][j];
                if correlation.abs() > ALIKE {
                    writeln!(
                        f,
                        "{} and {} are hard to tell apart (correlation {correlation:.2}): measure one of them by itself",
                        one.quantity.name(),
                        other.quantity.name()
                    )?;
                }
            }
        }
        writeln!(
            f,
            "\nNot calibrated: single ligaments, modulus and yield against each other (that takes a tensile test: kirigami material \
             fit), friction, the weight of the panels beyond their thickness, the model itself"
        )
    }
}
