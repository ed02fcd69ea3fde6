//! The panels, the hinges and their cut endpoints: the connectivity, which is the same for all
//! designs.

use crate::pattern::grid::{Endpoint, Grid, NE, NW, SE, SW};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A corner of a panel: (panel, corner), corners counter-clockwise from the south-west.
pub type PanelCorner = (usize, usize);

/// A corner at which two panels remain attached, and the cut endpoints that define the cuts there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HingeSite {
    /// The vertex (i, j) of the secondary cut.
    pub vertex: [usize; 2],
    /// The flank of the secondary cut at which the hinge is.
    pub endpoint: Endpoint,
    /// Panel A of the window, with even column + row, and its corner.
    pub a: PanelCorner,
    /// Panel B of the window, with odd column + row, and its corner.
    pub b: PanelCorner,
    /// The cut endpoint at the hinge.
    pub corner: usize,
    /// The ends of the secondary cut, in the direction of e_sec.
    pub(crate) secondary: [usize; 2],
    /// The far end of the main cut.
    pub main_end: usize,
    /// The middle of the main cut, where it ends unless another hinge is at its far end.
    pub main_middle: usize,
}

/// The panels of a sheet and the hinges that join them: cells of a grid.
///
/// A void and the four panels around it are a loop of four hinges, and loops that share two panels
/// open together. The voids that are kept therefore say which cells are panels, and which
/// neighbours hang together: those that are on one loop.
#[derive(Debug, PartialEq)]
pub struct Topology {
    /// All cells.
    pub grid: Grid,
    /// Column and row of each panel, row by row.
    pub places: Vec<[usize; 2]>,
    /// Ordered by vertex, row by row; at each vertex x before x'.
    pub sites: Vec<HingeSite>,
    /// The cut endpoints at the corners SW, SE, NE, NW of every panel.
    pub endpoints: Vec<[usize; 4]>,
    /// The shape of each panel that is not its cell.
    pub trims: Vec<Option<Trim>>,
    /// The points of trims that are on the outline of the opened sheet.
    pub outer: Vec<PanelCorner>,
    /// The panel of each cell.
    numbers: Vec<Option<usize>>,
    /// Whether the void at each interior vertex is kept, row by row.
    voids: Vec<bool>,
}

/// The boundary of a panel that is not its cell: counter-clockwise points SW + x (SE - SW) + y (NW -
/// SW), which move with the corners of the cell.
pub type Trim = Arc<[[f64; 2]]>;

impl From<Grid> for Arc<Topology> {
    /// Every cell is a panel.
    fn from(grid: Grid) -> Self {
        Self::new(Topology::with_loops(grid, |_, _| true))
    }
}

impl Topology {
    /// The panels around the `kept` voids of a grid, one entry per interior vertex, row by row.
    pub fn of_voids(grid: Grid, kept: &[bool]) -> Self {
        let at = |i: usize, j: usize| grid.is_interior(i, j) && kept[void(grid, i, j)];
        Self::with_loops(grid, at)
    }

    fn with_loops(grid: Grid, kept: impl Fn(usize, usize) -> bool) -> Self {
        let all = (0..grid.n).flat_map(|q| (0..grid.m).map(move |p| [p, q]));
        let on_loop = |&[p, q]: &[usize; 2]| {
            let vertices = [(p, q), (p + 1, q), (p, q + 1), (p + 1, q + 1)];
            vertices.into_iter().any(|(i, j)| kept(i, j))
        };
        let places: Vec<_> = all.filter(on_loop).collect();
        let mut numbers = vec![None; grid.panel_count()];
        for (panel, [p, q]) in places.iter().enumerate() {
            numbers[grid.panel(*p, *q)] = Some(panel);
        }
        let mut topology = Self {
            endpoints: places.iter().map(|place| endpoints(grid, *place)).collect(),
            trims: vec![None; places.len()],
            outer: Vec::new(),
            grid,
            places,
            sites: Vec::new(),
            numbers,
            voids: grid.interior_vertices().map(|(i, j)| kept(i, j)).collect(),
        };
        let sites =
            grid.vertices().flat_map(|(i, j)| Endpoint::BOTH.map(|endpoint| (i, j, endpoint)));
        topology.sites =
            sites.filter_map(|(i, j, end)| topology.hinge_site(i, j, end, &kept)).collect();
        topology
    }

