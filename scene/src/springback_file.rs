//! The law of released hinges that a scene names for its report.

use crate::keys::{SceneConfig, resolved};
use hinge::SheetMaterial;
use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};
use support::Fault;
use surrogate::Springback;

/// Why a law of released hinges is not for the hinges of a scene.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SpringbackMismatch {
    #[error(
        "the law of released hinges is for {law}, and the sheet is of another material law, {sheet}"
    )]
    Material { law: String, sheet: String },
    #[error(
        "the law of released hinges is for holes with a radius of {law} w_lig, but the sheet has {sheet:.3} w_lig: set \
         process.fillet_ratio = {law}"
    )]
    Hole { law: f64, sheet: f64 },
    #[error(
        "the law of released hinges is for windows with a radius of {law} mm at this thickness, but the sheet has {sheet} mm"
    )]
    Window { law: f64, sheet: f64 },
}

/// Why a scene cannot use the law that it names.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SpringbackFileError {
    #[error("surrogate.springback: {0}")]
    Read(#[from] Fault),
    #[error("surrogate.springback: {}: {source}; or remove the key", file.display())]
    Other { file: PathBuf, source: SpringbackMismatch },
}

/// The law that the scene at `path` names; `None` if it names none, or has another hinge law.
/// `measured` is the material in the thickness of its file.
pub(super) fn load(
    config: &SceneConfig,
    measured: &SheetMaterial,
    path: &Path,
) -> Result<Option<Springback>, SpringbackFileError> {
    // A residual deformation follows from the forces of a learned law.
    let learned = config.surrogate.as_ref().filter(|_| config.level.is_learned());
    let Some(file) = learned.and_then(|learned| learned.springback.as_ref()) else {
        return Ok(None);
    };
    let law = Springback::load(&resolved(path, file))?;
    check(config, measured, &law)
        .map_err(|source| SpringbackFileError::Other { file: file.clone(), source })?;
    Ok(Some(law))
}

/// An error if a law is not for the hinges of a scene.
fn check(
    config: &SceneConfig,
    measured: &SheetMaterial,
    law: &Springback,
) -> Result<(), SpringbackMismatch> {
    /// Relative difference of two radii that rounding may cause.
    const ROUNDED: f64 = 1e-6;
    let differ = |x: f64, y: f64| (x / y - 1.0).abs() > ROUNDED;
    if law.material_hash != measured.law_hash() {
        return Err(SpringbackMismatch::Material {
            law: law.material.clone(),
            sheet: measured.name.clone(),
        });
    }
    let [narrowest, widest] = config.ligament.range;
    for w_lig in [narrowest, widest] {
        let hinge = config.process.hinge(w_lig, FRAC_PI_2);
        let known = law.hinge.fillet_ratio;
        if differ(hinge.fillet_ratio, known) {
            let (law, sheet) = (known, hinge.fillet_ratio);
            return Err(SpringbackMismatch::Hole { law, sheet });
        }
    }
    let (known, window) = (config.scale(measured) * law.hinge.r_win, config.process.r_win);
    if differ(window, known) {
        let (law, sheet) = (known, window);
        return Err(SpringbackMismatch::Window { law, sheet });
    }
    Ok(())
}
