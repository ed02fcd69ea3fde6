//! Closed contours around what is removed from a sheet: a slit with the holes at its ends.
//!
//! A slit between two hinges is one contour. One that is open on the outline is a notch of the
//! outline, which thereby stays one contour.

use crate::{
    cut_file::{
        cut_drawing::{CutDrawing, Layer},
        cut_lines::{CutLines, Slit},
    },
    display::Shape,
};
use design::geometry::{
    polygon::{distance, distance_to_segment, edges},
    region::Ring,
};
use scene::drawing::bulged::Vertex;
use std::f64::consts::PI;
use support::{Extremes, Point};

impl CutLines {
    /// Adds the contours that a tool of the given kerf (mm) follows with its centre, half of that
    /// from the finished edges, counter-clockwise: one a slit between two hinges, and the outline
    /// with its notches. With 0 they are the finished edges. The tool must be narrower than the
    /// slits.
    pub(super) fn add_contours(&self, drawing: &mut CutDrawing, kerf: f64) {
        let inset = 0.5 * kerf;
        let end = |slit: &Slit, which: usize| {
            slit.hinges[which].map(|hinge| SlitEnd {
                at: slit.ends[which],
                towards: slit.ends[1 - which],
                radius: self.holes[hinge].radius - inset,
                half_width: 0.5 * self.slit_width - inset,
            })
        };
        for slit in &self.slits {
            if let (Some(from), Some(to)) = (end(slit, 0), end(slit, 1)) {
                let contour = [from, to].iter().flat_map(SlitEnd::around).collect();
                drawing.add(Layer::Cut, Shape::Contour(contour));
            }
        }
        let open: Vec<SlitEnd> = (self.slits.iter())
            .filter(|slit| slit.hinges[1].is_none())
            .filter_map(|slit| end(slit, 0))
            .collect();
        for outline in notched(&self.outlines_at(inset), &open) {
            drawing.add(Layer::Outline, Shape::Contour(outline));
        }
    }
}

/// The hole at the end of a slit.
struct SlitEnd {
    at: Point,
    /// Another point of the slit's line.
    towards: Point,
    radius: f64,
    half_width: f64,
}

impl SlitEnd {
    /// The angle of the slit at the centre of the hole, and half of the angle of its mouth (rad).
    fn mouth(&self) -> [f64; 2] {
        let [dx, dy] = [0, 1].map(|i| self.towards[i] - self.at[i]);
        [dy.atan2(dx), (self.half_width / self.radius).asin()]
    }

    /// The arc on the hole from one flank of the slit around its back to the other,
    /// counter-clockwise.
    fn around(&self) -> [Vertex; 3] {
        let [along, half] = self.mouth();
        let bulge = (0.25 * (PI - half)).tan();
        [(along + half, bulge), (along + PI, bulge), (along - half, 0.0)].map(|(angle, bulge)| {
            let (sin, cos) = angle.sin_cos();
            let [x, y] = self.at;
            ([x + self.radius * cos, y + self.radius * sin], bulge)
        })
    }

    /// Where the flanks cross the line through `p` and `q`, in the order of a walk around the
    /// sheet.
    fn on_edge(&self, [p, q]: [Point; 2]) -> [Point; 2] {
        let [angle, _] = self.mouth();
        let (sin, cos) = angle.sin_cos();
        let edge = [q[0] - p[0], q[1] - p[1]];
        [-1.0, 1.0].map(|side| {
            let from = [
                self.at[0] - side * self.half_width * sin,
                self.at[1] + side * self.half_width * cos,
            ];
            let across = edge[0] * sin - edge[1] * cos;
            let share = ((from[0] - p[0]) * sin - (from[1] - p[1]) * cos) / across;
            [p[0] + share * edge[0], p[1] + share * edge[1]]
        })
    }
}

/// The outlines of a sheet with a notch for each open slit.
fn notched(outlines: &[Ring], open: &[SlitEnd]) -> Vec<Vec<Vertex>> {
    let all = outlines.iter().flat_map(|outline| edges(outline));
    let sides: Vec<[Point; 2]> = all.map(|(p, q)| [p, q]).collect();
    let mut notches: Vec<Vec<(f64, [Vertex; 5])>> = vec![Vec::new(); sides.len()];
    for end in open {
        // The side on which the slit ends.
        let off = |&[p, q]: &[Point; 2]| distance_to_segment(end.towards, p, q);
        let nearest = (0..sides.len()).smallest_by(|side| off(&sides[*side]));
        let at = nearest.expect("an outline has sides");
        let [first, second] = end.on_edge(sides[at]);
        // Into the sheet, clockwise around the hole, and out.
        let [(from, bulge), (back, _), (to, _)] = end.around();
        let notch = [(first, 0.0), (to, -bulge), (back, -bulge), (from, 0.0), (second, 0.0)];
        notches[at].push((distance(sides[at][0], first), notch));
    }
    let mut sides = sides.into_iter().zip(notches);
    let notched = |outline: &Ring| {
        let mut contour = Vec::new();
        for ([corner, _], mut notches) in sides.by_ref().take(outline.len()) {
            contour.push((corner, 0.0));
            notches.sort_by(|a, b| a.0.total_cmp(&b.0));
            contour.extend(notches.into_iter().flat_map(|(_, notch)| notch));
        }
        contour
    };
    outlines.iter().map(notched).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use design::geometry::polygon::area;
    use scene::drawing::bulged::flattened;

    fn end(at: [f64; 2], towards: [f64; 2]) -> SlitEnd {
        SlitEnd { at, towards, radius: 1.5, half_width: 0.4 }
    }

    /// Area of a hole with the beginning of its slit, up to the distance `length` from its centre.
    fn removed(length: f64) -> f64 {
        let half = (0.4_f64 / 1.5).asin();
        (PI - half) * 1.5 * 1.5 + 0.4 * 1.5 * half.cos() + 0.8 * (length - 1.5 * half.cos())
    }

    #[test]
    fn a_slot_has_the_area_of_slit_and_holes() {
        let ends = [[1.0, 2.0], [21.0, 17.0]];
        let ends = [end(ends[0], ends[1]), end(ends[1], ends[0])];
        let slot: Vec<_> = ends.iter().flat_map(SlitEnd::around).collect();
        let exact = 2.0 * removed(12.5);
        // Chords are inside of their arcs.
        let ratio = area(&flattened(&slot, true)) / exact;
        assert!(1.0 - 2e-3 < ratio && ratio < 1.0, "{ratio}");
    }

    #[test]
    fn a_notch_removes_its_area_from_the_outline() {
        let outline = vec![[0.0, 0.0], [40.0, 0.0], [40.0, 30.0], [0.0, 30.0]];
        let open = [
            end([10.0, 8.0], [10.0, 0.0]),
            end([25.0, 8.0], [25.0, 0.0]),
            end([30.0, 20.0], [40.0, 20.0]),
        ];
        let contour = notched(&[outline], &open).remove(0);
        let exact = 1200.0 - 2.0 * removed(8.0) - removed(10.0);
        let found = area(&flattened(&contour, true));
        assert!((found - exact).abs() < 0.05, "{found} {exact}");
    }
}
