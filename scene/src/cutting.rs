//! How the sheet is cut: settings of the cut files that no equilibrium depends on.

use crate::stock::Stock;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the sheet is cut. A run continues under other values, which change its cut files only.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CuttingConfig {
    /// Length by which a slit that is open on the outline is cut beyond the finished edge (mm): 1,
    /// no key; some machines have their own.
    #[serde(skip)]
    pub over_run: f64,
    /// Width that the tool removes (mm), at most `process.slit_width`; a narrower tool cuts around
    /// the slits. By default a run's files are for a tool as wide as the slits.
    pub kerf: Option<f64>,
    /// The material that the sheet is cut from, in either orientation: `"a5"` to `"a0"`,
    /// `"letter"`, `"tabloid"`, or width and height (mm). The report warns of a sheet that does not
    /// fit on it.
    pub stock: Option<Stock>,
    /// Border of the stock that the machine cannot cut (mm).
    #[schemars(range(min = 0.0, max = 1e3))]
    pub margin: f64,
}

impl CuttingConfig {
    /// Width that the tool of the files of a run removes, in a sheet with slits of this width (mm).
    pub fn tool_kerf(&self, slit_width: f64) -> f64 {
        self.kerf.unwrap_or(slit_width)
    }
}

impl Default for CuttingConfig {
    fn default() -> Self {
        Self { over_run: 1.0, kerf: None, stock: None, margin: 0.0 }
    }
}
