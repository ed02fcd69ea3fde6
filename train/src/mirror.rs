//! Mirror symmetry by construction, instead of learned from mirror images.
//!
//! W(a, s, theta; alpha) = W(a, -s, theta; pi - alpha) is W(x) = W(S x) in standardised features,
//! with S = diag(1, -1, 1, 1, -1, 1) if the means of eta_s and alpha are 0 and pi / 2. The units of
//! each layer form pairs (j, n - 1 - j). One unit of a pair has the value of the other unit at the
//! mirror image:
//!
//! ```text
//! h_{n-1-j}(x) = h_j(S x)      if  W_0 = [A, S A R],  W_l = [A, R A R],  b_l = [b, R b]
//! ```
//!
//! with R the reversal of order. Only the halves A and b are trained. |chi - chi_0|^2 is invariant
//! because it is symmetric in the units of a pair; the output of a damage head is invariant with
//! W_L = [B; R B].

use crate::affine::Affine;
use burn::tensor::{Tensor, TensorData};
use std::f64::consts::FRAC_PI_2;
use surrogate::Standardisation;

/// The diagonal of S. Only weights for several radii have the last feature, the radius of the hole.
const SIGNS: [f64; 6] = [1.0, -1.0, 1.0, 1.0, -1.0, 1.0];

/// Positions of the features that change their sign.
const ETA_S: usize = 1;
const ALPHA: usize = 4;

/// How a layer is determined by its trained part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fold {
    /// The inputs are features; half of the columns are trained.
    First,
    /// The inputs and outputs are pairs; half of the columns are trained.
    Hidden,
    /// The inputs are pairs, the outputs are invariant; half of the rows are trained.
    Invariant,
}

impl Fold {
    /// (inputs, outputs) of the trained part of a layer of this shape.
    pub(crate) fn shape(self, [inputs, outputs]: [usize; 2]) -> [usize; 2] {
        match self {
            Self::First | Self::Hidden => [inputs, outputs / 2],
            Self::Invariant => [inputs / 2, outputs],
        }
    }

    /// The whole layer with the trained part `part`.
    pub(crate) fn unfold(self, part: Affine) -> Affine {
        let Affine { weight, bias } = part;
        let paired = |bias: Tensor<1>| Tensor::cat(vec![bias.clone(), bias.flip([0])], 0);
        match self {
            Self::First => {
                let options = (&weight.device(), weight.dtype());
                let [features, _] = weight.dims();
                let signs = TensorData::new(SIGNS[..features].to_vec(), [features, 1]);
                let signs: Tensor<2> = Tensor::from_data(signs, options);
                let images = (weight.clone() * signs).flip([1]);
                Affine { weight: Tensor::cat(vec![weight, images], 1), bias: paired(bias) }
            }
            Self::Hidden => Affine {
                weight: Tensor::cat(vec![weight.clone(), weight.flip([0, 1])], 1),
                bias: paired(bias),
            },
            Self::Invariant => {
                Affine { weight: Tensor::cat(vec![weight.clone(), weight.flip([0])], 0), bias }
            }
        }
    }

    /// The trained part of a whole layer.
    pub(crate) fn fold(self, whole: Affine) -> Affine {
        let Affine { weight, bias } = whole;
        let [inputs, outputs] = self.shape(weight.dims());
        Affine {
            weight: weight.narrow(0, 0, inputs).narrow(1, 0, outputs),
            bias: bias.narrow(0, 0, outputs),
        }
    }
}

/// Whether the mirror image of standardised features x is S x.
pub(crate) fn is_centred(standardisation: &Standardisation) -> bool {
    standardisation.mean[ETA_S] == 0.0 && standardisation.mean[ALPHA] == FRAC_PI_2
}

/// Sets the means of eta_s and alpha of rows with their mirror images to their exact values, so
/// that the mirror image of standardised features x is S x.
pub(crate) fn centre(standardisation: &mut Standardisation) {
    standardisation.mean[ETA_S] = 0.0;
    standardisation.mean[ALPHA] = FRAC_PI_2;
}
