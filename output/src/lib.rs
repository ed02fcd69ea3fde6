//! What a designed sheet is written as.
//!
//! | module | contents |
//! |---|---|
//! | [`display`] | the display list: shapes and styles, written as SVG and PDF |
//! | [`cut_file`] | the lines that a machine cuts, checked in the file as written: SVG, DXF, PDF in tiles |
//! | [`report`] | results, findings, warnings and estimates of a run: text, JSON, a printed sheet |
//! | [`run_files`], [`run_results`] | the files of a run |
//! | [`drawing`] | pictures of the sheet: flat, deployed, measured |
//! | [`listing`] | pattern, path and gradient in numbers |
//! | [`measurement`] | a measured sheet against its design |
//! | [`material_check`] | weights against the design that they are for |
//! | [`vtk_sheet`], [`hinge_states`] | the path for other programs |

#![warn(missing_docs)]

pub mod cut_file;
mod deployment_states;
pub mod display;
pub mod drawing;
pub mod hinge_states;
pub mod listing;
pub mod material_check;
pub mod measurement;
pub mod report;
mod report_pdf;
pub mod run_files;
mod run_page;
pub mod run_results;
pub mod vtk_sheet;
