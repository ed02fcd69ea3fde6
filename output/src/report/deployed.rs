//! What facts and findings are about: a deployed design and, after a search, its run.

use crate::{
    cut_file::CutLines,
    report::{hinge_row::HingeRow, numbers::rounded, reached::Reached},
};
use analysis::{
    design_checks::{DesignChecks, WholeSheet},
    mounting::Mounting,
    what_if::WhatIf,
};
use design::{
    geometry::polygon::{bounds, size},
    objective::{design_problem::Deployment, scores::Scores},
};
use scene::{Posture, Scene, design_run::Designed};
use support::{Fault, Point, severity::Severity};

/// A deployed design.
pub(super) struct DeployedDesign<'a> {
    pub scene: &'a Scene,
    pub deployment: &'a Deployment,
    /// The cut lines of the sheet.
    pub cuts: &'a Result<CutLines, Fault>,
    /// All hinges.
    pub hinges: Vec<HingeRow>,
    /// The run whose best design it is; `None` for only a design.
    pub run: Option<&'a FinishedRun<'a>>,
    /// How grave its findings are, once they are known.
    pub severities: Vec<Severity>,
}

/// A run, with what is computed of its best design once.
pub(super) struct FinishedRun<'a> {
    pub designed: &'a Designed,
    /// The scores of the best design.
    pub after: Scores,
    /// How much of the target one sees; [`seen`].
    pub seen: f64,
    /// What was measured of it after the search.
    pub checks: DesignChecks,
    /// How it is mounted; `None` if it is not.
    pub mounting: Option<Mounting>,
    /// What becomes of it if one thing is not as designed.
    pub changes: Vec<WhatIf>,
    pub reached: Option<Reached>,
}

impl DeployedDesign<'_> {
    pub(super) fn whole_sheet(&self) -> Option<&WholeSheet> {
        self.run?.checks.whole_sheet.as_ref()
    }

    /// Name of the file of the weights.
    pub(super) fn weights_file(&self) -> String {
        let files = self.scene.config.weights_files();
        let name = files.first().and_then(|path| path.file_name());
        name.map_or(String::new(), |name| name.to_string_lossy().into_owned())
    }

    /// Mass of the uncut sheet (kg).
    pub(super) fn mass_kg(&self) -> f64 {
        let area = self.deployment.sheet.panels.iter().map(|panel| panel.area).sum::<f64>();
        self.scene.material.mass_by_area() * area
    }

    /// Weight of the uncut sheet (N).
    pub(super) fn weight(&self) -> f64 {
        hinge::STANDARD_GRAVITY * self.mass_kg()
    }

    /// Weight over the load at the end of the path; `None` if that is zero or no force, or without
    /// equilibrium.
    pub(super) fn weight_over_load(&self) -> Option<f64> {
        let load = self.run?.reached.as_ref()?.force()?.abs();
        (load > 0.0).then(|| self.weight() / load)
    }

    /// Extent of the flat sheet along x and y (mm).
    pub(super) fn flat_size(&self) -> [f64; 2] {
        extent(self.deployment.sheet.outlines().into_iter().flatten())
    }

    /// The hinges whose rows `overstep`.
    pub(super) fn hinges_where(&self, overstep: impl Fn(&HingeRow) -> bool) -> Vec<usize> {
        self.hinges.iter().filter(|row| overstep(row)).map(|row| row.hinge).collect()
    }
}

/// What keeps the panels in their plane; `None` if the scene does not say.
pub(super) fn posture(scene: &Scene) -> Option<Posture> {
    scene.config.posture.map(|posture| posture.kind)
}

/// Whether the weight of the sheet acts in the model.
pub(super) fn is_heavy(scene: &Scene) -> bool {
    scene.weight_by_area() != [0.0; 2]
}

/// Effects in the plane that are not modelled for the out-of-plane restraint; `None` if there are
/// none, and if the scene states no restraint.
pub(super) fn left_out(scene: &Scene) -> Option<&'static str> {
    match posture(scene)? {
        Posture::HeldFlat => Some(
            "what holds the panels flat, and its friction; the weight of the sheet, if its plane is not horizontal",
        ),
        Posture::Mounted => {
            Some("friction on the board, and the weight of the sheet if the board is upright")
        }
        Posture::Lying => Some("in the design, friction"),
        Posture::Hanging if is_heavy(scene) => None,
        Posture::Hanging | Posture::Free => Some("the weight of the sheet"),
    }
}

/// A ratio to the load in words.
pub(super) fn of_the_load(ratio: f64) -> String {
    if ratio < 10.0 {
        format!("{} % of the load", rounded(100.0 * ratio, 2))
    } else {
        format!("{} times the load", rounded(ratio, 2))
    }
}

/// How much of the target one sees, from 0 to 1, and the distance of the outline of a sheet of some
/// flat size (mm), in words.
pub(crate) fn miss(seen: f64, outline_error: f64, size: [f64; 2]) -> String {
    format!(
        "{} % of the target is seen; the outline is {} mm (root mean square) from it, {} % of the longer side of the flat sheet",
        rounded(100.0 * seen, 3),
        rounded(outline_error, 3),
        rounded(100.0 * outline_error / size[0].max(size[1]), 2)
    )
}

pub(crate) fn extent(points: impl IntoIterator<Item = Point>) -> Point {
    size(bounds(points))
}

#[cfg(test)]
mod tests {
    use super::of_the_load;

    #[test]
    fn a_ratio_to_the_load_is_in_percent_or_times() {
        for (ratio, said) in [(0.162, "16 %"), (0.0486, "4.9 %"), (56.4, "56 times")] {
            assert!(of_the_load(ratio).starts_with(said), "{ratio}");
        }
    }
}
