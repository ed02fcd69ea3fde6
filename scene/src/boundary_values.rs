//! Supports and loads of a scene on the panels of its sheet: what solver, drawings, run page and
//! report read.

use crate::{
    actuation::{Attached, EdgeLoadConfig, LoadConfig, OpeningCoupleConfig, SupportConfig, name},
    checked_scene::Scene,
};
use design::{
    equilibrium::supports::{Dof, Load, Support},
    geometry::polygon::distance,
    pattern::grid::EDGES,
    sheet::{
        cut_sheet::AttachmentPoint,
        topology::{HingeSite, Topology},
    },
};
use serde::Serialize;
use std::collections::BTreeMap;
use support::Point;

/// Supports and loads at full load.
#[derive(Debug, Serialize)]
pub struct Actuation {
    /// In the order of the scene.
    pub supports: Vec<SupportedPanel>,
    /// Loads on panels, on edges and on hinges.
    pub loads: Vec<AppliedLoad>,
    /// The points of panels at which supports and loads of single panels act, in that order.
    #[serde(skip)]
    pub attachments: Vec<AttachmentPoint>,
    /// What symbols and curved arrows mean.
    pub legend: String,
}

/// A supported panel.
#[derive(Debug, Serialize)]
pub struct SupportedPanel {
    /// Kind and panel.
    pub name: String,
    /// Index of the panel.
    pub panel: usize,
    /// The prescribed ones of (u_x, u_y, phi) (mm, mm, rad).
    pub motion: [Option<f64>; 3],
    /// Outline of its symbol about the point that is held, in halves of the symbol's size.
    pub symbol: Vec<Point>,
    /// The direction in which it rolls.
    pub rail: Option<Point>,
}

/// A load on one or several panels.
#[derive(Debug, Serialize)]
pub struct AppliedLoad {
    /// What is loaded.
    pub name: String,
    /// The loaded panel [column, row], if it is a single one.
    pub place: Option<[usize; 2]>,
    /// (F_x, F_y, M) at the reference points of panels, by their indices (N, N, N mm).
    pub on_panels: Vec<(usize, [f64; 3])>,
    /// Resultant (N), and the couple of each loaded hinge or panel (N mm).
    pub total: [f64; 3],
    /// Text before the resultant in drawings, if it is shown instead of the forces on panels.
    pub label: Option<String>,
}

/// The symbols of the supports.
const SYMBOLS: &str = "Square: clamp; triangle: pin; disc: roller, free along its line.";
/// The couples of the loads on hinges.
const SUMS: &str = "Curved arrows on panels: sums of the opening couples of their hinges.";

impl Scene {
    /// Supports and loads on the panels of the sheet.
    pub fn actuation(&self) -> Actuation {
        let (config, topology) = (&self.config, &*self.topology);
        let supports: Vec<SupportedPanel> =
            (config.supports.iter()).map(|support| support.on(topology)).collect();
        let turns = |panel: usize| {
            let mut held = supports.iter().filter(|support| support.panel == panel);
            held.all(|support| support.motion[2].is_none())
        };
        let corners = config.sheet.outline().corners;
        let down = config.posture.and_then(|posture| posture.down());
        let panels = config.loads.iter().map(|load| load.on(topology, down));
        let edges = config.edge_loads.iter();
        let edges =
            edges.map(|load| load.on(topology, EDGES[load.edge as usize].map(|k| corners[k])));
        let openings = config.opening_couples.iter().map(|load| load.on(topology, turns));
        Actuation {
            attachments: config.attached().map(|it| it.on(topology)).collect(),
            loads: panels.chain(edges).chain(openings).collect(),
            legend: if config.opening_couples.is_empty() {
                SYMBOLS.to_owned()
            } else {
                format!("{SYMBOLS} {SUMS}")
            },
            supports,
        }
    }
}

impl Actuation {
    /// Supports for the solver.
    pub(super) fn boundary_supports(&self) -> Vec<Support> {
        let supports = self.supports.iter().flat_map(|support| {
            let panel = support.panel;
            std::iter::zip(Dof::ALL, support.motion)
                .filter_map(move |(dof, value)| value.map(|value| Support { panel, dof, value }))
        });
        supports.collect()
    }

