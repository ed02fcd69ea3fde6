//! The order in which the panels are eliminated, and the fronts of the factorisation.
//!
//! The degrees of freedom of a panel are coupled to the same others, so that only panels are analysed. A front is a set
//! of panels that are eliminated together, in a dense matrix of their columns and of all rows that these change. What
//! it changes in the rows of other panels is added to its parent, the front of the next of them (Duff and Reid
//! 1983; Liu 1992). A front is merged with its parent where this stores few zeros: dense work costs less than its
//! administration (Ashcraft and Grimes 1989).

use crate::pattern::grid::Grid;
use crate::sheet::topology::hinge_sites;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMat;
use faer::sparse::linalg::amd;
use std::ops::Range;

/// Maximum fraction of zeros in a front that is merged, by its number of columns (measured).
const ZEROS: [(usize, f64); 3] = [(6, 1.0), (24, 0.2), (usize::MAX, 0.02)];

/// Order of elimination with little fill-in.
#[derive(Debug)]
pub(crate) struct Elimination {
    /// Indices of the free degrees of freedom in the order of elimination, three entries per panel.
    pub free: Vec<Option<usize>>,
    /// Children before their parents.
    pub fronts: Vec<Front>,
}

/// Degrees of freedom that are eliminated together.
#[derive(Debug)]
pub(crate) struct Front {
    pub columns: Range<usize>,
    /// The later degrees of freedom to which they are coupled, ascending.
    pub rows: Vec<usize>,
    pub children: Vec<usize>,
    /// Distance from the root of the tree.
    pub depth: usize,
}

/// A front before the degrees of freedom are numbered.
struct Merged {
    /// Panels in the order of elimination.
    panels: Vec<usize>,
    /// The later panels to which they are coupled.
    later: Vec<usize>,
    children: Vec<usize>,
    /// Number of columns, of rows below them, and of stored zeros.
    columns: usize,
    rows: usize,
    zeros: usize,
}

impl Elimination {
    /// `supported` has three entries per panel.
    pub fn new(grid: Grid, supported: &[bool]) -> Self {
        let widths: Vec<usize> = (supported.chunks(3))
            .map(|panel| panel.iter().filter(|supported| !**supported).count())
            .collect();
        let fronts = merged(grid, &widths);
        let order = postorder(&fronts);
        let mut numbers = 0..;
        let mut free = vec![None; supported.len()];
        for panel in order.iter().flat_map(|&(front, _)| &fronts[front].panels) {
            for degree in (3 * panel..3 * panel + 3).filter(|&degree| !supported[degree]) {
                free[degree] = numbers.next();
            }
        }
        let mut rank = vec![0; fronts.len()];
        for (number, &(front, _)) in order.iter().enumerate() {
            rank[front] = number;
        }
        let of = |panels: &[usize]| {
            let degrees = panels
                .iter()
                .flat_map(|panel| &free[3 * panel..3 * panel + 3]);
            let mut numbers: Vec<usize> = degrees.flatten().copied().collect();
            numbers.sort_unstable();
            numbers
        };
        let numbered = |&(front, depth): &(usize, usize)| {
            let front: &Merged = &fronts[front];
            let columns = of(&front.panels);
            Front {
                columns: columns[0]..columns[0] + columns.len(),
                rows: of(&front.later),
                children: front.children.iter().map(|&child| rank[child]).collect(),
                depth,
            }
        };
        Self {
            fronts: order.iter().map(numbered).collect(),
            free,
        }
    }
}

