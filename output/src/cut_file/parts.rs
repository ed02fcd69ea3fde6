//! A sheet larger than the bed or the roll, split into parts.
//!
//! The parts are blocks of panels, separated along panel edges: the sheet is halved until every part fits. Every two neighbouring panels are joined by a hinge,
//! so that any such line crosses hinges. Their ligaments stay whole: see [`Seam`].

use crate::cut_file::cut_drawing::{CutDrawing, Layer};
use crate::cut_file::cut_lines::CutLines;
use crate::cut_file::fabrication_error::FabricationError;
use crate::cut_file::numbers::numbers;
use crate::cut_file::seam::Seam;
use crate::cut_file::sheet_drawing::note;
use crate::display::{Shape, Text};
use design::geometry::polygon::{area, distance, edges};
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::Sheet;
use std::ops::Range;

/// Rounding of lengths (mm).
const ROUNDING: f64 = 1e-6;

/// The parts of a sheet and their joints.
#[derive(Debug)]
pub struct Split {
    /// Part 1 and those after it.
    pub parts: Vec<Part>,
    /// One per hinge between two parts, with the parts that keep the ligament and that are joined to it.
    pub joints: Vec<(Seam, [usize; 2])>,
    /// Width of the adhesive tape on either side of a seam (mm).
    pub lap: f64,
}

/// A part that is cut from one piece of material.
#[derive(Debug)]
pub struct Part {
    /// Its lower left corner in the sheet, which is the origin of its drawing (mm).
    pub origin: [f64; 2],
    /// Width and height of its cuts (mm).
    pub size: [f64; 2],
    /// Area of its material (mm^2).
    pub area: f64,
    /// Cuts in cutting order, numbers and instructions.
    pub drawing: CutDrawing,
}

/// Splits a sheet into parts that fit on a bed (width and height, mm; infinite for a roll). One part if it fits as a whole.
pub fn split(
    cuts: &CutLines,
    sheet: &Sheet,
    bed: [f64; 2],
    lap: f64,
) -> Result<Split, FabricationError> {
    let splitter = Splitter {
        cuts,
        sheet,
        lap,
        numbers: numbers(cuts, sheet),
    };
    let Grid { m, n } = sheet.grid;
    let whole = Block {
        grid: sheet.grid,
        ranges: [0..m, 0..n],
    };
    let blocks = splitter.fitting(whole, bed)?;
    let of = |panel| blocks.iter().position(|block| block.has(panel));
    let mut joints = Vec::new();
    for (h, hinge) in sheet.hinges.iter().enumerate() {
        let (a, b) = (hinge.panel_a(), hinge.panel_b());
        if let (Some(one), Some(other)) = (of(a), of(b))
            && one != other
        {
            let seam = Seam::new(sheet, h, lap)?;
            let keeper_first = if seam.panel == b {
                [one, other]
            } else {
                [other, one]
            };
            joints.push((seam, keeper_first));
        }
    }
    let parts = (blocks.iter().enumerate())
        .map(|(i, block)| splitter.part([i + 1, blocks.len()], block))
        .collect::<Result<_, _>>()?;
    Ok(Split { parts, joints, lap })
}

impl Split {
    /// One row a joint: hinge, panel with the seam, parts, and the seam in the sheet.
    pub fn joint_list(&self) -> String {
        let mut text =
            "hinge,panel,ligament_on_part,joined_to_part,tape_each_side_mm,length_mm,x1_mm,y1_mm,x2_mm,y2_mm\n"
                .to_owned();
        for (seam, [keeper, joined]) in &self.joints {
            let Seam {
                hinge,
                panel,
                ends: [[x1, y1], [x2, y2]],
                ..
            } = seam;
            text += &format!(
                "{hinge},{panel},{},{},{},{:.3},{x1:.3},{y1:.3},{x2:.3},{y2:.3}\n",
                keeper + 1,
                joined + 1,
                self.lap,
                distance(seam.ends[0], seam.ends[1])
            );
        }
        text
    }
}

/// A block of panels.
#[derive(Clone, Debug)]
struct Block {
    grid: Grid,
    /// Columns and rows.
    ranges: [Range<usize>; 2],
}

impl Block {
    fn has(&self, panel: usize) -> bool {
        let [columns, rows] = &self.ranges;
        columns.contains(&(panel % self.grid.m)) && rows.contains(&(panel / self.grid.m))
    }

