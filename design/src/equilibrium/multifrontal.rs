//! LDL^T of a sparse symmetric matrix without pivoting, front by front (Duff and Reid 1983).
//!
//! ```text
//! front = [ A11  .   ] = [ L11  . ] [ D1  . ] [ L11'  L21' ]      U = A22 - L21 D1 L21'
//!         [ A21  A22 ]   [ L21  1 ] [ .   U ] [ .     1    ]
//! ```
//!
//! [L11; L21] of a front are stored as a dense block of columns, D1 on its diagonal. U is added to the parent. The fronts
//! of even and of odd depth have a stack of such matrices each: children lie on the other stack than their parent.
//!
//! Six columns, the degrees of freedom of two panels, are computed at a time from those before them, one to four
//! vectors of rows after another, whose sums stay in registers. So that there are only whole vectors, columns end with
//! zeros, and U begins with the pivot rows that fill its first vector; those are never read.

use crate::equilibrium::elimination::Front;
use pulp::{Simd, WithSimd};
use std::cell::RefCell;
use std::ops::Range;

/// Longest vector of any processor, in numbers.
const LANES: usize = 8;
/// Columns that are computed together.
const STRIP: usize = 6;
/// Columns that are subtracted from all later ones at a time, so that they stay in cache: a multiple of a strip (measured).
const SLAB: usize = 48;

/// The fronts of a sparse matrix and where their entries are stored.
#[derive(Debug)]
pub(crate) struct Multifrontal {
    fronts: Vec<Stored>,
    /// Position in the factor of each entry of the matrix.
    places: Vec<u32>,
    /// Positions of the pivots.
    pivots: Vec<usize>,
    /// Number of stored entries of the factor, and of the two stacks.
    size: usize,
    stacks: [usize; 2],
}

#[derive(Debug)]
struct Stored {
    front: Front,
    /// Position of the block in the factor.
    start: usize,
    /// Length of its columns.
    height: usize,
    /// Position of U in its stack.
    update: usize,
    /// Its rows in the front of the parent, by runs of successive ones.
    in_parent: Vec<Run>,
    /// Where the entries of its columns start and end in the matrix.
    entries: [usize; 2],
}

/// Successive rows of a front that are successive in the front of the parent.
#[derive(Debug)]
struct Run {
    from: usize,
    to: usize,
    length: usize,
}

/// Buffers that are kept between factorisations, since new memory would cost page faults.
#[derive(Default)]
struct Workspace {
    stacks: [Vec<f64>; 2],
    weights: Vec<f64>,
    column: Vec<f64>,
}

thread_local! {
    static WORKSPACE: RefCell<Workspace> = RefCell::default();
}

impl Stored {
    fn pivots(&self) -> usize {
        self.front.columns.len()
    }

    /// Row of the front at which the rows of U start, with the rows before that fill its first vector.
    fn base(&self) -> usize {
        self.pivots() / LANES * LANES
    }

    /// Length of the columns of U.
    fn update_height(&self) -> usize {
        self.height - self.base()
    }

    /// Where its columns are in the factor.
    fn block(&self) -> Range<usize> {
        self.start..self.start + self.height * self.pivots()
    }

    fn update_size(&self) -> usize {
        self.update_height() * self.front.rows.len()
    }

    fn stack(&self) -> usize {
        self.front.depth % 2
    }

    /// Row of the front that belongs to a row of the matrix.
    fn row(&self, row: usize) -> usize {
        match row < self.front.columns.end {
            true => row - self.front.columns.start,
            false => {
                let found = self.front.rows.binary_search(&row);
                self.pivots()
                    + found.expect("the front contains the rows of its columns and children")
            }
        }
    }
}

