//! How near the flanks of the main cut come to each other in a solved window, which has no contact.

use crate::calculix::dat::Frame;
use mesher::{Side, Window, WindowMesh};

/// A place on a flank: position in the plane and height, all deformed (mm).
#[derive(Clone, Copy)]
struct Place {
    plane: [f64; 2],
    height: f64,
}

/// The two flanks of a window on the lower face of its sheet, from the hole to the rim.
pub(crate) struct Flanks<'a> {
    mesh: &'a WindowMesh,
    /// Nodes of the flank on panel A, and on panel B.
    nodes: [Vec<usize>; 2],
}

impl<'a> Flanks<'a> {
    pub(crate) fn new(mesh: &'a WindowMesh) -> Self {
        let window = Window(&mesh.design);
        let along = |side: Side| {
            let places = mesh.plane.nodes.iter().enumerate();
            let mut along: Vec<(f64, usize)> = places
                .filter_map(|(node, place)| Some((window.on_flank(*place, side)?, node)))
                .collect();
            along.sort_by(|a, b| a.0.total_cmp(&b.0));
            along.into_iter().map(|(_, node)| node).collect()
        };
        Self {
            mesh,
            nodes: Side::BOTH.map(along),
        }
    }

    /// The least distance in the plane between the flanks where one is within a thickness of the height of the other (mm):
    /// negative where they pass through each other. Flanks that pass one above the other are no overlap. `None` if nowhere a
    /// flank has the other at its height.
    pub(crate) fn gap(&self, frame: &Frame) -> Option<f64> {
        let [a, b] = [0, 1].map(|side| self.deformed(&self.nodes[side], frame));
        let from_a = a
            .iter()
            .filter_map(|place| self.signed_distance(*place, &b, -1.0));
        let from_b = b
            .iter()
            .filter_map(|place| self.signed_distance(*place, &a, 1.0));
        from_a.chain(from_b).reduce(f64::min)
    }

    fn deformed(&self, nodes: &[usize], frame: &Frame) -> Vec<Place> {
        let place = |&node: &usize| {
            let ([x, y, z], [ux, uy, uz]) = (self.mesh.nodes[node], frame.displacements[node]);
            Place {
                plane: [x + ux, y + uy],
                height: z + uz,
            }
        };
        nodes.iter().map(place).collect()
    }

    /// Distance of a place from the nearest point of the other flank, positive if it is on the side of its own panel: seen from
    /// the hole that of B is to the left (`sign` 1) and that of A to the right (-1). `None` if it passes above or below.
    fn signed_distance(&self, place: Place, flank: &[Place], sign: f64) -> Option<f64> {
        let [x, y] = place.plane;
        let nearest = flank.windows(2).map(|ends| {
            let ([x0, y0], [x1, y1]) = (ends[0].plane, ends[1].plane);
            let (dx, dy) = (x1 - x0, y1 - y0);
            let length = dx.hypot(dy);
            let share = (((x - x0) * dx + (y - y0) * dy) / (length * length)).clamp(0.0, 1.0);
            let height = ends[0].height + share * (ends[1].height - ends[0].height);
            let distance = f64::hypot(x - x0 - share * dx, y - y0 - share * dy);
            let left = (dx * (y - y0) - dy * (x - x0)).signum();
            (distance, sign * left * distance, height)
        });
        let (_, signed, height) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let apart = (place.height - height).abs();
        (apart < self.mesh.thickness).then_some(signed)
    }
}
