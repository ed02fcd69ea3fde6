//! The sparse symmetric tangent H of (20): assembly from hinges and LDL^T factorisation. The
//! symbolic analysis is done once per topology and set of supports; free degrees of freedom are
//! numbered in elimination order.

use crate::{
    equilibrium::sparse_ldl::{SparseLdl, elimination_ranks},
    sheet::topology::Topology,
};
use faer::sparse::SymbolicSparseColMat;
use std::array::from_fn;
use std::collections::BTreeSet;
use std::iter::zip;

/// Maximum rounds of the condition estimate, which seldom needs more than three.
const HAGER_ROUNDS: usize = 5;

/// A pivot smaller than this, relative to its diagonal entry, is a rounding error.
pub const MIN_PIVOT_RATIO: f64 = 1e-13;

/// Sparsity of the tangent in the free degrees of freedom, lower triangle by columns.
#[derive(Debug)]
pub struct TangentPattern {
    ldl: SparseLdl,
    /// Indices of the free degrees of freedom in the order of elimination, three entries per panel.
    free: Box<[Option<usize>]>,
    /// Positions of the entries of each hinge's 6 x 6 block; `None` for supported or upper entries.
    slots: Vec<[[Option<u32>; 6]; 6]>,
}

/// LDL^T of a tangent.
#[derive(Clone, Debug)]
pub struct Factor {
    /// The entries of L and D.
    pub values: Vec<f64>,
    /// Number of pivots that are not positive beyond rounding: the number of unstable directions.
    pub negative_pivots: usize,
    /// Minimum ratio of a pivot to its diagonal entry: how close the tangent is to singular.
    pub pivot_ratio: f64,
}

/// The indices of the six degrees of freedom of each hinge.
fn at_hinges(topology: &Topology, free: &[Option<usize>]) -> Vec<[Option<usize>; 6]> {
    let numbers = |panels: [usize; 2]| from_fn(|d| free[3 * panels[d / 3] + d % 3]);
    topology.sites.iter().map(|site| numbers([site.a.0, site.b.0])).collect()
}

/// The sparsity of the lower triangle; it always contains the diagonal, for the shift.
fn sparsity(at_hinges: &[[Option<usize>; 6]], dimension: usize) -> SymbolicSparseColMat<usize> {
    let mut columns: Vec<BTreeSet<usize>> = (0..dimension).map(|i| [i].into()).collect();
    for numbers in at_hinges {
        for &column in numbers.iter().flatten() {
            let lower = numbers.iter().flatten().filter(|&&row| row > column);
            columns[column].extend(lower);
        }
    }
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for column in columns {
        rows.extend(column);
        starts.push(rows.len());
    }
    SymbolicSparseColMat::new_checked(dimension, dimension, starts, None, rows)
}

impl TangentPattern {
    /// The tangent of a sheet; `supported` has three entries per panel.
    pub fn new(topology: &Topology, supported: &[bool]) -> Self {
        let mut numbers = 0..;
        let mut free: Vec<Option<usize>> = (supported.iter())
            .map(|&supported| if supported { None } else { numbers.next() })
            .collect();
        let dimension = free.iter().flatten().count();
        let ranks = elimination_ranks(&sparsity(&at_hinges(topology, &free), dimension));
        (free.iter_mut().flatten()).for_each(|number| *number = ranks[*number]);
        let at_hinges = at_hinges(topology, &free);
        let ldl = SparseLdl::new(sparsity(&at_hinges, dimension));
        let (starts, rows) = ldl.entries();
        let slot = |row: usize, column: usize| {
            let range = starts[column]..starts[column + 1];
            let offset = rows[range.clone()].binary_search(&row).ok()?;
            Some((range.start + offset) as u32)
        };
        let slots = (at_hinges.iter())
            .map(|numbers| from_fn(|i| from_fn(|j| slot(numbers[i]?, numbers[j]?))))
            .collect();
        Self { ldl, free: free.into(), slots }
    }

    /// The free components of a vector with three components per panel.
    pub fn gather(&self, by_panel: &[[f64; 3]]) -> Vec<f64> {
        let mut row = vec![0.0; self.free.iter().flatten().count()];
        for (number, component) in zip(&self.free, by_panel.as_flattened()) {
            if let Some(number) = number {
                row[*number] = *component;
            }
        }
        row
    }

