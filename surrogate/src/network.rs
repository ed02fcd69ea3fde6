//! A tanh network with a linear last layer, validated on construction.

use crate::features::{FEATURES, Standardisation};
use faer::Mat;
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

/// An affine map in a form for matrix products.
#[derive(Clone, Debug)]
pub(crate) struct Affine {
    /// (outputs, inputs)
    pub weight: Mat<f64>,
    pub bias: Vec<f64>,
}

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
        let mut affine: Vec<Affine> = layers.iter().map(Affine::new).collect();
        affine[0].fold(standardisation);
        affine[0].widen();
        Ok(Self { layers, affine })
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
    fn new(layer: &Layer) -> Self {
        let (outputs, inputs) = (layer.bias.values.len(), layer.weight.shape[1]);
        Self {
            weight: Mat::from_fn(outputs, inputs, |i, j| layer.weight.values[i * inputs + j]),
            bias: layer.bias.values.clone(),
        }
    }

    /// W (xi - mean) / std + b = (W / std) xi + (b - (W / std) mean)
    fn fold(&mut self, standardisation: &Standardisation) {
        for (k, column) in self.weight.col_iter_mut().enumerate() {
            for (weight, bias) in column.iter_mut().zip(&mut self.bias) {
                *weight /= standardisation.std[k];
                *bias -= *weight * standardisation.mean[k];
            }
        }
    }

    /// Adds the features that the layer does not depend on.
    fn widen(&mut self) {
        let outputs = self.weight.nrows();
        self.weight.resize_with(outputs, FEATURES, |_, _| 0.0);
    }
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