impl Multifrontal {
    /// The factorisation of a matrix whose lower triangle is stored by columns.
    pub fn new(fronts: Vec<Front>, starts: &[usize], rows: &[usize]) -> Self {
        let (mut size, mut stacks, mut tops) = (0, [0; 2], [0; 2]);
        let mut stored: Vec<Stored> = Vec::with_capacity(fronts.len());
        for front in fronts {
            // The matrices of the children are free once they have been added.
            for &child in &front.children {
                let child = &stored[child];
                tops[child.stack()] -= child.update_size();
            }
            let columns = &front.columns;
            let mut next = Stored {
                start: size,
                height: (columns.len() + front.rows.len()).next_multiple_of(LANES),
                update: 0,
                in_parent: Vec::new(),
                entries: [starts[columns.start], starts[columns.end]],
                front,
            };
            size += next.height * next.pivots();
            let top = &mut tops[next.stack()];
            next.update = *top;
            *top += next.update_size();
            stacks[next.stack()] = stacks[next.stack()].max(*top);
            stored.push(next);
        }
        for parent in 0..stored.len() {
            for child in stored[parent].front.children.clone() {
                let rows = stored[child].front.rows.iter();
                stored[child].in_parent = runs(rows.map(|&row| stored[parent].row(row)));
            }
        }
        let mut places = Vec::with_capacity(rows.len());
        let mut pivots = Vec::with_capacity(starts.len() - 1);
        for front in &stored {
            for (local, column) in front.front.columns.clone().enumerate() {
                let first = front.start + local * front.height;
                pivots.push(first + local);
                let rows = &rows[starts[column]..starts[column + 1]];
                places.extend(rows.iter().map(|&row| (first + front.row(row)) as u32));
            }
        }
        Self {
            fronts: stored,
            places,
            pivots,
            size,
            stacks,
        }
    }

    /// Number of entries of L with D, and of multiplications that compute them from A.
    pub fn size(&self) -> [usize; 2] {
        let columns = self.fronts.iter().flat_map(|stored| {
            let height = stored.pivots() + stored.front.rows.len();
            (0..stored.pivots()).map(move |column| height - column)
        });
        columns.fold([0, 0], |[entries, multiplications], rows| {
            [entries + rows, multiplications + rows * (rows + 1) / 2]
        })
    }

    /// D, in the order of elimination.
    pub fn pivots<'a>(&'a self, factor: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.pivots.iter().map(|&place| factor[place])
    }

    /// LDL^T of the matrix with the entries `values`, stored in `factor`; `None` if a pivot vanishes or is not finite.
    pub fn factorise(&self, values: &[f64], factor: &mut Vec<f64>) -> Option<()> {
        factor.resize(self.size, 0.0);
        WORKSPACE.with_borrow_mut(|workspace| {
            for (stack, &size) in std::iter::zip(&mut workspace.stacks, &self.stacks) {
                stack.resize(size.max(stack.len()), 0.0);
            }
            pulp::Arch::new().dispatch(Factorise {
                plan: self,
                values,
                factor,
                workspace,
            })
        })
    }

    /// Solves with the factor, in place.
    pub fn solve(&self, factor: &[f64], x: &mut [f64]) {
        WORKSPACE.with_borrow_mut(|workspace| {
            pulp::Arch::new().dispatch(Solve {
                plan: self,
                factor,
                x,
                column: &mut workspace.column,
            });
        });
    }
}

/// Ascending numbers by runs.
fn runs(numbers: impl Iterator<Item = usize>) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (from, to) in numbers.enumerate() {
        match runs.last_mut() {
            Some(last) if last.to + last.length == to => last.length += 1,
            _ => runs.push(Run {
                from,
                to,
                length: 1,
            }),
        }
    }
    runs
}

struct Factorise<'a> {
    plan: &'a Multifrontal,
    values: &'a [f64],
    factor: &'a mut [f64],
    workspace: &'a mut Workspace,
}

