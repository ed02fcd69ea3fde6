//! The weight of the panels, in the plane of the sheet.
//!
//! With w the weight of a unit of area (a vector in the plane), A the area of a panel, c its centroid and r its reference
//! point, the weight has the work w A . (u + R(phi) (c - r)). Its moment about the reference point turns with the panel:
//!
//! ```text
//! F = w A,     M = (R(phi) (c - r)) x F,     -dM/dphi = (R(phi) (c - r)) . F
//! ```

use crate::geometry::plane::{I, add, complex, cross, dot, turn};
use crate::sheet::cut_sheet::{Panel, Sheet, SheetGradient};
use crate::sheet::kinematics::Configuration;
use faer::c64;

/// Distance of the centre of gravity from a nail, relative to the size of the sheet, below which the sheet hangs in no
/// definite position.
const BALANCED: f64 = 1e-6;

/// The weight of a panel in one of its rotations.
#[derive(Clone, Copy)]
pub(crate) struct PanelWeight {
    /// w A
    force: c64,
    /// R(phi) (c - r)
    arm: c64,
}

impl PanelWeight {
    pub fn new(panel: &Panel, by_area: [f64; 2], phi: f64) -> Self {
        Self {
            force: panel.area * complex(by_area),
            arm: turn(phi) * (complex(panel.centroid) - complex(panel.reference)),
        }
    }

    /// (F_x, F_y, M)
    pub fn force(&self) -> [f64; 3] {
        [self.force.re, self.force.im, cross(self.arm, self.force)]
    }

    /// -dM/dphi
    pub fn stiffness(&self) -> f64 {
        dot(self.arm, self.force)
    }

    /// The work from the flat sheet, in which the arm is `flat`.
    fn work(&self, [u_x, u_y, _]: [f64; 3], flat: c64) -> f64 {
        dot(self.force, c64::new(u_x, u_y) + self.arm - flat)
    }
}

/// The weight of every panel in a configuration, if there is any; `by_area` is that of a unit of area (N/mm^2).
pub(crate) fn panel_weights<'a>(
    sheet: &'a Sheet,
    by_area: [f64; 2],
    configuration: &'a [[f64; 3]],
) -> impl Iterator<Item = PanelWeight> + 'a {
    let weighing = if by_area == [0.0; 2] {
        0
    } else {
        sheet.panels.len()
    };
    std::iter::zip(&sheet.panels, configuration)
        .take(weighing)
        .map(move |(panel, motion)| PanelWeight::new(panel, by_area, motion[2]))
}

/// The work of the weight from the flat sheet to a configuration (N mm).
pub fn work_of_weight(sheet: &Sheet, by_area: [f64; 2], configuration: &[[f64; 3]]) -> f64 {
    let weights = panel_weights(sheet, by_area, configuration);
    let works = weights
        .zip(configuration)
        .zip(&sheet.panels)
        .map(|((weight, motion), panel)| {
            let flat = complex(panel.centroid) - complex(panel.reference);
            weight.work(*motion, flat)
        });
    works.sum()
}

/// Adds the gradient, with respect to the sheet, of the work of the weight in virtual motions `lambda` of the panels.
pub(crate) fn add_weight_gradient(
    by_sheet: &mut SheetGradient,
    sheet: &Sheet,
    by_area: [f64; 2],
    configuration: &[[f64; 3]],
    lambda: &[[f64; 3]],
) {
    let weights = panel_weights(sheet, by_area, configuration);
    for (k, (weight, [x, y, turned])) in weights.zip(lambda).enumerate() {
        let spin = I * turn(configuration[k][2]) * *turned;
        let motion = c64::new(*x, *y) + I * weight.arm * *turned;
        by_sheet.areas[k] += dot(complex(by_area), motion);
        let by_arm = weight.force * spin.conj();
        add(&mut by_sheet.centroids[k], by_arm);
        add(&mut by_sheet.references[k], -by_arm);
    }
}

/// The flat sheet turned about a point until its centre of gravity hangs below it; `None` if that is at the point.
pub(crate) fn hung_from(
    sheet: &Sheet,
    point: [f64; 2],
    by_area: [f64; 2],
) -> Option<Configuration> {
    let panels = &sheet.panels;
    let area: f64 = panels.iter().map(|panel| panel.area).sum();
    let moment: c64 = (panels.iter())
        .map(|panel| complex(panel.centroid) * panel.area)
        .sum();
    let (nail, down) = (complex(point), complex(by_area));
    let arm = moment / area - nail;
    if arm.norm() < BALANCED * sheet.outline.area().sqrt() || down.norm() == 0.0 {
        return None;
    }
    let angle = cross(arm, down).atan2(dot(arm, down));
    let motion = |panel: &Panel| {
        let shift = (turn(angle) - 1.0) * (complex(panel.reference) - nail);
        [shift.re, shift.im, angle]
    };
    Some(panels.iter().map(motion).collect())
}
