//! The cut pattern: the charts (5), the outline (4) and the one sparse solve that places every cut
//! endpoint (3),
//!
//! ```text
//! x_ij  = r_ij A_ij + (1 - r_ij) B_ij       interior cuts; A, B: the neighbours' facing endpoints
//! x'_ij = (1 - r_ij) A_ij + r_ij B_ij
//! x_ij  = x'_ij = (1 - tau) o_0 + tau o_1   cuts on the outline edge from o_0 to o_1
//! ```
//!
//! and its exact vector-Jacobian product through the transposed system.

use crate::grid::{EDGES, Endpoint, Grid};
use crate::plane::{complex, cross, dot};
use faer::Mat;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{SparseColMat, Triplet};
use serde::{Deserialize, Serialize};

/// Why there is no cut pattern for the given numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PatternError {
    #[error("a sheet of {m} x {n} panels has no interior cut: use at least 2 x 2")]
    TooFewPanels { m: usize, n: usize },
    #[error(
        "the outline {corners:?} is not a convex quadrilateral with its corners \
         counter-clockwise from the south-west"
    )]
    Outline { corners: [[f64; 2]; 4] },
    #[error("{name} has {found} entries; a sheet of {m} x {n} panels needs {expected}")]
    Count {
        name: &'static str,
        found: usize,
        expected: usize,
        m: usize,
        n: usize,
    },
    #[error("{name}[{index}] = {value} is not a finite number")]
    NotFinite {
        name: &'static str,
        index: usize,
        value: f64,
    },
    #[error(
        "{name}[{index}] has run so far that its chart (5) rounds to the bound of (0, 1): two cuts collide"
    )]
    Collision { name: &'static str, index: usize },
    #[error("the collinearity system of the pattern is singular")]
    Singular,
}

/// The fixed outline of the flat sheet: corners SW, SE, NE, NW (mm).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outline {
    pub corners: [[f64; 2]; 4],
}

impl Outline {
    /// The rectangle with its south-west corner at the origin.
    pub fn rectangle(width: f64, height: f64) -> Self {
        Self {
            corners: [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]],
        }
    }

    fn is_convex(&self) -> bool {
        let corner = |k: usize| complex(self.corners[k % 4]);
        (0..4).all(|k| {
            let turn = cross(corner(k + 1) - corner(k), corner(k + 2) - corner(k + 1));
            turn > 0.0 && turn.is_finite()
        })
    }
}

/// Unconstrained coordinates of a pattern (5), or a gradient in them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatternCoordinates {
    /// Logits of the void aspect ratios of the interior cuts, row by row.
    pub z: Vec<f64>,
    /// Logits of the intervals between the cuts on the edges bottom, right, top, left.
    pub ell: [Vec<f64>; 4],
}

impl PatternCoordinates {
    /// r = 1/2 everywhere and evenly spaced cuts on the outline.
    pub fn uniform(grid: Grid) -> Self {
        Self {
            z: vec![0.0; grid.aspect_ratio_count()],
            ell: grid.edge_cut_counts().map(|count| vec![0.0; count + 1]),
        }
    }

    fn check(&self, grid: Grid) -> Result<(), PatternError> {
        let expected = grid.edge_cut_counts().map(|count| count + 1);
        let blocks = [
            ("z", &self.z, grid.aspect_ratio_count()),
            ("ell of the bottom edge", &self.ell[0], expected[0]),
            ("ell of the right edge", &self.ell[1], expected[1]),
            ("ell of the top edge", &self.ell[2], expected[2]),
            ("ell of the left edge", &self.ell[3], expected[3]),
        ];
        for (name, values, expected) in blocks {
            if values.len() != expected {
                return Err(PatternError::Count {
                    name,
                    found: values.len(),
                    expected,
                    m: grid.m,
                    n: grid.n,
                });
            }
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                let value = values[index];
                return Err(PatternError::NotFinite { name, index, value });
            }
        }
        Ok(())
    }
}

/// A flat, gapless, rigidly deployable cut pattern kappa = (r, tau); (2).
#[derive(Clone, Debug)]
pub struct CutPattern {
    pub grid: Grid,
    pub outline: Outline,
    /// Void aspect ratios of the interior cuts, row by row, in (0, 1).
    pub r: Vec<f64>,
    /// Boundary positions on the edges bottom, right, top, left, as fractions of the edge.
    pub tau: [Vec<f64>; 4],
    /// Cut endpoints (mm), vertex by vertex and row by row: x_ij, then x'_ij.
    pub points: Vec<[f64; 2]>,
    /// Factors of the collinearity system, kept for the pullback.
    system: Lu<usize, f64>,
}

