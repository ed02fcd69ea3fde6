//! Checks of the tool's paths, as they are written, against the sheet that was simulated.
//!
//! * Every hinge has its hole, and the nearest cut is no further from its tip than w_lig.
//! * The edges of every panel lie on cuts, and the polygon between these cuts has the area of the panel.
//! * Two cuts leave at least the kerf between them, and so do cuts and outline. A slit then meets the outline at most
//!   once and no other cut, so that the sheet stays in one piece.

use crate::cut_file::cut_drawing::{CutDrawing, Layer};
use crate::cut_file::fabrication_error::FabricationError;
use crate::display::Shape;
use design::geometry::polygon::{
    area, distance, distance_between_segments, distance_to_outline, distance_to_segment, edges,
    side,
};
use design::sheet::cut_sheet::Sheet;
use std::collections::BTreeMap;

/// Rounding of lengths (mm), and of areas relative to the panel.
pub(super) const ROUNDING: f64 = 1e-6;

/// What is compared, in messages.
const HOLE: &str = "diameter of the hole of hinge";
const LIGAMENT: &str = "width of the ligament of hinge";
const PANEL: &str = "area of panel";

/// A cut with the width of the tool: the points nearer than `radius` to the segment `ends`.
struct Cut {
    ends: [[f64; 2]; 2],
    radius: f64,
    /// The hinges at its ends.
    hinges: Vec<usize>,
}

/// The finished edges that the paths leave.
struct Finished {
    holes: Vec<Cut>,
    slits: Vec<Cut>,
    outline: Vec<[[f64; 2]; 2]>,
}

pub(super) fn check(drawing: &CutDrawing, sheet: &Sheet) -> Result<(), FabricationError> {
    let finished = Finished::new(drawing, sheet);
    finished.ligaments(sheet)?;
    finished.panels(sheet)?;
    finished.gaps(sheet)
}

impl Finished {
    fn new(drawing: &CutDrawing, sheet: &Sheet) -> Self {
        let kerf = sheet.options.process.kerf;
        let bits = |point: [f64; 2]| point.map(f64::to_bits);
        let tips = sheet.hinges.iter().map(|hinge| bits(hinge.tip));
        let tips: BTreeMap<_, _> = std::iter::zip(tips, 0..).collect();
        let cut = |shape: &Shape, radius: f64| {
            let ends = shape.ends();
            let hinges = ends.iter().filter_map(|end| tips.get(&bits(*end)).copied());
            let mut hinges: Vec<usize> = hinges.collect();
            hinges.dedup();
            Cut {
                ends,
                radius,
                hinges,
            }
        };
        let holes = drawing.on(Layer::Holes).filter_map(|shape| match shape {
            Shape::Circle { radius, .. } => Some(cut(shape, radius + 0.5 * kerf)),
            _ => None,
        });
        let slits = drawing.on(Layer::Cut).map(|shape| cut(shape, 0.5 * kerf));
        let outlines = drawing.on(Layer::Outline);
        let outline = outlines.flat_map(|shape| match shape {
            Shape::Polygon(corners) => edges(corners)
                .map(|(p, q)| inwards(p, q, 0.5 * kerf))
                .collect(),
            _ => Vec::new(),
        });
        Self {
            holes: holes.collect(),
            slits: slits.collect(),
            outline: outline.collect(),
        }
    }