    /// The sum of all loads on free degrees of freedom, by panels.
    pub fn boundary_loads(&self) -> Vec<Load> {
        let mut total: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        for (panel, load) in self.loads.iter().flat_map(|load| &load.on_panels) {
            let sum = total.entry(*panel).or_default();
            (0..3).for_each(|d| sum[d] += load[d]);
        }
        for support in &self.supports {
            for (d, value) in support.motion.iter().enumerate() {
                if let (Some(_), Some(sum)) = (value, total.get_mut(&support.panel)) {
                    sum[d] = 0.0;
                }
            }
        }
        let loads = total.into_iter().flat_map(|(panel, values)| {
            let load = move |(dof, value)| Load { panel, dof, value };
            std::iter::zip(Dof::ALL, values).map(load)
        });
        loads.filter(|load| load.value != 0.0).collect()
    }
}

/// A panel [column, row] by its number in the drawings, which counts from 0, and its place, which
/// counts from 1.
pub fn panel_name(topology: &Topology, [column, row]: [usize; 2]) -> String {
    let number = topology.number([column, row]);
    format!("panel P{number} (column {}, row {})", column + 1, row + 1)
}

impl SupportConfig {
    fn on(&self, topology: &Topology) -> SupportedPanel {
        let (holds, motion) = (self.kind.holds(), self.motion());
        SupportedPanel {
            name: format!("{}, {}", name(self.kind), panel_name(topology, self.panel)),
            panel: topology.number(self.panel),
            motion: std::array::from_fn(|d| holds[d].then_some(motion[d])),
            symbol: self.kind.symbol(),
            rail: self.kind.rail(),
        }
    }
}

impl Attached {
    fn on(&self, topology: &Topology) -> AttachmentPoint {
        AttachmentPoint {
            name: format!("{}, {}", self.kind, panel_name(topology, self.panel)),
            panel: topology.number(self.panel),
            point: self.at.point(),
            hole: self.hole,
            clip: self.clip,
        }
    }
}

impl LoadConfig {
    /// `down` is the direction of gravity in the plane of the sheet.
    fn on(&self, topology: &Topology, down: Option<[f64; 2]>) -> AppliedLoad {
        let load = self.values(down);
        AppliedLoad {
            name: format!("load, {}", panel_name(topology, self.panel)),
            place: Some(self.panel),
            on_panels: vec![(topology.number(self.panel), load)],
            total: load,
            label: None,
        }
    }
}

impl EdgeLoadConfig {
    /// `from` and `to` are the ends of the edge in the flat sheet.
    fn on(&self, topology: &Topology, [from, to]: [Point; 2]) -> AppliedLoad {
        let length = distance(from, to);
        let resultant = self.traction.map(|traction| traction * length);
        let panels = self.edge.panels(topology);
        let [x, y] = resultant.map(|force| force / panels.len() as f64);
        let edge = format!("{} edge", name(self.edge));
        AppliedLoad {
            name: format!("load, {edge}"),
            place: None,
            on_panels: panels.into_iter().map(|k| (k, [x, y, 0.0])).collect(),
            total: [resultant[0], resultant[1], 0.0],
            label: Some(edge),
        }
    }
}

impl OpeningCoupleConfig {
    /// The sums of the couples on panels that may turn.
    fn on(&self, topology: &Topology, turns: impl Fn(usize) -> bool) -> AppliedLoad {
        let mut couples = vec![0.0; topology.panel_count()];
        let pair = (self.panels).map(|pair| pair.map(|place| topology.number(place)));
        for HingeSite { a, b, .. } in &topology.sites {
            if pair.is_none_or(|pair| pair.contains(&a.0) && pair.contains(&b.0)) {
                couples[a.0] -= self.couple;
                couples[b.0] += self.couple;
            }
        }
        let loaded = couples.into_iter().enumerate();
        let loaded = loaded.filter(|(k, couple)| *couple != 0.0 && turns(*k));
        let place = match self.panels {
            Some(pair) => pair.map(|panel| panel_name(topology, panel)).join(" and "),
            None => "every hinge".to_owned(),
        };
        AppliedLoad {
            name: format!("opening couple, {place}"),
            place: None,
            on_panels: loaded.map(|(k, couple)| (k, [0.0, 0.0, couple])).collect(),
            total: [0.0, 0.0, self.couple],
            label: None,
        }
    }
}
