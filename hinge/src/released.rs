//! A hinge that was deformed and unloaded: its residual deformation, and how stiff the hinge is
//! about that.

use crate::{HingeDeformation, HingeDesign, HingeForces};
use serde::{Deserialize, Serialize};
use std::array::from_fn;

/// The elastic energy of a released hinge, about its deformation without forces:
///
/// ```text
/// E(x) = (x - r) . K (x - r) / 2,        x = (a, s, theta)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReleasedHinge {
    /// r: the deformation without forces (mm, mm, rad).
    pub rest: HingeDeformation,
    /// K, symmetric and positive definite (N/mm, N, N mm).
    pub stiffness: [[f64; 3]; 3],
}

impl ReleasedHinge {
    /// K (x - r): the forces (F_a, F_s, M_theta) at a deformation.
    pub fn forces(&self, at: &HingeDeformation) -> [f64; 3] {
        let (at, rest) = (at.to_array(), self.rest.to_array());
        from_fn(|i| (0..3).map(|j| self.stiffness[i][j] * (at[j] - rest[j])).sum())
    }

    /// The energy at a deformation (N mm).
    pub fn energy(&self, at: &HingeDeformation) -> f64 {
        let (forces, at, rest) = (self.forces(at), at.to_array(), self.rest.to_array());
        0.5 * (0..3).map(|i| forces[i] * (at[i] - rest[i])).sum::<f64>()
    }

    /// The similar hinge in a sheet of `factor` times the thickness.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        // Forces grow with the square of the thickness, (a, s) with the thickness.
        let length = [1.0, 1.0, factor];
        Self {
            rest: self.rest.scaled(factor),
            stiffness: from_fn(|i| {
                from_fn(|j| factor * self.stiffness[i][j] * length[i] * length[j])
            }),
        }
    }

    /// The mirrored hinge; see [`HingeDeformation::mirrored`].
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let sign = [1.0, -1.0, 1.0];
        Self {
            rest: self.rest.mirrored(),
            stiffness: from_fn(|i| from_fn(|j| sign[i] * sign[j] * self.stiffness[i][j])),
        }
    }
}

/// One hinge by finite elements: deformed along a straight ray, and unloaded. A row of a table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReleasedSample {
    /// Ligament width (mm).
    pub w_lig: f64,
    /// Cut angle (rad).
    pub alpha: f64,
    /// Radius of the hole over w_lig.
    pub fillet_ratio: f64,
    /// Width of the cut (mm).
    pub kerf: f64,
    /// Radius of the window (mm).
    pub r_win: f64,
    /// The deformation reached: a (mm),
    pub a: f64,
    /// s (mm),
    pub s: f64,
    /// and theta (rad).
    pub theta: f64,
    /// The forces there: F_a (N),
    pub f_a: f64,
    /// F_s (N),
    pub f_s: f64,
    /// and M_theta (N mm).
    pub m_theta: f64,
    /// D_peak there, if it was evaluated.
    pub d_peak: Option<f64>,
    /// The deformation that stays without forces: a (mm),
    pub rest_a: f64,
    /// s (mm),
    pub rest_s: f64,
    /// and theta (rad).
    pub rest_theta: f64,
    /// The stiffness about it: K_aa (N/mm),
    pub k_aa: f64,
    /// K_as (N/mm),
    pub k_as: f64,
    /// K_a theta (N),
    pub k_at: f64,
    /// K_ss (N/mm),
    pub k_ss: f64,
    /// K_s theta (N),
    pub k_st: f64,
    /// and K_theta theta (N mm).
    pub k_tt: f64,
}

impl ReleasedSample {
    /// The row of a hinge with the forces and the D_peak that it reached.
    pub fn new(
        design: &HingeDesign,
        reached: &HingeDeformation,
        forces: &HingeForces,
        d_peak: Option<f64>,
        ReleasedHinge { rest, stiffness }: &ReleasedHinge,
    ) -> Self {
        Self {
            w_lig: design.w_lig,
            alpha: design.alpha,
            fillet_ratio: design.fillet_ratio,
            kerf: design.kerf,
            r_win: design.r_win,
            a: reached.a,
            s: reached.s,
            theta: reached.theta,
            f_a: forces.f_a,
            f_s: forces.f_s,
            m_theta: forces.m_theta,
            d_peak,
            rest_a: rest.a,
            rest_s: rest.s,
            rest_theta: rest.theta,
            k_aa: stiffness[0][0],
            k_as: stiffness[0][1],
            k_at: stiffness[0][2],
            k_ss: stiffness[1][1],
            k_st: stiffness[1][2],
            k_tt: stiffness[2][2],
        }
    }

    /// The hinge design.
    pub fn design(&self) -> HingeDesign {
        HingeDesign {
            w_lig: self.w_lig,
            alpha: self.alpha,
            fillet_ratio: self.fillet_ratio,
            kerf: self.kerf,
            r_win: self.r_win,
        }
    }

    /// The deformation that was reached.
    pub fn reached(&self) -> HingeDeformation {
        [self.a, self.s, self.theta].into()
    }

    /// The forces (F_a, F_s, M_theta) there (N, N, N mm).
    pub fn forces(&self) -> [f64; 3] {
        [self.f_a, self.f_s, self.m_theta]
    }

    /// The hinge after it was unloaded.
    pub fn released(&self) -> ReleasedHinge {
        ReleasedHinge {
            rest: [self.rest_a, self.rest_s, self.rest_theta].into(),
            stiffness: [
                [self.k_aa, self.k_as, self.k_at],
                [self.k_as, self.k_ss, self.k_st],
                [self.k_at, self.k_st, self.k_tt],
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hinge() -> ReleasedHinge {
        ReleasedHinge {
            rest: [-0.4, 0.1, 0.3].into(),
            stiffness: [[9.0, 1.0, -4.0], [1.0, 20.0, 2.0], [-4.0, 2.0, 30.0]],
        }
    }

    #[test]
    fn forces_are_the_gradient_of_the_energy_and_vanish_at_rest() {
        let hinge = hinge();
        assert_eq!(hinge.forces(&hinge.rest), [0.0; 3]);
        let at = [0.2, -0.3, 0.8];
        let forces = hinge.forces(&at.into());
        for i in 0..3 {
            let energy = |h: f64| {
                let mut moved = at;
                moved[i] += h;
                hinge.energy(&moved.into())
            };
            let slope = (energy(1e-4) - energy(-1e-4)) / 2e-4;
            assert!((slope - forces[i]).abs() < 1e-8, "{i}: {slope} {forces:?}");
        }
    }

    /// Energy grows with the cube of the thickness, and equals the energy of the mirrored
    /// deformation in the mirrored hinge.
    #[test]
    fn similar_and_mirrored_hinges_have_their_energies() {
        let (hinge, at) = (hinge(), HingeDeformation::from([0.2, -0.3, 0.8]));
        let energy = hinge.energy(&at);
        let similar = hinge.scaled(2.0).energy(&at.scaled(2.0));
        assert!((similar / (8.0 * energy) - 1.0).abs() < 1e-12);
        assert!((hinge.mirrored().energy(&at.mirrored()) / energy - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_row_has_its_hinge() {
        let design = crate::HingeConstants::PAPER.hinge(18.0, 1.4);
        let (reached, forces) = ([0.1, 0.2, 0.5].into(), HingeForces::default());
        let row = ReleasedSample::new(&design, &reached, &forces, Some(0.2), &hinge());
        assert_eq!((row.design(), row.reached(), row.released()), (design, reached, hinge()));
    }
}
