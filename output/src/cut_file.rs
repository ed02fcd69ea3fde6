//! Cut files of a designed sheet for cutting machines and for cutting by hand, at 1:1 in mm.
//!
//! [`CutLines`] is the finished geometry, checked against the simulated sheet. [`SheetDrawing`] is
//! what is cut, in cutting order, with numbers and instructions; [`dxf()`], [`svg()`] and
//! [`tiles_pdf`] are its files.

mod attachments;
mod cut_drawing;
mod cut_lines;
mod cut_list;
mod cutting_order;
mod dxf;
mod finished_contours;
mod gaps;
mod machine;
mod numbers;
mod pdf_tiles;
mod sheet_drawing;
mod svg;
mod tiling;
mod totals;

pub use attachments::PlacedAttachment;
pub use cut_drawing::{CutDrawing, Layer, deployed_panels};
pub use cut_lines::{CutLines, Hole, Slit};
pub use cut_list::{attachment_list, cut_list, cut_summary};
pub use dxf::dxf;
pub(crate) use machine::fits;
pub use machine::{Features, Machine, Machines, Service};
pub use pdf_tiles::tiles_pdf;
pub(crate) use pdf_tiles::{form, tile_pages};
pub use sheet_drawing::{FORCED, SheetDrawing, mark_errors};
pub use svg::svg;
pub use tiling::{OVERLAP, Tiling};
pub use totals::Totals;
