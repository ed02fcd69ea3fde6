//! Analyses of a deployed sheet beyond its shape: forces (section 3.2), Gamma (section 5.1),
//! comparison with measured points (section 4.4), paths of the hinges (section 5.2).

pub mod actuation_curve;
pub mod design_checks;
pub mod error_budget;
pub mod flanks;
pub mod flatness;
pub mod force_errors;
pub mod level_difference;
pub mod levels;
pub mod localisation;
pub mod material_check;
pub mod measured_openings;
pub mod measured_points;
pub mod measured_sheet;
pub mod out_of_plane;
pub mod path_fit;
pub mod path_separation;
pub mod refinement;
pub mod shape_path;
pub mod springback;
