//! A search at a coarser level than its run, as the state of the run keeps it.

use crate::level::Level;
use design::optimise::outer_loop::StepRecord;
use serde::{Deserialize, Serialize};

/// The difference of two levels of one sheet, in the state that is compared with the target.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
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
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CoarseSearch {
    /// The level of the search.
    pub level: Level,
    /// One record per step, beginning with the record of its start.
    pub history: Vec<StepRecord>,
    /// The finer level.
    pub finer: Level,
    /// The difference of the design to the finer level.
    pub difference: LevelDifference,
    /// The tolerance of the panel corners (mm); `None` if the finer level searches on in any case.
    pub tolerance: Option<f64>,
    /// Their error by the mesh of the windows (mm), which no learned level lowers; zero if it is
    /// unknown.
    #[serde(default)]
    pub mesh: f64,
}

impl CoarseSearch {
    /// Its steps.
    pub fn steps(&self) -> usize {
        self.history.len() - 1
    }

    /// Whether the panel corners differ by less than a length (mm).
    pub fn is_within(&self, length: f64) -> bool {
        self.difference.corners[1] <= length
    }

    /// Whether no finer level is needed: the panel corners differ by the tolerance at most, or by
    /// what the mesh of the windows makes uncertain.
    pub fn suffices(&self) -> bool {
        self.tolerance.is_some_and(|tolerance| self.is_within(tolerance.max(self.mesh)))
    }
}
