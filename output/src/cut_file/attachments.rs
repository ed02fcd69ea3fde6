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
    /// An attachment on its sheet; an error if its hole is too near to an edge of its panel, its hole or clip to a hinge, or
    /// if the clip is longer than its edge.
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
        placed.check_edges(sheet)?;
        placed.check_hinges(sheet)?;
        Ok(placed)
    }

    /// A hole leaves at least its radius to the edges of its panel.
    fn check_edges(&self, sheet: &Sheet) -> Result<(), FabricationError> {
        let Some(diameter) = self.hole else {
            return Ok(());
        };
        let half_kerf = 0.5 * sheet.options.process.kerf;
        let to_edges = edges(&sheet.panels[self.panel].corners)
            .map(|(p, q)| distance_to_segment(self.at, p, q))
            .fold(f64::INFINITY, f64::min);
        let (gap, least) = (to_edges - half_kerf - 0.5 * diameter, 0.5 * diameter);
        self.check("hole", "the edge of its panel".to_owned(), gap, least)
    }

    /// Hole and clip are outside of the windows of the hinges of their panel.
    fn check_hinges(&self, sheet: &Sheet) -> Result<(), FabricationError> {
        let hinges = sheet.hinges.iter().enumerate();
        let of_panel =
            hinges.filter(|(_, hinge)| [hinge.panel_a(), hinge.panel_b()].contains(&self.panel));
        for (h, hinge) in of_panel {
            let (what, least) = (format!("the tip of hinge {h}"), sheet.options.process.r_win);
            if let Some(diameter) = self.hole {
                let gap = distance(self.at, hinge.tip) - 0.5 * diameter;
                self.check("hole", what.clone(), gap, least)?;
            }
            if let Some([p, q]) = self.clip {
                self.check("clip", what, distance_to_segment(hinge.tip, p, q), least)?;
            }
        }
        Ok(())
    }

    fn check(
        &self,
        part: &'static str,
        what: String,
        gap: f64,
        least: f64,
    ) -> Result<(), FabricationError> {
        if gap >= least {
            return Ok(());
        }
        let name = self.name.clone();
        Err(FabricationError::TooNear {
            part,
            name,
            what,
            gap,
            least,
        })
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
