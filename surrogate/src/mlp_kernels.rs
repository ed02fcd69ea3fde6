//! Batched passes through a network by matrix products: values, tangents, reverse pass.
//!
//! A *block* has one column per unit of a layer. It contains the values for a chunk of hinges and,
//! below them, their derivatives in some of the features (13):
//!
//! ```text
//! rows 0..n          a          pre-activation of each hinge        a_l = h_{l-1} W_l' + b_l
//! rows n..2n, ...    da/dxi_k   one row block for each tangent k    T_l = (sigma'(a_{l-1}) T_{l-1}) W_l'
//! ```
//!
//! The products are between pairs of units, j and n - 1 - j, which are mirror images in networks
//! with mirror symmetry: with the sums p and the differences q of the inputs of a layer, and the
//! half sums e and half differences o of its outputs,
//!
//! ```text
//! e = E p,   o = O q,       a_j = e_j + o_j,   a_{n-1-j} = e_j - o_j
//! ```
//!
//! takes half of the operations of a = W h. Columns are in this order: all sums or first units of
//! pairs, then all differences or second units. Other networks need two more products.
//!
//! One sweep over the layers computes the values and all tangents. For a function f of the
//! outputs with gradient `seed`, the reverse pass gives lambda = df/dh of every hidden unit, the
//! gradient of f in all features, and the contribution of the network's curvature to the Hessian of
//! f,
//!
//! ```text
//! sum over layers and units of  lambda sigma''(a) (da/dxi_i) (da/dxi_j)
//! ```

use crate::features::FEATURES;
use crate::network::{DIFFERENCE, Network, PairedAffine, SUM};
use crate::tanh::tanh;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use pulp::{Simd, WithSimd};
use std::cell::RefCell;
use std::iter::zip;
use std::ops::Range;

/// Approximate maximum number of rows of a block. It is large enough that the packing of the
/// weights for each product costs little, and small enough that the block stays in cache.
const ROWS: usize = 320;

/// Number of hinges per chunk, for `hinges` hinges with `tangents` tangents. All chunks have the
/// same size, which is a multiple of the vector length.
pub(crate) fn chunk_size(hinges: usize, tangents: usize) -> usize {
    let chunks = hinges.div_ceil(ROWS / (1 + tangents)).max(1);
    hinges.div_ceil(chunks).next_multiple_of(8).max(8)
}

/// The buffers of the passes, reused from chunk to chunk.
#[derive(Default)]
pub(crate) struct Passes {
    /// Number of hinges in the chunk.
    n: usize,
    /// The features for which tangents are propagated forwards.
    tangents: Range<usize>,
    /// The features (13), one column per feature.
    inputs: Vec<f64>,
    /// A block for each hidden layer, with tanh(a) instead of a.
    hidden: Vec<Vec<f64>>,
    /// The block [tanh(a), sigma'(a) T] of the layer evaluated last.
    activation: Vec<f64>,
    /// The block of the outputs.
    output: Vec<f64>,
    /// df/da of the layer evaluated last in the reverse pass, one column per unit.
    adjoint: Vec<f64>,
    /// df/dh of the preceding layer.
    lambda: Vec<f64>,
    /// The weight of each hinge in [`accumulate_products`].
    weight: Vec<f64>,
    /// df/dxi, one column per feature.
    gradient: Vec<f64>,
}

thread_local! {
    /// Several megabytes of buffers. They are reused, because a solver with repeated evaluations
    /// would otherwise spend a large part of its time in page faults.
    static PASSES: RefCell<Passes> = RefCell::default();
}

impl Passes {
    /// Lends the buffers of this thread to `work`, which must not call this function again.
    pub(crate) fn lent<T>(work: impl FnOnce(&mut Self) -> T) -> T {
        PASSES.with_borrow_mut(work)
    }

