//! What friction changes in the deployment of a sheet that lies on a surface.

use crate::analysis::actuation_curve::ActuationCurve;
use crate::equilibrium::load_step::DescentEnd;
use crate::geometry::polygon::distance;
use crate::hinge_law::Order;
use crate::objective::design_problem::{Deployment, Mechanics};
use crate::sheet::kinematics::{deployed_corners, hinge_deformations};
use serde::Serialize;
use support::statistics::root_mean_square;

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
        let slid = (mechanics.solver).slid(mechanics.hinged(sheet, &*law, false), by_area)?;
        let deformations = hinge_deformations(sheet, &slid.configuration);
        let energies =
            (mechanics.hinged(sheet, &*law, false)).energies(&deformations, Order::Value);
        let stored = energies.iter().map(|energy| energy.w).sum();
        let without = deployment.final_step();
        let end = |load_factor: f64, configuration: &[[f64; 3]]| {
            ActuationCurve::point(mechanics, sheet, load_factor, configuration)
        };
        let ends = [
            end(without.load_factor, &without.configuration),
            end(slid.load_factor, &slid.configuration),
        ];
        let [free, held] = [&without.configuration, &slid.configuration]
            .map(|configuration| deployed_corners(sheet, configuration));
        let apart: Vec<f64> = std::iter::zip(free.as_flattened(), held.as_flattened())
            .map(|(p, q)| distance(*p, *q))
            .collect();
        Ok(Self {
            ends: match ends {
                [Some(without), Some(with)] => Some([without, with]),
                _ => None,
            },
            corners: [
                root_mean_square(apart.iter().copied()),
                apart.into_iter().fold(0.0, f64::max),
            ],
            work: [slid.dissipated, stored],
            slips: slid.slips,
        })
    }
}
