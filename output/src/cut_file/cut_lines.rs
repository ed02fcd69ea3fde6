//! The paths of the cutting tool, from the simulated geometry.
//!
//! A slit runs between the tips O of the hinges at its ends, so that each hinge keeps its ligament
//! w_lig; a slit that is open on the outline starts there. Each slit ends in a hole of radius rho_f
//! w_lig, which is drilled about O.
//!
//! **Ligament.** w_lig is the material between O and the finished edge of the secondary cut, as in
//! the window: the distance of O from the line of that cut is larger by half the slit. The hole
//! reduces the ligament by its radius, so that a caliper next to the hole reads (1 - rho_f) w_lig,
//! [`CutLines::caliper`].
//!
//! **Kerf.** The kerf is the width that the tool removes. A slit as wide is one pass along its line;
//! a wider one is a closed path along its flanks. Closed paths are offset by half the kerf (holes and
//! slits inwards, the outline outwards), so that finished holes, slits and sheet have their nominal
//! size.
//!
//! **Over-run.** A slit that is open on the outline is cut beyond the finished edge, so that no web
//! is left between the two cuts.

use crate::{
    cut_file::{
        attachments::PlacedAttachment,
        cut_drawing::{CutDrawing, Layer},
        gaps::{self, Cut},
    },
    display::Shape,
};
use design::{
    geometry::{
        polygon::{
            bounds, distance, distance_between_segments, distance_to_segment, edges, side, size,
        },
        region::Ring,
    },
    objective::design_problem::Deployment,
    pattern::cut_pattern::CutPattern,
    sheet::cut_sheet::{AttachmentPoint, Hinge, Sheet},
};
use scene::{CuttingConfig, Scene};
use std::collections::BTreeMap;
use support::{Extremes, Fault, Point, ensure};

/// The least 1 + cos of the turn of an outline at a corner that moves in full with its edges.
const SHARPEST: f64 = 0.1;
/// Rounding of lengths in a sheet of up to a metre (mm); in proportion in a larger one, since corners of
/// the union of panels are on a raster of a billionth of its size.
const ROUNDING: f64 = 1e-5;
const METRE: f64 = 1000.0;

/// One straight cut through the sheet.
#[derive(Clone, Copy, Debug)]
pub struct Slit {
    /// Its ends (mm); the first is always the tip O of a hinge.
    pub ends: [Point; 2],
    /// The hinge at each end; `None` at an end that is open on the outline.
    pub hinges: [Option<usize>; 2],
}

/// The drilled end of a slit.
#[derive(Clone, Copy, Debug)]
pub struct Hole {
    /// The tip O of its hinge (mm).
    pub centre: Point,
    /// Radius of the finished hole: rho_f w_lig (mm).
    pub radius: f64,
}

/// The finished geometry of a cut sheet.
#[derive(Clone, Debug)]
pub struct CutLines {
    /// All cuts inside the sheet, each once.
    pub slits: Vec<Slit>,
    /// One per hinge.
    pub holes: Vec<Hole>,
    /// Contours of the sheet: outer ones counter-clockwise, holes clockwise (mm).
    pub outlines: Vec<Ring>,
    /// Width of the slits (mm).
    pub slit_width: f64,
    /// How the sheet is cut.
    pub cutting: CuttingConfig,
    /// Where panels are held and pulled.
    pub attachments: Vec<PlacedAttachment>,
}

impl CutLines {
    /// The cuts of a deployed design of a scene.
    pub fn of(scene: &Scene, deployment: &Deployment) -> Result<Self, Fault> {
        let attachments = scene.actuation().attachments;
        let (pattern, sheet) = (&deployment.pattern, &deployment.sheet);
        Self::new(pattern, sheet, scene.config.cutting, &attachments)
    }

    /// The cuts of `sheet`, which must come from `pattern`, held and pulled at `attachments`. They
    /// are checked to leave every ligament as wide as in the model, to cut every edge of a panel,
    /// and to meet nowhere, so that the sheet stays in one piece.
    pub fn new(
        pattern: &CutPattern,
        sheet: &Sheet,
        cutting: CuttingConfig,
        attachments: &[AttachmentPoint],
    ) -> Result<Self, Fault> {
        let process = sheet.options.process;
        let holes: Vec<Hole> = sheet
            .hinges
            .iter()
            .map(|hinge| Hole { centre: hinge.tip, radius: process.hole_radius(hinge.w_lig) })
            .collect();
        for (hinge, hole) in holes.iter().enumerate() {
            let (diameter, slit) = (2.0 * hole.radius, process.slit_width);
            ensure!(
                diameter > slit,
                "the hole of hinge {hinge} is {diameter:.3} mm wide, which must exceed the slit of {slit} mm: \
                 increase the ligament width or the fillet ratio"
            );
        }
        let cuts = Self {
            slits: slits(pattern, sheet, &holes)?,
            holes,
            outlines: sheet.outlines(),
            slit_width: process.slit_width,
            cutting,
            attachments: (attachments.iter())
                .map(|attachment| PlacedAttachment::new(sheet, attachment))
                .collect::<Result<_, _>>()?,
        };
        cuts.reach_what_they_cut(sheet)?;
        gaps::check(cuts.finished(), &cuts.outlines, cuts.slit_width)?;
        Ok(cuts)
    }