    /// Computes the outputs and their derivatives in the features `tangents`, for a chunk of
    /// hinges.
    pub(crate) fn forward(
        &mut self,
        network: &Network,
        features: &[[f64; FEATURES]],
        tangents: Range<usize>,
    ) {
        self.n = features.len();
        self.tangents = tangents;
        self.inputs.clear();
        for k in 0..FEATURES {
            self.inputs.extend(features.iter().map(|xi| xi[k]));
        }
        let [first, following @ ..] = network.affine.as_slice() else {
            unreachable!("a network has at least one layer");
        };
        self.hidden.resize_with(following.len(), Vec::new);
        self.enter(first);
        for (index, affine) in following.iter().enumerate() {
            std::mem::swap(&mut self.output, &mut self.hidden[index]);
            let rows = self.rows();
            let block = &mut self.hidden[index];
            self.activation.resize(block.len(), 0.0);
            pulp::Arch::new().dispatch(Activate {
                n: self.n,
                rows,
                bias: &network.affine[index].bias,
                block,
                activation: &mut self.activation,
            });
            multiply(affine, &self.activation, rows, &mut self.output);
        }
        let rows = self.rows();
        let last = &network.affine[following.len()];
        for (column, bias) in self.output.chunks_exact_mut(rows).zip(&last.bias) {
            for value in &mut column[..self.n] {
                *value += bias;
            }
        }
    }

    /// Evaluates the first layer without its bias; its tangents are the columns of its weight.
    fn enter(&mut self, first: &PairedAffine) {
        let (n, rows) = (self.n, self.rows());
        multiply(first, &self.inputs, n, &mut self.adjoint);
        self.output.resize(rows * first.bias.len(), 0.0);
        let of_features = first.weights.iter().zip(first.outputs());
        let units = of_features.flat_map(|([weight, _], units)| {
            (0..units).map(move |unit| weight.as_ref().map(|weight| weight.row(unit)))
        });
        let columns = self.output.chunks_exact_mut(rows).zip(self.adjoint.chunks_exact(n));
        for ((column, values), by_feature) in columns.zip(units) {
            let (into, tangents) = column.split_at_mut(n);
            into.copy_from_slice(values);
            for (k, tangent) in self.tangents.clone().zip(tangents.chunks_exact_mut(n)) {
                tangent.fill(by_feature.map_or(0.0, |by_feature| by_feature[k]));
            }
        }
    }

    /// Computes the gradient in the features of a function of the outputs, given its gradient
    /// `seed` in the outputs (one column per output). Adds the contribution of the network's
    /// curvature to its Hessian to `curvature`, packed as in [`accumulate_products`].
    pub(crate) fn reverse(&mut self, network: &Network, seed: &[f64], curvature: &mut [f64]) {
        let (n, rows) = (self.n, self.rows());
        self.weight.resize(n, 0.0);
        self.adjoint.clear();
        self.adjoint.extend_from_slice(seed);
        for (affine, block) in network.affine[1..].iter().zip(&self.hidden).rev() {
            multiply_transposed(affine, &self.adjoint, n, &mut self.lambda);
            pulp::Arch::new().dispatch(Deactivate {
                rows,
                block,
                lambda: &mut self.lambda,
                weight: &mut self.weight,
                curvature,
            });
            std::mem::swap(&mut self.adjoint, &mut self.lambda);
        }
        multiply_transposed(&network.affine[0], &self.adjoint, n, &mut self.gradient);
    }

    /// Adds J'J to `packed`, where J is the derivative of the outputs in the features of the
    /// tangents.
    pub(crate) fn add_gauss_newton(&mut self, packed: &mut [f64]) {
        let rows = self.rows();
        self.weight.clear();
        self.weight.resize(self.n, 1.0);
        pulp::Arch::new().dispatch(GaussNewton {
            rows,
            block: &self.output,
            ones: &self.weight,
            packed,
        });
    }

    /// Values and tangents of each output: n values, then n derivatives for each tangent.
    pub(crate) fn outputs(&self) -> impl Iterator<Item = &[f64]> {
        self.output.chunks_exact(self.rows())
    }

