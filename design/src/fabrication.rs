//! From a designed sheet to files that a cutting machine reads, at 1:1 in mm.

mod cut_lines;
mod dxf;
mod svg;

pub use cut_lines::{CutLines, Hole, Label, Slit};
pub use dxf::write_dxf;
pub use svg::write_svg;

use std::path::PathBuf;

/// The layers of both formats.
const CUT: &str = "CUT";
const HOLES: &str = "HOLES";
const OUTLINE: &str = "OUTLINE";
const ANNOTATION: &str = "ANNOTATION";

/// A sheet that cannot be cut, or a file that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum FabricationError {
    #[error(
        "the slit at hinge {hinge} would be {length:.3} mm long, and the holes at its ends take \
         {drilled:.3} mm: narrow the ligament or lengthen the cut"
    )]
    SlitVanishes {
        hinge: usize,
        length: f64,
        drilled: f64,
    },
    #[error(
        "the hole of hinge {hinge} is {diameter:.3} mm wide, less than the kerf of {kerf} mm: \
         widen the ligament or the fillet ratio"
    )]
    HoleTooSmall {
        hinge: usize,
        diameter: f64,
        kerf: f64,
    },
    #[error("cannot write {path}: {source}", path = .path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("cannot write {path}: {source}", path = .path.display())]
    Dxf {
        path: PathBuf,
        source: ::dxf::DxfError,
    },
}
