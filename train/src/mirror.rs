//! Mirror symmetry by construction, instead of learned from mirror images.
//!
//! W(a, s, theta; alpha) = W(a, -s, theta; pi - alpha) is W(x) = W(S x) in standardised features,
//! with S = diag(1, -1, 1, 1, -1) where the means of eta_s and alpha are 0 and pi / 2. The units of
//! each layer come in pairs (j, n - 1 - j), of which one sees what the other sees of the image:
//!
//! ```text
//! h_{n-1-j}(x) = h_j(S x)      if  W_0 = [A, S A R],  W_l = [A, R A R],  b_l = [b, R b]
//! ```
//!
//! with R the reversal of order, and A and b halves, which are all that is trained. |chi - chi_0|^2
//! takes both of a pair alike; the output of a damage head does with W_L = [B; R B].

use crate::affine::Affine;
use burn::tensor::{Tensor, TensorData};
use std::f64::consts::FRAC_PI_2;
use surrogate::Standardisation;

/// The diagonal of S.
const SIGNS: [f64; 5] = [1.0, -1.0, 1.0, 1.0, -1.0];

/// How a layer is folded onto the part of it that is trained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fold {
    /// Not at all: no symmetry.
    Whole,
    /// The layer takes features; half of its columns are trained.
    First,
    /// The layer takes pairs and gives pairs; half of its columns are trained.
    Hidden,
    /// The layer takes pairs, its outputs are their own images; half of its rows are trained.
    Invariant,
}

impl Fold {
    /// (inputs, outputs) of the trained part of a layer of this shape.
    pub fn shape(self, [inputs, outputs]: [usize; 2]) -> [usize; 2] {
        match self {
            Self::Whole => [inputs, outputs],
            Self::First | Self::Hidden => [inputs, outputs / 2],
            Self::Invariant => [inputs / 2, outputs],
        }
    }

    /// The layer of which `part` is trained.
    pub fn unfold(self, part: Affine) -> Affine {
        let Affine { weight, bias } = part;
        let paired = |bias: Tensor<1>| Tensor::cat(vec![bias.clone(), bias.flip([0])], 0);
        match self {
            Self::Whole => Affine { weight, bias },
            Self::First => {
                let options = (&weight.device(), weight.dtype());
                let signs = TensorData::new(SIGNS.to_vec(), [SIGNS.len(), 1]);
                let signs: Tensor<2> = Tensor::from_data(signs, options);
                let images = (weight.clone() * signs).flip([1]);
                Affine {
                    weight: Tensor::cat(vec![weight, images], 1),
                    bias: paired(bias),
                }
            }
            Self::Hidden => Affine {
                weight: Tensor::cat(vec![weight.clone(), weight.flip([0, 1])], 1),
                bias: paired(bias),
            },
            Self::Invariant => Affine {
                weight: Tensor::cat(vec![weight.clone(), weight.flip([0])], 0),
                bias,
            },
        }
    }

    /// The part of a whole layer that is trained.
    pub fn fold(self, whole: Affine) -> Affine {
        let Affine { weight, bias } = whole;
        let [inputs, outputs] = self.shape(weight.dims());
        Affine {
            weight: weight.narrow(0, 0, inputs).narrow(1, 0, outputs),
            bias: bias.narrow(0, 0, outputs),
        }
    }
}

/// Whether the mirror image of standardised features is S times them.
pub(crate) fn is_centred(standardisation: &Standardisation) -> bool {
    let [_, eta_s, .., alpha] = standardisation.mean;
    eta_s == 0.0 && alpha == FRAC_PI_2
}

/// Makes it so, to the bit, for the features of rows with their mirror images.
pub(crate) fn centre(standardisation: &mut Standardisation) {
    let [_, eta_s, .., alpha] = &mut standardisation.mean;
    (*eta_s, *alpha) = (0.0, FRAC_PI_2);
}