    /// The inverse of [`gather`](Self::gather); supported components are zero.
    pub fn spread(&self, row: &[f64]) -> Vec<[f64; 3]> {
        (self.free.chunks(3))
            .map(|numbers| from_fn(|d| numbers[d].map_or(0.0, |i| row[i])))
            .collect()
    }

    /// Positions of the diagonal entries, the first of their columns.
    fn diagonal_slots(&self) -> &[usize] {
        let (starts, _) = self.ldl.entries();
        &starts[..starts.len() - 1]
    }

    /// The lower triangle of H from the 6 x 6 blocks of the hinges.
    pub fn assemble(&self, blocks: impl Iterator<Item = [[f64; 6]; 6]>) -> Vec<f64> {
        let mut values = vec![0.0; self.ldl.entries().1.len()];
        for (slots, block) in zip(&self.slots, blocks) {
            for (slots, entries) in zip(slots, block) {
                for (slot, entry) in zip(slots, entries) {
                    if let Some(slot) = slot {
                        values[*slot as usize] += entry;
                    }
                }
            }
        }
        values
    }

    /// The diagonal of H.
    pub fn diagonal(&self, values: &[f64]) -> Vec<f64> {
        (self.diagonal_slots().iter()).map(|&slot| values[slot]).collect()
    }

    /// S: the magnitudes of the diagonal of a tangent, all non-zero.
    pub fn shift_scale(&self, values: &[f64]) -> Vec<f64> {
        let mut scale = self.diagonal(values);
        let max = scale.iter().fold(0.0_f64, |max, entry| max.max(entry.abs()));
        let min = if max > 0.0 { 1e-12 * max } else { 1.0 };
        scale.iter_mut().for_each(|entry| *entry = entry.abs().max(min));
        scale
    }

    /// H + shift, for a diagonal shift.
    pub fn shifted(&self, values: &[f64], shift: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut values = values.to_vec();
        for (&slot, shift) in zip(self.diagonal_slots(), shift) {
            values[slot] += shift;
        }
        values
    }

