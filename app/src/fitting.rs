//! A sheet of an even pattern for a drawing, and what is said of it.

use crate::progress::announce;
use analysis::fit::scene::{FittedScene, fitted};
use anyhow::Result;
use scene::Scene;

/// Makes the sheet that opens onto the target of a scene; also returns what a person may expect of
/// it.
pub fn fit_to_target(scene: &Scene) -> Result<(FittedScene, String)> {
    announce("laying an even pattern over the target, in some seconds");
    let fit = fitted(scene)?;
    let expected = expected(&fit);
    Ok((fit, expected))
}

/// What a person may expect of the sheet.
pub fn expected(fit: &FittedScene) -> String {
    let FittedScene { panels, side, opening, seen, .. } = fit;
    format!(
        "The sheet of {panels} panels of {side:.0} mm, opened by {:.0} deg, is seen as the target: {:.1} % of the area of both in \
         common",
        opening.to_degrees(),
        100.0 * seen
    )
}
