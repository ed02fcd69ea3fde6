//! LDL^T of a sparse symmetric matrix without pivoting, by faer: column by column for few unknowns,
//! otherwise by supernodes, dense blocks of columns.

use faer::{
    Conj, Par, Side,
    dyn_stack::{MemBuffer, MemStack, StackReq},
    linalg::cholesky::ldlt::factor::LdltRegularization,
    mat::MatMut,
    sparse::{
        SparseColMatRef, SymbolicSparseColMat,
        linalg::{
            SupernodalThreshold, SymbolicSupernodalParams, amd,
            cholesky::{
                CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw,
                SymmetricOrdering, factorize_symbolic_cholesky, supernodal::SupernodalLdltRef,
            },
        },
    },
};
use std::cell::RefCell;

/// Number of unknowns from which the supernodal factorisation is faster (measured).
const SUPERNODAL_FROM: usize = 400;
/// Maximum fraction of zeros in a supernode that is merged with another, by its number of columns
/// (measured): dense work costs less than its administration.
const ZEROS: [(usize, f64); 3] = [(24, 1.0), (96, 0.3), (usize::MAX, 0.05)];

/// The lower triangle of a sparse symmetric matrix, analysed for its factorisation.
#[derive(Debug)]
pub(crate) struct SparseLdl {
    matrix: SymbolicSparseColMat<usize>,
    cholesky: SymbolicCholesky<usize>,
    /// Size of the workspace of factorisation and solution.
    scratch: StackReq,
}

thread_local! {
    /// Kept between factorisations, since new memory would cost page faults.
    static SCRATCH: RefCell<MemBuffer> = RefCell::new(MemBuffer::new(StackReq::EMPTY));
}

/// The rank of every row and column in an order of elimination with little fill-in (approximate
/// minimum degree).
pub(crate) fn elimination_ranks(matrix: &SymbolicSparseColMat<usize>) -> Vec<usize> {
    let (dimension, entries) = (matrix.ncols(), matrix.row_idx().len());
    let (mut order, mut ranks) = (vec![0; dimension], vec![0; dimension]);
    let scratch = amd::order_scratch::<usize>(dimension, entries);
    amd::order(
        &mut order,
        &mut ranks,
        matrix.as_ref(),
        amd::Control::default(),
        MemStack::new(&mut MemBuffer::new(scratch)),
    )
    .expect("indices fit in usize");
    ranks
}

impl SparseLdl {
    /// The factorisation in the order of the columns.
    pub(crate) fn new(matrix: SymbolicSparseColMat<usize>) -> Self {
        // faer without a given ordering analyses the upper triangle, whichever side is passed.
        let upper = matrix.transpose().to_col_major();
        let cholesky = factorize_symbolic_cholesky(
            upper.expect("indices fit in usize").as_ref(),
            Side::Upper,
            SymmetricOrdering::Identity,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: if matrix.ncols() < SUPERNODAL_FROM {
                    SupernodalThreshold::FORCE_SIMPLICIAL
                } else {
                    SupernodalThreshold::FORCE_SUPERNODAL
                },
                supernodal_params: SymbolicSupernodalParams { relax: Some(&ZEROS) },
                ..Default::default()
            },
        )
        .expect("indices fit in usize and the factor in memory");
        let scratch = StackReq::any_of(&[
            cholesky.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default()),
            cholesky.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]);
        Self { matrix, cholesky, scratch }
    }

    /// Where the columns of the matrix start, and the row of each entry.
    pub(crate) fn entries(&self) -> (&[usize], &[usize]) {
        (self.matrix.col_ptr(), self.matrix.row_idx())
    }

    /// Number of stored entries of L and D.
    fn factor_entries(&self) -> usize {
        self.cholesky.len_val()
    }

    /// Lends this thread's workspace to `work`, which must not request it again.
    fn with_scratch<T>(&self, work: impl FnOnce(&mut MemStack) -> T) -> T {
        SCRATCH.with_borrow_mut(|memory| {
            if !MemStack::new(memory).can_hold(self.scratch) {
                *memory = MemBuffer::new(self.scratch);
            }
            work(MemStack::new(memory))
        })
    }

    /// LDL^T of the matrix with the entries `values`, stored in `factor`; `None` if a pivot
    /// vanishes.
    pub(crate) fn factorise(&self, values: &[f64], factor: &mut Vec<f64>) -> Option<()> {
        factor.resize(self.factor_entries(), 0.0);
        let matrix = SparseColMatRef::new(self.matrix.as_ref(), values);
        let result = self.with_scratch(|stack| {
            self.cholesky.factorize_numeric_ldlt(
                factor,
                matrix,
                Side::Lower,
                LdltRegularization::default(),
                Par::Seq,
                stack,
                Default::default(),
            )
        });
        result.ok().map(drop)
    }

    /// D, in the order of elimination.
    pub(crate) fn pivots(&self, factor: &[f64]) -> Vec<f64> {
        match self.cholesky.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let starts = &symbolic.col_ptr()[..symbolic.ncols()];
                starts.iter().map(|&start| factor[start]).collect()
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let ldlt = SupernodalLdltRef::new(symbolic, factor);
                let blocks = (0..symbolic.n_supernodes()).map(|s| ldlt.supernode(s).val());
                let diagonals =
                    blocks.flat_map(|block| (0..block.ncols()).map(move |j| block[(j, j)]));
                diagonals.collect()
            }
        }
    }

    /// Solves with the factor, in place.
    pub(crate) fn solve(&self, factor: &[f64], x: &mut [f64]) {
        let rows = x.len();
        self.with_scratch(|stack| {
            LdltRef::new(&self.cholesky, factor).solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(x, rows, 1),
                Par::Seq,
                stack,
            );
        });
    }
}
