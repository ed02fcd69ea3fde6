//! The two element types of a window, and the volumes of their Gauss points.
//!
//! * C3D20R, the 20-node brick with 2x2x2 Gauss points: x fastest, z slowest.
//! * C3D15, the 15-node wedge with 3x3 Gauss points: three in the triangle, at its mid-lines, on
//!   each of three levels.
//!
//! Node order of both: bottom corners counter-clockwise as seen from +z, top corners, mid-sides of
//! the bottom, of the top, and of the verticals.

use serde::{Deserialize, Serialize};
use std::iter::zip;

/// An element type of the window, extruded from a face of the plane mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ElementKind {
    /// C3D20R, extruded from an 8-node quadrilateral.
    Brick,
    /// C3D15, extruded from a 6-node triangle; the element of the paper.
    Wedge,
}

impl ElementKind {
    /// The kind of an element with these nodes, or of the elements above a face with these nodes.
    pub fn of(nodes: &[usize]) -> Self {
        match nodes.len() {
            6 | 15 => Self::Wedge,
            _ => Self::Brick,
        }
    }

    /// The name in CalculiX.
    pub fn name(self) -> &'static str {
        match self {
            Self::Brick => "C3D20R",
            Self::Wedge => "C3D15",
        }
    }

    /// Number of corners of the face from which the element is extruded.
    pub fn corners(self) -> usize {
        match self {
            Self::Brick => 4,
            Self::Wedge => 3,
        }
    }

    /// Number of Gauss points of an element.
    pub fn gauss_points(self) -> usize {
        match self {
            Self::Brick => 8,
            Self::Wedge => 9,
        }
    }

    /// Natural coordinates and weight of a Gauss point, in CalculiX's order.
    fn gauss_point(self, point: usize) -> ([f64; 3], f64) {
        match self {
            Self::Brick => {
                let g = 1.0 / 3.0_f64.sqrt();
                let at = |bit: usize| if point >> bit & 1 == 1 { g } else { -g };
                ([at(0), at(1), at(2)], 1.0)
            }
            Self::Wedge => {
                let (one, two) = (1.0 / 6.0, 2.0 / 3.0);
                let [xi, eta] = [[one, one], [two, one], [one, two]][point % 3];
                let level = 0.6_f64.sqrt();
                let (zeta, weight) =
                    [(-level, 5.0 / 9.0), (0.0, 8.0 / 9.0), (level, 5.0 / 9.0)][point / 3];
                ([xi, eta, zeta], weight / 6.0)
            }
        }
    }

    /// Weight of a Gauss point in natural coordinates.
    pub(crate) fn gauss_weight(self, point: usize) -> f64 {
        self.gauss_point(point).1
    }

    fn shape_gradient(self, node: usize, at: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Brick => brick_gradient(&BRICK_NODES[node], at),
            Self::Wedge => wedge_gradient(node, at),
        }
    }

    /// Volume (mm^3) of each Gauss point of the element with these nodes.
    pub(crate) fn gauss_volumes(self, nodes: &[[f64; 3]]) -> Vec<f64> {
        let volume = |point| {
            let (at, weight) = self.gauss_point(point);
            let mut j = [[0.0; 3]; 3];
            for (node, position) in nodes.iter().enumerate() {
                let gradient = self.shape_gradient(node, at);
                for (row, x) in zip(&mut j, position) {
                    zip(row, gradient).for_each(|(entry, slope)| *entry += x * slope);
                }
            }
            let [a, b, c] = j;
            let determinant = a[0] * (b[1] * c[2] - b[2] * c[1])
                - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
            weight * determinant
        };
        (0..self.gauss_points()).map(volume).collect()
    }
}

/// Natural coordinates (xi, eta, zeta) of the nodes of the brick.
const BRICK_NODES: [[f64; 3]; 20] = [
    [-1., -1., -1.],
    [1., -1., -1.],
    [1., 1., -1.],
    [-1., 1., -1.],
    [-1., -1., 1.],
    [1., -1., 1.],
    [1., 1., 1.],
    [-1., 1., 1.],
    [0., -1., -1.],
    [1., 0., -1.],
    [0., 1., -1.],
    [-1., 0., -1.],
    [0., -1., 1.],
    [1., 0., 1.],
    [0., 1., 1.],
    [-1., 0., 1.],
    [-1., -1., 0.],
    [1., -1., 0.],
    [1., 1., 0.],
    [-1., 1., 0.],
];

/// Gradient of the serendipity shape function of the node at `node`: corners (1/8) prod(1 + x_i
/// n_i) (sum x_i n_i - 2); mid-sides (1/4) (1 - x_m^2) prod(1 + x_i n_i).
fn brick_gradient(node: &[f64; 3], at: [f64; 3]) -> [f64; 3] {
    let factor = |i: usize| {
        if node[i] == 0.0 {
            (1.0 - at[i] * at[i], -2.0 * at[i])
        } else {
            (1.0 + at[i] * node[i], node[i])
        }
    };
    let f = [factor(0), factor(1), factor(2)];
    let corner = node.iter().all(|n| *n != 0.0);
    let sum: f64 = (0..3).map(|i| at[i] * node[i]).sum::<f64>() - 2.0;
    std::array::from_fn(|i| {
        let others = f[(i + 1) % 3].0 * f[(i + 2) % 3].0;
        if corner {
            0.125 * others * (f[i].1 * sum + f[i].0 * node[i])
        } else {
            0.25 * others * f[i].1
        }
    })
}