    /// Whether every cell is a panel and no panel is trimmed.
    pub fn is_full(&self) -> bool {
        self.panel_count() == self.grid.panel_count() && self.trims.iter().all(Option::is_none)
    }

    /// Whether the void at vertex (i, j) is kept.
    pub fn has_void(&self, i: usize, j: usize) -> bool {
        self.grid.is_interior(i, j) && self.voids[void(self.grid, i, j)]
    }

    /// Whether the sheet is one piece that opens as one: all kept voids are joined by neighbours in
    /// rows and columns, which share two panels.
    pub fn is_mechanism(&self) -> bool {
        let all = || self.grid.interior_vertices().filter(|(i, j)| self.has_void(*i, *j));
        let Some(first) = all().next() else {
            return false;
        };
        let (mut joined, mut next) = (BTreeSet::from([first]), vec![first]);
        while let Some((i, j)) = next.pop() {
            for (i, j) in [(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)] {
                if self.has_void(i, j) && joined.insert((i, j)) {
                    next.push((i, j));
                }
            }
        }
        joined.len() == all().count()
    }

    /// Number of panels.
    pub fn panel_count(&self) -> usize {
        self.places.len()
    }

    /// Number of hinges.
    pub fn hinge_count(&self) -> usize {
        self.sites.len()
    }

    /// The panel in a column and a row, if there is one.
    pub fn panel(&self, p: usize, q: usize) -> Option<usize> {
        (p < self.grid.m && q < self.grid.n).then(|| self.numbers[self.grid.panel(p, q)])?
    }

    /// The panel at a place that is known to have one.
    ///
    /// # Panics
    /// If it has none.
    pub fn number(&self, [p, q]: [usize; 2]) -> usize {
        self.panel(p, q).expect("the place has a panel")
    }

    /// The panel beyond a side of a panel, counted from the bottom counter-clockwise.
    pub fn beyond(&self, panel: usize, side: usize) -> Option<usize> {
        let [p, q] = self.places[panel];
        let (p, q) = [
            (Some(p), q.checked_sub(1)),
            (Some(p + 1), Some(q)),
            (Some(p), Some(q + 1)),
            (p.checked_sub(1), Some(q)),
        ][side];
        self.panel(p?, q?)
    }

    /// Whether a panel has even column + row, so that it turns by -theta/2 in the ideal deployment.
    pub fn is_even(&self, panel: usize) -> bool {
        let [p, q] = self.places[panel];
        (p + q).is_multiple_of(2)
    }

    /// Whether the sheet continues beyond the secondary cut of a hinge.
    pub(crate) fn has_far_flank(&self, site: &HingeSite) -> bool {
        let [i, j] = site.vertex;
        let far = match site.endpoint {
            Endpoint::X => Endpoint::XPrime,
            Endpoint::XPrime => Endpoint::X,
        };
        flank(i, j, far).into_iter().any(|corner| self.with_corner(i, j, corner).is_some())
    }

