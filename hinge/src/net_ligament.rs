//! A hinge with any hole as the hinge with a hole of reference and the same net ligament.
//!
//! A ligament ends at the edge of the hole: (1 - rho_f) w_lig of it carry the load. The hinge with
//! the hole of reference rho_0 and the same net ligament has its tip O' on the normal of the
//! secondary cut through O,
//!
//! ```text
//! w' = (1 - rho_f) / (1 - rho_0) w_lig,      a' = a - 2 sin(theta / 2) (w_lig - w'),      s' = s,
//! ```
//!
//! as panel B, which is rigid there, moves the point O' by that. Hinges of one sheet with different
//! holes have similar states in these measures: rays, training domains and networks are of this
//! hinge, and the networks see rho_f besides. For the paper's film W at rho_f = 0.025 and 0.4 then
//! differs from that at 0.16 by 5 and 8 % instead of 24 and 31 %. At rho_f = rho_0 nothing changes.

use crate::{HingeDeformation, HingeDesign, HingeSample, Jet};

/// The map from a hinge to that with the hole of reference and the same net ligament.
#[derive(Clone, Copy, Debug)]
pub struct NetLigament {
    /// w' / w_lig.
    ratio: f64,
    /// w_lig - w' (mm).
    shift: f64,
    /// d(w_lig - w') / d rho_f (mm).
    shift_by_hole: f64,
}

impl NetLigament {
    /// The map of a hinge, for the hole `reference`, a multiple of w_lig.
    pub fn new(design: &HingeDesign, reference: f64) -> Self {
        let ratio = (1.0 - design.fillet_ratio) / (1.0 - reference);
        Self {
            ratio,
            shift: (1.0 - ratio) * design.w_lig,
            shift_by_hole: design.w_lig / (1.0 - reference),
        }
    }

    /// The hinge with the hole of reference; its `fillet_ratio` remains the actual one, as a
    /// feature.
    pub fn design(&self, design: &HingeDesign) -> HingeDesign {
        HingeDesign { w_lig: self.ratio * design.w_lig, ..*design }
    }

    /// The deformation of that hinge.
    pub fn deformation(&self, deformation: &HingeDeformation) -> HingeDeformation {
        HingeDeformation {
            a: deformation.a - chord(deformation.theta) * self.shift,
            ..*deformation
        }
    }

    /// The actual deformation from the deformation of the hinge with the hole of reference.
    pub fn actual(&self, deformation: &HingeDeformation) -> HingeDeformation {
        HingeDeformation {
            a: deformation.a + chord(deformation.theta) * self.shift,
            ..*deformation
        }
    }

    /// Deformation and moment of a sample of that hinge. The other quantities remain the quantities
    /// of the actual hinge.
    pub fn sample(&self, sample: &HingeSample) -> HingeSample {
        HingeSample {
            a: self.deformation(&sample.deformation()).a,
            m_theta: sample.m_theta - sample.f_a * self.by_theta(sample.theta)[0],
            ..*sample
        }
    }

    /// da' / d theta and d2a' / d theta2 (mm).
    pub fn by_theta(&self, theta: f64) -> [f64; 2] {
        let (sin, cos) = (0.5 * theta).sin_cos();
        [-cos * self.shift, 0.5 * sin * self.shift]
    }

    /// The derivatives of a', w' and da' / d theta in w_lig and in rho_f.
    pub fn by_width_and_hole(&self, theta: f64) -> [[f64; 3]; 2] {
        let half_angle = (0.5 * theta).cos();
        [[1.0 - self.ratio, self.ratio], [self.shift_by_hole, -self.shift_by_hole]]
            .map(|[shift, width]| [-chord(theta) * shift, width, -half_angle * shift])
    }
}

/// Displacement of a point at the distance 1 from O by a rotation, in the mean frame.
fn chord(theta: f64) -> f64 {
    2.0 * (0.5 * theta).sin()
}

/// The map as functions of (a, s, theta, w_lig, rho_f).
#[derive(Clone, Copy, Debug)]
pub struct NetLigamentJet {
    /// w'
    pub width: Jet,
    /// w_lig - w'
    shift: Jet,
}

