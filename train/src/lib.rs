//! Training of the condensed hinge energy with Burn.
//!
//! [`train`] takes a database and a configuration and returns a [`surrogate::Surrogate`] with its
//! test errors. The loss (15) contains forces, which are derivatives of the network. Their
//! parameter gradient needs no second-order differentiation: the three force tangents are
//! propagated forwards through the network as tensor operations, followed by one reverse pass.
//!
//! ```no_run
//! use dataset::Database;
//! use std::path::Path;
//! use train::{TrainingConfig, train};
//!
//! let database = Database::read(Path::new("data/pet-0.5mm/hinges.parquet"))?;
//! let config: TrainingConfig = support::toml_file::read(Path::new("configs/training/small.toml"))?;
//! let trained = train(&database, &config, &mut |epoch| println!("{epoch:?}"))?;
//! trained.surrogate.save(Path::new("runs/small.safetensors"))?;
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod affine;
mod config;
mod distillation;
mod error_interval;
mod fine_tuning;
mod loss;
mod networks;
mod samples;
mod state;
mod training;
mod validation;

pub use config::TrainingConfig;
pub use distillation::{Distillation, TrainingData};
pub use error_interval::ErrorInterval;
pub use fine_tuning::check_pretrained;
pub use state::Epoch;
pub use training::{Start, Trained, Training, train};
pub use validation::{Parity, inside, spot_check};
