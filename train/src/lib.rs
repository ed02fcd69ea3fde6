//! Training of the condensed hinge energy with Burn.
//!
//! [`train`] takes a database and a configuration and returns a [`surrogate::Surrogate`] with its
//! test errors. The loss (15) asks for forces; their parameter gradient needs no second-order
//! differentiation, because the three force tangents are pushed forward through the network as
//! tensor operations and one reverse pass follows.
//!
//! | file | idea |
//! |---|---|
//! | `config` | the training configuration |
//! | `backend` | Burn backends, chosen at run time |
//! | `samples` | rows as the network sees them: standardised, scaled, batched |
//! | `mirror` | mirror symmetry by construction |
//! | `affine` | a layer, and tanh networks of layers |
//! | `networks` | chi, chi_D and chi_P |
//! | `force_tangents` | chi and its derivatives in (eta_a, eta_s, theta) |
//! | `loss` | (15) |
//! | `optimiser` | Muon and Adam, learning rate |
//! | `epoch` | the record of one epoch |
//! | `training` | the loop: steps, best epoch |
//! | `state` | a training on disk, to go on from |
//! | `validation` | errors on rows held out |
//! | `bins` | the same by compression, shear, rotation, width, angle and distance from the edge |
//! | `stiffness` | the learned tangent against the finite elements |
//! | `ensemble` | networks of other seeds as a measure of error |
//! | `export` | Burn to `surrogate` |

mod affine;
mod backend;
mod bins;
mod config;
mod ensemble;
mod epoch;
mod error;
mod export;
mod force_tangents;
mod loss;
mod mirror;
mod networks;
mod optimiser;
mod samples;
mod state;
mod stiffness;
mod training;
mod validation;

pub use backend::{Backend, UnknownBackend};
pub use config::{InvalidConfig, Precision, TrainingConfig};
pub use ensemble::{Disagreement, EnsembleCheck, disagreements};
pub use epoch::Epoch;
pub use error::TrainError;
pub use state::StateError;
pub use stiffness::StiffnessCheck;
pub use training::{Start, Trained, Training, train};
pub use validation::{Parity, ParityPoint};
