//! A learned scene with linear springs of its own weights instead.

use anyhow::{Context, Result};
use design::scene::{CondensedConfig, HingeModel, SceneConfig};
use design::sheet::cut_sheet::HingePoint;
use std::path::{Path, PathBuf};

/// Replaces the learned law by linear springs with the secant stiffness of `weights` at an angle (deg).
pub fn condense(config: &mut SceneConfig, weights: &Path, secant_deg: f64) {
    config.hinge = HingeModel::Linear;
    config.hinge_point = Some(HingePoint::CutTip);
    config.surrogate = None;
    config.objective.damage = 0.0;
    // Only a learned law has a domain.
    config.objective.domain = 0.0;
    config.condensed = Some(CondensedConfig {
        weights: weights.to_owned(),
        secant_deg,
    });
}

/// The weights of the scene at `scene`, as a path independent of its folder.
pub fn own_weights(config: &SceneConfig, scene: &Path) -> Result<PathBuf> {
    let named = config.surrogate.as_ref();
    let named = &named
        .context("the scene has no weights: add surrogate.weights")?
        .weights;
    let folder = scene.parent().unwrap_or(Path::new(""));
    Ok(std::path::absolute(folder.join(named))?)
}
