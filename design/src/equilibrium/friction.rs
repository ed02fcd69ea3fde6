//! Friction of panels that lie on a surface, in one increment of a motion.
//!
//! Over an increment, a point that slides by d costs mu N |d|, N being the weight that rests on it. The potential is the sum
//! over four points of every panel, those of a Gauss rule on a square, each with a quarter of the panel's weight. |d| is
//! made smooth,
//!
//! ```text
//! mu N (sqrt(d^2 + c^2) - c),     force  -mu N d / sqrt(d^2 + c^2)
//! ```
//!
//! so that a point that sticks creeps by the order of c in every increment. Minimising energy and friction over increments that
//! are small is the usual incremental formulation of dry friction; it depends on the path, and its tangent is symmetric.

use crate::equilibrium::panel_force::PanelForce;
use crate::geometry::plane::{I, complex, dot, turn};
use crate::sheet::cut_sheet::{Panel, Sheet};
use crate::sheet::kinematics::Configuration;
use faer::c64;

/// Distance of the points of a panel from its centroid, over that of the corners: 1 / sqrt(3).
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// Friction in an increment from a known configuration.
#[derive(Clone)]
pub(crate) struct Friction {
    /// Friction of a unit of area while it slides, mu rho g t (N/mm^2).
    pub by_area: f64,
    /// The configuration at the beginning of the increment.
    pub from: Configuration,
    /// c (mm)
    pub creep: f64,
}

impl Friction {
    /// The friction of every panel after a motion from the beginning of the increment.
    pub fn on_panels<'a>(
        &'a self,
        sheet: &'a Sheet,
        configuration: &'a [[f64; 3]],
    ) -> impl Iterator<Item = PanelForce> + 'a {
        (sheet.panels.iter().zip(configuration).zip(&self.from))
            .map(|((panel, &to), &from)| self.on_panel(panel, from, to))
    }

    fn on_panel(&self, panel: &Panel, from: [f64; 3], to: [f64; 3]) -> PanelForce {
        let mut sum = PanelForce::default();
        let limit = 0.25 * self.by_area * panel.area;
        let spin = turn(to[2]);
        let shift = c64::new(to[0] - from[0], to[1] - from[1]);
        for flat in contact_points(panel) {
            let (arm, before) = (spin * flat, turn(from[2]) * flat);
            let slip = shift + arm - before;
            let length = slip.norm().hypot(self.creep);
            let force = slip * (-limit / length);
            // The motion of the point per unit of u_x, u_y and phi.
            let rates = [c64::new(1.0, 0.0), I, I * arm];
            let mut stiffness = [[0.0; 3]; 3];
            for (i, row) in stiffness.iter_mut().enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    let across = dot(rates[i], slip) * dot(rates[j], slip) / (length * length);
                    *entry = limit / length * (dot(rates[i], rates[j]) - across);
                }
            }
            stiffness[2][2] += dot(force, arm);
            sum.add(&PanelForce {
                force: rates.map(|rate| dot(rate, force)),
                stiffness,
                potential: limit * (length - self.creep),
            });
        }
        sum
    }
}

/// The points on which a panel rests, relative to its reference point.
fn contact_points(panel: &Panel) -> [c64; 4] {
    let (centroid, reference) = (complex(panel.centroid), complex(panel.reference));
    panel
        .corners
        .map(|corner| centroid - reference + GAUSS * (complex(corner) - centroid))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::taylor::central_slope;
    use crate::sheet::cut_sheet::PanelPoint;

    fn panel() -> Panel {
        Panel {
            corners: [[0.0, 0.0], [5.0, 0.5], [4.0, 4.0], [-0.5, 3.0]],
            point: PanelPoint::Fixed([1.0, 0.5]),
            reference: [1.0, 0.5],
            centroid: [2.1, 1.8],
            area: 14.0,
        }
    }

    #[test]
    fn force_and_stiffness_are_derivatives_of_the_potential() {
        let friction = |creep| Friction {
            by_area: 0.3,
            from: Vec::new(),
            creep,
        };
        let (from, to) = ([0.2, -0.1, 0.3], [0.5, 0.3, 0.1]);
        for creep in [1e-3, 0.4] {
            let friction = friction(creep);
            let found = friction.on_panel(&panel(), from, to);
            for i in 0..3 {
                let unit: [f64; 3] = std::array::from_fn(|j| f64::from(i == j));
                let at = |x: &[f64]| friction.on_panel(&panel(), from, [x[0], x[1], x[2]]);
                let slope = central_slope(|x| at(x).potential, &to, &unit, 1e-6);
                assert!((found.force[i] + slope).abs() < 1e-7, "{creep} {i}");
                for j in 0..3 {
                    let slope = central_slope(|x| at(x).force[j], &to, &unit, 1e-6);
                    assert!(
                        (found.stiffness[j][i] + slope).abs() < 1e-5,
                        "{creep} {i} {j}"
                    );
                }
            }
        }
    }

    /// A panel that slides without turning is held by mu N, against its motion.
    #[test]
    fn a_sliding_panel_is_held_by_its_weight_times_mu() {
        let friction = Friction {
            by_area: 0.3,
            from: Vec::new(),
            creep: 1e-6,
        };
        let [x, y, _] = friction
            .on_panel(&panel(), [0.0; 3], [0.3, -0.4, 0.0])
            .force;
        let limit = 0.3 * 14.0;
        assert!((x + 0.6 * limit).abs() < 1e-9 && (y - 0.8 * limit).abs() < 1e-9);
    }
}
