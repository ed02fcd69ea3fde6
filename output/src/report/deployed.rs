//! What facts and findings are about: a deployed design and, after a search, its run.

use crate::cut_file::{CutLines, FabricationError};
use crate::report::estimate::Estimate;
use crate::report::facts::reached::Reached;
use crate::report::findings::Warning;
use crate::report::hinge_row::HingeRow;
use crate::report::self_weight::SelfWeight;
use analysis::design_checks::{DesignChecks, WholeSheet};
use design::objective::design_problem::Deployment;
use design::objective::scores::Scores;
use scene::Scene;
use scene::design_run::Designed;

/// A deployed design.
pub(super) struct Deployed<'a> {
    pub scene: &'a Scene,
    pub deployment: &'a Deployment,
    /// The cut lines of the sheet.
    pub cuts: &'a Result<CutLines, FabricationError>,
    /// All hinges.
    pub hinges: Vec<HingeRow>,
    /// The run whose best design it is; `None` for a design alone.
    pub run: Option<&'a Run<'a>>,
    /// The findings, once they are known.
    pub warnings: Vec<Warning>,
}

/// A run, with what is computed of its best design once.
pub(super) struct Run<'a> {
    pub designed: &'a Designed,
    /// The scores of the best design.
    pub after: Scores,
    /// What was measured of it after the search.
    pub checks: DesignChecks,
    pub reached: Option<Reached>,
    pub weight: SelfWeight,
    pub estimate: Option<Estimate>,
}

impl Deployed<'_> {
    pub fn whole_sheet(&self) -> Option<&WholeSheet> {
        self.run?.checks.whole_sheet.as_ref()
    }

    /// Name of the file of the weights.
    pub fn weights_file(&self) -> String {
        let files = self.scene.config.weights_files();
        let name = files.first().and_then(|path| path.file_name());
        name.map_or(String::new(), |name| name.to_string_lossy().into_owned())
    }

    /// Extent of the flat sheet along x and y (mm).
    pub fn flat_size(&self) -> [f64; 2] {
        extent(self.deployment.sheet.outline.corners)
    }

    /// The hinges whose rows `overstep`.
    pub fn hinges_where(&self, overstep: impl Fn(&HingeRow) -> bool) -> Vec<usize> {
        self.hinges.iter().filter(|row| overstep(row)).map(|row| row.hinge).collect()
    }
}

pub(crate) fn extent(points: impl IntoIterator<Item = [f64; 2]>) -> [f64; 2] {
    let [low, high] = design::geometry::polygon::bounds(points);
    [high[0] - low[0], high[1] - low[1]]
}