/// The fronts of the panels with free degrees of freedom, children before parents.
fn merged(grid: Grid, widths: &[usize]) -> Vec<Merged> {
    let order = ordered(grid, widths);
    let mut rank = vec![usize::MAX; widths.len()];
    for (number, &panel) in order.iter().enumerate() {
        rank[panel] = number;
    }
    let mut later: Vec<Vec<usize>> = vec![Vec::new(); order.len()];
    for [a, b] in couplings(grid, widths) {
        let (first, second) = if rank[a] < rank[b] { (a, b) } else { (b, a) };
        later[rank[first]].push(second);
    }
    // The fronts whose parent is the front of a panel.
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); order.len()];
    let mut fronts: Vec<Option<Merged>> = Vec::with_capacity(order.len());
    for (number, &panel) in order.iter().enumerate() {
        let mut panels = std::mem::take(&mut later[number]);
        let below = std::mem::take(&mut children[number]);
        for &child in &below {
            let child = fronts[child].as_ref().expect("a child is not merged yet");
            panels.extend(child.later.iter().filter(|&&other| other != panel));
        }
        panels.sort_unstable();
        panels.dedup();
        let mut front = Merged {
            panels: vec![panel],
            columns: widths[panel],
            rows: panels.iter().map(|&other| widths[other]).sum(),
            later: panels,
            children: Vec::new(),
            zeros: 0,
        };
        for child in below {
            let inner = fronts[child].take().expect("a child is not merged yet");
            if let Err(inner) = front.absorb(inner) {
                fronts[child] = Some(inner);
                front.children.push(child);
            }
        }
        if let Some(next) = front.later.iter().map(|&other| rank[other]).min() {
            children[next].push(number);
        }
        fronts.push(Some(front));
    }
    // Numbers without the fronts that were merged.
    let mut left = 0..;
    let kept: Vec<usize> = (fronts.iter())
        .map(|front| {
            front
                .as_ref()
                .map_or(0, |_| left.next().unwrap_or_default())
        })
        .collect();
    let renumbered = |mut front: Merged| {
        front
            .children
            .iter_mut()
            .for_each(|child| *child = kept[*child]);
        front
    };
    fronts.into_iter().flatten().map(renumbered).collect()
}

impl Merged {
    /// Takes the panels of a child, if few zeros are stored then; otherwise returns the child.
    fn absorb(&mut self, child: Self) -> Result<(), Self> {
        let stored = |columns: usize, rows: usize| columns * (columns + 1) / 2 + columns * rows;
        let filled = |front: &Self| stored(front.columns, front.rows) - front.zeros;
        let columns = self.columns + child.columns;
        let all = stored(columns, self.rows);
        let zeros = all - filled(self) - filled(&child);
        let few = ZEROS.into_iter().find(|(most, _)| columns <= *most);
        if few.is_none_or(|(_, fraction)| zeros as f64 > fraction * all as f64) {
            return Err(child);
        }
        let own = std::mem::replace(&mut self.panels, child.panels);
        self.panels.extend(own);
        self.children.extend(child.children);
        (self.columns, self.zeros) = (columns, zeros);
        Ok(())
    }
}

/// The panels with free degrees of freedom in an order with little fill-in (approximate minimum degree).
fn ordered(grid: Grid, widths: &[usize]) -> Vec<usize> {
    let panels: Vec<usize> = (0..widths.len())
        .filter(|&panel| widths[panel] > 0)
        .collect();
    let mut number = vec![0; widths.len()];
    for (i, &panel) in panels.iter().enumerate() {
        number[panel] = i;
    }
    let mut columns: Vec<Vec<usize>> = (0..panels.len()).map(|i| vec![i]).collect();
    for [a, b] in couplings(grid, widths) {
        let (a, b) = (number[a], number[b]);
        columns[a.min(b)].push(a.max(b));
    }
    let (starts, rows) = columns_of(columns);
    let (dimension, entries) = (panels.len(), rows.len());
    let matrix = SymbolicSparseColMat::new_checked(dimension, dimension, starts, None, rows);
    let (mut order, mut inverse) = (vec![0; dimension], vec![0; dimension]);
    let scratch = amd::order_scratch::<usize>(dimension, entries);
    amd::order(
        &mut order,
        &mut inverse,
        matrix.as_ref(),
        amd::Control::default(),
        MemStack::new(&mut MemBuffer::new(scratch)),
    )
    .expect("indices fit in usize");
    order.into_iter().map(|i| panels[i]).collect()
}

