//! Supports and loads of a scene for each panel.

use crate::equilibrium::supports::{Dof, Load, Support};
use crate::pattern::grid::EDGES;
use crate::scene::actuation::{EdgeLoadConfig, OpeningCoupleConfig};
use crate::scene::checked_scene::Scene;
use crate::sheet::topology::{HingeSite, hinge_sites};

impl Scene {
    pub(super) fn supports(&self) -> Vec<Support> {
        let mut supports = Vec::new();
        for config in &self.config.supports {
            let panel = self.panel(config.panel);
            let motion = config.motion();
            for (dof, held) in Dof::ALL.into_iter().zip(config.kind.holds()) {
                if held {
                    let value = motion[dof.index()];
                    supports.push(Support { panel, dof, value });
                }
            }
        }
        supports
    }

    /// The sum of the loads on panels, edges and hinges.
    pub fn loads(&self) -> Vec<Load> {
        let mut total = vec![[0.0; 3]; self.grid().panel_count()];
        for load in &self.config.loads {
            let sum = &mut total[self.panel(load.panel)];
            sum[0] += load.force[0];
            sum[1] += load.force[1];
            sum[2] += load.couple;
        }
        for load in &self.config.edge_loads {
            let panels = load.edge.panels(self.grid());
            let [x, y] = (self.edge_resultant(load)).map(|force| force / panels.len() as f64);
            for panel in panels {
                total[panel][0] += x;
                total[panel][1] += y;
            }
        }
        for load in &self.config.opening_couples {
            for (panel, couple) in self.couples_on_panels(load).into_iter().enumerate() {
                total[panel][2] += couple;
            }
        }
        for support in self.supports() {
            total[support.panel][support.dof.index()] = 0.0;
        }
        let loads = total.iter().enumerate().flat_map(|(panel, values)| {
            let load = move |(dof, &value)| Load { panel, dof, value };
            Dof::ALL.into_iter().zip(values).map(load)
        });
        loads.filter(|load| load.value != 0.0).collect()
    }

    /// The couple (N mm) on every panel at full load, the sum over the hinges that the couples open.
    pub(crate) fn couples_on_panels(&self, load: &OpeningCoupleConfig) -> Vec<f64> {
        let mut couples = vec![0.0; self.grid().panel_count()];
        let pair = load
            .panels
            .map(|panels| panels.map(|panel| self.panel(panel)));
        for HingeSite { a, b, .. } in hinge_sites(self.grid()) {
            if pair.is_none_or(|pair| pair.contains(&a.0) && pair.contains(&b.0)) {
                couples[a.0] -= load.couple;
                couples[b.0] += load.couple;
            }
        }
        couples
    }

    /// The resultant (N) of a traction at full load.
    pub(crate) fn edge_resultant(&self, load: &EdgeLoadConfig) -> [f64; 2] {
        let [from, to] = EDGES[load.edge as usize].map(|k| self.config.sheet.outline().corners[k]);
        let length = f64::hypot(to[0] - from[0], to[1] - from[1]);
        load.traction.map(|traction| traction * length)
    }

    fn panel(&self, [column, row]: [usize; 2]) -> usize {
        self.grid().panel(column, row)
    }
}
