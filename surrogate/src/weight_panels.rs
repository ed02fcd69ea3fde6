//! Products of a block with the weights of a layer, in registers.
//!
//! ```text
//! y_j = sum over i of W_ij x_i        x_i, y_j: columns of the rows of a block
//! ```
//!
//! A tile, some vectors of rows times the columns of one panel of weights, stays in registers while
//! i runs over the inputs. The weights are stored in the order in which they are read, so that no
//! product has to rearrange them.

use faer::MatRef;
use pulp::{Simd, WithSimd};
use std::iter::zip;

/// Number of columns of a panel.
const COLUMNS: usize = 8;

/// Weights of shape (inputs, outputs) in panels of [`COLUMNS`] outputs.
#[derive(Clone, Debug)]
pub(crate) struct WeightPanels {
    /// Number of columns that the weights are multiplied by.
    pub inputs: usize,
    /// The panels one after the other, each row by row; columns beyond the last output are zero.
    weights: Vec<[f64; COLUMNS]>,
}

impl WeightPanels {
    pub(crate) fn new(weights: MatRef<f64>) -> Self {
        let (inputs, outputs) = weights.shape();
        let at = |i, j| if j < outputs { weights[(i, j)] } else { 0.0 };
        let panel = |first| (0..inputs).map(move |i| std::array::from_fn(|c| at(i, first + c)));
        let weights = (0..outputs).step_by(COLUMNS).flat_map(panel).collect();
        Self { inputs, weights }
    }

    /// Adds the product with `inputs` to `product`. Both have columns of `rows` rows, which fill
    /// vectors.
    pub(crate) fn multiply(&self, inputs: &[f64], rows: usize, product: &mut [f64]) {
        pulp::Arch::new().dispatch(Multiply { weights: self, inputs, rows, product });
    }
}

struct Multiply<'a> {
    weights: &'a WeightPanels,
    inputs: &'a [f64],
    rows: usize,
    product: &'a mut [f64],
}

impl WithSimd for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let mut first = 0;
        while first < self.rows {
            first += match (self.rows - first) / S::F64_LANES {
                // Two registers remain, for a weight and a vector of the inputs.
                3.. if S::REGISTER_COUNT >= 3 * COLUMNS + 2 => self.tiles::<S, 3>(simd, first),
                _ => self.tiles::<S, 1>(simd, first),
            };
        }
    }
}

impl Multiply<'_> {
    /// Computes `VECTORS` vectors of rows, and returns the number of these rows.
    #[inline(always)]
    fn tiles<S: Simd, const VECTORS: usize>(&mut self, simd: S, first: usize) -> usize {
        let rows = first..first + VECTORS * S::F64_LANES;
        let WeightPanels { inputs, weights, .. } = self.weights;
        let panels = weights.chunks_exact(*inputs);
        for (panel, columns) in zip(panels, self.product.chunks_mut(COLUMNS * self.rows)) {
            let mut sums = [[simd.splat_f64s(0.0); VECTORS]; COLUMNS];
            for (weights, column) in zip(panel, self.inputs.chunks_exact(self.rows)) {
                let vectors = S::as_simd_f64s(&column[rows.clone()]).0;
                for (sums, weight) in zip(&mut sums, weights) {
                    let weight = simd.splat_f64s(*weight);
                    for (sum, vector) in zip(sums, vectors) {
                        *sum = simd.mul_add_e_f64s(weight, *vector, *sum);
                    }
                }
            }
            for (sums, column) in zip(&sums, columns.chunks_exact_mut(self.rows)) {
                let vectors = S::as_mut_simd_f64s(&mut column[rows.clone()]).0;
                for (vector, sum) in zip(vectors, sums) {
                    *vector = simd.add_f64s(*vector, *sum);
                }
            }
        }
        rows.len()
    }
}
