//! One sheet under several actuations, one row each, as in Fig. 6 of the paper: loads and supports; the
//! flat pattern, panels coloured by their area; the deployed sheet with its target, unit cells
//! coloured by the family of their void; the transmitted forces.

use design::analysis::force_transmission::{ForceTransmission, Interface};
use design::analysis::tension_lines::TensionLine;
use design::geometry::polygon::bounds;
use design::objective::design_problem::Deployment;
use design::scene::{Scene, SupportKind};
use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::deployed_corners;
use design::sheet::topology::is_even;
use output::display::{Anchor, Canvas, Colour, Style};
use output::drawing::page::{ACCENT, INK, MUTED, PANELS, TEAL};

/// A row of the picture.
pub struct ActuationRow<'a> {
    pub label: &'a str,
    pub scene: &'a Scene,
    /// The flat sheet at the start of the search.
    pub start: &'a Sheet,
    pub deployment: &'a Deployment,
    pub transmission: &'a ForceTransmission,
    pub lines: &'a [TensionLine],
    /// The vertices of the unit cells and the families of their voids.
    pub families: &'a [([usize; 2], usize)],
}

const WIDTH_PX: f64 = 2400.0;
/// Colours of the void families; further families have the last colour.
const FAMILIES: [Colour; 3] = [[227, 168, 87], [124, 179, 166], [180, 159, 209]];
const PLAIN: Colour = [244, 245, 247];
/// Colours of panels with a quarter of, once and four times their area at the start.
const AREAS: [[f64; 3]; 3] = [
    [180.0, 83.0, 9.0],
    [250.0, 250.0, 250.0],
    [21.0, 128.0, 61.0],
];
/// Scales and names of the columns.
const COLUMNS: [(f64, &str); 4] = [
    (0.55, "(a) actuation"),
    (1.0, "(b) flat, by panel area"),
    (1.0, "(c) deployed, target dashed"),
    (0.85, "(d) forces within"),
];

/// The picture; empty without rows.
pub fn actuations(rows: &[ActuationRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let layout = Layout::new(rows, first);
    let page = [[0.0; 2], [layout.width, layout.height]];
    let mut canvas = Canvas::on_white(page);
    let bold = Style::fill(INK).bold();
    let u = layout.unit;
    for ((_, name), left) in COLUMNS.iter().zip(layout.left) {
        let at = [left, layout.height - 22.0 * u];
        canvas.text(at, 13.0 * u, Anchor::Start, bold, name);
    }
    for (i, row) in rows.iter().enumerate() {
        let bottom = layout.height - 40.0 * u - layout.row * (i as f64 + 1.0);
        let middle = bottom + 0.5 * layout.row;
        canvas.text([12.0 * u, middle], 20.0 * u, Anchor::Start, bold, row.label);
        let cell = |column: usize, [low, high]: [[f64; 2]; 2]| Cell {
            scale: COLUMNS[column].0,
            // The content between `low` and `high` is centred in the row.
            origin: [
                layout.left[column] - COLUMNS[column].0 * low[0],
                middle - COLUMNS[column].0 * 0.5 * (low[1] + high[1]),
            ],
            unit: u,
        };
        let flat = bounds(row.start.outline.corners);
        let open = bounds(row.scene.target.points.iter().copied());
        boundary_values(&mut canvas, &cell(0, flat), row);
        flat_areas(&mut canvas, &cell(1, flat), row);
        deployed(&mut canvas, &cell(2, open), row);
        forces(&mut canvas, &cell(3, open), row);
    }
    legend(&mut canvas, &layout);
    canvas.svg(page, WIDTH_PX, "px")
}

/// Positions of columns and rows (mm of the sheet).
struct Layout {
    width: f64,
    height: f64,
    /// A thousandth of the width.
    unit: f64,
    left: [f64; 4],
    /// Height of a row.
    row: f64,
}

impl Layout {
    fn new(rows: &[ActuationRow], first: &ActuationRow) -> Self {
        let size = |[low, high]: [[f64; 2]; 2]| [high[0] - low[0], high[1] - low[1]];
        let flat = size(bounds(first.start.outline.corners));
        let open = size(bounds(first.scene.target.points.iter().copied()));
        let gap = 0.12 * open[0];
        // Arrows extend beyond the flat sheet of the first column, which has labels at its left.
        let widths = [1.3 * flat[0], flat[0], open[0], open[0]];
        let mut left = [1.9 * gap; 4];
        for column in 1..4 {
            left[column] = left[column - 1] + COLUMNS[column - 1].0 * widths[column - 1] + gap;
        }
        let width = left[3] + COLUMNS[3].0 * widths[3] + 0.5 * gap;
        let (unit, row) = (width / 1000.0, 1.1 * open[1]);
        Self {
            width,
            height: row * rows.len() as f64 + 90.0 * unit,
            unit,
            left,
            row,
        }
    }
}

/// An area of the page in which a sheet is drawn.
struct Cell {
    origin: [f64; 2],
    scale: f64,
    unit: f64,
}

impl Cell {
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.origin[0] + self.scale * x,
            self.origin[1] + self.scale * y,
        ]
    }

    fn polygon(&self, canvas: &mut Canvas, points: &[[f64; 2]], style: Style) {
        let points: Vec<_> = points.iter().map(|point| self.at(*point)).collect();
        canvas.polygon(&points, style);
    }

    fn stroke(&self, colour: Colour, width: f64) -> Style {
        Style::stroke(colour, width * self.unit).round()
    }
}