impl WithSimd for Factorise<'_> {
    type Output = Option<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<()> {
        let Workspace {
            stacks, weights, ..
        } = self.workspace;
        for front in &self.plan.fronts {
            self.factor[front.block()].fill(0.0);
            let [from, to] = front.entries;
            for (place, value) in
                std::iter::zip(&self.plan.places[from..to], &self.values[from..to])
            {
                self.factor[*place as usize] = *value;
            }
            let block = &mut self.factor[front.block()];
            let [even, odd] = &mut *stacks;
            let (own, other) = match front.stack() {
                0 => (even, &*odd),
                _ => (odd, &*even),
            };
            let children = || {
                let children = front.front.children.iter();
                children.map(|&child| &self.plan.fronts[child])
            };
            for child in children() {
                extend(block, (front.height, 0), 0..front.pivots(), child, other);
            }
            factorise_block(simd, front, block, weights)?;
            let update = &mut own[front.update..][..front.update_size()];
            downdate_rest(simd, front, block, update, weights);
            for child in children() {
                let rest = front.pivots()..front.pivots() + front.front.rows.len();
                extend(
                    update,
                    (front.update_height(), front.base()),
                    rest,
                    child,
                    other,
                );
            }
        }
        Some(())
    }
}

/// Adds the U of a child to some columns of the parent, whose first stored row is `above`.
#[inline(always)]
fn extend(
    target: &mut [f64],
    (height, above): (usize, usize),
    columns: Range<usize>,
    child: &Stored,
    stack: &[f64],
) {
    let (tall, skipped) = (child.update_height(), child.pivots() - child.base());
    for (n, run) in child.in_parent.iter().enumerate() {
        let of_run = run.to.max(columns.start)..columns.end.min(run.to + run.length);
        for column in of_run {
            // Row of U on its diagonal, and those below in this run.
            let mut skip = column - run.to;
            let changes = &stack[child.update + (run.from + skip) * tall + skipped..];
            let target = &mut target[(column - columns.start) * height..][..height];
            for run in &child.in_parent[n..] {
                let target = &mut target[run.to + skip - above..][..run.length - skip];
                for (entry, change) in std::iter::zip(target, &changes[run.from + skip..]) {
                    *entry += change;
                }
                skip = 0;
            }
        }
    }
}

/// LDL^T of the columns of a front, and L21.
#[inline(always)]
fn factorise_block<S: Simd>(
    simd: S,
    front: &Stored,
    block: &mut [f64],
    weights: &mut Vec<f64>,
) -> Option<()> {
    let height = front.height;
    for first in (0..front.pivots()).step_by(STRIP) {
        let (done, rest) = block.split_at_mut(first * height);
        let width = STRIP.min(front.pivots() - first);
        let strip = &mut rest[..width * height];
        // The columns since the last whole slab; those before have been subtracted.
        let slab = first / SLAB * SLAB;
        let done = Done::new(&done[slab * height..], height, slab, 0);
        done.weigh(first..first + width, weights);
        done.multiply::<S, true>(simd, strip, first, weights);
        factorise_strip(simd, strip, height, first)?;
        let next = first + width;
        if next.is_multiple_of(SLAB) {
            let (done, rest) = block.split_at_mut(next * height);
            let done = Done::new(&done[(next - SLAB) * height..], height, next - SLAB, 0);
            for (strip, row) in rest.chunks_mut(STRIP * height).zip((next..).step_by(STRIP)) {
                done.weigh(row..row + strip.len() / height, weights);
                done.multiply::<S, true>(simd, strip, row, weights);
            }
        }
    }
    Some(())
}

/// U = -L21 D1 L21'.
#[inline(always)]
fn downdate_rest<S: Simd>(
    simd: S,
    front: &Stored,
    block: &[f64],
    update: &mut [f64],
    weights: &mut Vec<f64>,
) {
    let (height, tall) = (front.height, front.update_height());
    for (first, slab) in (0..).step_by(SLAB).zip(block.chunks(SLAB * height)) {
        let done = Done::new(slab, height, first, front.base());
        let strips = update.chunks_mut((STRIP * tall).max(1));
        for (strip, row) in strips.zip((front.pivots()..).step_by(STRIP)) {
            done.weigh(row..row + strip.len() / tall, weights);
            match first {
                0 => done.multiply::<S, false>(simd, strip, row, weights),
                _ => done.multiply::<S, true>(simd, strip, row, weights),
            }
        }
    }
}