    /// The ligaments at the ends of a cut shorten it: every ligament must still end at its
    /// secondary cut, and every edge of a panel must be cut somewhere.
    fn reach_what_they_cut(&self, sheet: &Sheet) -> Result<(), Fault> {
        let rounding = self.rounding();
        for (hinge, modelled) in sheet.hinges.iter().enumerate() {
            let (width, modelled) = (self.clearance(hinge), modelled.w_lig);
            ensure!(
                width <= modelled + rounding,
                "the cut opposite hinge {hinge} ends before its ligament, which is {width:.3} mm wide there and {modelled:.3} mm in \
                 the model: narrow the ligaments at the ends of that cut, or keep the panels larger (objective.panel_shape, \
                 objective.min_panel_width)"
            );
        }
        let slits = self.slits.iter().map(|slit| slit.ends);
        let lines: Vec<_> = slits.chain(self.outline_edges()).collect();
        for (panel, of) in sheet.panels.iter().enumerate() {
            let is_cut = |edge: [Point; 2]| lines.iter().any(|line| carries(line, edge, rounding));
            // A trimmed panel has another edge where it hangs together with no neighbour.
            let hangs = |side| {
                let other = sheet.topology.beyond(panel, side);
                let both = |hinge: &Hinge| {
                    let panels = hinge.panels();
                    panels.contains(&panel) && other.is_some_and(|other| panels.contains(&other))
                };
                sheet.hinges.iter().any(both)
            };
            let is_edge = |side| !of.is_trimmed() || hangs(side);
            let mut sides = edges(&of.corners).enumerate().filter(|(side, _)| is_edge(*side));
            ensure!(
                sides.all(|(_, (p, q))| is_cut([p, q])),
                "an edge of panel {panel} is not cut: the ligaments at its ends are longer than the edge: narrow them, or keep the \
                 panels larger (objective.panel_shape, objective.min_panel_width)"
            );
        }
        Ok(())
    }

    /// The finished holes and slits.
    fn finished(&self) -> Vec<Cut> {
        let holes = self.holes.iter().enumerate().map(|(hinge, hole)| Cut {
            ends: [hole.centre; 2],
            radius: hole.radius,
            hinges: vec![hinge],
        });
        let slits = self.slits.iter().map(|slit| Cut {
            ends: slit.ends,
            radius: 0.5 * self.slit_width,
            hinges: slit.hinges.into_iter().flatten().collect(),
        });
        holes.chain(slits).collect()
    }

    /// Width that the tool removes (mm).
    pub fn kerf(&self) -> f64 {
        self.cutting.tool_kerf(self.slit_width)
    }

    /// Whether a tool of the given kerf (mm) cuts a slit in one pass along its line.
    pub(super) fn is_one_pass(&self, kerf: f64) -> bool {
        kerf > self.slit_width - ROUNDING
    }

    /// The paths of the tool, in the order of the pattern.
    pub fn drawing(&self) -> CutDrawing {
        let kerf = self.kerf();
        self.paths(kerf, self.is_one_pass(kerf), 0.0, true)
    }

    /// The paths of a tool of the given kerf (mm), which cuts lines, or else around slits; crosses
    /// in place of holes of a diameter below `least_hole` (mm), and marks.
    pub(super) fn paths(&self, kerf: f64, lines: bool, least_hole: f64, marks: bool) -> CutDrawing {
        let mut drawing = CutDrawing::default();
        let mut hole = |layer, centre, radius| match 2.0 * radius < least_hole {
            true => drawing.add_cross(Layer::Punch, centre, radius),
            false => drawing.add(layer, Shape::Circle { centre, radius: radius - 0.5 * kerf }),
        };
        for Hole { centre, radius } in self.holes.iter().filter(|_| lines) {
            hole(Layer::Holes, *centre, *radius);
        }
        for attachment in &self.attachments {
            if let Some(diameter) = attachment.hole {
                hole(Layer::AttachmentHoles, attachment.at, 0.5 * diameter);
            }
        }
        if marks {
            self.attachments.iter().for_each(|attachment| attachment.mark(&mut drawing));
        }
        if !lines {
            self.add_contours(&mut drawing, kerf);
            return drawing;
        }
        for slit in &self.slits {
            drawing.add(Layer::Cut, Shape::Line(self.tool_slit(slit)));
        }
        for outline in self.outlines_at(0.5 * kerf) {
            drawing.add(Layer::Outline, Shape::Polygon(outline));
        }
        drawing
    }

