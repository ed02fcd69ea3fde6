//! Analyses of a deployed sheet beyond its shape: forces (section 3.2), Gamma (section 5.1), comparison with
//! measured points (section 4.4), paths of the hinges (section 5.2).

pub mod actuation_curve;
mod answers;
pub mod calibrated_scene;
pub mod calibration;
pub mod coupon;
mod coupon_scene;
pub mod cutting_errors;
pub mod data_error;
pub mod error_budget;
pub mod flanks;
pub mod flatness;
pub mod force_errors;
pub mod force_transmission;
pub mod friction_effect;
pub mod localisation;
pub mod marks;
pub mod measured_openings;
pub mod measured_sheet;
pub mod measurements;
pub mod path_fit;
pub mod path_separation;
pub mod real_sheet;
pub mod shape_path;
pub mod sheet_residuals;
pub mod simulated_coupon;
pub mod simulated_measurements;
pub mod springback;
pub mod taylor;
pub mod threshold;