/// Successive columns of L with D on their diagonal.
#[derive(Clone, Copy)]
struct Done<'a> {
    entries: &'a [f64],
    height: usize,
    /// Column of the front that is the first of these.
    first: usize,
    /// Row of the front that is row 0 of the strips to which their products are added.
    base: usize,
}

impl<'a> Done<'a> {
    fn new(entries: &'a [f64], height: usize, first: usize, base: usize) -> Self {
        Self {
            entries,
            height,
            first,
            base,
        }
    }

    /// -D L' of some rows, by columns.
    #[inline(always)]
    fn weigh(self, rows: Range<usize>, weights: &mut Vec<f64>) {
        weights.clear();
        for (k, column) in (self.first..).zip(self.entries.chunks_exact(self.height)) {
            let pivot = column[k];
            weights.extend(column[rows.clone()].iter().map(|entry| -pivot * entry));
        }
    }

    /// Adds to a strip (`ADD`), or writes to it, the products of the columns with their weights, in its rows from
    /// that with its first diagonal entry, which is row `diagonal` of the front.
    #[inline(always)]
    fn multiply<S: Simd, const ADD: bool>(
        self,
        simd: S,
        strip: &mut [f64],
        diagonal: usize,
        weights: &[f64],
    ) {
        match strip.len() / (self.height - self.base) {
            1 => self.multiply_by::<S, 1, ADD>(simd, strip, diagonal, weights),
            2 => self.multiply_by::<S, 2, ADD>(simd, strip, diagonal, weights),
            3 => self.multiply_by::<S, 3, ADD>(simd, strip, diagonal, weights),
            4 => self.multiply_by::<S, 4, ADD>(simd, strip, diagonal, weights),
            5 => self.multiply_by::<S, 5, ADD>(simd, strip, diagonal, weights),
            _ => self.multiply_by::<S, STRIP, ADD>(simd, strip, diagonal, weights),
        }
    }

    /// [`multiply`](Self::multiply) for a strip of `N` columns.
    #[inline(always)]
    fn multiply_by<S: Simd, const N: usize, const ADD: bool>(
        self,
        simd: S,
        strip: &mut [f64],
        diagonal: usize,
        weights: &[f64],
    ) {
        let (weights, _) = weights.as_chunks::<N>();
        let tall = self.height - self.base;
        let mut row = (diagonal - self.base) / LANES * LANES;
        // Sums of six columns by four vectors fit into the 32 registers of AVX-512.
        while S::F64_LANES == LANES && row + 4 * S::F64_LANES <= tall {
            self.tile::<S, 4, N, ADD>(simd, strip, row, weights);
            row += 4 * S::F64_LANES;
        }
        while row + 2 * S::F64_LANES <= tall {
            self.tile::<S, 2, N, ADD>(simd, strip, row, weights);
            row += 2 * S::F64_LANES;
        }
        if row < tall {
            self.tile::<S, 1, N, ADD>(simd, strip, row, weights);
        }
    }

    /// [`multiply`](Self::multiply) for `R` vectors of rows.
    #[inline(always)]
    fn tile<S: Simd, const R: usize, const N: usize, const ADD: bool>(
        self,
        simd: S,
        strip: &mut [f64],
        row: usize,
        weights: &[[f64; N]],
    ) {
        let rows = R * S::F64_LANES;
        let mut sums = [[simd.splat_f64s(0.0); R]; N];
        let columns = self.entries.chunks_exact(self.height);
        for (column, weights) in std::iter::zip(columns, weights) {
            let (vectors, _) = S::as_simd_f64s(&column[self.base + row..][..rows]);
            for n in 0..N {
                let weight = simd.splat_f64s(weights[n]);
                for r in 0..R {
                    sums[n][r] = simd.mul_add_f64s(weight, vectors[r], sums[n][r]);
                }
            }
        }
        let columns = strip.chunks_exact_mut(self.height - self.base);
        for (column, sums) in std::iter::zip(columns, sums) {
            let (vectors, _) = S::as_mut_simd_f64s(&mut column[row..][..rows]);
            for r in 0..R {
                vectors[r] = match ADD {
                    true => simd.add_f64s(vectors[r], sums[r]),
                    false => sums[r],
                };
            }
        }
    }
}

