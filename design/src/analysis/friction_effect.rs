//! What friction changes in the deployment of a sheet that lies on a surface.

use crate::analysis::actuation_curve::ActuationCurve;
use crate::equilibrium::load_step::DescentEnd;
use crate::hinge_law::Order;
use crate::objective::design_problem::{Deployment, Mechanics};
use crate::sheet::kinematics::{corner_distances, hinge_deformations};
use serde::Serialize;
use support::statistics::rms_and_maximum;

/// The end of the path with friction beside the end without.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrictionEffect {
    /// Displacement and load at the end of the path without friction, and with it; `None` if nothing moves the sheet.
    pub ends: Option<[[f64; 2]; 2]>,
    /// Root mean square and maximum of the distances of panel corners between the two (mm).
    pub corners: [f64; 2],
    /// Work done against friction, and stored in the hinges, at the end of the path with friction (N mm).
    pub work: [f64; 2],
    /// Length of the way of every panel's centroid over the surface (mm).
    pub slips: Vec<f64>,
}

impl FrictionEffect {
    /// On a deployment without friction; `by_area` is the friction of a unit of area while it slides (N/mm^2).
    ///
    /// # Errors
    /// Why no equilibrium with friction was found, with the load parameter up to which there is one.
    pub fn new(
        mechanics: &Mechanics,
        deployment: &Deployment,
        by_area: f64,
    ) -> Result<Self, (f64, DescentEnd)> {
        let sheet = &deployment.sheet;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(sheet, &*law, false);
        let slid = mechanics.solver.slid(hinged, by_area)?;
        let deformations = hinge_deformations(sheet, &slid.configuration);
        let energies = hinged.energies(&deformations, Order::Value);
        let stored = energies.iter().map(|energy| energy.w).sum();
        let without = deployment.final_step();
        let ends = ActuationCurve::through(
            mechanics,
            sheet,
            &(without.load_factor, without.configuration.clone()),
            std::iter::once((slid.load_factor, &*slid.configuration)),
        );
        let apart = corner_distances(sheet, &without.configuration, &slid.configuration);
        Ok(Self {
            ends: ends.map(|curve| [curve.points[0], curve.points[1]]),
            corners: rms_and_maximum(apart),
            work: [slid.dissipated, stored],
            slips: slid.slips,
        })
    }
}