impl NetLigamentJet {
    /// See [`NetLigament::new`]; without a hole of reference the hinge itself.
    pub fn new(design: &HingeDesign, reference: Option<f64>) -> Self {
        let w_lig = Jet::variable(Jet::W_LIG, design.w_lig);
        let width = reference.map_or(w_lig, |reference| {
            let solid = Jet::constant(1.0) - Jet::variable(Jet::HOLE, design.fillet_ratio);
            w_lig * solid * (1.0 - reference).recip()
        });
        Self { width, shift: w_lig - width }
    }

    /// (a', s', theta) from (a, s, theta).
    pub fn deformation(&self, [a, s, theta]: [Jet; 3]) -> [Jet; 3] {
        [a - chord_jet(theta) * self.shift, s, theta]
    }

    /// (a, s, theta) from (a', s', theta).
    pub fn actual(&self, [a, s, theta]: [Jet; 3]) -> [Jet; 3] {
        [a + chord_jet(theta) * self.shift, s, theta]
    }
}

fn chord_jet(theta: Jet) -> Jet {
    let (sin, cos) = (0.5 * theta.value).sin_cos();
    theta.map([2.0 * sin, cos, -0.5 * sin])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HingeConstants;

    fn drilled() -> HingeDesign {
        HingeDesign { fillet_ratio: 0.35, ..HingeConstants::PAPER.hinge(12.0, 1.2) }
    }

    #[test]
    fn the_edge_of_the_hole_stays_where_it_is() {
        let design = drilled();
        let seen = NetLigament::new(&design, 0.16).design(&design);
        let net = |w_lig: f64, ratio: f64| (1.0 - ratio) * w_lig;
        assert!((net(seen.w_lig, 0.16) - net(design.w_lig, 0.35)).abs() < 1e-12);
    }

    /// Panel B turns about the point that O' is: there the deformation is a rotation alone.
    #[test]
    fn a_rotation_about_the_other_tip_has_no_translation_there() {
        let design = drilled();
        let ligament = NetLigament::new(&design, 0.16);
        let shift = design.w_lig - ligament.design(&design).w_lig;
        let turned = HingeDeformation { a: 2.0 * 0.4f64.sin() * shift, s: 0.0, theta: 0.8 };
        assert!(ligament.deformation(&turned).a.abs() < 1e-12);
        assert!((ligament.actual(&ligament.deformation(&turned)).a - turned.a).abs() < 1e-12);
    }

    #[test]
    fn the_hole_of_reference_changes_nothing() {
        let design = HingeConstants::PAPER.hinge(7.3, 1.2);
        let ligament = NetLigament::new(&design, HingeConstants::PAPER.fillet_ratio);
        let state = HingeDeformation::from([0.3, -0.2, 0.7]);
        assert_eq!((ligament.design(&design), ligament.deformation(&state)), (design, state));
    }

    #[test]
    fn the_jets_have_the_values_and_the_derivatives_of_the_map() {
        let (design, state) = (drilled(), [0.4, -0.3, 0.9]);
        let ligament = NetLigament::new(&design, 0.16);
        let jet = NetLigamentJet::new(&design, Some(0.16));
        let [a, ..] = jet.deformation(std::array::from_fn(|i| Jet::variable(i, state[i])));
        let by_theta = ligament.by_theta(state[2]);
        let [by_width, by_hole] = ligament.by_width_and_hole(state[2]);
        let found = [
            a.value,
            a.gradient[2],
            a.hessian[2][2],
            a.gradient[3],
            a.gradient[4],
            a.hessian[2][3],
            a.hessian[2][4],
            jet.width.gradient[3],
            jet.width.gradient[4],
        ];
        let expected = [
            ligament.deformation(&state.into()).a,
            by_theta[0],
            by_theta[1],
            by_width[0],
            by_hole[0],
            by_width[2],
            by_hole[2],
            by_width[1],
            by_hole[1],
        ];
        for (found, expected) in std::iter::zip(found, expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
