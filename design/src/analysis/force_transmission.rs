//! How a deployed sheet transmits its loads from panel to panel; section 3.2, Table 1.
//!
//! Every hinge is an interface of two panels. In the frame of (a, s, theta) its force has a normal component
//! f_n = dW/da, positive in tension, and a tangential component f_t = dW/ds. The transmitted force is the sum of
//! |f_n| and |f_t| over the interfaces.

use crate::hinge_law::Order;
use crate::objective::design_problem::{Deployment, DesignError, DesignProblem};

/// One hinge of the deployed sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// f_n (N), positive in tension.
    pub normal: f64,
    /// f_t (N).
    pub tangential: f64,
}

/// The interfaces of a deployed sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceTransmission {
    /// One per hinge.
    pub interfaces: Vec<Interface>,
}

/// Fractions of the transmitted force, each in [0, 1]; the rest is shear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransmissionShares {
    /// Of interfaces that are pulled apart.
    pub tension: f64,
    /// Of interfaces that are pressed together.
    pub compression: f64,
}

impl Interface {
    /// Magnitude of the force (N).
    pub fn force(&self) -> f64 {
        self.normal.hypot(self.tangential)
    }
}

impl ForceTransmission {
    /// At full load of a deployment of `problem`, whose model must be an equilibrium.
    pub fn new(problem: &DesignProblem, deployment: &Deployment) -> Result<Self, DesignError> {
        let mechanics = problem.model.mechanics().ok_or(DesignError::NoMechanics)?;
        let law = mechanics.law.prepare(&deployment.sheet.designs());
        let energies = law.energies(&deployment.final_step().deformations, Order::Forces);
        let interfaces = energies.iter().map(|energy| {
            let [normal, tangential, _] = energy.forces;
            Interface { normal, tangential }
        });
        Ok(Self {
            interfaces: interfaces.collect(),
        })
    }

    /// The columns of Table 1 on the force.
    pub fn shares(&self) -> TransmissionShares {
        let sum = |part: &dyn Fn(&Interface) -> f64| self.interfaces.iter().map(part).sum::<f64>();
        let (tension, compression, shear) = (
            sum(&|interface| interface.normal.max(0.0)),
            sum(&|interface| (-interface.normal).max(0.0)),
            sum(&|interface| interface.tangential.abs()),
        );
        // A sheet without loads transmits no force.
        let share = |part: f64| {
            Some(part / (tension + compression + shear))
                .filter(|share| share.is_finite())
                .unwrap_or(0.0)
        };
        TransmissionShares {
            tension: share(tension),
            compression: share(compression),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transmission(forces: &[[f64; 2]]) -> ForceTransmission {
        let interface = |&[normal, tangential]: &[f64; 2]| Interface { normal, tangential };
        ForceTransmission {
            interfaces: forces.iter().map(interface).collect(),
        }
    }

    #[test]
    fn shares_of_four_interfaces_by_hand() {
        let forces = [[6.0, 0.0], [-2.0, 1.0], [0.0, -1.0], [0.0, 0.0]];
        let shares = transmission(&forces).shares();
        assert_eq!((shares.tension, shares.compression), (0.6, 0.2));
        let unloaded = transmission(&[[0.0; 2]]).shares();
        assert_eq!((unloaded.tension, unloaded.compression), (0.0, 0.0));
    }
}
