//! Where panels are held and pulled: holes for nails and hooks, which are cut, and marks, which are
//! not.

use crate::{
    cut_file::cut_drawing::{CutDrawing, Layer},
    display::Shape,
};
use design::sheet::{
    attachment::{Clearance, Obstacle},
    cut_sheet::{AttachmentPoint, Sheet},
};
use support::{Fault, Point};

/// Half the length of the arms of a mark (mm).
const ARM: f64 = 2.0;

/// A point of the flat sheet at which a panel is held or pulled.
#[derive(Clone, Debug)]
pub struct PlacedAttachment {
    /// What is attached.
    pub name: String,
    /// Index of the panel.
    pub panel: usize,
    /// Its position (mm).
    pub at: Point,
    /// Diameter of the finished hole (mm).
    pub hole: Option<f64>,
    /// The ends of a clip on an edge of the panel (mm).
    pub clip: Option<[Point; 2]>,
}

impl PlacedAttachment {
    /// An attachment on its sheet; an error if its hole or its clip lacks room.
    pub(super) fn new(sheet: &Sheet, at: &AttachmentPoint) -> Result<Self, Fault> {
        let clearances = at.clearances(sheet);
        if let Some(short) = clearances.iter().find(|room| room.distance < room.least) {
            return Err(without_room(&at.name, *short));
        }
        Ok(Self {
            name: at.name.clone(),
            panel: at.panel,
            at: sheet.panels[at.panel].position(at.point),
            hole: at.hole,
            clip: at.clip_ends(sheet),
        })
    }

    /// Adds its mark to a drawing, unless it has a hole.
    pub(super) fn mark(&self, drawing: &mut CutDrawing) {
        let [x, y] = self.at;
        match (self.hole, self.clip) {
            (Some(_), _) => {}
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

/// What keeps an attachment from being made.
fn without_room(name: &str, Clearance { obstacle, distance, least }: Clearance) -> Fault {
    let (part, what) = match obstacle {
        Obstacle::Ends(_) => {
            return format!(
                "the clip of {name} is {least} mm wide, its edge {distance:.1} mm: use a narrower clip"
            )
            .into();
        }
        Obstacle::Edge(_) => ("centre of the hole", "the edge of its panel".to_owned()),
        Obstacle::HoleToHinge(h) => ("centre of the hole", format!("the tip of hinge {h}")),
        Obstacle::ClipToHinge(h) => ("clip", format!("the tip of hinge {h}")),
    };
    format!(
        "the {part} of {name} is {distance:.1} mm from {what}, and needs {least:.1} mm: move its `at` away from there, or make \
         it smaller"
    )
    .into()
}
