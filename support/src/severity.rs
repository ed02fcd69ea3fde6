//! Findings: statements about a material, a design or a sheet, with their severity.

use serde::{Deserialize, Serialize};

/// How grave a finding is.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::Display,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Severity {
    /// The model is less accurate than elsewhere.
    Note,
    /// The sheet may not behave as computed: check before cutting.
    Warning,
    /// The sheet will not behave as computed, or cannot be cut: no cut file is written unless
    /// forced.
    Error,
}

/// A statement about a material or a sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, derive_more::Display)]
#[display("{severity}: {message}")]
pub struct Finding {
    /// The consequence.
    pub severity: Severity,
    /// The quantity, its limit and the consequence, in words.
    pub message: String,
}

impl Severity {
    /// A finding of this severity.
    pub fn finding(self, message: String) -> Finding {
        let severity = self;
        Finding { severity, message }
    }
}
