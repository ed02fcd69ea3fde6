//! The board behind a mounted sheet, seen from the front: numbered crosses and the opened panels.

use crate::{
    cut_file::{CutDrawing, Layer},
    display::{Shape, Text, rectangle},
};
use analysis::mounting::Mounting;
use design::{
    geometry::polygon::{bounds, size},
    sheet::{cut_sheet::Sheet, kinematics::deployed_boundaries},
};

/// Half the length of the arms of a cross (mm).
const ARM: f64 = 8.0;
/// Height of a number, and its distance from the cross (mm).
const NUMBER: f64 = 6.0;
const ASIDE: f64 = 3.0;

/// The board, at 1:1 in the coordinates of `deployed.dxf`.
pub(crate) fn board(sheet: &Sheet, mounting: &Mounting) -> CutDrawing {
    let mut drawing = CutDrawing::default();
    let panels = deployed_boundaries(sheet, &mounting.opened);
    let opened = bounds(panels.iter().flatten().copied());
    let ([low, high], board, size) = (opened, mounting.board(sheet), size(opened));
    let border = [0, 1].map(|axis| 0.5 * (board[axis] - size[axis]));
    let corners =
        [[0, 1].map(|axis| low[axis] - border[axis]), [0, 1].map(|axis| high[axis] + border[axis])];
    drawing.add(Layer::Registration, Shape::Polygon(rectangle(corners).to_vec()));
    for panel in panels {
        drawing.add(Layer::Panels, Shape::Polygon(panel));
    }
    for (i, fastener) in mounting.fasteners.iter().enumerate() {
        let centre = fastener.place;
        drawing.add_cross(Layer::Attachments, centre, ARM);
        let radius = 0.5 * fastener.hole.unwrap_or_default();
        if radius > 0.0 {
            drawing.add(Layer::Attachments, Shape::Circle { centre, radius });
        }
        let at = centre.map(|x| x + ASIDE);
        drawing.add(Layer::Attachments, Shape::Text(Text::line(at, NUMBER, &(i + 1).to_string())));
    }
    drawing
}
