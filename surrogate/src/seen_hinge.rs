//! Energy and damage of a hinge from the energy and damage of the hinge that the networks see: the hinge with the hole of reference
//! and the same net ligament ([`NetLigament`]), with the derivatives of this map.

use crate::features::FEATURES;
use crate::hinge_energy::{HingeEnergy, Order};
use hinge::{HingeDeformation, HingeDesign, NetLigament};
use std::array::from_fn;

/// The hinge that the networks see, and its deformation.
pub(crate) fn seen(
    ligament: &NetLigament,
    design: &HingeDesign,
    deformation: &HingeDeformation,
) -> (HingeDesign, HingeDeformation) {
    (ligament.design(design), ligament.deformation(deformation))
}

/// The energy of the actual hinge, rotated by `theta`, from the energy of the hinge that the networks see.
pub(crate) fn energy(
    ligament: &NetLigament,
    at: HingeEnergy,
    theta: f64,
    order: Order,
) -> HingeEnergy {
    if order < Order::Forces {
        return at;
    }
    let mut energy = at;
    let [f_a, ..] = at.forces;
    let [by_theta, curvature] = ligament.by_theta(theta);
    energy.forces[2] += f_a * by_theta;
    if order < Order::Tangent {
        return energy;
    }
    let rows = (at.tangent).map(|[by_a, by_s, by_angle]| [by_a, by_s, by_angle + by_a * by_theta]);
    energy.tangent = rows;
    energy.tangent[2] = from_fn(|j| rows[2][j] + rows[0][j] * by_theta);
    energy.tangent[2][2] += f_a * curvature;
    if order < Order::Design {
        return energy;
    }
    let [by_width, by_hole] = ligament.by_width_and_hole(theta);
    for (g, [a, w, a_theta]) in [(0, by_width), (2, by_hole)] {
        let of_feature = if g == 0 { 0.0 } else { 1.0 };
        let along =
            |by_feature: f64, by_a: f64, by_w: f64| of_feature * by_feature + by_a * a + by_w * w;
        energy.design[g] = along(at.design[g], f_a, at.design[0]);
        for i in 0..3 {
            energy.mixed[i][g] = along(at.mixed[i][g], at.tangent[i][0], at.mixed[i][0]);
        }
        energy.mixed[2][g] += energy.mixed[0][g] * by_theta + f_a * a_theta;
    }
    energy.mixed[2][1] += at.mixed[0][1] * by_theta;
    energy
}

/// A gradient in (a, s, theta, w_lig, alpha, rho_f) of the actual hinge from the gradient of the hinge that the networks see.
pub(crate) fn gradient(ligament: &NetLigament, at: [f64; FEATURES], theta: f64) -> [f64; FEATURES] {
    let [by_a, by_s, by_angle, by_w, by_alpha, by_hole] = at;
    let [[a_width, w_width, _], [a_hole, w_hole, _]] = ligament.by_width_and_hole(theta);
    [
        by_a,
        by_s,
        by_angle + by_a * ligament.by_theta(theta)[0],
        by_a * a_width + by_w * w_width,
        by_alpha,
        by_hole + by_a * a_hole + by_w * w_hole,
    ]
}
