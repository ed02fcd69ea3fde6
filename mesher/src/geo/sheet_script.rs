//! The mesh of a sheet: the structured mesh of every window, and unless panels are rigid, one
//! surface a panel between windows and edges.

use super::Script;
use super::structured::{self, Rim};
use crate::{Frame, Panels, PlacedWindow, SheetShape, Window, cross, dot, minus, unit};
use std::iter::zip;
use support::{Fault, Point, add_line, refuse};

/// Largest distance of a point on the edge of a panel from it (mm).
const ON_EDGE: f64 = 1e-6;
/// Shortest part of an edge over r_win: a shorter one would give slivers.
const LEAST: f64 = 0.02;
/// Largest size of a panel's elements over the size at its edges.
const COARSEST: f64 = 1.1;

/// The script of a sheet. Its faces are named after the panels, 1 and those after it, and then
/// after the windows.
pub(crate) fn sheet_script(shape: &SheetShape) -> Result<String, Fault> {
    let mut geo = Script::default();
    let size = COARSEST * shape.element_size;
    add_line!(geo.text, "Mesh.MeshSizeMax = {size:?};");
    // The frontal-Delaunay algorithm, whose triangles recombine to good quadrilaterals.
    add_line!(geo.text, "Mesh.Algorithm = 6;");
    add_line!(geo.text, "Mesh.RecombinationAlgorithm = 1;");
    let mut rims: Vec<Vec<Option<Arc>>> =
        shape.panels.iter().map(|panel| vec![None; panel.corners.len()]).collect();
    let mut faces = Vec::new();
    for (number, window) in shape.windows.iter().enumerate() {
        let first = geo.patches + 1;
        geo.frame = window.frame;
        let curves = structured::add(&mut geo, &Window(&window.design), &shape.plane);
        faces.push(first..=geo.patches);
        let sides = [curves.rim_a, curves.rim_b];
        for (rim, (panel, corner)) in zip(sides, window.panels) {
            let ends = rim.ends.map(|end| window.frame.point(end));
            rims[panel][corner] = Some(Arc { number, rim, ends });
        }
    }
    geo.frame = Frame::default();
    rims.retain(|_| shape.model == Panels::Meshed);
    for (panel, rims) in rims.into_iter().enumerate() {
        let outline = PanelOutline { shape, panel, rims };
        let surface = outline.add(&mut geo)?;
        geo.faces(panel + 1, surface..=surface);
    }
    for (window, faces) in faces.into_iter().enumerate() {
        geo.faces(shape.panels.len() + 1 + window, faces);
    }
    Ok(geo.text)
}

/// The arc of a window about a corner of a panel.
#[derive(Clone)]
struct Arc {
    /// Number of the window.
    number: usize,
    rim: Rim,
    /// Its ends in the sheet (mm), counter-clockwise about the window's origin.
    ends: [Point; 2],
}

/// The boundary of a panel without its windows.
struct PanelOutline<'a> {
    shape: &'a SheetShape,
    panel: usize,
    /// The arcs about its corners.
    rims: Vec<Option<Arc>>,
}

