//! Where panels are held and pulled: holes for nails and hooks, which are cut, and marks, which are not.

use crate::cut_file::cut_drawing::{CutDrawing, Layer};
use crate::cut_file::fabrication_error::FabricationError;
use crate::display::Shape;
use design::geometry::polygon::{distance, distance_to_segment, edges};
use design::scene::Attachment;
use design::sheet::cut_sheet::{PanelPoint, Sheet};

/// Half the length of the arms of a mark (mm).
const ARM: f64 = 2.0;

/// A point of the flat sheet at which a panel is held or pulled.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedAttachment {
    /// What is attached.
    pub name: String,
    /// Index of the panel.
    pub panel: usize,
    /// Its position (mm).
    pub at: [f64; 2],
    /// Diameter of the finished hole (mm).
    pub hole: Option<f64>,
    /// The ends of a clip on an edge of the panel (mm).
    pub clip: Option<[[f64; 2]; 2]>,
}

impl PlacedAttachment {
    /// An attachment on its sheet; an error if the hole is too near to an edge of its panel or to a hinge, or if the clip
    /// is longer than its edge.
    pub(super) fn new(sheet: &Sheet, attachment: &Attachment) -> Result<Self, FabricationError> {
        let panel = &sheet.panels[attachment.panel];
        let placed = Self {
            name: attachment.name.clone(),
            panel: attachment.panel,
            at: panel.position(attachment.point),
            hole: attachment.hole,
            clip: match (attachment.clip, attachment.point) {
                (Some(width), PanelPoint::Middle(ends)) => {
                    let [p, q] = ends.map(|corner| panel.corners[corner]);
                    let room = distance(p, q);
                    if width > room {
                        let name = attachment.name.clone();
                        return Err(FabricationError::ClipTooWide { name, width, room });
                    }
                    let part = |share: f64| [0, 1].map(|c| p[c] + share * (q[c] - p[c]));
                    Some([-0.5, 0.5].map(|side| part(0.5 + side * width / room)))
                }
                _ => None,
            },
        };
        placed.check_hole(sheet)?;
        Ok(placed)
    }

    fn check_hole(&self, sheet: &Sheet) -> Result<(), FabricationError> {
        let Some(diameter) = self.hole else {
            return Ok(());
        };
        let refuse = |what: String, gap: f64, least: f64| {
            Err(FabricationError::HoleTooNear {
                name: self.name.clone(),
                what,
                gap,
                least,
            })
        };
        let half_kerf = 0.5 * sheet.options.process.kerf;
        let to_edges = edges(&sheet.panels[self.panel].corners)
            .map(|(p, q)| distance_to_segment(self.at, p, q))
            .fold(f64::INFINITY, f64::min);
        let (gap, least) = (to_edges - half_kerf - 0.5 * diameter, 0.5 * diameter);
        if gap < least {
            return refuse("the edge of its panel".to_owned(), gap, least);
        }
        for (h, hinge) in sheet.hinges.iter().enumerate() {
            if ![hinge.panel_a(), hinge.panel_b()].contains(&self.panel) {
                continue;
            }
            let gap = distance(self.at, hinge.tip) - 0.5 * diameter;
            let least = sheet.options.process.r_win;
            if gap < least {
                return refuse(format!("the tip of hinge {h}"), gap, least);
            }
        }
        Ok(())
    }

    /// Adds hole and mark to a drawing of the paths of a tool with the given kerf (mm).
    pub(super) fn draw(&self, drawing: &mut CutDrawing, kerf: f64) {
        let [x, y] = self.at;
        match (self.hole, self.clip) {
            (Some(diameter), _) => {
                let (centre, radius) = (self.at, 0.5 * (diameter - kerf));
                drawing.add(Layer::AttachmentHoles, Shape::Circle { centre, radius });
            }
            (None, Some(ends)) => drawing.add(Layer::Attachments, Shape::Line(ends)),
            (None, None) => {
                for [dx, dy] in [[ARM, ARM], [ARM, -ARM]] {
                    let arm = [[x - dx, y - dy], [x + dx, y + dy]];
                    drawing.add(Layer::Attachments, Shape::Line(arm));
                }
            }
        }
    }
}
