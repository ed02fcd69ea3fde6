//! A drawing as the target of a sheet.

use crate::target::{Target, TargetShape};
use design::geometry::{
    plane::{complex, point},
    polygon,
    similarity::Similarity,
};
use std::path::Path;
use support::Fault;

/// Points along a drawn outline from which its area is computed.
const DRAWING_POINTS: usize = 2000;

/// Centre of the bounding box and height (mm) at which the outline of a drawing (SVG or DXF), with
/// its holes, has the given area (mm^2) and the mean of its points at `centre` (mm).
pub fn place_drawing(file: &Path, centre: [f64; 2], area: f64) -> Result<([f64; 2], f64), Fault> {
    let of_height_1 = TargetShape::Svg {
        file: file.to_owned(),
        centre: [0.0; 2],
        height: Some(1.0),
        rotation_deg: 0.0,
    };
    let outline = Target::sample(&of_height_1, Path::new(""), DRAWING_POINTS)?;
    let height = rounded((area / polygon::area(&outline.points).abs()).sqrt());
    let offset = outline.mean();
    let placed = [0, 1].map(|i| rounded(centre[i] - height * offset[i]));
    Ok((placed, height))
}

impl TargetShape {
    /// The shape after a motion and a change of size. `points` are samples of it, which stand for a
    /// polygon that is in a file.
    pub fn placed(self, place: &Similarity, points: &[[f64; 2]]) -> Self {
        let at = |p: [f64; 2]| point(place.of(complex(p))).map(rounded);
        let scaled = |length: f64| rounded(length * place.scale());
        let turned = |deg: f64| rounded(deg + place.rotation().to_degrees());
        let all = |points: &[[f64; 2]]| points.iter().copied().map(at).collect();
        match self {
            Self::Circle { centre, radius } => {
                Self::Circle { centre: at(centre), radius: scaled(radius) }
            }
            Self::Rectangle { centre, size, rotation_deg } => Self::Rectangle {
                centre: at(centre),
                size: size.map(scaled),
                rotation_deg: turned(rotation_deg),
            },
            Self::Polygon { vertices } => Self::Polygon { vertices: all(&vertices) },
            Self::Curve { points } => Self::Curve { points: all(&points) },
            Self::Csv { .. } => Self::Polygon { vertices: all(points) },
            Self::Svg { file, centre, height, rotation_deg } => Self::Svg {
                file,
                centre: at(centre),
                height: height.map(scaled),
                rotation_deg: turned(rotation_deg),
            },
        }
    }
}

/// To six significant digits, so that a product of two short numbers is short.
pub fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::c64;

    #[test]
    fn a_shape_is_placed_as_its_points_are() {
        let place = Similarity { turn: c64::cis(0.4) * 1.7, shift: c64::new(30.0, -12.0) };
        let corners = vec![[0.0, 0.0], [9.0, 1.0], [7.0, 6.0], [1.0, 5.0]];
        for shape in [
            TargetShape::Circle { centre: [3.0, 4.0], radius: 2.0 },
            TargetShape::Rectangle { centre: [3.0, 4.0], size: [5.0, 2.0], rotation_deg: 20.0 },
            TargetShape::Polygon { vertices: corners.clone() },
            TargetShape::Curve { points: corners },
        ] {
            let points = |shape: &TargetShape| Target::sample(shape, Path::new(""), 400).unwrap();
            let before = points(&shape).points;
            let moved = points(&shape.placed(&place, &before));
            let area = Target::area(&moved);
            for point_before in &before {
                let expected = point(place.of(complex(*point_before)));
                assert!(moved.distance(expected) < 1e-3 * area.sqrt());
            }
        }
    }
}
