//! The VTK grid of a window, evaluated with VTK's cells: their parametric coordinates as in
//! vtkQuadraticHexahedron and vtkQuadraticWedge, and the polynomials that they interpolate.

use hinge::HingeConstants;
use mesher::{Gmsh, Tier, WindowMesh, WindowShape, vtk_grid};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::vtk::CellKind;

/// A cell of VTK: parametric coordinates of the nodes, exponents of the monomials, and an
/// integration rule.
struct VtkCell {
    nodes: Vec<[f64; 3]>,
    monomials: Vec<[i32; 3]>,
    rule: Vec<([f64; 3], f64)>,
}

fn corners_and_middles(lower: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let at = |t: f64| lower.iter().map(move |[r, s]| [*r, *s, t]);
    let middles = |t: f64| {
        let next = lower.iter().cycle().skip(1);
        lower.iter().zip(next).map(move |([r, s], [r2, s2])| [0.5 * (r + r2), 0.5 * (s + s2), t])
    };
    at(0.0).chain(at(1.0)).chain(middles(0.0)).chain(middles(1.0)).chain(at(0.5)).collect()
}

fn hexahedron() -> VtkCell {
    let g = 0.5 / 3.0_f64.sqrt();
    let all = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
    // No more than one factor is quadratic.
    let monomials = all.filter(|powers| powers.iter().filter(|&&p| p == 2).count() <= 1);
    VtkCell {
        nodes: corners_and_middles(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
        monomials: monomials.collect(),
        rule: (0..8)
            .map(|i| {
                (
                    [i & 1, i >> 1 & 1, i >> 2].map(|bit| if bit == 1 { 0.5 + g } else { 0.5 - g }),
                    0.125,
                )
            })
            .collect(),
    }
}

fn wedge() -> VtkCell {
    let plane = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];
    let linear = plane.iter().flat_map(|&[r, s]| [[r, s, 0], [r, s, 1]]);
    let quadratic = plane[..3].iter().map(|&[r, s]| [r, s, 2]);
    let level = 0.5 * 0.6_f64.sqrt();
    let levels = [(0.5 - level, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + level, 5.0 / 18.0)];
    let (one, two) = (1.0 / 6.0, 2.0 / 3.0);
    VtkCell {
        nodes: corners_and_middles(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
        monomials: linear.chain(quadratic).collect(),
        rule: levels
            .iter()
            .flat_map(|&(t, weight)| {
                [[one, one], [two, one], [one, two]].map(|[r, s]| ([r, s, t], weight / 6.0))
            })
            .collect(),
    }
}

/// Solves A x = b for several right-hand sides by elimination with pivoting.
fn solved(mut a: Vec<Vec<f64>>, mut b: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    let n = a.len();
    for column in 0..n {
        let pivot =
            (column..n).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs())).unwrap();
        assert!(a[pivot][column].abs() > 1e-9, "the nodes do not determine the polynomials");
        a.swap(column, pivot);
        b.swap(column, pivot);
        let (pivots, values) = (a[column].clone(), b[column]);
        for row in (0..n).filter(|row| *row != column) {
            let factor = a[row][column] / pivots[column];
            let changes = a[row].iter_mut().zip(&pivots);
            changes.for_each(|(x, pivot)| *x -= factor * pivot);
            let changes = b[row].iter_mut().zip(values);
            changes.for_each(|(x, value)| *x -= factor * value);
        }
    }
    (0..n).map(|row| b[row].map(|x| x / a[row][row])).collect()
}

impl VtkCell {
    /// Determinants of the Jacobian at the points of the rule, times their weights.
    fn volumes(&self, positions: Vec<[f64; 3]>) -> Vec<f64> {
        let value = |[p, q, w]: [i32; 3], [r, s, t]: [f64; 3]| r.powi(p) * s.powi(q) * t.powi(w);
        let rows =
            self.nodes.iter().map(|at| self.monomials.iter().map(|m| value(*m, *at)).collect());
        let coefficients = solved(rows.collect(), positions);
        let volume = |(at, weight): &([f64; 3], f64)| {
            let mut j = [[0.0; 3]; 3];
            for (powers, x) in self.monomials.iter().zip(&coefficients) {
                for axis in (0..3).filter(|&axis| powers[axis] > 0) {
                    let mut lower = *powers;
                    lower[axis] -= 1;
                    let slope = f64::from(powers[axis]) * value(lower, *at);
                    (0..3).for_each(|row| j[row][axis] += x[row] * slope);
                }
            }
            let minor = |a: usize, b: usize| j[1][a] * j[2][b] - j[1][b] * j[2][a];
            weight * (j[0][0] * minor(1, 2) - j[0][1] * minor(0, 2) + j[0][2] * minor(0, 1))
        };
        self.rule.iter().map(volume).collect()
    }
}

fn mesh(tier: Tier) -> WindowMesh {
    let design = HingeConstants::PAPER.hinge(18.0, 1.1);
    let scratch = tempfile::tempdir().unwrap();
    let (limit, stop) = (Duration::from_secs(60), AtomicBool::new(false));
    let gmsh = Gmsh::find().unwrap();
    WindowShape { design: &design, thickness: 0.5, recipe: &tier.recipe() }
        .mesh(scratch.path(), &gmsh, limit, &stop)
        .unwrap()
}

/// A wrong order of the nodes would give negative Jacobians or another volume.
#[test]
fn every_cell_has_the_volume_of_its_element_in_the_order_of_vtk() {
    for (tier, kind, cell) in [
        (Tier::Tiny, CellKind::QuadraticHexahedron, hexahedron()),
        (Tier::Paper, CellKind::QuadraticWedge, wedge()),
    ] {
        let mesh = mesh(tier);
        let grid = vtk_grid(&mesh);
        assert_eq!((grid.kind, grid.cells.len()), (kind, mesh.elements.len()));
        assert_eq!(grid.points.len(), mesh.nodes.len());
        assert_eq!(cell.nodes.len(), cell.monomials.len());
        for (nodes, expected) in grid.cells.iter().zip(&mesh.gauss_volumes) {
            let volumes = cell.volumes(nodes.iter().map(|&node| grid.points[node]).collect());
            let total: f64 = expected.iter().sum();
            for (volume, expected) in volumes.iter().zip(expected) {
                // Elimination of 20 unknowns loses about three digits.
                assert!(
                    *volume > 0.0 && (volume - expected).abs() < 1e-9 * total,
                    "{volume} {expected}"
                );
            }
        }
    }
}