    /// The gradient that [`Passes::reverse`] computed for one hinge of the chunk.
    pub(crate) fn gradient(&self, hinge: usize) -> [f64; FEATURES] {
        std::array::from_fn(|k| self.gradient[k * self.n + hinge])
    }

    fn rows(&self) -> usize {
        self.n * (1 + self.tangents.len())
    }
}

/// Multiplies `inputs` by the weights of a layer.
fn multiply(affine: &PairedAffine, inputs: &[f64], rows: usize, product: &mut Vec<f64>) {
    let weight = |to: usize, from: usize| affine.weights[to][from].as_ref().map(Mat::transpose);
    multiply_pairs(weight, inputs, rows, affine.outputs(), product);
}

/// Multiplies `adjoint` by the transposed weights of a layer, which gives df/dh of the units of the
/// preceding layer.
fn multiply_transposed(
    affine: &PairedAffine,
    adjoint: &[f64],
    rows: usize,
    product: &mut Vec<f64>,
) {
    let weight = |to: usize, from: usize| affine.weights[from][to].as_ref().map(Mat::as_ref);
    multiply_pairs(weight, adjoint, rows, affine.inputs, product);
}

/// Multiplies sums and differences by weights of shape (inputs, outputs).
fn multiply_pairs<'a>(
    weight: impl Fn(usize, usize) -> Option<MatRef<'a, f64>>,
    inputs: &[f64],
    rows: usize,
    outputs: [usize; 2],
    product: &mut Vec<f64>,
) {
    product.resize(rows * (outputs[SUM] + outputs[DIFFERENCE]), 0.0);
    let (sums, differences) = product.split_at_mut(rows * outputs[SUM]);
    for (to, product) in [(SUM, sums), (DIFFERENCE, differences)] {
        let mut accum = Accum::Replace;
        for from in [SUM, DIFFERENCE] {
            let Some(weight) = weight(to, from) else { continue };
            let len = rows * weight.nrows();
            let inputs = if from == SUM { &inputs[..len] } else { &inputs[inputs.len() - len..] };
            matmul(
                MatMut::from_column_major_slice_mut(product, rows, weight.ncols()),
                accum,
                MatRef::from_column_major_slice(inputs, rows, weight.nrows()),
                weight,
                1.0,
                Par::Seq,
            );
            accum = Accum::Add;
        }
        if accum == Accum::Replace {
            product.fill(0.0);
        }
    }
}

/// Adds the bias to the pre-activations in `block`, whose sums and differences it replaces by
/// [tanh(a), T] of the units, and writes the sums and differences of [tanh(a), sigma'(a) T] to
/// `activation`.
struct Activate<'a> {
    n: usize,
    rows: usize,
    bias: &'a [f64],
    block: &'a mut [f64],
    activation: &'a mut [f64],
}

impl WithSimd for Activate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.n;
        let units = zip(pairs(self.block, self.rows), pairs(self.activation, self.rows));
        let (sums, differences) = self.bias.split_at(self.bias.len() / 2);
        for ((block, activation), (even_bias, odd_bias)) in zip(units, zip(sums, differences)) {
            let [(h, tangents), (g, opposite)] = block.map(|column| column.split_at_mut(n));
            let [(sum, sums), (difference, differences)] =
                activation.map(|column| column.split_at_mut(n));
            for i in 0..n {
                let (even, odd) = (h[i] + even_bias, g[i] + odd_bias);
                (h[i], g[i]) = (tanh(even + odd), tanh(even - odd));
                (sum[i], difference[i]) = (h[i] + g[i], h[i] - g[i]);
            }
            let tangents = zip(tangents.chunks_exact_mut(n), opposite.chunks_exact_mut(n));
            let pushed = zip(sums.chunks_exact_mut(n), differences.chunks_exact_mut(n));
            for ((t, u), (sum, difference)) in zip(tangents, pushed) {
                for i in 0..n {
                    (t[i], u[i]) = (t[i] + u[i], t[i] - u[i]);
                    let [one, other] = [(h[i], t[i]), (g[i], u[i])].map(|(h, t)| (1.0 - h * h) * t);
                    (sum[i], difference[i]) = (one + other, one - other);
                }
            }
        }
    }
}

