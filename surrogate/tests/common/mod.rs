//! Surrogates with random weights, and a hinge design.

use hinge::HingeDesign;
use std::path::{Path, PathBuf};
use surrogate::Surrogate;

pub fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases")
}

/// A surrogate without D_peak.
pub fn tiny() -> Surrogate {
    Surrogate::load(&cases().join("chi_tiny.safetensors")).unwrap()
}

/// A surrogate like [`tiny`] with D_peak and a sharpness of 8.
pub fn with_peak() -> Surrogate {
    Surrogate::load(&cases().join("chi_domain.safetensors")).unwrap()
}

pub fn design(w_lig: f64, alpha: f64) -> HingeDesign {
    hinge::HingeConstants::PAPER.hinge(w_lig, alpha)
}
