//! Indices of an M x N sheet: vertices, cut endpoints and panels.
//!
//! Vertex (i, j), i = 0..=M along x and j = 0..=N along y, carries the cut C_ij, horizontal where
//! i + j is even. Panel k = q M + p is in column p and row q.

/// An M x N sheet of quadrilateral panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Panels along x.
    pub m: usize,
    /// Panels along y.
    pub n: usize,
}

/// The two endpoints at a cut: x is on the south side of a horizontal and on the east side of a
/// vertical cut, x' on the opposite side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Endpoint {
    /// x_ij.
    X,
    /// x'_ij.
    XPrime,
}

impl Endpoint {
    /// x, then x'.
    pub(crate) const BOTH: [Self; 2] = [Self::X, Self::XPrime];
}

/// The corners of a panel or of the outline, counter-clockwise.
pub(crate) const SW: usize = 0;
pub(crate) const SE: usize = 1;
pub(crate) const NE: usize = 2;
pub(crate) const NW: usize = 3;

/// The outline edges in the order of (4), each directed along increasing i or j.
pub const EDGES: [[usize; 2]; 4] = [[SW, SE], [SE, NE], [NW, NE], [SW, NW]];

impl Grid {
    /// Number of panels, MN.
    pub fn panel_count(&self) -> usize {
        self.m * self.n
    }

    /// Number of hinges, one per interior panel edge: 2MN - M - N.
    pub fn hinge_count(&self) -> usize {
        (2 * self.m * self.n).saturating_sub(self.m + self.n)
    }

    /// Number of void aspect ratios, one per interior cut: (M-1)(N-1).
    pub fn aspect_ratio_count(&self) -> usize {
        self.m.saturating_sub(1) * self.n.saturating_sub(1)
    }

    /// Number of movable cuts on the outline edges bottom, right, top, left.
    pub fn edge_cut_counts(&self) -> [usize; 4] {
        let (m, n) = (self.m.saturating_sub(1), self.n.saturating_sub(1));
        [m, n, m, n]
    }

    pub(crate) fn point_count(&self) -> usize {
        2 * (self.m + 1) * (self.n + 1)
    }

    /// Index of x_ij or x'_ij among the cut endpoints.
    pub(crate) fn endpoint(&self, i: usize, j: usize, endpoint: Endpoint) -> usize {
        2 * (j * (self.m + 1) + i) + endpoint as usize
    }

    /// Indices of x_ij and x'_ij.
    pub(crate) fn endpoints(&self, i: usize, j: usize) -> [usize; 2] {
        [Endpoint::X, Endpoint::XPrime].map(|endpoint| self.endpoint(i, j, endpoint))
    }

    /// Index of the panel in column `p` and row `q`.
    pub fn panel(&self, p: usize, q: usize) -> usize {
        q * self.m + p
    }

    pub(crate) fn horizontal(i: usize, j: usize) -> bool {
        (i + j).is_multiple_of(2)
    }

    pub(crate) fn is_interior(&self, i: usize, j: usize) -> bool {
        (1..self.m).contains(&i) && (1..self.n).contains(&j)
    }

    /// All vertices, row by row.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let m = self.m;
        (0..=self.n).flat_map(move |j| (0..=m).map(move |i| (i, j)))
    }

    pub(crate) fn interior_vertices(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let grid = *self;
        self.vertices().filter(move |&(i, j)| grid.is_interior(i, j))
    }

    /// The vertex at position `s` of an outline edge (0 at its start).
    pub(crate) fn edge_vertex(&self, edge: usize, s: usize) -> (usize, usize) {
        match edge {
            0 => (s, 0),
            1 => (self.m, s),
            2 => (s, self.n),
            _ => (0, s),
        }
    }

    /// The endpoints A and B of the neighbouring cuts that face the interior cut C_ij; (3).
    pub(crate) fn facing_endpoints(&self, i: usize, j: usize) -> [usize; 2] {
        if Self::horizontal(i, j) {
            [self.endpoint(i - 1, j, Endpoint::X), self.endpoint(i + 1, j, Endpoint::XPrime)]
        } else {
            [self.endpoint(i, j - 1, Endpoint::XPrime), self.endpoint(i, j + 1, Endpoint::X)]
        }
    }
}