fn boundary_values(canvas: &mut Canvas, cell: &Cell, row: &ActuationRow) {
    let u = cell.unit;
    for (k, panel) in row.start.panels.iter().enumerate() {
        let fill = PANELS[usize::from(!is_even(row.start.grid, k))];
        let style = cell.stroke([195, 203, 212], 0.4).filled(fill);
        cell.polygon(canvas, &panel.corners, style);
    }
    let centroid = |[column, line]: [usize; 2]| {
        cell.at(row.start.panels[row.start.grid.panel(column, line)].centroid)
    };
    let ink = Style::fill(INK);
    for support in &row.scene.config.supports {
        let [x, y] = centroid(support.panel);
        match support.kind {
            SupportKind::RollerX | SupportKind::RollerY => canvas.circle([x, y], 4.0 * u, ink),
            SupportKind::Pin | SupportKind::Clamp => {
                let triangle = [[-5.0, -6.0], [5.0, -6.0], [0.0, 3.0]];
                canvas.polygon(&triangle.map(|[a, b]| [x + a * u, y + b * u]), ink);
            }
        }
    }
    let loads = &row.scene.config.loads;
    let size = |[x, y]: [f64; 2]| f64::hypot(x, y);
    let max = loads
        .iter()
        .map(|load| size(load.force))
        .fold(0.0, f64::max);
    let (stroke, fill) = (cell.stroke(ACCENT, 1.8), Style::fill(ACCENT));
    for load in loads {
        let [x, y] = centroid(load.panel);
        let force = size(load.force);
        if force > 0.0 {
            let [c, s] = load.force.map(|component| component / force);
            let length = (12.0 + 18.0 * force / max) * u;
            let at =
                |along: f64, aside: f64| [x + along * c - aside * s, y + along * s + aside * c];
            canvas.line([x, y], at(length - 5.0 * u, 0.0), stroke);
            let head = [
                at(length, 0.0),
                at(length - 7.0 * u, 3.2 * u),
                at(length - 7.0 * u, -3.2 * u),
            ];
            canvas.polygon(&head, fill);
        }
        if load.couple != 0.0 {
            let sense = if load.couple > 0.0 {
                "\u{21ba}"
            } else {
                "\u{21bb}"
            };
            canvas.text([x, y + 6.0 * u], 24.0 * u, Anchor::Middle, fill, sense);
        }
    }
}

fn flat_areas(canvas: &mut Canvas, cell: &Cell, row: &ActuationRow) {
    let edge = cell.stroke(INK, 0.5);
    for (panel, start) in std::iter::zip(&row.deployment.sheet.panels, &row.start.panels) {
        let colour = area_colour(panel.area / start.area);
        cell.polygon(canvas, &panel.corners, edge.filled(colour));
    }
}

fn deployed(canvas: &mut Canvas, cell: &Cell, row: &ActuationRow) {
    let sheet = &row.deployment.sheet;
    let mut fills = vec![PLAIN; sheet.panels.len()];
    for &([i, j], family) in row.families {
        for (p, q) in [(i - 1, j - 1), (i, j - 1), (i - 1, j), (i, j)] {
            fills[sheet.grid.panel(p, q)] = FAMILIES[family.min(FAMILIES.len() - 1)];
        }
    }
    let edge = cell.stroke(INK, 0.5);
    let corners = deployed_corners(sheet, &row.deployment.final_step().configuration);
    for (corners, fill) in corners.iter().zip(fills) {
        cell.polygon(canvas, corners, edge.filled(fill));
    }
    let u = cell.unit;
    let style = cell.stroke(ACCENT, 1.2).dashed(5.0 * u, 3.5 * u);
    cell.polygon(canvas, &row.scene.target.points, style);
}

