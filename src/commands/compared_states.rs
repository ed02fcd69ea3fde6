//! Parity charts of values and their finer reference values.

use crate::ui::{charts, picture};
use anyhow::Result;
use dataset::{COMPARED, ComparedState};
use std::path::Path;

/// Draws every state, one chart per known quantity; `axes` names the reference and the evaluated
/// values.
pub fn draw(groups: &[&[ComparedState]], axes: [&str; 2], stem: &Path) -> Result<()> {
    let svg = charts::parity(&groups.concat(), COMPARED, axes)?;
    picture::save(&svg, stem, 2000)?;
    Ok(())
}