/// The columns of pairs of units in a block with `rows` rows.
#[inline(always)]
fn pairs(block: &mut [f64], rows: usize) -> impl Iterator<Item = [&mut [f64]; 2]> {
    let (firsts, seconds) = block.split_at_mut(block.len() / 2);
    zip(firsts.chunks_exact_mut(rows), seconds.chunks_exact_mut(rows)).map(<[_; 2]>::from)
}

/// Replaces the sums and differences in `lambda`, of which df/dh is made, by the sums and
/// differences of df/da, with sigma' = 1 - h^2 and sigma'' = -2 h sigma', and adds lambda sigma''
/// T_i T_j to `curvature`; `weight` is a buffer for lambda sigma'' of one unit.
struct Deactivate<'a> {
    rows: usize,
    block: &'a [f64],
    lambda: &'a mut [f64],
    weight: &'a mut [f64],
    curvature: &'a mut [f64],
}

impl WithSimd for Deactivate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.weight.len();
        let (firsts, seconds) = self.block.split_at(self.block.len() / 2);
        let columns = zip(firsts.chunks_exact(self.rows), seconds.chunks_exact(self.rows));
        for ([sum, difference], columns) in zip(pairs(self.lambda, n), columns) {
            let [(h, tangents), (g, opposite)] =
                <[_; 2]>::from(columns).map(|column| column.split_at(n));
            for i in 0..n {
                let (even, odd) = (sum[i], difference[i]);
                sum[i] = (1.0 - h[i] * h[i]) * (even + odd);
                difference[i] = (1.0 - g[i] * g[i]) * (even - odd);
            }
            for (h, lambda, tangents) in [(h, &*sum, tangents), (g, &*difference, opposite)] {
                for i in 0..n {
                    self.weight[i] = -2.0 * h[i] * lambda[i];
                }
                accumulate_products(self.weight, tangents, self.curvature);
            }
            for i in 0..n {
                (sum[i], difference[i]) = (sum[i] + difference[i], sum[i] - difference[i]);
            }
        }
    }
}

/// See [`Passes::add_gauss_newton`].
struct GaussNewton<'a> {
    rows: usize,
    block: &'a [f64],
    ones: &'a [f64],
    packed: &'a mut [f64],
}

impl WithSimd for GaussNewton<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for column in self.block.chunks_exact(self.rows) {
            accumulate_products(self.ones, &column[self.ones.len()..], self.packed);
        }
    }
}

/// Adds weight T_i T_j to `packed` for every pair i <= j of the row blocks of `tangents`.
///
/// `packed` contains one run of n values for each pair, in the order (0, 0), (0, 1), ..., (1, 1),
/// ...; see [`packed_index`].
#[inline(always)]
fn accumulate_products(weight: &[f64], tangents: &[f64], packed: &mut [f64]) {
    let n = weight.len();
    let mut runs = packed.chunks_exact_mut(n);
    for (i, left) in tangents.chunks_exact(n).enumerate() {
        for (right, run) in tangents.chunks_exact(n).skip(i).zip(&mut runs) {
            for (((run, weight), left), right) in run.iter_mut().zip(weight).zip(left).zip(right) {
                *run += weight * left * right;
            }
        }
    }
}

/// Number of pairs i <= j < `tangents`.
pub(crate) fn packed_len(tangents: usize) -> usize {
    tangents * (tangents + 1) / 2
}

/// Position of the pair (i, j) in the order of [`accumulate_products`].
pub(crate) fn packed_index(i: usize, j: usize, tangents: usize) -> usize {
    let (i, j) = (i.min(j), i.max(j));
    i * tangents - packed_len(i) + j
}