/// LDL^T of a strip whose first diagonal entry is in row `first`. Entries above the diagonal become zero.
#[inline(always)]
fn factorise_strip<S: Simd>(simd: S, strip: &mut [f64], height: usize, first: usize) -> Option<()> {
    for c in 0..strip.len() / height {
        let row = first + c;
        let (column, right) = strip[c * height..].split_at_mut(height);
        let pivot = column[row];
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        let top = row / LANES * LANES;
        for (n, next) in right.chunks_exact_mut(height).enumerate() {
            let weight = -column[row + 1 + n] / pivot;
            add(simd, &mut next[top..], &column[top..], weight);
        }
        let (vectors, _) = S::as_mut_simd_f64s(&mut column[top..]);
        let inverse = simd.splat_f64s(1.0 / pivot);
        for vector in vectors {
            *vector = simd.mul_f64s(*vector, inverse);
        }
        column[first / LANES * LANES..row].fill(0.0);
        column[row] = pivot;
    }
    Some(())
}

/// sum += weight * column, of a whole number of vectors.
#[inline(always)]
fn add<S: Simd>(simd: S, sum: &mut [f64], column: &[f64], weight: f64) {
    let weight = simd.splat_f64s(weight);
    let (sum, _) = S::as_mut_simd_f64s(sum);
    let (column, _) = S::as_simd_f64s(column);
    for (sum, vector) in std::iter::zip(sum, column) {
        *sum = simd.mul_add_f64s(weight, *vector, *sum);
    }
}

/// The product of two columns of a whole number of vectors.
#[inline(always)]
fn product<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let (a, _) = S::as_simd_f64s(a);
    let (b, _) = S::as_simd_f64s(b);
    let mut sum = simd.splat_f64s(0.0);
    for (a, b) in std::iter::zip(a, b) {
        sum = simd.mul_add_f64s(*a, *b, sum);
    }
    simd.reduce_sum_f64s(sum)
}

struct Solve<'a> {
    plan: &'a Multifrontal,
    factor: &'a [f64],
    x: &'a mut [f64],
    column: &'a mut Vec<f64>,
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (x, column) = (self.x, self.column);
        for front in &self.plan.fronts {
            let pivots = front.pivots();
            let own = &mut x[front.front.columns.clone()];
            column.clear();
            column.extend_from_slice(own);
            column.resize(front.height, 0.0);
            let block = self.factor[front.block()].chunks_exact(front.height);
            for (k, (x, l)) in std::iter::zip(own, block).enumerate() {
                *x = column[k];
                let top = (k + 1) / LANES * LANES;
                add(simd, &mut column[top..], &l[top..], -*x);
            }
            for (&row, change) in std::iter::zip(&front.front.rows, &column[pivots..]) {
                x[row] += change;
            }
        }
        for (x, pivot) in std::iter::zip(&mut *x, self.plan.pivots(self.factor)) {
            *x /= pivot;
        }
        for front in self.plan.fronts.iter().rev() {
            let pivots = front.pivots();
            column.clear();
            column.resize(pivots, 0.0);
            column.extend(front.front.rows.iter().map(|&row| x[row]));
            column.resize(front.height, 0.0);
            let own = &mut x[front.front.columns.clone()];
            let block = self.factor[front.block()].chunks_exact(front.height);
            for (k, (x, l)) in std::iter::zip(own, block).enumerate().rev() {
                let top = k / LANES * LANES;
                *x -= product(simd, &column[top..], &l[top..]);
                column[k] = *x;
            }
        }
    }
}
