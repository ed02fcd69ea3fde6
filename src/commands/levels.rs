//! `kirigami levels`: what every level of a scene costs, and how far it is from the finest.

use crate::{
    commands::inspect::scene_args::Inspected,
    ui::{interrupt, print_of},
};
use analysis::levels::{LevelCost, Levels, levels};
use anyhow::Result;
use app::{design_checks::record, progress::announce};
use clap::Args;
use support::{
    document::Document,
    table::{Cell, Table},
};

/// Compare the levels of a scene: seconds of a search, and the difference to the finest level
///
/// Deploys the design of the scene's run, or its start design, at every level for which the scene
/// names networks and at those below, and times ten steps of the search at each. The difference to
/// the finest level is the estimate of a level's error. What no level lowers, such as the errors of
/// the mesh and of the material, is listed below the table. `kirigami design --within` chooses the
/// level by itself; docs/CHOOSE.md explains the levels; `kirigami verify` compares the finest one
/// with finite elements. Of the design of a run, report and page of the run are written again, with
/// the table. Example: kirigami levels configs/scenes/a4-plate.toml
#[derive(Args)]
pub struct LevelsCommand {
    #[command(flatten)]
    inspected: Inspected,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

impl LevelsCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, name) = self.inspected.chosen().read()?;
        let stop = interrupt::stop_flag()?;
        let found = levels(&scene, &design, stop, &mut |level| {
            announce(&format!("level {level}"));
        })?;
        print_of(self.json, &name, &found, document(&found))?;
        if self.inspected.chosen().is_run(&scene) {
            record(&scene, &design, |checks| checks.levels = Some(found))?;
        }
        Ok(())
    }
}

fn document(found: &Levels) -> Document {
    let mut table = Table::new([
        "level",
        "step\ns",
        "search\ns",
        "corners, rms\nmm",
        "largest\nmm",
        "load\n%",
        "D_peak\n",
    ]);
    found.levels.iter().for_each(|level| table.row(cells(level)));
    let finest = found.levels.last().map_or("", |level| level.level.name());
    let mut page = Document::default();
    page.table(table);
    page.text(format!(
        "step, search: of the search, at the speed of its first ten steps; corners, load, D_peak: differences to `{finest}`"
    ));
    page.list(found.levels.iter().filter_map(|level| {
        let failure = level.failure.as_ref()?;
        Some(format!("{}: {failure}", level.level))
    }));
    page.list(found.others.iter().map(|other| {
        let corners = other
            .effect
            .as_ref()
            .map_or("not known".into(), |effect| format!("{:.3} mm", effect.corners[1]));
        format!("no level lowers: {}, {corners}", other.cause.name())
    }));
    page
}

fn cells(level: &LevelCost) -> [Cell; 7] {
    let difference = level.difference.as_ref();
    [
        Cell::text(level.level.name()),
        Cell::fixed(level.step, 4),
        Cell::fixed(level.search, 1),
        Cell::fixed(difference.map(|found| found.corners[0]), 3),
        Cell::fixed(difference.map(|found| found.corners[1]), 3),
        Cell::fixed(difference.and_then(|found| found.load).map(|x| 100.0 * x), 2),
        Cell::fixed(difference.and_then(|found| found.damage), 4),
    ]
}
