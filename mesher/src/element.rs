//! The 20-node brick with 2x2x2 integration points (C3D20R): volumes at its Gauss points.
//!
//! Node order: bottom corners counter-clockwise seen from +z, top corners, mid-sides of the
//! bottom, of the top, and of the verticals. Gauss points: x fastest, z slowest.

/// Natural coordinates (xi, eta, zeta) of the nodes.
const NODES: [[f64; 3]; 20] = [
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

/// Volume (mm^3) that each Gauss point stands for: the Jacobian determinant, as weights are 1.
pub(crate) fn gauss_volumes(nodes: &[[f64; 3]; 20]) -> [f64; 8] {
    let g = 1.0 / 3.0_f64.sqrt();
    std::array::from_fn(|point| {
        let sign = |bit: usize| if point >> bit & 1 == 1 { g } else { -g };
        jacobian_determinant(nodes, [sign(0), sign(1), sign(2)])
    })
}

fn jacobian_determinant(nodes: &[[f64; 3]; 20], at: [f64; 3]) -> f64 {
    let mut j = [[0.0; 3]; 3];
    for (position, natural) in nodes.iter().zip(&NODES) {
        let gradient = shape_gradient(natural, at);
        for r in 0..3 {
            for c in 0..3 {
                j[r][c] += position[r] * gradient[c];
            }
        }
    }
    j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1])
        - j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0])
        + j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0])
}

/// Gradient of the serendipity shape function of the node at `node`:
/// corners (1/8) prod(1 + x_i n_i) (sum x_i n_i - 2); mid-sides (1/4) (1 - x_m^2) prod(1 + x_i n_i).
fn shape_gradient(node: &[f64; 3], at: [f64; 3]) -> [f64; 3] {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheared_box_has_its_volume_at_every_gauss_point() {
        let nodes = NODES.map(|[x, y, z]| [3.0 * x + 0.4 * y, 2.0 * y - 0.1 * z, 0.5 * z]);
        for volume in gauss_volumes(&nodes) {
            assert!((volume - 3.0).abs() < 1e-13);
        }
    }

    /// The shape functions hold a general quadratic map exactly: sum of volumes = exact volume.
    #[test]
    fn a_bulged_box_has_its_exact_volume() {
        let nodes = NODES.map(|[x, y, z]| [x + 0.1 * (1.0 - y * y), y, z + 0.2 * x * y]);
        let total: f64 = gauss_volumes(&nodes).iter().sum();
        assert!((total - 8.0).abs() < 1e-13);
    }

    #[test]
    fn gradients_are_those_of_a_partition_of_unity() {
        for axis in 0..3 {
            let total: f64 = NODES
                .iter()
                .map(|n| shape_gradient(n, [0.3, -0.7, 0.2])[axis])
                .sum();
            assert!(total.abs() < 1e-15);
        }
    }
}
