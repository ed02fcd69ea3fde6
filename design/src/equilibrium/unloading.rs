//! A sheet that is unloaded: from a configuration to the equilibrium without loads.
//!
//! The forces that would hold the panels in the configuration are taken off in proportion. The path
//! begins in balance also where the forces of the hinge law differ from the forces under load.
//! Supports that rest and the weight of the sheet stay; supports that moved the sheet are removed,
//! too. A sheet without weight that no support holds then is free: the panel of its first support
//! stays where it is.

use crate::{
    equilibrium::{
        hinged_sheet::HingedSheet,
        load_step::LoadStep,
        potential::{Branch, PathStage},
        solver::EquilibriumSolver,
        supports::{Dof, Support, hold_rigid_body},
    },
    hinge_law::Order,
    sheet::{cut_sheet::Sheet, kinematics::Configuration},
};
use support::{Fault, fault};

/// Number of steps in which the loads are taken off.
const STEPS: usize = 10;

impl EquilibriumSolver {
    /// The load steps from the configuration `start`; the last one is without loads. Their
    /// load factor is the part of the holding forces that is left.
    pub fn unload(&self, sheet: HingedSheet, start: Configuration) -> Result<Vec<LoadStep>, Fault> {
        let mut free = self.unloaded(sheet.sheet)?;
        if let Some(holding) = free.holding(sheet, start.clone()) {
            free.loads = holding.iter().map(|force| force.map(|x| -x)).collect();
            free.held = holding.into();
        }
        let path = free.path_from(sheet, start).into_iter();
        Ok(path.map(|step| LoadStep { load_factor: 1.0 - step.load_factor, ..step }).collect())
    }

    /// The same problem without loads, and without the supports that moved the sheet.
    fn unloaded(&self, sheet: &Sheet) -> Result<Self, Fault> {
        let resting = self.supports.iter().filter(|support| support.value == 0.0);
        let mut resting: Vec<Support> = resting.copied().collect();
        if self.weight == [0.0; 2] && !hold_rigid_body(&resting, sheet) {
            let panel = self.supports[0].panel;
            resting.retain(|support| support.panel != panel);
            resting.extend(Dof::ALL.map(|dof| Support { panel, dof, value: 0.0 }));
        }
        let free = Self {
            weight: self.weight,
            attachment_points: self.attachment_points.clone(),
            ..Self::new(self.topology.clone(), &resting, &[], STEPS, self.settings)?
        };
        let what = "without the supports that moved it the sheet is free to move as a rigid body, and its \
                    unloaded position is undetermined. Hold it by supports that do not move";
        free.check_supports(sheet).map_err(|_| fault!("{what}")).map(|()| free)
    }

    /// The forces (F_x, F_y, M) on the free panels that balance a configuration without loads;
    /// `None` if its energy is not finite.
    fn holding(&self, sheet: HingedSheet, configuration: Configuration) -> Option<Vec<[f64; 3]>> {
        let branch = Branch::new(self, sheet, PathStage::Actuation);
        let state = branch.state(0.0, configuration, Order::Forces)?;
        Some(self.pattern.spread(&state.gradient))
    }
}