    /// Every hinge has its hole and a secondary cut at the distance w_lig from its tip. A cut that is nearer is
    /// reported with the other findings of the design.
    fn ligaments(&self, sheet: &Sheet) -> Result<(), FabricationError> {
        for (hinge, simulated) in sheet.hinges.iter().enumerate() {
            let tip = simulated.tip;
            let nominal = sheet.options.process.hole_radius(simulated.w_lig);
            let its = |cut: &&Cut| cut.hinges == [hinge];
            let hole = self.holes.iter().find(its);
            let written = hole.map_or(0.0, |hole| hole.radius);
            if (written - nominal).abs() > ROUNDING {
                return Err(FabricationError::Differs {
                    what: HOLE,
                    index: hinge,
                    written: 2.0 * written,
                    simulated: 2.0 * nominal,
                });
            }
            let others = self.slits.iter().filter(|cut| !cut.hinges.contains(&hinge));
            let to_slits =
                others.map(|cut| distance_to_segment(tip, cut.ends[0], cut.ends[1]) - cut.radius);
            let to_outline = self.outline.iter();
            let to_outline = to_outline.map(|[p, q]| distance_to_segment(tip, *p, *q));
            let written = to_slits.chain(to_outline).fold(f64::INFINITY, f64::min);
            if written > simulated.w_lig + ROUNDING {
                return Err(FabricationError::Differs {
                    what: LIGAMENT,
                    index: hinge,
                    written,
                    simulated: simulated.w_lig,
                });
            }
        }
        Ok(())
    }

    fn panels(&self, sheet: &Sheet) -> Result<(), FabricationError> {
        let slits = self.slits.iter().map(|cut| cut.ends);
        let lines: Vec<[[f64; 2]; 2]> = slits.chain(self.outline.iter().copied()).collect();
        for (panel, simulated) in sheet.panels.iter().enumerate() {
            let carriers: Option<Vec<_>> = edges(&simulated.corners)
                .map(|(p, q)| lines.iter().find(|line| carries(line, [p, q])))
                .collect();
            let written = carriers.map_or(0.0, |carriers| {
                let corners: [[f64; 2]; 4] =
                    std::array::from_fn(|k| crossing(carriers[(k + 3) % 4], carriers[k]));
                area(&corners)
            });
            let simulated = simulated.area;
            if (written - simulated).abs() > ROUNDING * simulated {
                return Err(FabricationError::Differs {
                    what: PANEL,
                    index: panel,
                    written,
                    simulated,
                });
            }
        }
        Ok(())
    }

    fn gaps(&self, sheet: &Sheet) -> Result<(), FabricationError> {
        let least = sheet.options.process.kerf;
        let corners = &sheet.outline.corners;
        for hole in &self.holes {
            let [centre, _] = hole.ends;
            let gap = distance_to_outline(centre, corners) - hole.radius;
            if gap < least {
                let hinge = hole.hinges[0];
                return Err(FabricationError::CutMeetsOutline { hinge, gap, least });
            }
        }
        // Cuts from left to right: only those that begin before another ends can meet it.
        let mut cuts: Vec<&Cut> = self.holes.iter().chain(&self.slits).collect();
        let side = |cut: &Cut, of: fn(f64, f64) -> f64| of(cut.ends[0][0], cut.ends[1][0]);
        cuts.sort_by(|a, b| side(a, f64::min).total_cmp(&side(b, f64::min)));
        for (i, cut) in cuts.iter().enumerate() {
            let reach = side(cut, f64::max) + cut.radius + least;
            let near = cuts[i + 1..]
                .iter()
                .take_while(|other| side(other, f64::min) < reach + other.radius + cut.radius);
            for other in near {
                if cut.hinges.iter().any(|hinge| other.hinges.contains(hinge)) {
                    continue;
                }
                let apart = distance_between_segments(cut.ends, other.ends);
                let gap = apart - cut.radius - other.radius;
                if gap < least {
                    let hinges = [cut.hinges[0], other.hinges[0]];
                    return Err(FabricationError::CutsMeet { hinges, gap, least });
                }
            }
        }
        Ok(())
    }
}

/// An edge of a counter-clockwise polygon, moved inwards.
fn inwards(p: [f64; 2], q: [f64; 2], by: f64) -> [[f64; 2]; 2] {
    let f = by / distance(p, q);
    let shift = [-f * (q[1] - p[1]), f * (q[0] - p[0])];
    [p, q].map(|[x, y]| [x + shift[0], y + shift[1]])
}

