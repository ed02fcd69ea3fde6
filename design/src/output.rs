//! Output of a design: reports, the page of a run, listings, drawings, cut files.

pub mod canvas;
pub mod cut_file;
mod deployment_states;
pub mod drawing;
pub mod hinge_states;
pub mod listing;
pub mod material_check;
pub mod measurement;
mod pdf;
pub mod report;
mod report_pdf;
mod run_page;
pub mod run_results;
pub mod vtk_sheet;