    /// The two parts of the block along an axis (0: columns, 1: rows), for every line between panels: that nearest to the
    /// middle first. The upper or the left part comes first.
    fn halves(&self, axis: usize) -> Vec<[Self; 2]> {
        let Range { start, end } = self.ranges[axis];
        let mut lines: Vec<usize> = (start + 1..end).rev().collect();
        lines.sort_by_key(|line| (2 * line).abs_diff(start + end));
        let halves = lines.into_iter().map(|line| {
            let part = |range: Range<usize>| {
                let mut part = self.clone();
                part.ranges[axis] = range;
                part
            };
            match axis {
                0 => [part(start..line), part(line..end)],
                _ => [part(line..end), part(start..line)],
            }
        });
        halves.collect()
    }
}

struct Splitter<'a> {
    cuts: &'a CutLines,
    sheet: &'a Sheet,
    lap: f64,
    numbers: (Vec<Text>, Vec<Text>),
}

impl Splitter<'_> {
    /// The block, halved until every part fits on the bed.
    fn fitting(&self, block: Block, bed: [f64; 2]) -> Result<Vec<Block>, FabricationError> {
        let [low, high] = self.extent(&block)?;
        let size = [high[0] - low[0], high[1] - low[1]];
        let excess = [size[0] / bed[0], size[1] / bed[1]];
        if excess[0].max(excess[1]) <= 1.0 {
            return Ok(vec![block]);
        }
        // Along the axis that exceeds the bed most, or else along the other.
        let first = usize::from(excess[1] > excess[0]);
        let halves = [first, 1 - first].map(|axis| block.halves(axis)).concat();
        let mut no_room = None;
        for [one, other] in halves {
            // Both halves have the same seams between them.
            match self.extent(&one).and(self.extent(&other)) {
                Err(error) => no_room = no_room.or(Some(error)),
                Ok(_) => {
                    let mut parts = self.fitting(one, bed)?;
                    parts.extend(self.fitting(other, bed)?);
                    return Ok(parts);
                }
            }
        }
        let [columns, rows] = &block.ranges;
        let panel = block.grid.panel(columns.start, rows.start);
        Err(no_room.unwrap_or(FabricationError::PartTooLarge { panel, size, bed }))
    }

    /// The bounding box of a part with the reach of the tool beyond its edges (mm).
    fn extent(&self, part: &Block) -> Result<[[f64; 2]; 2], FabricationError> {
        let pieces = self.pieces(&self.seams(part)?, part);
        let shapes: Vec<Shape> = pieces.into_iter().map(Shape::Polygon).collect();
        let [low, high] = Shape::extent(shapes.iter());
        let reach = f64::max(0.5 * self.cuts.kerf, self.cuts.cutting.over_run);
        Ok([low.map(|x| x - reach), high.map(|x| x + reach)])
    }

    /// The seams at the hinges between the panels inside of a part and those outside.
    fn seams(&self, part: &Block) -> Result<Vec<Seam>, FabricationError> {
        let hinges = self.sheet.hinges.iter().enumerate();
        hinges
            .filter(|(_, hinge)| part.has(hinge.panel_a()) != part.has(hinge.panel_b()))
            .map(|(h, _)| Seam::new(self.sheet, h, self.lap))
            .collect()
    }

    /// The material of a part as counter-clockwise polygons: its panels without the corners that they give away, and the
    /// corners that it receives.
    fn pieces(&self, seams: &[Seam], part: &Block) -> Vec<Vec<[f64; 2]>> {
        let panels = self.sheet.panels.iter().enumerate();
        let own = panels.filter(|(k, _)| part.has(*k)).map(|(k, panel)| {
            let given = |c: usize| {
                seams
                    .iter()
                    .find(|seam| (seam.panel, seam.corner) == (k, c))
            };
            let corners = (0..4).flat_map(|c| match given(c) {
                Some(Seam {
                    ends: [after, before],
                    ..
                }) => vec![*before, *after],
                None => vec![panel.corners[c]],
            });
            corners.collect()
        });
        let received = seams.iter().filter(|seam| !part.has(seam.panel));
        let received = received.map(|seam| {
            let corner = self.sheet.panels[seam.panel].corners[seam.corner];
            vec![corner, seam.ends[0], seam.ends[1]]
        });
        own.chain(received).collect()
    }

    fn part(&self, [number, count]: [usize; 2], part: &Block) -> Result<Part, FabricationError> {
        let seams = self.seams(part)?;
        let pieces = self.pieces(&seams, part);
        let borders: Vec<_> = pieces.iter().flat_map(|piece| edges(piece)).collect();
        let keeps = |h: usize| {
            let hinge = &self.sheet.hinges[h];
            match seams.iter().find(|seam| seam.hinge == h) {
                Some(seam) => !part.has(seam.panel),
                None => part.has(hinge.panel_a()),
            }
        };
        let cuts = self.cuts;
        let mut drawing = CutDrawing::default();
        for (_, hole) in cuts.holes.iter().enumerate().filter(|(h, _)| keeps(*h)) {
            let (centre, radius) = (hole.centre, cuts.tool_radius(hole));
            drawing.add(Layer::Holes, Shape::Circle { centre, radius });
        }
        for attachment in &cuts.attachments {
            if part.has(attachment.panel) {
                attachment.draw(&mut drawing, cuts.kerf);
            }
        }
        for slit in &cuts.slits {
            for piece in covered(slit.ends, cuts.tool_slit(slit), &borders) {
                drawing.add(Layer::Cut, Shape::Line(piece));
            }
        }
        for seam in &seams {
            drawing.add(Layer::Joint, Shape::Line(seam.ends));
        }
        let tool: Vec<_> = edges(&cuts.tool_outline()).collect();
        for ((p, q), (from, to)) in edges(&cuts.outline).zip(tool) {
            for piece in covered([p, q], [from, to], &borders) {
                drawing.add(Layer::Outline, Shape::Line(piece));
            }
        }
        let [low, high] = Shape::extent(drawing.cuts());
        let mut drawing = drawing.in_cutting_order(low);
        let (panels, hinges) = &self.numbers;
        let panels = panels.iter().enumerate().filter(|(k, _)| part.has(*k));
        let hinges = hinges.iter().enumerate().filter(|(h, _)| keeps(*h));
        for (_, text) in panels.chain(hinges) {
            drawing.add(Layer::Annotation, Shape::Text(text.clone()));
        }
        drawing.shift(low.map(|x| -x));
        let lines = [
            format!(
                "Part {number} of {count}; its lower left corner is at ({:.1}, {:.1}) mm of the sheet. 1:1 in mm.",
                low[0], low[1]
            ),
            "Order: HOLES, CUT, JOINT, OUTLINE. CUT and JOINT are one pass of the tool.".to_owned(),
            format!(
                "JOINT: lay the parts edge to edge; adhesive tape on both faces, {} mm to either side of the seam.",
                self.lap
            ),
        ];
        note(&mut drawing, &lines);
        Ok(Part {
            origin: low,
            size: [high[0] - low[0], high[1] - low[1]],
            area: pieces.iter().map(|piece| area(piece)).sum(),
            drawing,
        })
    }
}

