//! The error of collecting, reading, writing and correcting a database.

use support::fault::Fault;

/// Why a database cannot be collected, read, written or corrected.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    /// The table has other columns or types.
    #[error("the table is not a valid database: {0}")]
    Table(#[from] polars::error::PolarsError),
    /// Any other mistake.
    #[error(transparent)]
    Fault(#[from] Fault),
}
