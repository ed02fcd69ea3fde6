//! Supports and loads as they are drawn.

use crate::scene::{Scene, SheetEdge, SupportKind};
use serde::Serialize;

/// Supports and loads of a scene at full load.
#[derive(Serialize)]
pub(super) struct ActuationMarks {
    supports: Vec<SupportMark>,
    loads: Vec<LoadMark>,
    edges: Vec<EdgeMark>,
    /// Loads that are not drawn, in words.
    notes: Vec<String>,
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
        let notes = config.opening_couples.iter().map(|load| match load.panels {
            None => format!(
                "opening couple of {} N mm on every hinge at full load",
                load.couple
            ),
            Some([[a, b], [c, d]]) => format!(
                "opening couple of {} N mm between panels [{a}, {b}] and [{c}, {d}] at full load",
                load.couple
            ),
        });
        Self {
            supports: supports.collect(),
            loads: loads.collect(),
            edges: edges.collect(),
            notes: notes.collect(),
        }
    }
}