impl CutPattern {
    /// Places every cut.
    pub fn new(
        grid: Grid,
        outline: Outline,
        coordinates: &PatternCoordinates,
    ) -> Result<Self, PatternError> {
        let Grid { m, n } = grid;
        if m < 2 || n < 2 {
            return Err(PatternError::TooFewPanels { m, n });
        }
        if !outline.is_convex() {
            return Err(PatternError::Outline {
                corners: outline.corners,
            });
        }
        coordinates.check(grid)?;
        let r: Vec<f64> = coordinates.z.iter().copied().map(logistic).collect();
        if let Some(index) = r.iter().position(|&r| r <= 0.0 || r >= 1.0) {
            return Err(PatternError::Collision { name: "z", index });
        }
        let tau = coordinates.ell.each_ref().map(|ell| partial_sums(ell));
        for tau in &tau {
            if let Some(index) = intervals(tau).iter().position(|&interval| interval <= 0.0) {
                return Err(PatternError::Collision { name: "ell", index });
            }
        }
        let system = SparseColMat::try_new_from_triplets(
            grid.point_count(),
            grid.point_count(),
            &collinearity(grid, &r),
        )
        .map_err(|_| PatternError::Singular)?
        .sp_lu()
        .map_err(|_| PatternError::Singular)?;
        let solution = system.solve(outline_points(grid, &outline, &tau));
        let points: Vec<[f64; 2]> = (0..grid.point_count())
            .map(|row| [solution[(row, 0)], solution[(row, 1)]])
            .collect();
        if points.iter().flatten().any(|value| !value.is_finite()) {
            return Err(PatternError::Singular);
        }
        Ok(Self {
            grid,
            outline,
            r,
            tau,
            points,
            system,
        })
    }

    /// x_ij (mm).
    pub fn x(&self, i: usize, j: usize) -> [f64; 2] {
        self.points[self.grid.endpoint(i, j, Endpoint::X)]
    }

    /// x'_ij (mm).
    pub fn x_prime(&self, i: usize, j: usize) -> [f64; 2] {
        self.points[self.grid.endpoint(i, j, Endpoint::XPrime)]
    }

    /// The gradient in (z, ell) of a function whose gradient in [`points`](Self::points) is given.
    pub fn pullback(&self, points: &[[f64; 2]]) -> PatternCoordinates {
        let adjoint = self
            .system
            .solve_transpose(Mat::from_fn(points.len(), 2, |row, axis| points[row][axis]));
        let adjoint = |point: usize| complex([adjoint[(point, 0)], adjoint[(point, 1)]]);

        let z = std::iter::zip(self.grid.interior_vertices(), &self.r)
            .map(|((i, j), r)| {
                let [a, b] = self.grid.facing_endpoints(i, j);
                let slit = complex(self.points[a]) - complex(self.points[b]);
                let x = self.grid.endpoint(i, j, Endpoint::X);
                let x_prime = self.grid.endpoint(i, j, Endpoint::XPrime);
                r * (1.0 - r) * dot(adjoint(x) - adjoint(x_prime), slit)
            })
            .collect();

        let ell = std::array::from_fn(|edge| {
            let [start, end] = EDGES[edge].map(|corner| complex(self.outline.corners[corner]));
            let tau: Vec<f64> = (1..=self.tau[edge].len())
                .map(|s| {
                    let (i, j) = self.grid.edge_vertex(edge, s);
                    let x = self.grid.endpoint(i, j, Endpoint::X);
                    let x_prime = self.grid.endpoint(i, j, Endpoint::XPrime);
                    dot(adjoint(x) + adjoint(x_prime), end - start)
                })
                .collect();
            partial_sums_pullback(&self.tau[edge], &tau)
        });
        PatternCoordinates { z, ell }
    }
}

/// The logistic function sigma of (5).
pub(crate) fn logistic(z: f64) -> f64 {
    1.0 / (1.0 + (-z).exp())
}

/// Partial sums of softmax(ell), without the last, which is 1; (5).
fn partial_sums(ell: &[f64]) -> Vec<f64> {
    let greatest = ell.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = ell.iter().map(|logit| (logit - greatest).exp()).collect();
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    weights[..weights.len() - 1]
        .iter()
        .map(|weight| {
            sum += weight / total;
            sum
        })
        .collect()
}

/// The intervals between neighbouring boundary positions: the softmax weights.
fn intervals(tau: &[f64]) -> Vec<f64> {
    let ends = std::iter::once(0.0)
        .chain(tau.iter().copied())
        .chain(std::iter::once(1.0));
    ends.clone().skip(1).zip(ends).map(|(b, a)| b - a).collect()
}

/// The gradient in ell from the gradient in tau.
fn partial_sums_pullback(tau: &[f64], gradient: &[f64]) -> Vec<f64> {
    let weights = intervals(tau);
    let mut by_weight = vec![0.0; weights.len()];
    for s in (0..gradient.len()).rev() {
        by_weight[s] = by_weight[s + 1] + gradient[s];
    }
    let mean: f64 = std::iter::zip(&weights, &by_weight)
        .map(|(w, g)| w * g)
        .sum();
    std::iter::zip(&weights, &by_weight)
        .map(|(w, g)| w * (g - mean))
        .collect()
}

/// The matrix of (3)-(4): one row per cut endpoint.
fn collinearity(grid: Grid, r: &[f64]) -> Vec<Triplet<usize, usize, f64>> {
    let mut entries: Vec<_> = (0..grid.point_count())
        .map(|point| Triplet::new(point, point, 1.0))
        .collect();
    for ((i, j), &r) in std::iter::zip(grid.interior_vertices(), r) {
        let [a, b] = grid.facing_endpoints(i, j);
        let x = grid.endpoint(i, j, Endpoint::X);
        let x_prime = grid.endpoint(i, j, Endpoint::XPrime);
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
        let positions = std::iter::once(0.0)
            .chain(tau.iter().copied())
            .chain(std::iter::once(1.0));
        for (s, tau) in positions.enumerate() {
            let (i, j) = grid.edge_vertex(edge, s);
            for endpoint in [Endpoint::X, Endpoint::XPrime] {
                for axis in 0..2 {
                    points[(grid.endpoint(i, j, endpoint), axis)] =
                        (1.0 - tau) * start[axis] + tau * end[axis];
                }
            }
        }
    }
    points
}
