//! The cells of a sheet: which voids of its pattern are kept, and the shapes of the panels that are
//! trimmed.

use crate::rounding::short;
use design::{
    geometry::polygon::{area, self_crossing},
    pattern::grid::Grid,
    sheet::topology::Topology,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use support::{Fault, Point, ensure, refuse};

/// A kept void in a row of the voids.
const KEPT: char = 'o';
/// A void that is not kept.
const LEFT_OUT: char = '.';

/// The cells that are panels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CellsConfig {
    /// Rows of the voids between the cells from above, one character each: `o` is kept, `.` is not.
    pub voids: Vec<String>,
    /// The panels that are not their cells.
    pub trimmed: Vec<TrimmedPanel>,
}

/// The shape of a panel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrimmedPanel {
    /// [column, row], counted from [0, 0] at the lower left.
    pub panel: [usize; 2],
    /// Its corners in sides of its cell from the lower left corner of the cell, counter-clockwise.
    pub corners: Vec<Point>,
    /// Numbers of the corners, counted from 0, that are on the target when the sheet is open: their
    /// distance from it is measured.
    #[serde(default)]
    pub outer: Vec<usize>,
}

impl From<&Topology> for CellsConfig {
    fn from(topology: &Topology) -> Self {
        let Grid { m, n } = topology.grid;
        let row = |j: usize| {
            let symbol = |i| if topology.has_void(i, j) { KEPT } else { LEFT_OUT };
            (1..m).map(symbol).collect()
        };
        let shapes = std::iter::zip(&topology.places, &topology.trims).enumerate();
        let outer = |number: usize| {
            let of_panel = topology.outer.iter().filter(move |(panel, _)| *panel == number);
            of_panel.map(|(_, corner)| *corner).collect()
        };
        Self {
            voids: (1..n).rev().map(row).collect(),
            trimmed: shapes
                .filter_map(|(number, (panel, trim))| {
                    let corners = trim.as_ref()?.iter().map(|at| at.map(short)).collect();
                    Some(TrimmedPanel { panel: *panel, corners, outer: outer(number) })
                })
                .collect(),
        }
    }
}

impl CellsConfig {
    /// The panels and hinges that it describes.
    pub(crate) fn topology(&self, grid: Grid) -> Result<Topology, Fault> {
        let built = self.built(grid);
        let wrong = |what| format!("cells: {what}: write them again by `kirigami init --target`");
        Ok(built.map_err(wrong)?)
    }

    fn built(&self, grid: Grid) -> Result<Topology, Fault> {
        let fits = |row: &String| {
            row.chars().count() == grid.m - 1 && row.chars().all(|c| c == KEPT || c == LEFT_OUT)
        };
        ensure!(
            self.voids.len() == grid.n - 1 && self.voids.iter().all(fits),
            "`voids` are not {} rows of {} characters `{KEPT}` and `{LEFT_OUT}`, the voids between {} x {} cells",
            grid.n - 1,
            grid.m - 1,
            grid.m,
            grid.n
        );
        let rows = self.voids.iter().rev();
        let kept: Vec<bool> = rows.flat_map(|row| row.chars().map(|c| c == KEPT)).collect();
        let mut topology = Topology::of_voids(grid, &kept);
        ensure!(
            topology.is_mechanism(),
            "the kept `voids` are no mechanism of one piece: each must have a kept neighbour in its row or column, and \
             all must be joined"
        );
        for TrimmedPanel { panel: [p, q], corners, outer } in &self.trimmed {
            let Some(number) = topology.panel(*p, *q) else {
                refuse!("`trimmed` names the cell [{p}, {q}], which is no panel");
            };
            let simple = corners.len() > 2 && corners.iter().flatten().all(|x| x.abs() < 100.0);
            ensure!(
                simple && area(corners) > 0.0 && self_crossing(corners).is_none(),
                "the corners of panel [{p}, {q}] are no polygon, counter-clockwise, that does not cross itself"
            );
            if let Some(corner) = outer.iter().find(|corner| **corner >= corners.len()) {
                refuse!("panel [{p}, {q}] has no corner {corner}, which is `outer`");
            }
            topology.outer.extend(outer.iter().map(|corner| (number, *corner)));
            topology.trims[number] = Some(corners.as_slice().into());
        }
        Ok(topology)
    }
}