/// Whether an edge lies along a line, at least in part.
pub(super) fn carries(line: &[[f64; 2]; 2], edge: [[f64; 2]; 2]) -> bool {
    let [a, b] = *line;
    edge.iter()
        .all(|end| (side((a, b), *end) / distance(a, b)).abs() < ROUNDING)
        && distance_between_segments(*line, edge) < ROUNDING
}

/// The point at which two lines cross.
fn crossing([a, b]: &[[f64; 2]; 2], [c, d]: &[[f64; 2]; 2]) -> [f64; 2] {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
    let along = ((c[0] - a[0]) * v[1] - (c[1] - a[1]) * v[0]) / (u[0] * v[1] - u[1] * v[0]);
    [a[0] + along * u[0], a[1] + along * u[1]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut_file::CutLines;
    use design::pattern::coordinates::PatternCoordinates;
    use design::pattern::cut_pattern::{CutPattern, Outline};
    use design::pattern::grid::Grid;
    use design::sheet::cut_sheet::{HingePoint, SheetOptions};
    use hinge::HingeConstants;
    use scene::CuttingConfig;

    /// The uniform sheet of 3 x 3 panels of 400 mm, and its drawing.
    fn uniform() -> (Sheet, CutDrawing) {
        let grid = Grid { m: 3, n: 3 };
        let outline = Outline::rectangle(1200.0, 1200.0);
        let pattern = CutPattern::new(grid, outline, &PatternCoordinates::uniform(grid)).unwrap();
        let options = SheetOptions {
            hinge_point: HingePoint::CutTip,
            process: HingeConstants::PAPER.into(),
        };
        let sheet = Sheet::new(&pattern, &[18.0; 12], options).unwrap();
        let cuts = CutLines::new(&pattern, &sheet, CuttingConfig::default(), &[]).unwrap();
        (sheet, cuts.drawing())
    }

    /// The drawing with the first shape of a layer changed.
    fn with(layer: Layer, change: impl Fn(&mut Shape)) -> Result<(), FabricationError> {
        let (sheet, mut drawing) = uniform();
        assert!(check(&drawing, &sheet).is_ok());
        let first = drawing.shapes.iter_mut().find(|(on, _)| *on == layer);
        change(&mut first.unwrap().1);
        check(&drawing, &sheet)
    }

    /// What differs in the drawing with the first shape of a layer changed.
    fn differs(layer: Layer, change: impl Fn(&mut Shape)) -> (&'static str, usize) {
        match with(layer, change).unwrap_err() {
            FabricationError::Differs { what, index, .. } => (what, index),
            other => panic!("{other}"),
        }
    }

    #[test]
    fn a_hole_a_slit_and_an_outline_elsewhere_are_refused() {
        let hole = differs(Layer::Holes, |shape| {
            if let Shape::Circle { radius, .. } = shape {
                *radius += 0.01;
            }
        });
        assert_eq!(hole, (HOLE, 0));
        let (slit, _) = differs(Layer::Cut, |shape| {
            if let Shape::Line([_, end]) = shape {
                *end = end.map(|x| x + 0.01);
            }
        });
        assert!([PANEL, LIGAMENT].contains(&slit), "{slit}");
        let outline = differs(Layer::Outline, |shape| {
            if let Shape::Polygon(corners) = shape {
                corners[0][0] += 0.5;
                corners[3][0] += 0.5;
            }
        });
        assert_eq!(outline, (PANEL, 0));
    }

    #[test]
    fn a_slit_through_another_is_refused() {
        let (sheet, mut drawing) = uniform();
        let across = Shape::Line([sheet.hinges[0].tip, [1150.0, 1150.0]]);
        drawing.add(Layer::Cut, across);
        let error = check(&drawing, &sheet);
        let meet = matches!(error, Err(FabricationError::CutsMeet { gap, .. }) if gap < 0.0);
        assert!(meet, "{error:?}");
    }
}