    /// The hinge at an endpoint of C_ij; `None` if its panels are not on one loop.
    fn hinge_site(
        &self,
        i: usize,
        j: usize,
        endpoint: Endpoint,
        kept: impl Fn(usize, usize) -> bool,
    ) -> Option<HingeSite> {
        let [first, second] = flank(i, j, endpoint).map(|corner| self.with_corner(i, j, corner));
        let (first, second) = (first?, second?);
        let (far_i, far_j, _) = main_vertex(i, j, endpoint);
        if !(kept(i, j) || kept(far_i, far_j)) {
            return None;
        }
        let (a, b) = if self.is_even(first.0) { (first, second) } else { (second, first) };
        let [from, to] = slit(self.grid, i, j);
        Some(HingeSite {
            vertex: [i, j],
            endpoint,
            a,
            b,
            corner: self.grid.endpoint(i, j, endpoint),
            secondary: match endpoint {
                Endpoint::X => [from, to],
                Endpoint::XPrime => [to, from],
            },
            main_end: main_end(self.grid, i, j, endpoint),
            main_middle: self.grid.endpoint(far_i, far_j, Endpoint::X),
        })
    }

    /// The panel whose given corner lies at vertex (i, j), if there is one.
    fn with_corner(&self, i: usize, j: usize, corner: usize) -> Option<PanelCorner> {
        let p = i.checked_sub(usize::from(corner == SE || corner == NE))?;
        let q = j.checked_sub(usize::from(corner == NE || corner == NW))?;
        Some((self.panel(p, q)?, corner))
    }
}

/// The number of the void at an interior vertex.
fn void(grid: Grid, i: usize, j: usize) -> usize {
    (j - 1) * (grid.m - 1) + i - 1
}

/// The corners, at vertex (i, j), of the two cells on a flank of its cut.
fn flank(i: usize, j: usize, endpoint: Endpoint) -> [usize; 2] {
    match (Grid::horizontal(i, j), endpoint) {
        (true, Endpoint::X) => [NE, NW],
        (true, Endpoint::XPrime) => [SE, SW],
        (false, Endpoint::X) => [SW, NW],
        (false, Endpoint::XPrime) => [SE, NE],
    }
}

/// The cut endpoints at the corners SW, SE, NE, NW of a cell.
fn endpoints(grid: Grid, [p, q]: [usize; 2]) -> [usize; 4] {
    let endpoint = |i, j, even, odd| {
        let flank = if Grid::horizontal(i, j) { even } else { odd };
        grid.endpoint(i, j, flank)
    };
    [
        endpoint(p, q, Endpoint::XPrime, Endpoint::X),
        endpoint(p + 1, q, Endpoint::XPrime, Endpoint::XPrime),
        endpoint(p + 1, q + 1, Endpoint::X, Endpoint::XPrime),
        endpoint(p, q + 1, Endpoint::X, Endpoint::X),
    ]
}

/// The ends of the slit of C_ij: [A, B] of (3), or the ends of its outline edge.
fn slit(grid: Grid, i: usize, j: usize) -> [usize; 2] {
    if grid.is_interior(i, j) {
        return grid.facing_endpoints(i, j);
    }
    let ends = if Grid::horizontal(i, j) { [(0, j), (grid.m, j)] } else { [(i, 0), (i, grid.n)] };
    ends.map(|(i, j)| grid.endpoint(i, j, Endpoint::X))
}

/// The vertex in the middle of the cut that ends at this endpoint of C_ij, and which of the
/// endpoints that face it is at its far end.
fn main_vertex(i: usize, j: usize, endpoint: Endpoint) -> (usize, usize, usize) {
    // South of a horizontal and west of a vertical cut the main cut ends in its B, so its far end
    // is A; north and east it is the reverse.
    match (Grid::horizontal(i, j), endpoint) {
        (true, Endpoint::X) => (i, j - 1, 0),
        (true, Endpoint::XPrime) => (i, j + 1, 1),
        (false, Endpoint::X) => (i + 1, j, 1),
        (false, Endpoint::XPrime) => (i - 1, j, 0),
    }
}

/// The far end of the cut that ends at this endpoint of C_ij.
fn main_end(grid: Grid, i: usize, j: usize, endpoint: Endpoint) -> usize {
    let (i, j, far) = main_vertex(i, j, endpoint);
    if grid.is_interior(i, j) {
        grid.facing_endpoints(i, j)[far]
    } else {
        grid.endpoint(i, j, Endpoint::X)
    }
}
