//! The hinge database: every converged increment of every window solve, as one table.
//!
//! A database is `X.parquet` with its manifest `X.json`: hash, counts, units, training domain,
//! rejected rows and the split. It is collected once ([`Database::collect`]), never repaired, and
//! refuses rows that do not belong together.
//!
//! | file | idea |
//! |---|---|
//! | `rows` | one row: design, sample, provenance |
//! | `schema` | the columns |
//! | `gates` | which rows are rejected, and why |
//! | `split` | training, validation and test by geometry |
//! | `mirror` | the mirror image of a row |
//! | `manifest` | what stands beside the Parquet file |
//! | `noise` | scatter of the increments of a ray |
//! | `parquet` | reading and writing |
//! | `compare` | the same rays solved twice |
//! | `bridge` | rows of a coarse mesh corrected to a finer one |
//! | `csv` | CSV, also of other solvers |
//! | `summary` | counts, ranges, histograms and coverage, to print |

mod bridge;
mod compare;
mod csv;
mod database;
mod gates;
mod manifest;
mod mirror;
mod noise;
mod parquet;
mod rows;
mod schema;
mod split;
mod summary;

pub use bridge::{left_out, speaks_for};
pub use compare::{COMPARED, ComparedRay, ComparedState, compare, reference_rms, relative_rms};
pub use csv::{ColumnMap, Constant, rows_from_csv};
pub use database::{Database, DatasetError, Mixing};
pub use gates::{Gates, Rejection};
pub use manifest::{FORMAT_VERSION, Manifest};
pub use mirror::with_mirrored;
pub use noise::noise;
pub use rows::Row;
pub use split::{Part, Split, SplitPlan};
pub use summary::Details;