/// Gradient of a shape function of the wedge, with the area coordinates L = (1 - xi - eta, xi, eta)
/// and s = -1, 1 on the lower and upper face: corners (L/2) ((2L - 1) (1 + s zeta) - (1 - zeta^2)),
/// mid-sides 2 L L' (1 + s zeta), verticals L (1 - zeta^2).
fn wedge_gradient(node: usize, [xi, eta, zeta]: [f64; 3]) -> [f64; 3] {
    let l = [1.0 - xi - eta, xi, eta];
    let (i, j) = (node % 3, (node + 1) % 3);
    let s = if matches!(node, 0..3 | 6..9) { -1.0 } else { 1.0 };
    let bubble = 1.0 - zeta * zeta;
    // Derivatives in L_0, L_1, L_2 and in zeta.
    let mut by_l = [0.0; 3];
    let by_zeta = match node {
        0..6 => {
            by_l[i] = 0.5 * ((4.0 * l[i] - 1.0) * (1.0 + s * zeta) - bubble);
            0.5 * l[i] * ((2.0 * l[i] - 1.0) * s + 2.0 * zeta)
        }
        6..12 => {
            by_l[i] = 2.0 * l[j] * (1.0 + s * zeta);
            by_l[j] = 2.0 * l[i] * (1.0 + s * zeta);
            2.0 * l[i] * l[j] * s
        }
        _ => {
            by_l[i] = bubble;
            -2.0 * l[i] * zeta
        }
    };
    [by_l[1] - by_l[0], by_l[2] - by_l[0], by_zeta]
}

#[cfg(test)]
mod tests {
    use super::*;

    const WEDGE_NODES: [[f64; 3]; 15] = [
        [0., 0., -1.],
        [1., 0., -1.],
        [0., 1., -1.],
        [0., 0., 1.],
        [1., 0., 1.],
        [0., 1., 1.],
        [0.5, 0., -1.],
        [0.5, 0.5, -1.],
        [0., 0.5, -1.],
        [0.5, 0., 1.],
        [0.5, 0.5, 1.],
        [0., 0.5, 1.],
        [0., 0., 0.],
        [1., 0., 0.],
        [0., 1., 0.],
    ];

    /// The element type, its nodes in natural coordinates, and its volume in natural coordinates.
    fn natural() -> [(ElementKind, Vec<[f64; 3]>, f64); 2] {
        [
            (ElementKind::Brick, BRICK_NODES.to_vec(), 8.0),
            (ElementKind::Wedge, WEDGE_NODES.to_vec(), 1.0),
        ]
    }

    #[test]
    fn the_volume_of_a_sheared_element_is_split_by_the_gauss_weights() {
        for (kind, nodes, volume) in natural() {
            let sheared: Vec<_> = nodes
                .iter()
                .map(|[x, y, z]| [3.0 * x + 0.4 * y, 2.0 * y - 0.1 * z, 0.5 * z])
                .collect();
            for (point, found) in kind.gauss_volumes(&sheared).into_iter().enumerate() {
                let (_, weight) = kind.gauss_point(point);
                assert!((found - 3.0 * weight).abs() < 1e-13, "{kind:?} {point}");
            }
            let total: f64 = kind.gauss_volumes(&sheared).iter().sum();
            assert!((total - 3.0 * volume).abs() < 1e-13, "{kind:?}");
        }
    }

    /// The shape functions represent a quadratic map exactly; this map preserves volumes.
    #[test]
    fn a_bulged_element_has_its_exact_volume() {
        for (kind, nodes, volume) in natural() {
            let bulged: Vec<_> = nodes
                .iter()
                .map(|[x, y, z]| [x + 0.1 * (1.0 - y * y), *y, z + 0.2 * x * y])
                .collect();
            let total: f64 = kind.gauss_volumes(&bulged).iter().sum();
            assert!((total - volume).abs() < 1e-13, "{kind:?}: {total}");
        }
    }

    /// The gradient of sum N_i f(x_i) equals the gradient of f, for every f that the element
    /// represents exactly.
    #[test]
    fn gradients_are_exact_for_quadratic_functions() {
        let at = [0.3, 0.2, -0.4];
        let f = |[x, y, z]: [f64; 3]| 1.0 + x + 2.0 * y * y - z * z + 0.5 * x * y + 3.0 * y * z;
        let exact = [
            1.0 + 0.5 * at[1],
            4.0 * at[1] + 0.5 * at[0] + 3.0 * at[2],
            -2.0 * at[2] + 3.0 * at[1],
        ];
        for (kind, nodes, _) in natural() {
            for (axis, exact) in exact.into_iter().enumerate() {
                let found: f64 = (0..nodes.len())
                    .map(|node| f(nodes[node]) * kind.shape_gradient(node, at)[axis])
                    .sum();
                assert!((found - exact).abs() < 1e-14, "{kind:?} {axis}");
            }
        }
    }
}