    /// H x, and |H| |x| for the estimate of its rounding errors.
    pub fn product(&self, values: &[f64], x: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut product, mut bound) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        let mut add = |row: usize, term: f64| {
            product[row] += term;
            bound[row] += term.abs();
        };
        let (starts, rows) = self.ldl.entries();
        for column in 0..x.len() {
            for slot in starts[column]..starts[column + 1] {
                let row = rows[slot];
                add(row, values[slot] * x[column]);
                if row != column {
                    add(column, values[slot] * x[row]);
                }
            }
        }
        (product, bound)
    }

    /// LDL^T, stored in `memory` of an earlier factor; `None` if a pivot vanishes or is not finite.
    pub fn factorise(&self, values: &[f64], memory: Vec<f64>) -> Option<Factor> {
        let mut factor = memory;
        self.ldl.factorise(values, &mut factor)?;
        let (mut negative_pivots, mut pivot_ratio) = (0, 1.0_f64);
        for (pivot, &slot) in zip(self.ldl.pivots(&factor), self.diagonal_slots()) {
            // Relative to its original diagonal entry of H.
            let ratio = pivot / values[slot].abs();
            if !ratio.is_finite() || ratio == 0.0 {
                return None;
            }
            negative_pivots += usize::from(ratio <= MIN_PIVOT_RATIO);
            pivot_ratio = pivot_ratio.min(ratio);
        }
        Some(Factor { negative_pivots, pivot_ratio, values: factor })
    }

    /// Estimate of the condition number of H scaled to a unit diagonal, in the 1-norm (Hager 1984).
    pub fn condition(&self, values: &[f64], factor: &Factor) -> f64 {
        let root: Vec<f64> = self.diagonal(values).iter().map(|d| d.abs().sqrt()).collect();
        let n = root.len();
        if n == 0 {
            return 1.0;
        }
        let (starts, rows) = self.ldl.entries();
        let mut sums = vec![0.0; n];
        for column in 0..n {
            for slot in starts[column]..starts[column + 1] {
                let row = rows[slot];
                let entry = (values[slot] / (root[row] * root[column])).abs();
                sums[column] += entry;
                if row != column {
                    sums[row] += entry;
                }
            }
        }
        let inverse = |x: &[f64]| -> Vec<f64> {
            let mut scaled: Vec<f64> = zip(x, &root).map(|(x, r)| x * r).collect();
            self.solve(factor, &mut scaled);
            zip(scaled, &root).map(|(x, r)| x * r).collect()
        };
        let (mut x, mut max) = (vec![1.0 / n as f64; n], 0.0);
        for _ in 0..HAGER_ROUNDS {
            let y = inverse(&x);
            let norm: f64 = y.iter().map(|y| y.abs()).sum();
            if norm <= max {
                break;
            }
            max = norm;
            let signs: Vec<f64> = y.iter().map(|y| y.signum()).collect();
            let z = inverse(&signs);
            let steepest = (0..n).max_by(|&i, &j| z[i].abs().total_cmp(&z[j].abs()));
            x.fill(0.0);
            x[steepest.expect("the tangent has at least one row")] = 1.0;
        }
        max * sums.into_iter().fold(0.0, f64::max)
    }

    /// Solves with the factor, in place.
    pub fn solve(&self, factor: &Factor, rhs: &mut [f64]) {
        self.ldl.solve(&factor.values, rhs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::grid::Grid;
    use std::sync::Arc;

    const GRIDS: [Grid; 4] =
        [Grid { m: 2, n: 1 }, Grid { m: 1, n: 9 }, Grid { m: 3, n: 3 }, Grid { m: 25, n: 20 }];

    /// Panel 0 clamped, and of some others one or two degrees of freedom supported.
    fn pattern(grid: Grid) -> TangentPattern {
        let supported = |i: usize| i < 3 || (i > 5 && i % 17 < 2);
        let supported: Vec<bool> = (0..3 * grid.panel_count()).map(supported).collect();
        TangentPattern::new(&Arc::<Topology>::from(grid), &supported)
    }

    /// A positive definite matrix: a full block v v^T of each hinge plus a diagonal.
    fn positive(pattern: &TangentPattern) -> Vec<f64> {
        let blocks = (0..pattern.slots.len()).map(|h| {
            let v: [f64; 6] = std::array::from_fn(|d| ((7 * h + d * d) as f64).sin());
            v.map(|row| v.map(|column| row * column))
        });
        let values = pattern.assemble(blocks);
        pattern.shifted(&values, std::iter::repeat(0.1))
    }

    #[test]
    fn solutions_satisfy_their_equations() {
        for pattern in GRIDS.map(pattern) {
            let values = positive(&pattern);
            let factor = pattern.factorise(&values, Vec::new()).unwrap();
            assert_eq!(factor.negative_pivots, 0);
            let rhs: Vec<f64> =
                (0..pattern.diagonal_slots().len()).map(|i| (i as f64).cos()).collect();
            let mut solution = rhs.clone();
            pattern.solve(&factor, &mut solution);
            let (product, _) = pattern.product(&values, &solution);
            assert!(std::iter::zip(product, rhs).all(|(p, b)| (p - b).abs() < 1e-12));
        }
    }

    #[test]
    fn negative_pivots_are_counted_and_zero_ones_refused() {
        for pattern in GRIDS.map(pattern) {
            let dimension = pattern.diagonal_slots().len();
            let factorise = |values: &[f64]| pattern.factorise(values, Vec::new());
            let opposite: Vec<f64> = positive(&pattern).iter().map(|value| -value).collect();
            assert_eq!(factorise(&opposite).unwrap().negative_pivots, dimension);
            let zero = vec![0.0; opposite.len()];
            let signs = (0..dimension).map(|i| if i % 5 == 2 { -1.0 } else { 2.0 });
            let signed = factorise(&pattern.shifted(&zero, signs)).unwrap();
            assert_eq!(signed.negative_pivots, (dimension + 2) / 5);
            assert!(factorise(&zero).is_none());
            assert!(factorise(&vec![f64::NAN; zero.len()]).is_none());
        }
    }
}
