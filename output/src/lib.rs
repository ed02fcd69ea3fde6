//! What a designed sheet is written as.
//!
//! Every drawing is a list of shapes, the [`display`] list, which SVG, PDF and DXF write: the lines
//! that a machine cuts ([`cut_file`]), checked in the file as written, and the pictures
//! ([`drawing`]). [`report`] holds results, findings and warnings of a run; [`run_files`] lists the
//! files of its folder.
//!
//! The cut file of a sheet:
//!
//! ```
//! use scene::Scene;
//! use output::cut_file::{CutLines, SheetDrawing, dxf};
//! use std::path::Path;
//!
//! # let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
//! let scene = Scene::read(&scenes.join("pin-7x7.toml"))?;
//! let deployment = scene.problem()?.deploy(&scene.start())?;
//! let cuts = CutLines::of(&scene, &deployment)?;
//! let drawing = SheetDrawing::new(&cuts, &deployment.sheet, &scene.material);
//! assert!(dxf(&drawing.annotated()).contains("LWPOLYLINE"));
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

pub mod cut_file;
mod deployment_states;
pub mod display;
pub mod drawing;
pub mod listing;
pub mod measurement;
mod mounting_kit;
pub mod report;
pub mod run_files;
pub mod run_page;
pub mod run_results;
pub mod vtk_sheet;
