//! The cut pattern: the outline (4) and the single sparse solve that determines all cut
//! endpoints (3),
//!
//! ```text
//! x_ij  = r_ij A_ij + (1 - r_ij) B_ij       interior cuts; A, B: the neighbours' facing endpoints
//! x'_ij = (1 - r_ij) A_ij + r_ij B_ij
//! x_ij  = x'_ij = (1 - tau) o_0 + tau o_1   cuts on the outline edge from o_0 to o_1
//! ```
//!
//! and its exact vector-Jacobian product by the transposed system.

use crate::{
    geometry::{
        plane::{complex, cross, dot, point},
        polygon::bounds,
    },
    pattern::{
        coordinates::{
            PatternCoordinates, intervals, logistic, partial_sums, partial_sums_pullback, with_ends,
        },
        grid::{EDGES, Grid},
    },
};
use faer::{
    Mat, c64,
    linalg::solvers::Solve,
    sparse::{SparseColMat, Triplet, linalg::solvers::Lu},
};
use serde::{Deserialize, Serialize};
use std::iter::zip;
use support::{Fault, Point, ensure, fault};

/// The fixed outline of the flat sheet: corners SW, SE, NE, NW (mm).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outline {
    /// Corners SW, SE, NE, NW (mm).
    pub corners: [Point; 4],
}

impl Outline {
    /// The rectangle with its south-west corner at the origin.
    pub fn rectangle(width: f64, height: f64) -> Self {
        Self { corners: [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]] }
    }

    /// Area of the outline (mm^2).
    pub fn area(&self) -> f64 {
        let [sw, se, ne, nw] = self.corners.map(complex);
        0.5 * cross(ne - sw, nw - se)
    }

    /// The larger of width and height (mm).
    pub fn size(&self) -> f64 {
        let [low, high] = bounds(self.corners);
        f64::max(high[0] - low[0], high[1] - low[1])
    }

    /// An error unless the outline is strictly convex with counter-clockwise corners.
    pub fn check(&self) -> Result<(), Fault> {
        let corner = |k: usize| complex(self.corners[k % 4]);
        let convex = (0..4).all(|k| {
            let turn = cross(corner(k + 1) - corner(k), corner(k + 2) - corner(k + 1));
            turn > 0.0 && turn.is_finite()
        });
        ensure!(
            convex,
            "the outline {:?} is not a convex quadrilateral with its corners counter-clockwise from the \
     south-west",
            self.corners
        );
        Ok(())
    }
}

/// A flat, gapless, rigidly deployable cut pattern kappa = (r, tau); (2).
#[derive(Clone, Debug)]
pub struct CutPattern {
    /// Numbers of panels.
    pub grid: Grid,
    /// Outline of the flat sheet.
    pub outline: Outline,
    /// Void aspect ratios of the interior cuts, row by row, in (0, 1).
    pub r: Vec<f64>,
    /// Boundary positions on the edges bottom, right, top, left, as fractions of the edge.
    pub tau: [Vec<f64>; 4],
    /// Cut endpoints (mm), row by row: x_ij, then x'_ij of each vertex.
    pub points: Vec<Point>,
    /// Factors of the collinearity system, stored for the pullback.
    system: Lu<usize, f64>,
}

impl CutPattern {
    /// Computes the endpoints of all cuts.
    pub fn new(
        grid: Grid,
        outline: Outline,
        coordinates: &PatternCoordinates,
    ) -> Result<Self, Fault> {
        let Grid { m, n } = grid;
        ensure!(
            m >= 2 && n >= 2,
            "a sheet of {m} x {n} panels has no interior cut: use at least 2 x 2"
        );
        outline.check()?;
        coordinates.check(grid)?;
        let r: Vec<f64> = coordinates.z.iter().copied().map(logistic).collect();
        if let Some(index) = r.iter().position(|&r| r <= 0.0 || r >= 1.0) {
            return Err(colliding("z", index));
        }
        let tau = coordinates.ell.each_ref().map(|ell| partial_sums(ell));
        for tau in &tau {
            if let Some(index) = intervals(tau).iter().position(|&interval| interval <= 0.0) {
                return Err(colliding("ell", index));
            }
        }
        let system = SparseColMat::try_new_from_triplets(
            grid.point_count(),
            grid.point_count(),
            &collinearity(grid, &r),
        )
        .map_err(|_| singular())?
        .sp_lu()
        .map_err(|_| singular())?;
        let solution = system.solve(outline_points(grid, &outline, &tau));
        let points: Vec<Point> =
            (0..grid.point_count()).map(|row| [solution[(row, 0)], solution[(row, 1)]]).collect();
        if points.iter().flatten().any(|value| !value.is_finite()) {
            return Err(singular());
        }
        Ok(Self { grid, outline, r, tau, points, system })
    }

