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

use crate::features::{DEFORMATION_FEATURES, FEATURES};
use crate::network::{DIFFERENCE, Network, SUM};
use crate::tanh::{fuses, tanh};
use crate::weight_panels::WeightPanels;
use pulp::{Simd, WithSimd};
use std::array::from_fn;
use std::cell::RefCell;
use std::iter::{repeat_n, zip};
use std::mem::swap;
use std::ops::Range;

/// Approximate maximum number of rows of a block, which then stays in cache (measured).
const ROWS: usize = 96;

/// Number of hinges that fill the vectors of any processor.
const LANES: usize = 8;

/// Number of hinges per chunk, for `hinges` hinges with `tangents` tangents. All chunks but the last
/// have the same size, which fills whole tiles of three vectors.
pub(crate) fn chunk_size(hinges: usize, tangents: usize) -> usize {
    let chunks = hinges.div_ceil(ROWS / (1 + tangents)).max(1);
    hinges.div_ceil(chunks).next_multiple_of(3 * LANES).max(3 * LANES)
}

/// The hinges, the last one repeated until all vectors are full.
pub(crate) fn filled<T: Clone>(hinges: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut hinges = Vec::from_iter(hinges);
    if let Some(last) = hinges.last().cloned() {
        hinges.resize(hinges.len().next_multiple_of(LANES), last);
    }
    hinges
}

/// The buffers of the passes, reused from chunk to chunk.
#[derive(Default)]
pub(crate) struct Passes {
    /// Number of hinges in the chunk.
    n: usize,
    /// The features for which tangents are propagated forwards.
    tangents: Range<usize>,
    /// The block of the features (13).
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
    /// The weights in [`add_products`].
    weights: Vec<f64>,
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

    /// Computes the outputs and their derivatives in the features `tangents`, for a chunk of hinges
    /// that is [`filled`].
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
            for tangent in self.tangents.clone() {
                self.inputs.extend(repeat_n(f64::from(tangent == k), self.n));
            }
        }
        let (rows, layers) = (self.rows(), &network.affine);
        let last = layers.len() - 1;
        self.hidden.resize_with(last, Vec::new);
        multiply(&layers[0].forward, &self.inputs, rows, layers[0].outputs(), &mut self.output);
        for (block, pair) in zip(&mut self.hidden, layers.windows(2)) {
            swap(&mut self.output, block);
            self.activation.resize(block.len(), 0.0);
            let (n, bias, activation) = (self.n, &*pair[0].bias, &mut *self.activation);
            pulp::Arch::new().dispatch(Activate { n, rows, bias, block, activation });
            let (weights, units) = (&pair[1].forward, pair[1].outputs());
            multiply(weights, &self.activation, rows, units, &mut self.output);
        }
        for (column, bias) in self.output.chunks_exact_mut(rows).zip(&layers[last].bias) {
            for value in &mut column[..self.n] {
                *value += bias;
            }
        }
    }

    /// Computes the gradient in the features of a function of the outputs, given its gradient
    /// `seed` in the outputs (one column per output). Adds the contribution of the network's
    /// curvature to its Hessian to `curvature`, in the order of [`AddProducts`].
    pub(crate) fn reverse(&mut self, network: &Network, seed: &[f64], curvature: &mut [f64]) {
        let (n, rows) = (self.n, self.rows());
        self.adjoint.clear();
        self.adjoint.extend_from_slice(seed);
        for (affine, block) in network.affine[1..].iter().zip(&self.hidden).rev() {
            multiply(&affine.backward, &self.adjoint, n, affine.inputs, &mut self.lambda);
            self.weights.resize(self.lambda.len(), 0.0);
            let (lambda, weights) = (&mut *self.lambda, &mut *self.weights);
            pulp::Arch::new().dispatch(Deactivate { n, rows, block, lambda, weights });
            add_products(n, self.tangents.len(), block, weights, curvature);
            swap(&mut self.adjoint, &mut self.lambda);
        }
        let first = &network.affine[0];
        multiply(&first.backward, &self.adjoint, n, first.inputs, &mut self.gradient);
    }

    /// Adds J'J to `products`, where J is the derivative of the outputs in the features of the
    /// tangents; see [`AddProducts`].
    pub(crate) fn add_gauss_newton(&mut self, products: &mut [f64]) {
        self.weights.clear();
        self.weights.resize(self.n, 1.0);
        add_products(self.n, self.tangents.len(), &self.output, &self.weights, products);
    }

    /// Values and tangents of each output: n values, then n derivatives for each tangent.
    pub(crate) fn outputs(&self) -> impl Iterator<Item = &[f64]> {
        self.output.chunks_exact(self.rows())
    }

    /// [`Passes::outputs`], which the next Gauss-Newton products are of.
    pub(crate) fn outputs_mut(&mut self) -> impl Iterator<Item = &mut [f64]> {
        let rows = self.rows();
        self.output.chunks_exact_mut(rows)
    }

    /// The gradient that [`Passes::reverse`] computed for one hinge of the chunk.
    pub(crate) fn gradient(&self, hinge: usize) -> [f64; FEATURES] {
        from_fn(|k| self.gradient[k * self.n + hinge])
    }

    fn rows(&self) -> usize {
        self.n * (1 + self.tangents.len())
    }
}

