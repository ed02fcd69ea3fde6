//! The law of released hinges that a scene names for its report.

use crate::keys::{SceneConfig, resolved};
use hinge::SheetMaterial;
use std::{f64::consts::FRAC_PI_2, path::Path};
use support::{Fault, at, ensure};
use surrogate::Springback;

/// The law that the scene at `path` names; `None` if it names none, or has another hinge law.
/// `measured` is the material in the thickness of its file.
pub(super) fn load(
    config: &SceneConfig,
    measured: &SheetMaterial,
    path: &Path,
) -> Result<Option<Springback>, Fault> {
    // A residual deformation follows from the forces of a learned law.
    let learned = config.surrogate.as_ref().filter(|_| config.level.is_learned());
    let Some(file) = learned.and_then(|learned| learned.springback.as_ref()) else {
        return Ok(None);
    };
    let law = Springback::load(&resolved(path, file)).map_err(at("surrogate.springback"))?;
    check(config, measured, &law).map_err(|mismatch| {
        format!("surrogate.springback: {}: {mismatch}; or remove the key", file.display())
    })?;
    Ok(Some(law))
}

/// An error if a law is not for the hinges of a scene.
fn check(config: &SceneConfig, measured: &SheetMaterial, law: &Springback) -> Result<(), Fault> {
    /// Relative difference of two radii that rounding may cause.
    const ROUNDED: f64 = 1e-6;
    let differ = |x: f64, y: f64| (x / y - 1.0).abs() > ROUNDED;
    ensure!(
        law.material_hash == measured.law_hash(),
        "the law of released hinges is for {}, and the sheet is of another material law, {}",
        law.material,
        measured.name
    );
    let known = law.hinge.fillet_ratio;
    for w_lig in config.ligament.range {
        let hole = config.process.hinge(w_lig, FRAC_PI_2).fillet_ratio;
        ensure!(
            !differ(hole, known),
            "the law of released hinges is for holes with a radius of {known} w_lig, but the sheet has {hole:.3} w_lig: set \
             process.fillet_ratio = {known}"
        );
    }
    let (known, window) = (config.scale(measured) * law.hinge.r_win, config.process.r_win);
    ensure!(
        !differ(window, known),
        "the law of released hinges is for windows with a radius of {known} mm at this thickness, but the sheet has {window} mm"
    );
    Ok(())
}
