//! The hinge database: every converged increment of every window solve, as one table.
//!
//! A database is `X.parquet` with its manifest `X.json`: hash, counts, units, training domain,
//! rejected rows and the split. It is collected once with [`Database::collect`], which rejects invalid rows instead
//! of repairing them. Rows of different materials, tiers or hinge constants are an error.
//!
//! Reading a database:
//!
//! ```
//! use dataset::{Database, Part};
//! use std::path::Path;
//!
//! # let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/pet-0.5mm/reference.parquet");
//! let database = Database::read(&path)?;
//! println!("{}", database.manifest().tier);
//! for row in database.part(Part::Test) {
//!     assert!(row.sample.w.is_finite() && row.design.w_lig > 0.0);
//! }
//! # Ok::<_, dataset::DatasetError>(())
//! ```

#![warn(missing_docs)]

mod check;
mod compare;
mod csv;
mod database;
mod database_files;
mod digest;
mod error;
mod fidelity;
mod fidelity_correction;
mod gates;
mod manifest;
mod mirror;
mod mixing;
mod parquet;
mod ray_stream;
mod rows;
mod schema;
mod split;
mod summary;

pub use check::Finding;
pub use compare::{COMPARED, ComparedRay, ComparedState, compare, reference_rms, relative_rms};
pub use csv::{ColumnMap, Constant, rows_from_csv};
pub use database::Database;
pub use error::DatasetError;
pub use fidelity::Fidelity;
pub use fidelity_correction::{LeftOut, left_out};
pub use gates::{Gates, Rejection};
pub use manifest::{FORMAT_VERSION, Manifest};
pub use mirror::with_mirrored;
pub use mixing::Mixing;
pub use ray_stream::Collected;
pub use rows::Row;
pub use split::{Part, Split, SplitPlan};
