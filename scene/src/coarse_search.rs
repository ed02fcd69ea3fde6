//! A search at a coarser level than its run, as the state of the run keeps it.

use crate::level::Level;
use design::objective::scores::Scores;
use serde::{Deserialize, Serialize};

/// The difference of two levels of one sheet, in the state that is compared with the target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelDifference {
    /// Distance of the panel corners (mm): root mean square and maximum. Of pins, after the rigid
    /// motion that makes it smallest.
    pub corners: [f64; 2],
    /// Difference of the load, relative to the finer level; `None` if a level has no load, or dead
    /// loads open the sheet.
    pub load: Option<f64>,
    /// Difference of the largest D_peak of the hinges along the path; `None` if a level does not
    /// predict it.
    pub damage: Option<f64>,
}

/// A search at a coarser level, and the difference of its design to the next finer level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoarseSearch {
    /// The level of the search.
    pub level: Level,
    /// The scores of its start.
    pub start: Scores,
    /// Its steps.
    pub steps: usize,
    /// The finer level.
    pub finer: Level,
    /// The difference of the design to the finer level.
    pub difference: LevelDifference,
    /// The tolerance of the panel corners (mm).
    pub tolerance: f64,
}

impl CoarseSearch {
    /// Whether the panel corners differ by the tolerance at most.
    pub fn suffices(&self) -> bool {
        self.difference.corners[1] <= self.tolerance
    }
}
