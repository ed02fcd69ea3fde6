//! A surface in space, seen along an axis, with the faces in colours.

use crate::{
    display::Style,
    drawing::page::{ColourScale, INK, Page},
};
use design::geometry::polygon::{bounds, size};
use support::Point;

/// From where a surface is seen.
#[derive(Clone, Copy, Debug)]
pub enum View {
    /// From above the sheet: x to the right, y up.
    Above,
    /// Along the plane of the sheet, against y: x to the right, z up.
    Front,
    /// Along the plane of the sheet, against x: y to the right, z up.
    Side,
}

/// Faces in space.
pub struct Surface<'a> {
    /// Positions of the points (mm).
    pub points: &'a [[f64; 3]],
    /// Points of each face.
    pub faces: &'a [Vec<usize>],
    /// The value of each face, which its colour shows.
    pub values: &'a [f64],
    /// The last value of the colour scale; larger values have its colour.
    pub largest: f64,
    /// Name and unit of the values.
    pub name: &'a str,
}

impl View {
    /// Position on the picture, and depth: what has more is in front.
    fn of(self, [x, y, z]: [f64; 3]) -> (Point, f64) {
        match self {
            Self::Above => ([x, y], z),
            Self::Front => ([x, z], -y),
            Self::Side => ([y, z], x),
        }
    }
}

/// Least height of a picture over its width.
const LEAST_HEIGHT: f64 = 0.25;

/// The picture of a surface. What is nearer is drawn over what is further away.
pub fn surface(surface: &Surface, view: View, title: &str, subtitle: &str) -> String {
    let seen: Vec<_> = surface.points.iter().map(|point| view.of(*point)).collect();
    let corners: Vec<Point> = seen.iter().map(|(at, _)| *at).collect();
    let [low, high] = bounds(corners.iter().copied());
    // A sheet seen from its edge is flat: the colour scale needs a height.
    let [width, height] = size([low, high]);
    let room = (LEAST_HEIGHT * width - height).max(0.0) / 2.0;
    let corners = [[low[0], low[1] - room], [high[0], high[1] + room]];
    let mut page = Page::around(corners, title, subtitle, true);
    let scale = ColourScale::covering([surface.largest]);
    let depth = |face: &Vec<usize>| {
        let sum: f64 = face.iter().map(|point| seen[*point].1).sum();
        sum / face.len() as f64
    };
    let mut order: Vec<usize> = (0..surface.faces.len()).collect();
    order.sort_by(|a, b| depth(&surface.faces[*a]).total_cmp(&depth(&surface.faces[*b])));
    for face in order {
        let outline: Vec<_> = surface.faces[face].iter().map(|p| seen[*p].0).collect();
        let fill = Style::fill(scale.colour(surface.values[face]));
        page.canvas.polygon(&outline, fill);
        let edge = page.canvas.stroke(INK, 0.15);
        page.canvas.polygon(&outline, edge);
    }
    page.colour_scale(&scale, surface.name);
    page.finish()
}
