//! The hinge database: every converged increment of every window solve, as one table.
//!
//! A database is `X.parquet` with its manifest `X.json`: hash, counts, units, training domain,
//! rejected rows and the split. It is collected once with [`Database::collect`], which rejects
//! invalid rows instead of repairing them. Rays of different materials or hinge constants are an
//! error. Some rays may be there on a finer mesh too: [`Database::corrected`] corrects the others
//! by them.
//!
//! Reading a database:
//!
//! ```
//! use dataset::{Database, Subset};
//! use std::path::Path;
//!
//! # let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/polypropylene-3mm/hinges.parquet");
//! let database = Database::read(&path)?;
//! println!("{}", database.manifest().tier);
//! for ray in database.part(Subset::Test) {
//!     assert!(ray.samples[0].w.is_finite() && ray.design.w_lig > 0.0);
//! }
//! # Ok::<_, support::Fault>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod bridge;
mod check;
mod compare;
mod database;
mod database_files;
mod digest;
mod fidelity_correction;
mod manifest;
mod parquet;
mod rays;
mod schema;
mod split;
mod summary;

pub use check::Defect;
pub use compare::{COMPARED, ComparedRay, ComparedState, compare, reference_rms, relative_rms};
pub use database::Database;
pub use fidelity_correction::{LeftOut, left_out};
pub use manifest::{AcceptanceLimits, FORMAT_VERSION, FinerMesh, Manifest, Rejection};

pub use database_files::Collected;
pub use fe_driver::{Fidelity, SolvedRay};
pub use rays::{samples, with_mirrored};
pub use schema::{COLUMNS, ColumnMeaning};
pub use split::{Split, SplitPlan, Subset};
