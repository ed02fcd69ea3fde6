//! How a coupon is cut, hung and measured, and what its readings will say.

use crate::commands::calibrate::coupon_folder::READINGS;
use crate::commands::calibrate::fit_args::READING_ERROR;
use crate::ui::shell_word::shell_word;
use anyhow::Result;
use design::analysis::calibration::{CalibrationError, Estimate, Quantity};
use design::analysis::coupon::Specimen;
use design::analysis::simulated_coupon::{SimulatedCoupon, SimulationError};
use design::scene::Scene;
use design::sheet::deviation::Deviation;
use std::fmt;
use std::path::Path;

/// The estimates of a coupon that is as its drawing says, when its thickness is measured by itself.
pub(super) struct Expected {
    estimates: Vec<Estimate>,
}

impl Expected {
    pub fn of(specimens: &[Specimen]) -> Result<Self> {
        let drawn = Deviation::default();
        let coupon = SimulatedCoupon {
            specimens,
            cut: &drawn,
            error: 0.01 * READING_ERROR,
        };
        let fitted = [Quantity::Kerf, Quantity::Stress];
        match coupon.calibrate(&fitted, &drawn, |exact, _| exact) {
            Ok(found) => Ok(Self {
                estimates: found.estimates,
            }),
            Err(SimulationError::Calibration(CalibrationError::Undetermined)) => Ok(Self {
                estimates: Vec::new(),
            }),
            Err(error) => Err(error.into()),
        }
    }
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let found = self.estimates.iter().map(|estimate| {
            let error = 2.0 * estimate.standard_error;
            match estimate.quantity {
                Quantity::Kerf => format!("kerf to +- {error:.3} mm"),
                Quantity::Thickness => format!("thickness to +- {error:.3} mm"),
                Quantity::Stress => format!("stresses to +- {:.1} %", 100.0 * error),
            }
        });
        let found: Vec<String> = found.collect();
        write!(
            f,
            "Expected from readings to {READING_ERROR} % of the largest, with the thickness measured by itself: {} (two standard errors)",
            if found.is_empty() {
                "nothing that is not known already".to_owned()
            } else {
                found.join(", ")
            }
        )
    }
}

/// The text of coupon.md.
pub(super) fn instructions(
    scene: &Scene,
    specimens: &[Specimen],
    expected: &Expected,
    folder: &Path,
) -> String {
    let mut rows = String::new();
    for of in specimens {
        let loaded = &of.loaded;
        let steps: Vec<String> = std::iter::zip(&loaded.masses_g, &loaded.displacements)
            .map(|(mass, moved)| format!("{mass} g: {:.1}", loaded.distance + moved))
            .collect();
        rows += &format!(
            "| {} | {} | {} | {:.1} | {} | {:.1} | {:.0} |\n",
            of.name,
            loaded.scene.config.ligament.start,
            of.corner_deg,
            loaded.distance,
            steps.join(", "),
            loaded.distance + loaded.stop(),
            loaded.opening.to_degrees()
        );
    }
    let material = &scene.material;
    format!(
        "# Coupon of {name}, {thickness} mm

For the scene \"{title}\". {expected}. The errors of the hinge model itself are not in it.

## Cut

Cut `cut.dxf` or `cut.svg` (1:1, mm) from the plate of the sheet, on the machine and with the settings of the sheet, in the same direction of
the plate. Row A has square panels, row B panels of 60 degrees; one, two or three holes in a panel are the number of a specimen. Break the
specimens out without opening them. Measure the thickness at several places with a micrometer or a caliper.

## Hang

* Put a thin hook of wire through the hole in the upper left panel and hang it from a nail, so that the specimen swings freely. Hang the
  weights from a hook in the hole in the lower right panel. Nothing else touches the specimen.
* Weigh all that hangs there, hook and bag included: a kitchen scale does. Bottles of water make any mass.
* Only ever add weight, gently. Stop at the largest mass of the table, or before it when the distance is beyond that of the column `stop`:
  further on the model is not known, or the plastic tears. A specimen that was opened further, or let go, is used up.
* Plastics creep: read every distance at the same time after hanging, for example half a minute.

## Read

Read the distance between the facing edges of the two hook holes, before the weights (mass 0, by its own weight) and under each mass, with a
caliper or in a photograph: the camera at the height of the specimen, several steps away and square to it, a ruler in the plane of the
specimen, specimen name and mass on a slip of paper in the picture. Photograph the opened specimens under their largest mass also if you read
with a caliper: panels that leave the plane, torn ligaments and a wrong name are seen later.

Write the distances into `{READINGS}`, with the masses that hung.

| specimen | ligaments (mm) | corner (deg) | distance before the weights (mm) | mass: distance to expect (mm) | stop (mm) | opening at the end (deg) |
|---|---|---|---|---|---|---|
{rows}
A plate that is softer than its data sheet opens further. A distance that moves five times as far as expected is refused as a mistake.

## Calibrate

```sh
kirigami calibrate {command} --known thickness=MEASURED
```
",
        name = material.name,
        thickness = material.thickness,
        title = scene.config.title,
        command = shell_word(folder),
    )
}
