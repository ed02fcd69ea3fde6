//! The cut endpoints of each panel and each hinge: the connectivity, which is the same for all
//! designs.

use crate::pattern::grid::{Endpoint, Grid, NE, NW, SE, SW};

/// A corner of a panel: (panel, corner), corners counter-clockwise from the south-west.
pub type PanelCorner = (usize, usize);

/// A corner at which two panels remain attached, and the cut endpoints that define the cuts there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
}

/// The cut endpoints at the corners SW, SE, NE, NW of every panel.
pub fn panel_endpoints(grid: Grid) -> Vec<[usize; 4]> {
    let endpoint = |i, j, even, odd| {
        let flank = if Grid::horizontal(i, j) { even } else { odd };
        grid.endpoint(i, j, flank)
    };
    let panels = (0..grid.n).flat_map(|q| (0..grid.m).map(move |p| (p, q)));
    panels
        .map(|(p, q)| {
            [
                endpoint(p, q, Endpoint::XPrime, Endpoint::X),
                endpoint(p + 1, q, Endpoint::XPrime, Endpoint::XPrime),
                endpoint(p + 1, q + 1, Endpoint::X, Endpoint::XPrime),
                endpoint(p, q + 1, Endpoint::X, Endpoint::X),
            ]
        })
        .collect()
}

/// All hinges, ordered by vertex, row by row; at each vertex x before x'.
pub fn hinge_sites(grid: Grid) -> Vec<HingeSite> {
    grid.vertices()
        .flat_map(|(i, j)| [(i, j, Endpoint::X), (i, j, Endpoint::XPrime)])
        .filter_map(|(i, j, endpoint)| hinge_site(grid, i, j, endpoint))
        .collect()
}

/// The hinge at an endpoint of C_ij; `None` if a panel is missing, at outline slits and corners.
fn hinge_site(grid: Grid, i: usize, j: usize, endpoint: Endpoint) -> Option<HingeSite> {
    let corners = match (Grid::horizontal(i, j), endpoint) {
        (true, Endpoint::X) => [NE, NW],
        (true, Endpoint::XPrime) => [SE, SW],
        (false, Endpoint::X) => [SW, NW],
        (false, Endpoint::XPrime) => [SE, NE],
    };
    let [first, second] = corners.map(|corner| panel_with_corner(grid, i, j, corner));
    let (first, second) = (first?, second?);
    let (a, b) = if is_even(grid, first.0) { (first, second) } else { (second, first) };
    let [from, to] = slit(grid, i, j);
    Some(HingeSite {
        vertex: [i, j],
        endpoint,
        a,
        b,
        corner: grid.endpoint(i, j, endpoint),
        secondary: match endpoint {
            Endpoint::X => [from, to],
            Endpoint::XPrime => [to, from],
        },
        main_end: main_end(grid, i, j, endpoint),
    })
}

/// The panel whose given corner is at vertex (i, j), if there is one.
fn panel_with_corner(grid: Grid, i: usize, j: usize, corner: usize) -> Option<PanelCorner> {
    let p = i.checked_sub(usize::from(corner == SE || corner == NE))?;
    let q = j.checked_sub(usize::from(corner == NE || corner == NW))?;
    (p < grid.m && q < grid.n).then(|| (grid.panel(p, q), corner))
}

/// Whether panel k has even column + row, so that it turns by -theta/2 in the ideal deployment.
pub fn is_even(grid: Grid, panel: usize) -> bool {
    (panel % grid.m + panel / grid.m).is_multiple_of(2)
}

/// The ends of the slit of C_ij: [A, B] of (3), or the ends of its outline edge.
fn slit(grid: Grid, i: usize, j: usize) -> [usize; 2] {
    if grid.is_interior(i, j) {
        return grid.facing_endpoints(i, j);
    }
    let ends = if Grid::horizontal(i, j) { [(0, j), (grid.m, j)] } else { [(i, 0), (i, grid.n)] };
    ends.map(|(i, j)| grid.endpoint(i, j, Endpoint::X))
}

/// The far end of the cut that ends at this endpoint of C_ij.
fn main_end(grid: Grid, i: usize, j: usize, endpoint: Endpoint) -> usize {
    // South of a horizontal and west of a vertical cut the main cut ends in its B, so its far end
    // is A; north and east it is the reverse.
    let (i, j, far) = match (Grid::horizontal(i, j), endpoint) {
        (true, Endpoint::X) => (i, j - 1, 0),
        (true, Endpoint::XPrime) => (i, j + 1, 1),
        (false, Endpoint::X) => (i + 1, j, 1),
        (false, Endpoint::XPrime) => (i - 1, j, 0),
    };
    if grid.is_interior(i, j) {
        grid.facing_endpoints(i, j)[far]
    } else {
        grid.endpoint(i, j, Endpoint::X)
    }
}
