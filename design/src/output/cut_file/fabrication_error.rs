//! Errors of cut files.

use std::path::PathBuf;

/// A sheet that cannot be cut, or a file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum FabricationError {
    #[error(
        "the slit at hinge {hinge} would be {length:.3} mm long, but the holes at its ends take \
         {drilled:.3} mm: narrow the ligament or lengthen the cut"
    )]
    SlitVanishes {
        hinge: usize,
        length: f64,
        drilled: f64,
    },
    #[error(
        "the hole of hinge {hinge} is {diameter:.3} mm wide, which must exceed the kerf of {kerf} mm: \
         increase the ligament width or the fillet ratio"
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
