//! A tanh network with a linear last layer, validated on construction.

use crate::features::{FEATURES, Standardisation};
use faer::Mat;
use std::f64::consts::FRAC_1_SQRT_2;
use support::{Fault, fault, refuse};

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
pub struct Layer {
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
    layers: Vec<Layer>,
    /// Layers as evaluated: the standardisation is folded into the first layer.
    pub(crate) affine: Vec<Affine>,
}

/// An affine map between the sums and differences of pairs of units: see [`crate::mlp_kernels`].
#[derive(Clone, Debug)]
pub(crate) struct Affine {
    /// By [`SUM`] and [`DIFFERENCE`] of outputs and inputs; `None` if zero. In a network with mirror
    /// symmetry no sum depends on a difference, and no difference on a sum.
    pub weights: [[Option<Mat<f64>>; 2]; 2],
    /// Number of sums and of differences of the inputs; the features are sums.
    pub inputs: [usize; 2],
    /// Of the sums, then of the differences.
    pub bias: Vec<f64>,
}

/// Positions in [`Affine::weights`].
pub(crate) const SUM: usize = 0;
pub(crate) const DIFFERENCE: usize = 1;

/// Units with their factors.
type Combination = Vec<(usize, f64)>;

/// Sums of units, then differences.
type Combinations = [Vec<Combination>; 2];

impl Network {
    /// Validates every tensor. `name` is the name of the network in errors, `outputs` the required
    /// number of outputs.
    pub(crate) fn new(
        name: &str,
        layers: Vec<Layer>,
        outputs: Option<usize>,
        standardisation: &Standardisation,
    ) -> Result<Self, Fault> {
        if layers.is_empty() {
            return Err(missing(&format!("{name}.0.weight")));
        }
        let mut inputs = standardisation.mean.len();
        for (index, Layer { weight, bias }) in layers.iter().enumerate() {
            let last = index + 1 == layers.len();
            let required = if last { outputs } else { None };
            weight.check(&format!("{name}.{index}.weight"), &[required, Some(inputs)])?;
            let rows = Some(weight.shape[0]);
            bias.check(&format!("{name}.{index}.bias"), &[rows])?;
            inputs = bias.values.len();
        }
        let count = layers.len();
        let affine = (0..count).map(|index| {
            let Layer { weight, bias } = &layers[index];
            let [outputs, inputs] = [weight.shape[0], weight.shape[1]];
            let mut weight = Mat::from_fn(outputs, inputs, |i, j| weight.values[i * inputs + j]);
            let mut bias = bias.values.clone();
            let inputs = if index == 0 {
                fold(standardisation, &mut weight, &mut bias);
                alone(FEATURES)
            } else {
                pairs(inputs, 0.5)
            };
            let outputs = match (index + 1 == count, outputs) {
                (true, 1) => alone(1),
                // The sum of the squares of the outputs is the same.
                (true, _) => pairs(outputs, FRAC_1_SQRT_2),
                (false, _) => pairs(outputs, 0.5),
            };
            Affine::new(&weight, &bias, &inputs, &outputs)
        });
        Ok(Self { affine: affine.collect(), layers })
    }

    /// The layers as in the weight file.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Number of features that the network depends on.
    pub(crate) fn features(&self) -> usize {
        self.layers[0].weight.shape[1]
    }

    pub(crate) fn outputs(&self) -> usize {
        self.affine[self.affine.len() - 1].bias.len()
    }
}

impl Affine {
    fn new(weight: &Mat<f64>, bias: &[f64], inputs: &Combinations, outputs: &Combinations) -> Self {
        let block = |to: &Vec<Combination>, from: &Vec<Combination>| {
            // The sum of a row is exactly the negative of that of its mirror image.
            let of_row = |row, j: usize| -> f64 {
                from[j].iter().map(|(column, factor)| factor * weight[(row, *column)]).sum()
            };
            let all = Mat::from_fn(to.len(), from.len(), |i, j| -> f64 {
                to[i].iter().map(|(row, factor)| factor * of_row(*row, j)).sum()
            });
            let is_zero = all.col_iter().all(|column| column.iter().all(|weight| *weight == 0.0));
            (!is_zero).then_some(all)
        };
        let sum = |combination: &Combination| {
            combination.iter().map(|(unit, factor)| factor * bias[*unit]).sum()
        };
        Self {
            weights: outputs.each_ref().map(|to| inputs.each_ref().map(|from| block(to, from))),
            inputs: inputs.each_ref().map(Vec::len),
            bias: outputs.iter().flatten().map(sum).collect(),
        }
    }

    /// Number of sums and of differences of the outputs.
    pub(crate) fn outputs(&self) -> [usize; 2] {
        let units = self.bias.len();
        [units.div_ceil(2), units / 2]
    }
}

/// Every unit as a sum of its own.
fn alone(units: usize) -> Combinations {
    [(0..units).map(|unit| vec![(unit, 1.0)]).collect(), Vec::new()]
}

/// Sums and differences of units j and n - 1 - j, times a factor; an odd number of units has one
/// more, which is zero.
fn pairs(units: usize, factor: f64) -> Combinations {
    let last = units.next_multiple_of(2) - 1;
    [factor, -factor].map(|second| {
        let pair = |unit| {
            let both = [(unit, factor), (last - unit, second)];
            both.into_iter().filter(|(unit, _)| *unit < units).collect()
        };
        (0..units.div_ceil(2)).map(pair).collect()
    })
}

/// The weights of features that are not standardised, and of all features:
/// W (xi - mean) / std + b = (W / std) xi + (b - (W / std) mean).
fn fold(standardisation: &Standardisation, weight: &mut Mat<f64>, bias: &mut [f64]) {
    for (k, column) in weight.col_iter_mut().enumerate() {
        for (weight, bias) in column.iter_mut().zip(&mut *bias) {
            *weight /= standardisation.std[k];
            *bias -= *weight * standardisation.mean[k];
        }
    }
    let outputs = weight.nrows();
    weight.resize_with(outputs, FEATURES, |_, _| 0.0);
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
            let lengths: Vec<String> = expected
                .iter()
                .map(|length| length.map_or("any".into(), |length| length.to_string()))
                .collect();
            return Err(other_shape(name, &format!("[{}]", lengths.join(", ")), &self.shape));
        }
        finite(name, &self.values)
    }
}
