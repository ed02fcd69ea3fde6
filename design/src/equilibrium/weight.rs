//! The weight of the panels, in the plane of the sheet.
//!
//! Let w be the weight of a unit of area (a vector in the plane), A the area of a panel, c its
//! centroid and r its reference point, the weight has the work w A . (u + R(phi) (c - r)). Its
//! moment about the reference point turns with the panel:
//!
//! ```text
//! F = w A,     M = (R(phi) (c - r)) x F,     -dM/dphi = (R(phi) (c - r)) . F
//! ```

use crate::{
    geometry::plane::{I, complex, cross, dot, turn},
    sheet::{
        cut_sheet::{Panel, Sheet, SheetGradient},
        kinematics::{Configuration, Motion},
    },
};
use faer::c64;
use std::iter::zip;

/// Distance of the centre of gravity from a nail, relative to the size of the sheet, below which
/// the sheet hangs in no definite position.
const BALANCED: f64 = 1e-6;

/// A force on a panel in one of its positions, with its derivative.
#[derive(Clone, Copy, Default)]
pub(crate) struct PanelForce {
    /// (F_x, F_y, M) about the reference point of the panel.
    pub force: Motion,
    /// Minus the derivative of `force` in the motion of the panel.
    pub stiffness: [Motion; 3],
    /// The potential energy of the force (N mm).
    pub potential: f64,
}

impl PanelForce {
    /// The resistance of the stiffness to a motion.
    pub(crate) fn resistance(&self, motion: &Motion) -> Motion {
        self.stiffness.map(|row| row[0] * motion[0] + row[1] * motion[1] + row[2] * motion[2])
    }
}

/// The weight of a panel in one of its rotations.
#[derive(Clone, Copy)]
struct PanelWeight {
    /// w A
    force: c64,
    /// R(phi) (c - r)
    arm: c64,
}

impl PanelWeight {
    fn new(panel: &Panel, by_area: [f64; 2], phi: f64) -> Self {
        Self {
            force: panel.area * complex(by_area),
            arm: turn(phi) * (complex(panel.centroid) - complex(panel.reference)),
        }
    }

    fn on(&self, panel: &Panel, [u_x, u_y, _]: Motion) -> PanelForce {
        let flat = complex(panel.centroid) - complex(panel.reference);
        let mut stiffness = [[0.0; 3]; 3];
        stiffness[2][2] = dot(self.arm, self.force);
        PanelForce {
            force: [self.force.re, self.force.im, cross(self.arm, self.force)],
            stiffness,
            potential: -dot(self.force, c64::new(u_x, u_y) + self.arm - flat),
        }
    }
}

/// The weight of every panel in a configuration; `by_area` is the weight of a unit of area
/// (N/mm^2).
pub(crate) fn weights_of_panels<'a>(
    sheet: &'a Sheet,
    by_area: [f64; 2],
    configuration: &'a [Motion],
) -> impl Iterator<Item = PanelForce> + 'a {
    zip(&sheet.panels, configuration)
        .map(move |(panel, &motion)| PanelWeight::new(panel, by_area, motion[2]).on(panel, motion))
}

/// Adds the gradient, with respect to the sheet, of the work of the weight in virtual motions
/// `lambda` of the panels.
pub(crate) fn add_weight_gradient(
    by_sheet: &mut SheetGradient,
    sheet: &Sheet,
    by_area: [f64; 2],
    configuration: &[Motion],
    lambda: &[Motion],
) {
    for (k, (panel, [x, y, turned])) in zip(&sheet.panels, lambda).enumerate() {
        let weight = PanelWeight::new(panel, by_area, configuration[k][2]);
        let spin = I * turn(configuration[k][2]) * *turned;
        let motion = c64::new(*x, *y) + I * weight.arm * *turned;
        by_sheet.areas[k] += dot(complex(by_area), motion);
        let by_arm = weight.force * spin.conj();
        by_sheet.centroids[k] += by_arm;
        by_sheet.references[k] -= by_arm;
    }
}

/// The flat sheet turned about a point until its centre of gravity hangs below it; `None` if that
/// is at the point.
pub(crate) fn hung_from(
    sheet: &Sheet,
    point: [f64; 2],
    by_area: [f64; 2],
) -> Option<Configuration> {
    let panels = &sheet.panels;
    let area: f64 = panels.iter().map(|panel| panel.area).sum();
    let moment: c64 = (panels.iter()).map(|panel| complex(panel.centroid) * panel.area).sum();
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
