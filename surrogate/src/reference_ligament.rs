//! Energy and damage of a hinge from the energy and damage of the hinge that the networks see: the
//! hinge with the hole of reference and the same net ligament ([`NetLigament`]), with the
//! derivatives of this map.

use crate::features::{HingeEnergy, Order};
use hinge::{DesignGradient, HingeDeformation, HingeDesign, HingeGradient, NetLigament};
use std::array::from_fn;

/// The hinge that the networks see, and its deformation.
pub(crate) fn seen(
    ligament: &NetLigament,
    design: &HingeDesign,
    deformation: &HingeDeformation,
) -> (HingeDesign, HingeDeformation) {
    (ligament.design(design), ligament.deformation(deformation))
}

/// The energy of the actual hinge, rotated by `theta`, from the energy of the hinge that the
/// networks see.
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
    let by = ligament.by_width_and_hole(theta);
    energy.design = by_design(f_a, at.design, by);
    energy.mixed = from_fn(|i| by_design(at.tangent[i][0], at.mixed[i], by));
    let [of_a, ..] = energy.mixed;
    let [[.., by_width], [.., by_hole]] = by;
    energy.mixed[2] += DesignGradient {
        w_lig: of_a.w_lig * by_theta + f_a * by_width,
        alpha: of_a.alpha * by_theta,
        hole: of_a.hole * by_theta + f_a * by_hole,
    };
    energy
}

/// The gradient of the actual hinge from the gradient of the hinge that the networks see.
pub(crate) fn gradient(ligament: &NetLigament, at: HingeGradient, theta: f64) -> HingeGradient {
    let [by_a, by_s, by_angle] = at.state;
    HingeGradient {
        state: [by_a, by_s, by_angle + by_a * ligament.by_theta(theta)[0]],
        design: by_design(by_a, at.design, ligament.by_width_and_hole(theta)),
    }
}

/// The gradient in the design of the actual hinge from a' and the design of the hinge that the
/// networks see.
fn by_design(
    by_a: f64,
    at: DesignGradient,
    [[a_width, w_width, _], [a_hole, w_hole, _]]: [[f64; 3]; 2],
) -> DesignGradient {
    DesignGradient {
        w_lig: by_a * a_width + at.w_lig * w_width,
        alpha: at.alpha,
        hole: at.hole + by_a * a_hole + at.w_lig * w_hole,
    }
}