/// Multiplies sums and differences by weights, whose units are the sums and differences of `units`
/// in the product.
fn multiply(
    weights: &[[Option<WeightPanels>; 2]; 2],
    inputs: &[f64],
    rows: usize,
    units: [usize; 2],
    product: &mut Vec<f64>,
) {
    product.clear();
    product.resize(rows * (units[SUM] + units[DIFFERENCE]), 0.0);
    let (sums, differences) = product.split_at_mut(rows * units[SUM]);
    for (to, product) in [(SUM, sums), (DIFFERENCE, differences)] {
        for from in [SUM, DIFFERENCE] {
            let Some(weights) = &weights[to][from] else { continue };
            let len = rows * weights.inputs;
            let inputs = if from == SUM { &inputs[..len] } else { &inputs[inputs.len() - len..] };
            weights.multiply(inputs, rows, product);
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
        let (n, fused) = (self.n, fuses::<S>());
        let units = zip(pairs(self.block, self.rows), pairs(self.activation, self.rows));
        let (sums, differences) = self.bias.split_at(self.bias.len() / 2);
        for ((block, activation), (even_bias, odd_bias)) in zip(units, zip(sums, differences)) {
            let [(h, tangents), (g, opposite)] = block.map(|column| column.split_at_mut(n));
            let [(sum, sums), (difference, differences)] =
                activation.map(|column| column.split_at_mut(n));
            for i in 0..n {
                let (even, odd) = (h[i] + even_bias, g[i] + odd_bias);
                (h[i], g[i]) = (tanh(even + odd, fused), tanh(even - odd, fused));
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
/// differences of df/da, with sigma' = 1 - h^2 and sigma'' = -2 h sigma', and writes lambda sigma''
/// to `weights`.
struct Deactivate<'a> {
    n: usize,
    rows: usize,
    block: &'a [f64],
    lambda: &'a mut [f64],
    weights: &'a mut [f64],
}

impl WithSimd for Deactivate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.n;
        let (firsts, seconds) = self.block.split_at(self.block.len() / 2);
        let columns = zip(firsts.chunks_exact(self.rows), seconds.chunks_exact(self.rows));
        let weights = pairs(self.weights, n);
        for ([sum, difference], ((h, g), [of_h, of_g])) in
            zip(pairs(self.lambda, n), zip(columns, weights))
        {
            // Loops over few slices, which the compiler vectorises.
            for i in 0..n {
                let (even, odd) = (sum[i], difference[i]);
                sum[i] = (1.0 - h[i] * h[i]) * (even + odd);
                difference[i] = (1.0 - g[i] * g[i]) * (even - odd);
            }
            for (weights, h, lambda) in [(of_h, h, &*sum), (of_g, g, &*difference)] {
                for i in 0..n {
                    weights[i] = -2.0 * h[i] * lambda[i];
                }
            }
            for i in 0..n {
                (sum[i], difference[i]) = (sum[i] + difference[i], sum[i] - difference[i]);
            }
        }
    }
}

/// Adds weight T_i T_j to `products` for the `T` tangents of the units in `block`. The weights are
/// one run for each unit, or one for all.
///
/// `products` contains one run of n values for each i of a deformation feature and each j; runs of
/// j < i are left out.
struct AddProducts<'a, const T: usize> {
    n: usize,
    block: &'a [f64],
    weights: &'a [f64],
    products: &'a mut [f64],
}

impl<const T: usize> WithSimd for AddProducts<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.n;
        for hinge in (0..n).step_by(S::F64_LANES) {
            let run = |values: &[f64], k: usize| S::as_simd_f64s(&values[k * n + hinge..]).0[0];
            let mut sums = [[simd.splat_f64s(0.0); T]; DEFORMATION_FEATURES];
            let weights = self.weights.chunks_exact(n).cycle();
            for (column, weights) in zip(self.block.chunks_exact(n * (1 + T)), weights) {
                let tangents: [_; T] = from_fn(|k| run(column, 1 + k));
                for i in 0..DEFORMATION_FEATURES {
                    let weighted = simd.mul_f64s(run(weights, 0), tangents[i]);
                    for j in i..T {
                        sums[i][j] = simd.mul_add_e_f64s(weighted, tangents[j], sums[i][j]);
                    }
                }
            }
            for (sum, run) in zip(sums.as_flattened(), self.products.chunks_exact_mut(n)) {
                let run = &mut S::as_mut_simd_f64s(&mut run[hinge..]).0[0];
                *run = simd.add_f64s(*run, *sum);
            }
        }
    }
}

/// See [`AddProducts`]; without tangents there are none.
fn add_products(n: usize, tangents: usize, block: &[f64], weights: &[f64], products: &mut [f64]) {
    let arch = pulp::Arch::new();
    match tangents {
        FEATURES => arch.dispatch(AddProducts::<FEATURES> { n, block, weights, products }),
        DEFORMATION_FEATURES => {
            arch.dispatch(AddProducts::<DEFORMATION_FEATURES> { n, block, weights, products });
        }
        _ => {}
    }
}
