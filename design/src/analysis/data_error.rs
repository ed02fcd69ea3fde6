//! Why measurements are not those of a sheet.

use crate::analysis::measured_sheet::MeasurementError;
use crate::objective::design_problem::DesignError;

/// Why measurements are not those of a sheet.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum DataError {
    #[error("nothing was measured: give points, or readings of displacement and load")]
    NoData,
    #[error("nothing moves this sheet: loads cannot be compared")]
    NothingMoves,
    #[error("this sheet is moved by {0}")]
    OtherUnits(&'static str),
    #[error("reading {index}: {fault}")]
    Reading { index: usize, fault: ReadingFault },
    #[error(transparent)]
    Points(#[from] MeasurementError),
    #[error(transparent)]
    Design(#[from] DesignError),
}

/// Why a reading is not one of the sheet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum ReadingFault {
    #[error(
        "a {what} of {value:.4} {unit} is not above 0 and at most that at full load, {full:.4} {unit}{}",
        if *.swapped { "; the columns of displacement and load seem to be swapped" } else { "" }
    )]
    OutOfRange {
        what: &'static str,
        unit: &'static str,
        value: f64,
        full: f64,
        swapped: bool,
    },
    #[error("readings are in ascending order, but this one is not above the one before it")]
    NotAscending,
    #[error(
        "a {what} of {value:.4} {unit} is {:.3} times that of the drawing's sheet, {predicted:.4} {unit}: check the units{}",
        value / predicted,
        if *.swapped { ", and whether the columns of displacement and load are swapped" } else { "" }
    )]
    Implausible {
        what: &'static str,
        unit: &'static str,
        value: f64,
        predicted: f64,
        swapped: bool,
    },
}