fn forces(canvas: &mut Canvas, cell: &Cell, row: &ActuationRow) {
    let (transmission, u) = (row.transmission, cell.unit);
    let corners = deployed_corners(
        &row.deployment.sheet,
        &row.deployment.final_step().configuration,
    );
    let mut pressed = vec![0.0; corners.len()];
    for interface in &transmission.interfaces {
        for panel in interface.panels {
            pressed[panel] += (-interface.normal).max(0.0);
        }
    }
    let most = pressed.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let edge = cell.stroke([195, 203, 212], 0.5);
    for (corners, pressed) in corners.iter().zip(pressed) {
        cell.polygon(canvas, corners, edge.filled([255; 3]));
        let fraction = pressed / most;
        let style = Style::fill(TEAL).opacity(fraction, 1.0);
        cell.polygon(canvas, corners, style);
    }
    let maximum = |size: &dyn Fn(&Interface) -> f64| {
        (transmission.interfaces.iter().map(size)).fold(f64::MIN_POSITIVE, f64::max)
    };
    let most_tension = maximum(&|it| it.normal);
    for line in row.lines {
        for &h in &line.interfaces {
            let interface = &transmission.interfaces[h];
            let style = cell.stroke(ACCENT, 0.8 + 3.6 * interface.normal / most_tension);
            let hinge = cell.at(interface.at);
            for panel in interface.panels {
                canvas.line(cell.at(transmission.centroids[panel]), hinge, style);
            }
        }
    }
    let most_shear = maximum(&|it| it.tangential.abs());
    let ink = Style::fill(INK);
    for h in transmission.strongest(|it| it.tangential.abs()) {
        let interface = &transmission.interfaces[h];
        let fraction = interface.tangential.abs() / most_shear;
        canvas.circle(cell.at(interface.at), (0.7 + 2.3 * fraction) * u, ink);
    }
}

fn legend(canvas: &mut Canvas, layout: &Layout) {
    let u = layout.unit;
    let (muted, y, height) = (Style::fill(MUTED), 20.0 * u, 11.0 * u);
    let text = |canvas: &mut Canvas, x: f64, text: &str| {
        canvas.text([x, y], height, Anchor::Start, muted, text);
    };
    let swatch = |canvas: &mut Canvas, x: f64, style: Style| {
        let (low, high) = (y - 1.5 * u, y + 8.5 * u);
        let corners = [
            [x, low],
            [x + 10.0 * u, low],
            [x + 10.0 * u, high],
            [x, high],
        ];
        canvas.polygon(&corners, style);
    };
    text(canvas, layout.left[0], "\u{25b2} pin   \u{25cf} roller");
    for step in 0..=16 {
        let ratio = 2f64.powf(step as f64 / 4.0 - 2.0);
        let x = layout.left[1] + 26.0 * u + 6.0 * u * f64::from(step);
        swatch(canvas, x, Style::fill(area_colour(ratio)));
    }
    text(canvas, layout.left[1], "\u{bc}");
    text(canvas, layout.left[1] + 138.0 * u, "4 \u{d7} area");
    for (k, colour) in FAMILIES.iter().enumerate() {
        let x = layout.left[2] + 70.0 * u * k as f64;
        swatch(canvas, x, Style::fill(*colour));
        text(canvas, x + 14.0 * u, &format!("family {}", k + 1));
    }
    let x = layout.left[3];
    let line = Style::stroke(ACCENT, 3.0 * u);
    canvas.line([x, y + 3.5 * u], [x + 12.0 * u, y + 3.5 * u], line);
    text(canvas, x + 16.0 * u, "tension");
    swatch(canvas, x + 70.0 * u, Style::fill(TEAL));
    text(canvas, x + 84.0 * u, "compression");
    canvas.circle([x + 172.0 * u, y + 3.5 * u], 2.6 * u, Style::fill(INK));
    text(canvas, x + 179.0 * u, "shear");
}

/// Brown for panels with reduced area, white for unchanged area, green for increased area.
fn area_colour(ratio: f64) -> Colour {
    let position = (0.5 * ratio.log2() + 1.0).clamp(0.0, 2.0);
    let stop = (position as usize).min(1);
    let f = position - stop as f64;
    [0, 1, 2].map(|c| (AREAS[stop][c] + f * (AREAS[stop + 1][c] - AREAS[stop][c])).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_are_coloured_by_the_logarithm_of_their_area() {
        assert_eq!(area_colour(1.0), [250, 250, 250]);
        assert_eq!(area_colour(0.25), area_colour(0.1));
        assert_eq!(area_colour(4.0), [21, 128, 61]);
    }
}
