//! Output of a design: reports, listings, drawings, cut files.

pub mod canvas;
pub mod cut_file;
pub mod drawing;
pub mod listing;
pub mod report;
pub mod run_results;