impl PanelOutline<'_> {
    /// Adds the panel as one surface, and returns its number.
    fn add(&self, geo: &mut Script) -> Result<i32, Fault> {
        let panel = &self.shape.panels[self.panel];
        // Where the outline reaches and leaves each corner, counter-clockwise: one point, or the
        // ends of an arc, which is passed clockwise.
        let mut ends = Vec::with_capacity(self.rims.len());
        for (corner, arc) in self.rims.iter().enumerate() {
            ends.push(match arc {
                Some(arc) => {
                    self.check_arc(corner, arc)?;
                    let last = arc.rim.points.len() - 1;
                    [(arc.rim.points[last], arc.ends[1]), (arc.rim.points[0], arc.ends[0])]
                }
                None => [(geo.point(panel.corners[corner]), panel.corners[corner]); 2],
            });
        }
        let mut marks = panel.marks.clone();
        let mut outline = Vec::new();
        for corner in 0..self.rims.len() {
            if let Some(arc) = &self.rims[corner] {
                outline.extend(arc.rim.arcs.iter().rev().map(|curve| -curve));
            }
            let (from, to) = (ends[corner][1], ends[(corner + 1) % ends.len()][0]);
            outline.extend(self.edge(geo, corner, [from, to], &mut marks)?);
        }
        let surface = geo.surface(&outline);
        geo.recombine(surface);
        let size = self.shape.element_size;
        for mark in marks {
            self.check_mark(mark)?;
            let id = geo.point(mark);
            add_line!(geo.text, "MeshSize {{{id}}} = {size:?};");
            add_line!(geo.text, "Point{{{id}}} In Surface{{{surface}}};");
        }
        Ok(surface)
    }

    /// Adds the straight edge from a corner to the next, divided at the marks on it, which
    /// are removed.
    fn edge(
        &self,
        geo: &mut Script,
        corner: usize,
        [from, to]: [(i32, Point); 2],
        marks: &mut Vec<Point>,
    ) -> Result<Vec<i32>, Fault> {
        let panel = &self.shape.panels[self.panel];
        let [first, last] = panel.edge(corner);
        let direction = unit(first, last);
        let along = |point: Point| dot(minus(point, from.1), direction);
        let length = along(to.1);
        let radius = (self.rims.iter().flatten().next())
            .map(|arc| self.shape.windows[arc.number].design.r_win);
        let least = radius.map_or(0.0, |radius| LEAST * radius);
        if length <= least {
            let (panel, short, [x, y]) = (self.panel, least - length, first);
            refuse!(
                "panel {panel} is too small for its windows: its edge from ({x:.1}, {y:.1}) mm is {short} mm too \
                 short; use a smaller r_win or larger panels"
            );
        }
        let across = |point: Point| cross(direction, minus(point, from.1)).abs();
        let mut stops: Vec<f64> = Vec::new();
        marks.retain(|mark| {
            let at = along(*mark);
            let on = across(*mark) <= ON_EDGE && at > least && at < length - least;
            if on {
                stops.push(at);
            }
            !on
        });
        stops.sort_unstable_by(f64::total_cmp);
        stops.dedup_by(|next, kept| *next - *kept < ON_EDGE);
        let mut points = vec![(from.0, 0.0)];
        for at in stops {
            let position = [0, 1].map(|i| from.1[i] + at * direction[i]);
            points.push((geo.point(position), at));
        }
        points.push((to.0, length));
        let lines = points.windows(2).map(|pair| {
            let [(start, near), (end, far)] = [pair[0], pair[1]];
            let elements = ((far - near) / self.shape.element_size).round().max(1.0);
            let line = geo.line(start, end);
            geo.divide(line, elements as usize, 1.0)
        });
        Ok(lines.collect())
    }

    /// The arc about a corner ends on the two edges that meet there.
    fn check_arc(&self, corner: usize, arc: &Arc) -> Result<(), Fault> {
        let panel = &self.shape.panels[self.panel];
        let edges = [panel.edge_before(corner), corner];
        for (edge, end) in zip(edges, [arc.ends[1], arc.ends[0]]) {
            let [from, to] = panel.edge(edge);
            let off = cross(unit(from, to), minus(end, from)).abs();
            if off > ON_EDGE {
                let (window, panel) = (arc.number, self.panel);
                refuse!(
                    "the window of hinge {window} does not end on the edges of panel {panel}: it is {off} mm away \
                     from them"
                );
            }
        }
        Ok(())
    }

    /// A mark in the interior is in the panel and outside of its windows.
    fn check_mark(&self, mark: Point) -> Result<(), Fault> {
        let panel = &self.shape.panels[self.panel];
        let [x, y] = mark;
        let to_the_right = |corner: &usize| {
            let [p, q] = panel.edge(*corner);
            (p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
        };
        let inside = (0..panel.corners.len()).filter(to_the_right).count() % 2 == 1;
        let in_window = |arc: &Arc| {
            let PlacedWindow { design, frame, .. } = &self.shape.windows[arc.number];
            let [x, y] = frame.local(mark);
            x.hypot(y) < (1.0 + LEAST) * design.r_win
        };
        let what = if !inside {
            "is not inside the panel"
        } else if self.rims.iter().flatten().any(in_window) {
            "is in the window of a hinge"
        } else {
            return Ok(());
        };
        let panel = self.panel;
        refuse!(
            "the point ({x:.3}, {y:.3}) mm at which panel {panel} is held or pulled {what}: move it"
        )
    }
}
