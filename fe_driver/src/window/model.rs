//! A meshed window and all other data of its input deck.

use crate::window::deformation_path::DeformationPath;
use crate::window::step_control::StepControl;
use hinge::SheetMaterial;
use mesher::WindowMesh;

/// A meshed window with its path, material and step control.
#[derive(Clone, Copy, Debug)]
pub struct WindowModel<'a> {
    pub mesh: &'a WindowMesh,
    pub path: &'a DeformationPath,
    pub material: &'a SheetMaterial,
    pub step: &'a StepControl,
}
