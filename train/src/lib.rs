//! Training of the condensed hinge energy with Burn.
//!
//! [`train`] takes a database and a configuration and returns a [`surrogate::Surrogate`] with its
//! test errors. The loss (15) contains forces, which are derivatives of the network. Their parameter gradient needs
//! no second-order differentiation: the three force tangents are propagated forwards through the network as
//! tensor operations, followed by one reverse pass.
//!
//! | file | contents |
//! |---|---|
//! | `config` | the training configuration |
//! | `backend` | Burn backends, chosen at run time |
//! | `samples` | rows as inputs and targets of the network: standardised, scaled, batched |
//! | `mirror` | mirror symmetry by construction |
//! | `affine` | a layer, and tanh networks of layers |
//! | `networks` | chi, chi_D and chi_P |
//! | `force_tangents` | chi and its derivatives in (eta_a, eta_s, theta) |
//! | `loss` | the loss (15) |
//! | `optimiser` | Muon and Adam, learning rate |
//! | `parent` | given weights, scaled to the rows, as the start of a training |
//! | `epoch` | the record of one epoch |
//! | `training` | the training loop: steps, best epoch |
//! | `state` | the state of a training on disk, for resuming |
//! | `validation` | errors on rows that are not used in training |
//! | `bins` | these errors by compression, shear, rotation, width, angle and distance from the domain's edge |
//! | `stiffness` | the learned tangent compared with the finite elements |
//! | `ensemble` | the spread of networks with different seeds as a measure of error |
//! | `export` | conversion of Burn networks to `surrogate` |

#![warn(missing_docs)]

mod affine;
mod backend;
mod bins;
mod config;
mod ensemble;
mod epoch;
mod error;
mod export;
mod force_tangents;
mod lesson;
mod loss;
mod mirror;
mod networks;
mod optimiser;
mod parent;
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
pub use lesson::{Lesson, TrainingData};
pub use parent::check_parent;
pub use state::StateError;
pub use stiffness::StiffnessCheck;
pub use training::{Start, Trained, Training, train};
pub use validation::{Parity, ParityPoint};
