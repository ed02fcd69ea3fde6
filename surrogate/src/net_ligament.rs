//! A hinge with any hole as the hinge with the hole of reference and the same net ligament.
//!
//! A ligament ends at the edge of the hole: (1 - rho_f) w_lig of it carry the load. The hinge with the hole of reference rho_0
//! and the same net ligament has its tip O' on the normal of the secondary cut through O,
//!
//! ```text
//! w' = (1 - rho_f) / (1 - rho_0) w_lig,      a' = a - 2 sin(theta / 2) (w_lig - w'),      s' = s,
//! ```
//!
//! as panel B, which is rigid there, moves the point O' by that. The networks see this hinge and rho_f. For the paper's film W
//! at rho_f = 0.025 and 0.4 then differs from that at 0.16 by 5 and 8 % instead of 24 and 31 %, and F_a is close to its value.
//! At rho_f = rho_0 nothing changes.

use crate::energy::{HingeEnergy, Order};
use crate::features::FEATURES;
use hinge::{HingeDeformation, HingeDesign, HingeSample};
use std::array::from_fn;

/// The map from one hinge to that with the hole of reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetLigament {
    /// w' / w_lig.
    ratio: f64,
    /// w_lig - w' (mm).
    shift: f64,
    /// d(w_lig - w') / d rho_f (mm).
    shift_by_hole: f64,
}

impl NetLigament {
    /// The map of a hinge, for weights with the hole `reference`, a multiple of w_lig.
    pub fn new(design: &HingeDesign, reference: f64) -> Self {
        let ratio = (1.0 - design.fillet_ratio) / (1.0 - reference);
        Self {
            ratio,
            shift: (1.0 - ratio) * design.w_lig,
            shift_by_hole: design.w_lig / (1.0 - reference),
        }
    }

    /// The hinge that the networks see; its `fillet_ratio` is the actual one, as a feature.
    pub fn design(&self, design: &HingeDesign) -> HingeDesign {
        HingeDesign {
            w_lig: self.ratio * design.w_lig,
            ..*design
        }
    }

    /// The deformation of that hinge.
    pub fn deformation(&self, deformation: &HingeDeformation) -> HingeDeformation {
        HingeDeformation {
            a: deformation.a - 2.0 * (0.5 * deformation.theta).sin() * self.shift,
            ..*deformation
        }
    }

    /// Deformation and moment of a sample of that hinge. The other quantities are those of the actual hinge.
    pub fn sample(&self, sample: &HingeSample) -> HingeSample {
        HingeSample {
            a: self.deformation(&sample.deformation()).a,
            m_theta: sample.m_theta - sample.f_a * self.by_theta(sample.theta),
            ..*sample
        }
    }

    /// da' / d theta.
    fn by_theta(&self, theta: f64) -> f64 {
        -(0.5 * theta).cos() * self.shift
    }

    /// da' and dw' in (w_lig, alpha, rho_f).
    fn by_design(&self, theta: f64) -> [[f64; 2]; 3] {
        let chord = 2.0 * (0.5 * theta).sin();
        [
            [-chord * (1.0 - self.ratio), self.ratio],
            [0.0; 2],
            [-chord * self.shift_by_hole, -self.shift_by_hole],
        ]
    }

    /// The energy of the actual hinge, rotated by `theta`, from that of the hinge that the networks see.
    pub(crate) fn energy(&self, at: HingeEnergy, theta: f64, order: Order) -> HingeEnergy {
        if order < Order::Forces {
            return at;
        }
        let mut energy = at;
        let [f_a, ..] = at.forces;
        let by_theta = self.by_theta(theta);
        energy.forces[2] += f_a * by_theta;
        if order < Order::Tangent {
            return energy;
        }
        let along = |row: [f64; 3]| [row[0], row[1], row[2] + row[0] * by_theta];
        let rows = at.tangent.map(along);
        energy.tangent = rows;
        energy.tangent[2] = from_fn(|j| rows[2][j] + rows[0][j] * by_theta);
        energy.tangent[2][2] += f_a * 0.5 * (0.5 * theta).sin() * self.shift;
        if order < Order::Design {
            return energy;
        }
        for (g, [a, w]) in self.by_design(theta).into_iter().enumerate() {
            let of_feature = |values: [f64; 3]| if g == 0 { 0.0 } else { values[g] };
            energy.design[g] = of_feature(at.design) + f_a * a + at.design[0] * w;
            for i in 0..3 {
                energy.mixed[i][g] =
                    of_feature(at.mixed[i]) + at.tangent[i][0] * a + at.mixed[i][0] * w;
            }
            energy.mixed[2][g] += energy.mixed[0][g] * by_theta;
        }
        let half_angle = (0.5 * theta).cos();
        energy.mixed[2][0] -= f_a * half_angle * (1.0 - self.ratio);
        energy.mixed[2][2] -= f_a * half_angle * self.shift_by_hole;
        energy
    }

    /// A gradient in (a, s, theta, w_lig, alpha, rho_f) of the actual hinge from that of the hinge that the networks see.
    pub(crate) fn gradient(&self, at: [f64; FEATURES], theta: f64) -> [f64; FEATURES] {
        let [by_a, by_s, by_angle, by_w, by_alpha, by_hole] = at;
        let [[a_w, w_w], _, [a_hole, w_hole]] = self.by_design(theta);
        [
            by_a,
            by_s,
            by_angle + by_a * self.by_theta(theta),
            by_a * a_w + by_w * w_w,
            by_alpha,
            by_hole + by_a * a_hole + by_w * w_hole,
        ]
    }
}
