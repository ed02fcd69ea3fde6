//! How far panel B of a window leaves the plane of panel A.

use serde::{Deserialize, Serialize};

/// The lift and the small tilt of panel B, about O on it and the axes of the window turned with it. On a path they grow
/// in proportion to lambda.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lean {
    /// Displacement of O on panel B out of the plane (mm).
    pub lift: f64,
    /// Rotations about x and y (rad).
    pub tilt: [f64; 2],
}

impl Lean {
    /// The lean at `lambda` on the path to this one.
    pub fn at(&self, lambda: f64) -> Self {
        Self {
            lift: lambda * self.lift,
            tilt: self.tilt.map(|x| lambda * x),
        }
    }

    /// What is added to a point of panel B by the lean, to first order, in the axes of the panel (mm). The point is relative
    /// to O.
    pub fn displacement(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [by_x, by_y] = self.tilt;
        [by_y * z, -by_x * z, self.lift + by_x * y - by_y * x]
    }
}
