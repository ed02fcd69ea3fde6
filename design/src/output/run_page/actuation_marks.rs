//! Supports and loads as they are drawn.

use crate::scene::{Scene, SheetEdge, SupportKind};
use serde::Serialize;

/// Supports and loads of a scene at full load.
#[derive(Serialize)]
pub(super) struct ActuationMarks {
    supports: Vec<SupportMark>,
    loads: Vec<LoadMark>,
    edges: Vec<EdgeMark>,
    openings: Vec<OpeningMark>,
}

/// A supported panel.
#[derive(Serialize)]
struct SupportMark {
    panel: usize,
    /// [column, row]
    place: [usize; 2],
    kind: SupportKind,
}

/// A loaded panel, with its force (N) and couple (N mm).
#[derive(Serialize)]
struct LoadMark {
    panel: usize,
    /// [column, row]
    place: [usize; 2],
    force: [f64; 2],
    couple: f64,
}

/// The panels of a loaded edge, with the force on each of them (N).
#[derive(Serialize)]
struct EdgeMark {
    edge: SheetEdge,
    panels: Vec<usize>,
    force: [f64; 2],
}

/// Opening couples: of a hinge, and their sums on the panels (N mm). Supported rotations have none.
#[derive(Serialize)]
struct OpeningMark {
    /// Two neighbours [column, row]; without them every hinge.
    places: Option<[[usize; 2]; 2]>,
    couple: f64,
    on_panels: Vec<(usize, f64)>,
}

impl ActuationMarks {
    pub fn of(scene: &Scene) -> Self {
        let (config, grid) = (&scene.config, scene.grid());
        let panel = |[column, row]: [usize; 2]| grid.panel(column, row);
        let supports = config.supports.iter().map(|support| SupportMark {
            panel: panel(support.panel),
            place: support.panel,
            kind: support.kind,
        });
        let loads = config.loads.iter().map(|load| LoadMark {
            panel: panel(load.panel),
            place: load.panel,
            force: load.force,
            couple: load.couple,
        });
        let edges = config.edge_loads.iter().map(|load| {
            let panels = load.edge.panels(grid);
            let force = scene
                .edge_resultant(load)
                .map(|force| force / panels.len() as f64);
            EdgeMark {
                edge: load.edge,
                panels,
                force,
            }
        });
        let held = |k: usize| {
            let mut supports = config.supports.iter();
            supports.any(|it| panel(it.panel) == k && it.kind.holds()[2])
        };
        let openings = config.opening_couples.iter().map(|load| OpeningMark {
            places: load.panels,
            couple: load.couple,
            on_panels: (scene.couples_on_panels(load).into_iter().enumerate())
                .filter(|(k, couple)| *couple != 0.0 && !held(*k))
                .collect(),
        });
        Self {
            supports: supports.collect(),
            loads: loads.collect(),
            edges: edges.collect(),
            openings: openings.collect(),
        }
    }
}