/// The pairs of panels, both with free degrees of freedom, that a hinge couples.
fn couplings(grid: Grid, widths: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    let sites = hinge_sites(grid).into_iter();
    let pairs = sites.map(|site| [site.a.0, site.b.0]);
    pairs.filter(|pair| pair.iter().all(|&panel| widths[panel] > 0))
}

/// Sorted rows of the columns of a sparse matrix, and where each column starts.
pub(crate) fn columns_of(columns: Vec<Vec<usize>>) -> (Vec<usize>, Vec<usize>) {
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for mut column in columns {
        column.sort_unstable();
        column.dedup();
        rows.extend(column);
        starts.push(rows.len());
    }
    (starts, rows)
}

/// The fronts with their depths, each after its children, and these without a front between them that is not below one
/// of them.
fn postorder(fronts: &[Merged]) -> Vec<(usize, usize)> {
    let mut is_child = vec![false; fronts.len()];
    for &child in fronts.iter().flat_map(|front| &front.children) {
        is_child[child] = true;
    }
    let mut order = Vec::with_capacity(fronts.len());
    let mut stack: Vec<(usize, usize)> = (0..fronts.len())
        .filter(|&front| !is_child[front])
        .map(|front| (front, 0))
        .collect();
    // Parents first, then reversed.
    while let Some((front, depth)) = stack.pop() {
        order.push((front, depth));
        stack.extend(
            fronts[front]
                .children
                .iter()
                .map(|&child| (child, depth + 1)),
        );
    }
    order.reverse();
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tree is that of Gaussian elimination: what a front leaves is taken by its parent, and every degree of freedom
    /// is eliminated once.
    #[test]
    fn parents_take_the_rows_of_their_children() {
        for (m, n) in [(1, 1), (1, 5), (4, 3), (20, 30)] {
            let grid = Grid { m, n };
            let supported: Vec<bool> = (0..3 * grid.panel_count()).map(|i| i % 11 == 1).collect();
            let Elimination { free, fronts } = Elimination::new(grid, &supported);
            let mut numbers: Vec<usize> = free.iter().flatten().copied().collect();
            numbers.sort_unstable();
            assert!(numbers.iter().enumerate().all(|(i, number)| i == *number));
            let ends = fronts.iter().map(|front| front.columns.clone());
            assert_eq!(ends.flatten().collect::<Vec<_>>(), numbers);
            let mut parents = vec![0; fronts.len()];
            for (index, front) in fronts.iter().enumerate() {
                assert!(front.rows.iter().all(|&row| row >= front.columns.end));
                for &child in &front.children {
                    let taken =
                        |row: &usize| front.columns.contains(row) || front.rows.contains(row);
                    assert!(child < index && fronts[child].rows.iter().all(taken));
                    assert_eq!(fronts[child].depth, front.depth + 1);
                    parents[child] += 1;
                }
            }
            let left = |(front, parents): (&Front, usize)| front.rows.is_empty() == (parents == 0);
            assert!(std::iter::zip(&fronts, parents).all(left));
        }
    }

    /// Elimination row by row of panels would fill a band of 120 rows below the diagonal.
    #[test]
    fn a_third_of_the_band_is_filled() {
        let grid = Grid { m: 40, n: 40 };
        let fronts = Elimination::new(grid, &[false; 4800]).fronts;
        let stored = fronts.iter().map(|front| {
            let (columns, rows) = (front.columns.len(), front.rows.len());
            columns * (columns + 1) / 2 + columns * rows
        });
        let part = stored.sum::<usize>() as f64 / (4800 * 120) as f64;
        assert!((0.3..0.4).contains(&part), "{part}");
    }
}
