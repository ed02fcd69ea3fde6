//! A frame in the plane of the sheet.

use serde::{Deserialize, Serialize};

/// An origin and the direction of the x axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Position of the origin (mm).
    pub origin: [f64; 2],
    /// Unit vector along the x axis.
    pub e_x: [f64; 2],
}

impl Default for Frame {
    /// The frame in which positions are given.
    fn default() -> Self {
        Self { origin: [0.0; 2], e_x: [1.0, 0.0] }
    }
}

impl Frame {
    /// The position of the point (x, y) of the frame (mm).
    pub fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([o_x, o_y], [c, s]) = (self.origin, self.e_x);
        [o_x + c * x - s * y, o_y + s * x + c * y]
    }

    /// The coordinates in the frame of a point (mm).
    pub fn local(&self, point: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.e_x;
        let [x, y] = [0, 1].map(|i| point[i] - self.origin[i]);
        [c * x + s * y, c * y - s * x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn local_coordinates_are_those_of_the_point() {
        let frame = Frame { origin: [3.0, -2.0], e_x: [0.6, 0.8] };
        assert_eq!(frame.point([0.0, 0.0]), frame.origin);
        let [x, y] = frame.local(frame.point([1.5, -0.5]));
        assert!((x - 1.5).abs() + (y + 0.5).abs() < 1e-15);
        assert_eq!(Frame::default().point([0.25, -7.0]), [0.25, -7.0]);
    }
}
