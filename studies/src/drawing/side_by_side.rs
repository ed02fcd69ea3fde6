//! Sheets side by side at one scale: flat above, deployed with their targets below.

use crate::tessellation::{Defects, Tessellation};
use design::geometry::polygon::{area, bounds, common};
use design::pattern::grid::Grid;
use design::sheet::topology::is_even;
use output::display::{Anchor, Canvas, Colour, Style};
use output::drawing::page::{ACCENT, INK, MUTED, PANELS};

/// Colour of area that the flat panels do not cover.
const VOID: Colour = [246, 165, 95];
/// Colour of overlaps.
const OVERLAP: Colour = [139, 26, 26];

/// One sheet with its target.
pub struct Column<'a> {
    pub title: &'a str,
    /// Text below the deployed sheet.
    pub lines: Vec<String>,
    pub tessellation: &'a Tessellation,
    pub target: &'a [[f64; 2]],
}

/// The picture; empty without columns.
pub fn side_by_side(columns: &[Column]) -> String {
    let deployed = |column: &Column| {
        let panels = column.tessellation.deployed.iter().flatten();
        bounds(panels.chain(column.target).copied())
    };
    let flat = |column: &Column| {
        let sheet = column.tessellation;
        bounds(
            (sheet.flat.iter().flatten())
                .chain(&sheet.outline.corners)
                .copied(),
        )
    };
    let size = |of: &dyn Fn(&Column) -> [[f64; 2]; 2], axis: usize| {
        let sizes = columns
            .iter()
            .map(|column| of(column)[1][axis] - of(column)[0][axis]);
        sizes.fold(0.0, f64::max)
    };
    let width = 1.1 * f64::max(size(&deployed, 0), size(&flat, 0));
    let unit = width / 300.0;
    let (high_flat, high_deployed) = (1.1 * size(&flat, 1), 1.1 * size(&deployed, 1));
    let lines = columns
        .iter()
        .map(|column| column.lines.len())
        .max()
        .unwrap_or(0);
    let (title, text) = (34.0 * unit, 17.0 * unit);
    let bottom = -high_flat - high_deployed - title - text * (lines as f64 + 2.5);
    let right = width * columns.len() as f64;
    let page = [[0.0, bottom], [right, 0.0]];
    let mut canvas = Canvas::on_white(page);
    for (c, column) in columns.iter().enumerate() {
        let middle = width * (c as f64 + 0.5);
        let ink = Style::fill(INK).bold();
        canvas.text(
            [middle, -24.0 * unit],
            16.0 * unit,
            Anchor::Middle,
            ink,
            column.title,
        );
        let sheet = column.tessellation;
        let onto = |[low, high]: [[f64; 2]; 2], y: f64| {
            let centre = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
            move |[a, b]: [f64; 2]| [middle + a - centre[0], y + b - centre[1]]
        };
        let place = onto(flat(column), -title - 0.5 * high_flat);
        canvas.polygon(&sheet.outline.corners.map(place), Style::fill(VOID));
        panels(&mut canvas, sheet.grid, &sheet.flat, place);
        let place = onto(deployed(column), -title - high_flat - 0.5 * high_deployed);
        panels(&mut canvas, sheet.grid, &sheet.deployed, place);
        let target: Vec<_> = column.target.iter().map(|point| place(*point)).collect();
        let dashed = Style::stroke(ACCENT, 1.5 * unit).dashed(6.0 * unit, 4.0 * unit);
        canvas.polygon(&target, dashed);
        for (i, line) in column.lines.iter().enumerate() {
            let y = -title - high_flat - high_deployed - text * (i as f64 + 1.0);
            let muted = Style::fill(MUTED);
            canvas.text([middle, y], 12.0 * unit, Anchor::Middle, muted, line);
        }
    }
    let torn = |column: &Column| {
        let Defects { overlap, void, .. } = column.tessellation.defects();
        overlap[0] + overlap[1] + void > 1e-6
    };
    if columns.iter().any(torn) {
        legend(&mut canvas, [0.5 * right, bottom + 0.7 * text], unit);
    }
    canvas.svg(page, 1600.0, "px")
}

fn legend(canvas: &mut Canvas, [x, y]: [f64; 2], unit: f64) {
    let muted = Style::fill(MUTED);
    let entries = [
        (VOID, "area that no panel covers", x - 245.0 * unit),
        (OVERLAP, "panels that overlap", x + 25.0 * unit),
    ];
    for (colour, text, x) in entries {
        let (side, low) = (11.0 * unit, y - 1.0 * unit);
        let square = [
            [x, low],
            [x + side, low],
            [x + side, low + side],
            [x, low + side],
        ];
        canvas.polygon(&square, Style::fill(colour));
        canvas.text(
            [x + 17.0 * unit, y],
            12.0 * unit,
            Anchor::Start,
            muted,
            text,
        );
    }
}

fn panels(
    canvas: &mut Canvas,
    grid: Grid,
    panels: &[[[f64; 2]; 4]],
    place: impl Fn([f64; 2]) -> [f64; 2],
) {
    let mean = panels.iter().map(|panel| area(panel).abs()).sum::<f64>() / panels.len() as f64;
    let edge = 0.025 * mean.sqrt();
    for (k, panel) in panels.iter().enumerate() {
        let fill = PANELS[usize::from(!is_even(grid, k))];
        let style = Style::stroke(INK, edge).round().filled(fill);
        canvas.polygon(&panel.map(&place), style);
    }
    for (k, panel) in panels.iter().enumerate() {
        for other in &panels[..k] {
            let shared = common(panel, other);
            if area(&shared) > 1e-4 * mean {
                let shared: Vec<_> = shared.into_iter().map(&place).collect();
                canvas.polygon(&shared, Style::fill(OVERLAP).opacity(0.8, 1.0));
            }
        }
    }
}