    /// The path of the tool along a slit: with the over-run at an end that is open on the outline
    /// (mm).
    pub fn tool_slit(&self, slit: &Slit) -> [Point; 2] {
        let [from, to] = slit.ends;
        match slit.hinges[1] {
            Some(_) => slit.ends,
            None => {
                let longer = 1.0 + self.cutting.over_run / distance(from, to);
                let end = [0, 1].map(|axis| from[axis] + longer * (to[axis] - from[axis]));
                [from, end]
            }
        }
    }

    /// Width of a ligament as measured by a caliper, from the edge of its hole to the secondary cut
    /// (mm).
    pub fn caliper(&self, hinge: usize) -> f64 {
        self.clearance(hinge) - self.holes[hinge].radius
    }

    /// The path of the tool's centre around the sheet (mm).
    pub fn tool_outlines(&self) -> Vec<Ring> {
        self.outlines_at(0.5 * self.kerf())
    }

    /// Rounding of lengths in the sheet (mm).
    pub(crate) fn rounding(&self) -> f64 {
        let [width, height] = size(bounds(self.outlines.iter().flatten().copied()));
        ROUNDING * (width.max(height) / METRE).max(1.0)
    }

    /// The edges of the outlines.
    fn outline_edges(&self) -> impl Iterator<Item = [Point; 2]> {
        self.outlines.iter().flat_map(|outline| edges(outline)).map(|(p, q)| [p, q])
    }

    /// The outlines moved outwards by a distance (mm).
    pub(super) fn outlines_at(&self, off: f64) -> Vec<Ring> {
        self.outlines.iter().map(|outline| moved_outwards(outline, off)).collect()
    }

    /// Material between the tip O of a hinge and the nearest cut other than its own (mm).
    ///
    /// It is w_lig for a valid hinge, and less if another cut is closer than the secondary cut.
    /// Half of a slit lies on this side of its line.
    pub fn clearance(&self, hinge: usize) -> f64 {
        let tip = self.holes[hinge].centre;
        let to_slits =
            self.slits.iter().filter(|slit| !slit.hinges.contains(&Some(hinge))).map(|slit| {
                distance_to_segment(tip, slit.ends[0], slit.ends[1]) - 0.5 * self.slit_width
            });
        let to_outline = self.outline_edges().map(|[p, q]| distance_to_segment(tip, p, q));
        to_slits.chain(to_outline).smallest()
    }
}

/// A contour moved outwards by a distance (mm).
fn moved_outwards(outline: &[Point], off: f64) -> Ring {
    let count = outline.len();
    let outward = |k: usize| {
        let (p, q) = (outline[k % count], outline[(k + 1) % count]);
        let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
        [dy / dx.hypot(dy), -dx / dx.hypot(dy)]
    };
    let moved = |k: usize| {
        // The corner moves so that both of its edges move by the distance; a sharp one less.
        let (a, b) = (outward(k + count - 1), outward(k));
        let shift = off / (1.0 + a[0] * b[0] + a[1] * b[1]).max(SHARPEST);
        let corner = outline[k];
        [corner[0] + shift * (a[0] + b[0]), corner[1] + shift * (a[1] + b[1])]
    };
    (0..count).map(moved).collect()
}

/// Whether an edge lies along a line, at least in part, but for a rounding (mm).
fn carries(line: &[Point; 2], edge: [Point; 2], rounding: f64) -> bool {
    let [a, b] = *line;
    edge.iter().all(|end| (side((a, b), *end) / distance(a, b)).abs() < rounding)
        && distance_between_segments(*line, edge) < rounding
}

/// Every slit once: the main cut of one hinge (open on the outline) or of two.
fn slits(pattern: &CutPattern, sheet: &Sheet, holes: &[Hole]) -> Result<Vec<Slit>, Fault> {
    let sites = &sheet.topology.sites;
    let at_corner: BTreeMap<usize, usize> =
        sites.iter().enumerate().map(|(hinge, site)| (site.corner, hinge)).collect();
    let mut slits = Vec::new();
    for (hinge, site) in sites.iter().enumerate() {
        let other = at_corner
            .get(&site.main_end)
            .copied()
            .filter(|&other| sites[other].main_end == site.corner);
        if other.is_some_and(|other| other < hinge) {
            continue;
        }
        let tip = holes[hinge].centre;
        let end = other.map_or(pattern.points[site.main_middle], |other| holes[other].centre);
        let main = sheet.hinges[hinge].main;
        let length = main[0] * (end[0] - tip[0]) + main[1] * (end[1] - tip[1]);
        let drilled = holes[hinge].radius + other.map_or(0.0, |other| holes[other].radius);
        ensure!(
            length > drilled,
            "the slit at hinge {hinge} would be {length:.3} mm long, but the holes at its ends take \
             {drilled:.3} mm: narrow the ligament or lengthen the cut"
        );
        slits.push(Slit { ends: [tip, end], hinges: [Some(hinge), other] });
    }
    Ok(slits)
}
