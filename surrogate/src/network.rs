//! A tanh network with a linear last layer, validated on construction.

use crate::features::{FEATURES, Standardisation};
use crate::weight_panels::WeightPanels;
use faer::{Mat, MatRef};
use std::array::from_fn;
use std::f64::consts::FRAC_1_SQRT_2;
use support::{Fault, Joined, fault, refuse};

/// An array of a weight file, in row-major order.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    /// Length of each dimension.
    pub shape: Vec<usize>,
    /// The values, as many as the product of `shape`.
    pub values: Vec<f64>,
}

/// One affine map y = weight x + bias; `weight` is (outputs, inputs), `bias` (outputs).
#[derive(Clone, Debug, PartialEq)]
pub struct DenseLayer {
    /// The matrix, of shape (outputs, inputs).
    pub weight: Tensor,
    /// The constant term, of shape (outputs).
    pub bias: Tensor,
}

/// y = W_L tanh(... tanh(W_0 x + b_0) ...) + b_L, whose input x is the features (13), not
/// standardised.
#[derive(Clone, Debug)]
pub struct Network {
    /// Layers as in the weight file: the input of the first layer is standardised.
    layers: Vec<DenseLayer>,
    /// Layers as evaluated: the standardisation is folded into the first layer.
    pub(crate) affine: Vec<PairedAffine>,
}

/// An affine map between the sums and differences of pairs of units: see [`crate::mlp_kernels`].
#[derive(Clone, Debug)]
pub(crate) struct PairedAffine {
    /// Weights by [`SUM`] and [`DIFFERENCE`] of outputs and inputs; `None` if zero. In a network with
    /// mirror symmetry no sum depends on a difference, and no difference on a sum.
    pub forward: [[Option<WeightPanels>; 2]; 2],
    /// The transposed weights, by sums and differences of inputs and outputs.
    pub backward: [[Option<WeightPanels>; 2]; 2],
    /// Number of sums and of differences of the inputs; the features are sums.
    pub inputs: [usize; 2],
    /// The biases of the sums, then of the differences.
    pub bias: Vec<f64>,
}

/// Positions in [`PairedAffine::forward`].
pub(crate) const SUM: usize = 0;
pub(crate) const DIFFERENCE: usize = 1;

impl Network {
    /// Validates every tensor. `name` is the name of the network in errors, `outputs` the required
    /// number of outputs.
    pub(crate) fn new(
        name: &str,
        layers: Vec<DenseLayer>,
        outputs: Option<usize>,
        standardisation: &Standardisation,
    ) -> Result<Self, Fault> {
        if layers.is_empty() {
            return Err(missing(&format!("{name}.0.weight")));
        }
        let mut inputs = standardisation.mean.len();
        for (index, DenseLayer { weight, bias }) in layers.iter().enumerate() {
            let last = index + 1 == layers.len();
            let required = if last { outputs } else { None };
            weight.check(&format!("{name}.{index}.weight"), &[required, Some(inputs)])?;
            let rows = Some(weight.shape[0]);
            bias.check(&format!("{name}.{index}.bias"), &[rows])?;
            inputs = bias.values.len();
        }
        let last = layers.len() - 1;
        let affine = |(index, layer): (usize, &DenseLayer)| {
            let standardisation = (index == 0).then_some(standardisation);
            PairedAffine::new(layer, standardisation, index == last)
        };
        Ok(Self { affine: layers.iter().enumerate().map(affine).collect(), layers })
    }

    /// The layers as in the weight file.
    pub fn layers(&self) -> &[DenseLayer] {
        &self.layers
    }

    pub(crate) fn outputs(&self) -> usize {
        self.affine[self.affine.len() - 1].bias.len()
    }
}