    /// The gradient in (z, ell) and in the outline's corners of a function with the given gradient
    /// in [`points`](Self::points).
    pub fn pullback(&self, points: &[c64]) -> (PatternCoordinates, [Point; 4]) {
        let adjoint = self
            .system
            .solve_transpose(Mat::from_fn(points.len(), 2, |row, axis| point(points[row])[axis]));
        let adjoint = |point: usize| complex([adjoint[(point, 0)], adjoint[(point, 1)]]);

        let z = zip(self.grid.interior_vertices(), &self.r)
            .map(|((i, j), r)| {
                let [a, b] = self.grid.facing_endpoints(i, j);
                let slit = complex(self.points[a]) - complex(self.points[b]);
                let [x, x_prime] = self.grid.endpoints(i, j);
                r * (1.0 - r) * dot(adjoint(x) - adjoint(x_prime), slit)
            })
            .collect();

        let ell = std::array::from_fn(|edge| {
            let [start, end] = EDGES[edge].map(|corner| complex(self.outline.corners[corner]));
            let tau: Vec<f64> = (1..=self.tau[edge].len())
                .map(|s| {
                    let (i, j) = self.grid.edge_vertex(edge, s);
                    let [x, x_prime] = self.grid.endpoints(i, j);
                    dot(adjoint(x) + adjoint(x_prime), end - start)
                })
                .collect();
            partial_sums_pullback(&self.tau[edge], &tau)
        });
        (PatternCoordinates { z, ell }, self.outline_pullback(adjoint))
    }

    /// The gradient in the outline's corners, from the adjoint of the cut endpoints.
    fn outline_pullback(&self, adjoint: impl Fn(usize) -> c64) -> [Point; 4] {
        let mut corners = [c64::ZERO; 4];
        for (edge, tau) in self.tau.iter().enumerate() {
            let [start, end] = EDGES[edge];
            for (s, tau) in zip(1.., tau) {
                let (i, j) = self.grid.edge_vertex(edge, s);
                let [x, x_prime] = self.grid.endpoints(i, j).map(&adjoint);
                let force = x + x_prime;
                corners[start] += force * (1.0 - tau);
                corners[end] += force * *tau;
            }
        }
        let Grid { m, n } = self.grid;
        for (corner, (i, j)) in zip(&mut corners, [(0, 0), (m, 0), (m, n), (0, n)]) {
            self.grid.endpoints(i, j).into_iter().for_each(|point| *corner += adjoint(point));
        }
        corners.map(point)
    }
}

fn colliding(name: &str, index: usize) -> Fault {
    fault!(
        "{name}[{index}] is so far from 0 that its chart (5) rounds to a bound: two cuts collide"
    )
}

fn singular() -> Fault {
    fault!("the collinearity system of the pattern is singular")
}

/// The matrix of (3)-(4): one row per cut endpoint.
fn collinearity(grid: Grid, r: &[f64]) -> Vec<Triplet<usize, usize, f64>> {
    let mut entries: Vec<_> =
        (0..grid.point_count()).map(|point| Triplet::new(point, point, 1.0)).collect();
    for ((i, j), &r) in zip(grid.interior_vertices(), r) {
        let [a, b] = grid.facing_endpoints(i, j);
        let [x, x_prime] = grid.endpoints(i, j);
        entries.extend([
            Triplet::new(x, a, -r),
            Triplet::new(x, b, r - 1.0),
            Triplet::new(x_prime, a, r - 1.0),
            Triplet::new(x_prime, b, -r),
        ]);
    }
    entries
}

/// The right-hand side of (3)-(4): the outline points, zero at interior cuts.
fn outline_points(grid: Grid, outline: &Outline, tau: &[Vec<f64>; 4]) -> Mat<f64> {
    let mut points = Mat::zeros(grid.point_count(), 2);
    for (edge, tau) in tau.iter().enumerate() {
        let [start, end] = EDGES[edge].map(|corner| outline.corners[corner]);
        for (s, tau) in with_ends(tau).enumerate() {
            let (i, j) = grid.edge_vertex(edge, s);
            for point in grid.endpoints(i, j) {
                for axis in 0..2 {
                    points[(point, axis)] = (1.0 - tau) * start[axis] + tau * end[axis];
                }
            }
        }
    }
    points
}
