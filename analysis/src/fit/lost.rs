//! The parts of a drawing that its sheet does not show.

use crate::fit::even_sheet::{EvenSheet, QUICK};
use crate::fit::trimmed::{Limits, missing};
use design::geometry::plane::{complex, point};
use design::geometry::region::{Corners, Region, as_seen};
use design::objective::centre;

/// Halvings of the width of a part.
const HALVINGS: usize = 12;
/// Factors by which the tried sheets are larger.
const LARGER: [f64; 3] = [1.25, 1.5, 2.0];

/// A part of a drawing that is not seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Lost {
    /// Where it is in the drawing as it stands: -1, 0 or 1 to the right and upwards.
    pub place: [i32; 2],
    /// Its largest width in sides of a panel.
    pub width: f64,
}

/// The lost parts, the widest first.
pub(super) fn lost(sheet: &EvenSheet) -> Vec<Lost> {
    let drawing = &sheet.drawing;
    let seen = as_seen(sheet.opened(1.0), drawing);
    let upright = |at: [f64; 2]| point(sheet.place.back(complex(at)));
    let [low, high] = drawing.map(upright).bounds();
    let third = |at: [f64; 2]| {
        [0, 1].map(|c| (3.0 * (at[c] - low[c]) / (high[c] - low[c])).clamp(0.0, 2.9) as i32 - 1)
    };
    let lost = |part: Region| Lost {
        place: third(upright(centre::of(&part.polygons[0][0]))),
        width: width(&part),
    };
    let mut lost: Vec<Lost> = missing(drawing, &seen).into_iter().map(lost).collect();
    lost.sort_by(|one, other| other.width.total_cmp(&one.width));
    lost
}

/// The diameter of the largest circle in a region.
fn width(region: &Region) -> f64 {
    let [width, height] = region.extent();
    let [mut least, mut most] = [0.0, f64::min(width, height)];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (least + most);
        let fits = !region.offset(-0.5 * middle, Corners::Sharp).polygons.is_empty();
        *(if fits { &mut least } else { &mut most }) = middle;
    }
    least
}

/// The factor by which a sheet has more panels along each side that loses nothing; `None` if none of
/// those that are tried does.
pub(super) fn kept_by(target: &Region, size: f64, limits: Limits) -> Option<f64> {
    let limits = Limits { stock: [f64::INFINITY; 2], ..limits };
    LARGER.into_iter().find(|factor| {
        let larger = EvenSheet::new(target, &[factor * size], limits, QUICK);
        larger.is_some_and(|sheet| lost(&sheet).is_empty())
    })
}