/// The pieces of a tool's path, along the line with the given ends, beside which the borders of a part lie.
fn covered(
    [from, to]: [[f64; 2]; 2],
    tool: [[f64; 2]; 2],
    borders: &[([f64; 2], [f64; 2])],
) -> Vec<[[f64; 2]; 2]> {
    let length = distance(from, to);
    let unit = [0, 1].map(|axis| (to[axis] - from[axis]) / length);
    let along = |[x, y]: [f64; 2]| (x - from[0]) * unit[0] + (y - from[1]) * unit[1];
    let off = |[x, y]: [f64; 2]| (y - from[1]) * unit[0] - (x - from[0]) * unit[1];
    let mut intervals: Vec<[f64; 2]> = borders
        .iter()
        .filter(|(p, q)| off(*p).abs() < ROUNDING && off(*q).abs() < ROUNDING)
        .map(|(p, q)| {
            let (s, t) = (along(*p), along(*q));
            [s.min(t).max(0.0), s.max(t).min(length)]
        })
        .filter(|[s, t]| t - s > ROUNDING)
        .collect();
    intervals.sort_by(|[s, _], [t, _]| s.total_cmp(t));
    let mut merged: Vec<[f64; 2]> = Vec::new();
    for [s, t] in intervals {
        match merged.last_mut() {
            Some(last) if s < last[1] + ROUNDING => last[1] = last[1].max(t),
            _ => merged.push([s, t]),
        }
    }
    // The tool's path begins and ends beside the line's ends, and is parallel to it.
    let shift = {
        let [a, b] = tool;
        let [u, v] = [along(a), along(b)];
        move |s: f64| {
            let f = (s - u) / (v - u);
            [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])]
        }
    };
    let piece = |[s, t]: [f64; 2]| {
        let begin = if s < ROUNDING { tool[0] } else { shift(s) };
        let end = if t > length - ROUNDING {
            tool[1]
        } else {
            shift(t)
        };
        [begin, end]
    };
    merged.into_iter().map(piece).collect()
}
