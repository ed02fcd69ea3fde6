//! The path of a sheet that lies on a surface with friction, in increments of the load parameter.
//!
//! Every increment minimises the potential (10) and the friction of the panels since the state before. It has no gradient
//! in the design.

use crate::equilibrium::branch::Branch;
use crate::equilibrium::friction::Friction;
use crate::equilibrium::hinged_sheet::HingedSheet;
use crate::equilibrium::load_step::{DescentEnd, Effort};
use crate::equilibrium::place::Place;
use crate::equilibrium::potential::{Potential, Stage, moved};
use crate::equilibrium::solver::EquilibriumSolver;
use crate::sheet::kinematics::{Configuration, deployed};

/// Number of increments of a load step.
const INCREMENTS: usize = 4;
/// Creeps of the regularised friction, over the size of a panel, each the start of the next.
const CREEPS: [f64; 2] = [1e-3, 1e-5];

/// The end of a path with friction.
#[derive(Clone, Debug)]
pub struct Slid {
    /// zeta
    pub load_factor: f64,
    /// q: the motion of every panel.
    pub configuration: Configuration,
    /// Length of the way of every panel's centroid over the surface (mm).
    pub slips: Vec<f64>,
    /// Work done against friction (N mm).
    pub dissipated: f64,
    /// Maximum unbalanced force of the last increment, relative to the maximum force.
    pub residual: f64,
}

impl EquilibriumSolver {
    /// The flat sheet deployed against friction, `by_area` being that of a unit of area while it slides (N/mm^2).
    ///
    /// # Errors
    /// Why an increment found no minimum, with the load parameter before it.
    pub fn slid(&self, sheet: HingedSheet, by_area: f64) -> Result<Slid, (f64, DescentEnd)> {
        let mut branch = Branch::new(self, sheet, Stage::Actuation);
        let panels = sheet.sheet.panels.len();
        let mut slid = Slid {
            load_factor: 0.0,
            configuration: self.flat(),
            slips: vec![0.0; panels],
            dissipated: 0.0,
            residual: 0.0,
        };
        let mut last = Place {
            at: 0.0,
            configuration: self.flat(),
            forces: vec![[0.0; 3]; sheet.sheet.hinges.len()],
        };
        let increments = INCREMENTS * self.steps;
        let ends: Vec<f64> = (1..=increments)
            .map(|i| i as f64 / increments as f64)
            .collect();
        let mut before = self.flat();
        for (at, free) in std::iter::zip(&ends, self.readings(sheet, &ends)) {
            let stopped = self.is_stopped().then_some(DescentEnd::Stopped);
            if let Some(end) = free.descent_end.or(stopped) {
                return Err((last.at, end));
            }
            // The sheet without friction shows where to begin.
            let motion = moved(&free.configuration, &before, -1.0);
            before = free.configuration;
            let mut next = Place {
                at: *at,
                configuration: moved(&last.configuration, &motion, 1.0),
                ..last.clone()
            };
            branch.hold(&mut next, &last);
            let mut rubbed = 0.0;
            for creep in CREEPS {
                let friction = Friction {
                    by_area,
                    from: last.configuration.clone(),
                    creep: creep * branch.panel_size,
                };
                let potential = Potential {
                    friction: Some(&friction),
                    ..branch.potential(next.at)
                };
                let found = potential.minimise(next.configuration, &mut Effort::default());
                let state = found.map_err(|failure| (last.at, failure.end))?.state;
                (slid.load_factor, slid.residual) = (state.load_factor, state.residual);
                branch.force = state.force;
                let on_panels = friction.on_panels(sheet.sheet, &state.configuration);
                rubbed = on_panels.map(|on_panel| on_panel.potential).sum();
                next.configuration = state.configuration;
            }
            slid.dissipated += rubbed;
            for (k, (slip, panel)) in
                std::iter::zip(&mut slid.slips, &sheet.sheet.panels).enumerate()
            {
                let [from, to] = [&last, &next]
                    .map(|place| deployed(panel, place.configuration[k], panel.centroid));
                *slip += (to[0] - from[0]).hypot(to[1] - from[1]);
            }
            last = next;
        }
        slid.configuration = last.configuration;
        Ok(slid)
    }
}
