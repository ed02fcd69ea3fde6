//! Output of a design: reports, listings, drawings, cut files.

pub mod canvas;
pub mod cut_file;
pub mod drawing;
pub mod hinge_states;
pub mod listing;
pub mod material_check;
pub mod measurement;
pub mod report;
pub mod run_results;
pub mod vtk_sheet;
