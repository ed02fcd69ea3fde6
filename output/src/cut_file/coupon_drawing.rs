//! The specimens of a coupon in one cut file, in rows of those with the same outline.
//!
//! Every specimen has its number as so many holes in its lower left panel, which stay when it is cut out; its letter is its outline. The
//! file for drawing programs also writes its name on its upper right panel.

use crate::cut_file::attachments::PlacedAttachment;
use crate::cut_file::cut_drawing::{CutDrawing, Layer};
use crate::cut_file::cut_lines::CutLines;
use crate::cut_file::fabrication_error::FabricationError;
use crate::cut_file::machine::Machine;
use crate::cut_file::sheet_drawing::note;
use crate::display::{Shape, Text};
use design::geometry::polygon::distance;
use hinge::SheetMaterial;

/// Distance between specimens (mm).
const GAP: f64 = 10.0;
/// Diameter of the holes that number a specimen, over the side of a panel.
const NUMBER_HOLE: f64 = 1.0 / 15.0;
/// Distance of their centres, in diameters.
const APART: f64 = 2.0;
/// Height of the names (mm).
const NAME: f64 = 8.0;

/// A specimen of a coupon.
pub struct CouponPiece {
    /// Its name.
    pub name: String,
    /// Its place in its row, from 1: a new row begins at 1.
    pub number: usize,
    /// Its cuts, with the holes for its hooks.
    pub cuts: CutLines,
    /// Centres of its lower left and of its upper right panel (mm).
    pub panels: [[f64; 2]; 2],
}

/// The drawing of all specimens: for a machine, or with names and instructions.
pub fn coupon_drawing(
    pieces: &[CouponPiece],
    material: &SheetMaterial,
    machine: Option<&Machine>,
) -> Result<CutDrawing, FabricationError> {
    let mut all = CutDrawing::default();
    let (mut right, mut bottom) = (0.0, 0.0);
    for piece in pieces {
        let mut own = piece.drawing(machine)?;
        let [low, high] = Shape::extent(own.on(Layer::Outline));
        if piece.number == 1 {
            right = 0.0;
            bottom -= high[1] - low[1] + GAP;
        }
        own.shift([right - low[0], bottom - low[1]]);
        // Copies of one parallelogram with a level lower edge.
        let [left_corner, right_corner, ..] = piece.cuts.outline;
        right += right_corner[0] - left_corner[0] + GAP;
        all.shapes.extend(own.shapes);
    }
    if let (None, Some(first)) = (machine, pieces.first()) {
        let kerf = first.cuts.kerf;
        note(
            &mut all,
            &[
                format!(
                    "Coupon, {}, {} mm thick, 1:1 in mm. The holes in the lower left panel number a specimen.",
                    material.name, material.thickness
                ),
                format!(
                    "Kerf {kerf} mm: CUT is one pass of the tool; HOLES, ATTACHMENT_HOLES and OUTLINE are paths of its centre."
                ),
            ],
        );
    }
    Ok(all)
}

impl CouponPiece {
    fn drawing(&self, machine: Option<&Machine>) -> Result<CutDrawing, FabricationError> {
        let mut cuts = self.cuts.clone();
        let [[x, y], named] = self.panels;
        // In proportion to the panels, so that three holes stay clear of the cuts around them.
        let [corner, next, ..] = cuts.outline;
        let hole = NUMBER_HOLE * 0.5 * distance(corner, next);
        for i in 0..self.number {
            let off = APART * hole * (i as f64 - 0.5 * (self.number as f64 - 1.0));
            cuts.attachments.push(PlacedAttachment {
                name: format!("number of {}", self.name),
                panel: 0,
                at: [x + off, y],
                hole: Some(hole),
                clip: None,
            });
        }
        if let Some(machine) = machine {
            return machine.drawing(&cuts);
        }
        let mut drawing = cuts.drawing().in_cutting_order(cuts.tool_outline()[0]);
        let name = Text::centred(named, NAME, self.name.clone());
        drawing.add(Layer::Annotation, Shape::Text(name));
        Ok(drawing)
    }
}
