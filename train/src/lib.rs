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
//! | `networks` | chi and chi_D |
//! | `force_tangents` | chi and its derivatives in (eta_a, eta_s, theta) |
//! | `loss` | (15) |
//! | `training` | the loop: Adam, schedule, best checkpoint |
//! | `validation` | errors on rows held out |
//! | `export` | Burn to `surrogate` |

mod backend;
mod config;
mod export;
mod force_tangents;
mod loss;
mod networks;
mod samples;
mod training;
mod validation;

pub use backend::{Backend, UnknownBackend};
pub use config::{InvalidConfig, TrainingConfig};
pub use training::{Epoch, TrainError, Trained, train};
pub use validation::{Parity, ParityPoint};
