//! The rigid motion in space that points follow best, in the mean of squares.
//!
//! The rotation is the quaternion that is the eigenvector of the largest eigenvalue of a symmetric
//! 4 x 4 matrix (B. K. P. Horn, J. Opt. Soc. Am. A 4, 629, 1987). It is defined for points of one
//! plane, too, if they are not on one line.

use faer::Side;
use faer::mat::Mat;

/// A rigid motion, with the means of the points before and after it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidMotion {
    /// Mean of the points before (mm).
    pub from: [f64; 3],
    /// Mean of the points after (mm).
    pub to: [f64; 3],
    /// Rotation matrix, row by row.
    pub rotation: [[f64; 3]; 3],
}

impl RigidMotion {
    /// The motion from the points `before` to the points `after`.
    pub(crate) fn fitted(before: &[[f64; 3]], after: &[[f64; 3]]) -> Self {
        let (from, to) = (mean(before), mean(after));
        let mut s = [[0.0; 3]; 3];
        for (p, q) in std::iter::zip(before, after) {
            for i in 0..3 {
                for j in 0..3 {
                    s[i][j] += (p[i] - from[i]) * (q[j] - to[j]);
                }
            }
        }
        Self { from, to, rotation: rotation(s) }
    }

    /// The displacement of a point relative to the rigid body: the position of the point less its
    /// position on the body, in the frame of the body.
    pub(crate) fn left(&self, before: [f64; 3], after: [f64; 3]) -> [f64; 3] {
        let r = &self.rotation;
        std::array::from_fn(|i| {
            let turned_back: f64 = (0..3).map(|j| r[j][i] * (after[j] - self.to[j])).sum();
            turned_back - (before[i] - self.from[i])
        })
    }
}

fn mean(points: &[[f64; 3]]) -> [f64; 3] {
    let count = points.len().max(1) as f64;
    std::array::from_fn(|i| points.iter().map(|point| point[i]).sum::<f64>() / count)
}

/// The rotation R that maximises the trace of R s, for s the sum of the products of coordinates
/// before and after.
fn rotation(s: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let trace = s[0][0] + s[1][1] + s[2][2];
    let twist = [s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]];
    let matrix = Mat::from_fn(4, 4, |i, j| match (i, j) {
        (0, 0) => trace,
        (0, k) | (k, 0) => twist[k - 1],
        (i, j) => {
            let (i, j) = (i - 1, j - 1);
            s[i][j] + s[j][i] - if i == j { trace } else { 0.0 }
        }
    });
    // Points that all fall together have every rotation.
    let Ok(eigen) = matrix.self_adjoint_eigen(Side::Lower) else {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    };
    // Eigenvalues increase.
    let [w, x, y, z] = [0, 1, 2, 3].map(|i| eigen.U()[(i, 3)]);
    [
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The rotation by the vector v, by Rodrigues' formula.
    fn about(v: [f64; 3]) -> [[f64; 3]; 3] {
        let angle = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [x, y, z] = v.map(|c| if angle > 0.0 { c / angle } else { 0.0 });
        let (sin, cos) = angle.sin_cos();
        let rest = 1.0 - cos;
        [
            [cos + x * x * rest, x * y * rest - z * sin, x * z * rest + y * sin],
            [y * x * rest + z * sin, cos + y * y * rest, y * z * rest - x * sin],
            [z * x * rest - y * sin, z * y * rest + x * sin, cos + z * z * rest],
        ]
    }

    proptest! {
        /// Also for the points of a plane, as a panel's are.
        #[test]
        fn a_rigid_motion_is_found(
            v in proptest::array::uniform3(-1.7..1.7f64),
            shift in proptest::array::uniform3(-50.0..50.0f64),
            height in prop_oneof![Just(0.0), Just(7.0)],
        ) {
            let before = [[0.0, 0.0, 0.0], [70.0, 3.0, 0.0], [65.0, 60.0, 0.0], [-2.0, 40.0, height]];
            let r = about(v);
            let after = before.map(|p| -> [f64; 3] {
                std::array::from_fn(|i| shift[i] + (0..3).map(|j| r[i][j] * p[j]).sum::<f64>())
            });
            let found = RigidMotion::fitted(&before, &after);
            let entries = std::iter::zip(found.rotation.as_flattened(), r.as_flattened());
            for (found, expected) in entries {
                prop_assert!((found - expected).abs() < 1e-10);
            }
            for (p, q) in std::iter::zip(before, after) {
                prop_assert!(found.left(p, q).iter().all(|x| x.abs() < 1e-9));
            }
        }
    }

    #[test]
    fn bending_is_left_along_the_normal() {
        let before = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        // Warped: two opposite corners up, the others down, in a plane that has turned upright.
        let after = [[0.0, -0.1, 0.0], [2.0, 0.1, 0.0], [2.0, -0.1, 2.0], [0.0, 0.1, 2.0]];
        let found = RigidMotion::fitted(&before, &after);
        for (p, q) in std::iter::zip(before, after) {
            let left = found.left(p, q);
            assert!(left[0].abs() < 1e-12 && left[1].abs() < 1e-12, "{left:?}");
            assert!((left[2].abs() - 0.1).abs() < 1e-12, "{left:?}");
        }
    }
}
