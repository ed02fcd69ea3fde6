//! A meshed window and all other data of its input deck.

use crate::{DeformationPath, StepControl};
use hinge::SheetMaterial;
use mesher::WindowMesh;

/// A meshed window with its path, material and step control.
#[derive(Clone, Copy, Debug)]
pub struct WindowModel<'a> {
    /// The mesh of the window.
    pub mesh: &'a WindowMesh,
    /// The path along which arc B is driven.
    pub path: &'a DeformationPath,
    /// The sheet material.
    pub material: &'a SheetMaterial,
    /// The increments of the solve.
    pub step: &'a StepControl,
    /// Whether the displacements of all nodes are printed, for
    /// [`CalculiX::fields`](crate::CalculiX::fields); if not, only the displacements of the lower
    /// face are printed, which are a small part of the output.
    pub print_all: bool,
}