impl PairedAffine {
    /// A layer of a network; the first one has the standardisation of its inputs.
    fn new(layer: &DenseLayer, first: Option<&Standardisation>, is_last: bool) -> Self {
        let (outputs, inputs) = (layer.bias.values.len(), layer.weight.shape[1]);
        let mut weight = Mat::from_fn(outputs, inputs, |i, j| layer.weight.values[i * inputs + j]);
        let mut bias = Mat::from_fn(outputs, 1, |i, _| layer.bias.values[i]);
        if let Some(standardisation) = first {
            // W (xi - mean) / std + b = (W / std) xi + (b - (W / std) mean)
            for (k, mut column) in weight.col_iter_mut().enumerate() {
                column /= standardisation.std[k];
                let mut bias = bias.as_mut().col_mut(0);
                bias -= standardisation.mean[k] * &column;
            }
            // Features on which the layer does not depend.
            weight.resize_with(outputs, FEATURES, |_, _| 0.0);
        }
        let of_outputs = |rows: Mat<f64>| match (is_last, outputs) {
            (true, 1) => alone(rows),
            // The sum of the squares of the outputs is the same.
            (true, _) => in_pairs(rows, FRAC_1_SQRT_2),
            (false, _) => in_pairs(rows, 0.5),
        };
        let of_inputs = |rows: Mat<f64>| {
            let columns = rows.transpose().to_owned();
            let pairs = if first.is_some() { alone(columns) } else { in_pairs(columns, 0.5) };
            pairs.map(|columns| columns.transpose().to_owned())
        };
        let weights = of_outputs(weight).map(of_inputs);
        let panels = |weights: MatRef<f64>| {
            let is_zero = weights.col_iter().all(|column| column.norm_max() == 0.0);
            (!is_zero).then(|| WeightPanels::new(weights))
        };
        Self {
            inputs: weights[SUM].each_ref().map(Mat::ncols),
            forward: from_fn(|to| from_fn(|from| panels(weights[to][from].transpose()))),
            backward: from_fn(|to| from_fn(|from| panels(weights[from][to].as_ref()))),
            bias: of_outputs(bias).iter().flat_map(|part| part.col(0).iter().copied()).collect(),
        }
    }

    /// Number of sums and of differences of the outputs.
    pub(crate) fn outputs(&self) -> [usize; 2] {
        let units = self.bias.len();
        [units.div_ceil(2), units / 2]
    }
}

/// Every row as a sum of its own.
fn alone(rows: Mat<f64>) -> [Mat<f64>; 2] {
    let none = Mat::zeros(0, rows.ncols());
    [rows, none]
}

/// Sums and differences of rows j and n - 1 - j, times a factor; an odd number of rows has one more,
/// which is zero.
fn in_pairs(rows: Mat<f64>, factor: f64) -> [Mat<f64>; 2] {
    let half = rows.nrows().div_ceil(2);
    let at = |i, j| if i < rows.nrows() { rows[(i, j)] } else { 0.0 };
    [1.0, -1.0].map(|sign| {
        let pair = |i, j| factor * (at(i, j) + sign * at(2 * half - 1 - i, j));
        Mat::from_fn(half, rows.ncols(), pair)
    })
}

pub(crate) fn missing(tensor: &str) -> Fault {
    fault!("tensor `{tensor}` is missing; train or export the weights again")
}

pub(crate) fn other_shape(tensor: &str, expected: &str, found: &[usize]) -> Fault {
    fault!("tensor `{tensor}` has the shape {found:?}, expected {expected}")
}

/// Rejects a value that is not finite.
pub(crate) fn finite(tensor: &str, values: &[f64]) -> Result<(), Fault> {
    let Some(index) = values.iter().position(|value| !value.is_finite()) else {
        return Ok(());
    };
    refuse!(
        "tensor `{tensor}` contains {} at index {index}; every weight must be finite",
        values[index]
    )
}

impl Tensor {
    /// Checks that the shape is `expected` (`None`: any positive length) and that every value is
    /// finite.
    fn check(&self, name: &str, expected: &[Option<usize>]) -> Result<(), Fault> {
        let matches = self.shape.len() == expected.len()
            && self
                .shape
                .iter()
                .zip(expected)
                .all(|(&found, expected)| expected.map_or(found > 0, |length| found == length))
            && self.values.len() == self.shape.iter().product::<usize>();
        if !matches {
            let lengths = expected
                .iter()
                .map(|length| length.map_or("any".into(), |length| length.to_string()))
                .joined(", ");
            return Err(other_shape(name, &format!("[{lengths}]"), &self.shape));
        }
        finite(name, &self.values)
    }
}
