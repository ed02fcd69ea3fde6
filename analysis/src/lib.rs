//! What is computed of a deployed sheet beyond its shape.
//!
//! Load against displacement ([`actuation_curve`]), errors by cause ([`error_budget`]), stability
//! out of the plane ([`out_of_plane`]), springback, the levels of a scene and their differences,
//! and the comparison with measured points ([`measured_sheet`], section 4.4). [`fit`] finds the
//! sheet for a silhouette, [`refinement`] the cheapest level that keeps a tolerance. What studies
//! have measured stands in [`calibration`].

#![cfg_attr(not(test), warn(unreachable_pub))]

pub mod actuation_curve;
pub mod calibration;
pub mod design_checks;
pub mod error_budget;
mod error_causes;
pub mod fit;
pub mod flanks;
pub mod flatness;
mod force_errors;
pub mod level_difference;
pub mod levels;
pub mod material_check;
pub mod measured_openings;
pub mod measured_points;
pub mod measured_sheet;
pub mod mounting;
pub mod out_of_plane;
pub mod path_fit;
pub mod path_separation;
pub mod refinement;
pub mod shape_path;
pub mod springback;
pub mod unit;
pub mod what_if;
