//! `kirigami verify`: the hinges of a designed sheet solved by finite elements, compared with the
//! surrogate.

mod whole_sheet;

use crate::commands::inspect::scene_args::Inspected;
use crate::commands::solve_args::{SolveArgs, task_error};
use crate::ui::count::count;
use crate::ui::run_folder;
use anyhow::{Context, Result};
use clap::Args;
use design::pattern::design_vector::DesignVector;
use mesher::Tier;
use output::drawing;
use scene::{Posture, Scene};
use serde::Serialize;
use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use support::document::Document;
use surrogate::Surrogate;
use verification::{
    ElementWindows, Replay, SheetErrors, balanced, recorded_paths, verification_tier,
};

/// Solve the hinges of a design by finite elements, along their paths in the sheet
///
/// Compares energy, forces and damage of the surrogate with CalculiX on the same paths, hinge by
/// hinge: how true the weights are where this design goes. Writes replay.md.
/// With --equilibrium the sheet is balanced with the forces of the finite elements: the error of
/// its deployed shape. Writes equilibrium.md. With --sheet the whole sheet is solved: whether its
/// panels stay in their plane, and what that changes. Writes sheet.md. Without --design the design
/// of the scene's run is verified, or the start design if the scene has no run. Example: kirigami
/// verify configs/scenes/demo.toml --equilibrium
#[derive(Args)]
pub struct VerifyCommand {
    #[command(flatten)]
    inspected: Inspected,
    /// Number of hinges to solve, spread evenly over the sheet [default: all]
    #[arg(long, value_name = "N", value_parser = count::<NonZeroUsize>)]
    sample: Option<NonZeroUsize>,
    /// Mesh tier of the windows [default: the tier of the weights' database, or the finer tier that
    /// the database was corrected to; of a whole sheet small, or plate for a plate]; a window of
    /// the tier reference takes two minutes on one core
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    /// Deploy the sheet with finite elements for its hinges, which are solved several times
    #[arg(long, group = "of_sheet", conflicts_with = "sample")]
    equilibrium: bool,
    /// Maximum number of times that all hinges are solved on the mesh of --tier; before `reference`
    /// and `plate-reference` the sheet is balanced on the cheaper `default` and `plate`
    #[arg(long, value_name = "N", default_value_t = 6, requires = "equilibrium", value_parser = count::<usize>)]
    rounds: usize,
    /// Solve the whole sheet, every window and every panel: minutes to an hour. Compares corners,
    /// load, openings and energies, and says whether the panels stay in their plane. Writes
    /// sheet.md, sheet.vtu and pictures from above and from the side. Of the design of a run,
    /// report and page of the run are written again, with what was found
    #[arg(long, group = "of_sheet", conflicts_with = "sample")]
    sheet: bool,
    /// What keeps the panels of the whole sheet in their plane: held-flat, lying (on a table),
    /// hanging, free [default: the posture of the scene]
    #[arg(long, value_name = "SUPPORT", requires = "sheet", value_parser = whole_sheet::support)]
    support: Option<Posture>,
    /// Solve the panel COLUMN,ROW and those around it instead of the whole sheet, for sheets that
    /// are too large; the other panels move as the hinge law predicts
    #[arg(long, value_name = "COLUMN,ROW", requires = "sheet", value_parser = whole_sheet::panel)]
    patch: Option<[usize; 2]>,
    /// The flanks of cuts touch in the whole sheet, in place of passing through each other; several
    /// times the time. Where they meet, the solve may end early
    #[arg(long, requires = "sheet")]
    contact: bool,
    /// Print JSON instead of text
    #[arg(long, requires = "of_sheet")]
    json: bool,
    /// Folder for the tables and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/verify")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

impl VerifyCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, name) = self.inspected.read()?;
        if self.sheet {
            return self.whole_sheet(&scene, &design, &name);
        }
        let surrogate = scene
            .surrogate()
            .context("only a surrogate can be verified: set level = \"standard\" in the scene")?;
        let tier = verification_tier(self.tier, surrogate)?;
        if self.equilibrium {
            self.balance(&scene, &design, name, tier)
        } else {
            self.replay(&scene, &design, &name, surrogate, tier)
        }
    }

    /// The equilibrium with finite elements.
    fn balance(
        &self,
        scene: &Scene,
        design: &DesignVector,
        name: String,
        tier: Tier,
    ) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let service = &self.solve.service(&self.out)?;
        let windows = ElementWindows { tier, service };
        let found = balanced(scene, design, &windows, self.rounds);
        let (found, _) = found.map_err(task_error)?;
        let picture = drawing::deployed(scene, found.by_elements());
        run_folder::write(&self.out, "deployed.svg", &picture)?;
        let budget = found.budget(scene)?;
        let equilibrium = SheetErrors::new(&found, name, budget.as_ref());
        let document = equilibrium.document();
        run_folder::write(&self.out, "equilibrium.md", &document.markdown())?;
        self.print(&equilibrium, &document)
    }

    fn print(&self, found: &impl Serialize, document: &Document) -> Result<()> {
        if self.json {
            println!("{}", serde_json::to_string_pretty(found)?);
        } else {
            self.print_text(document);
        }
        Ok(())
    }

    /// Finite elements along the paths that the hinges have in the sheet by the hinge law.
    fn replay(
        &self,
        scene: &Scene,
        design: &DesignVector,
        name: &str,
        surrogate: &Surrogate,
        tier: Tier,
    ) -> Result<()> {
        let mut paths = recorded_paths(scene, design)?;
        if let Some(sample) = self.sample {
            let (all, sample) = (paths.len(), sample.get());
            let chosen: BTreeSet<usize> = (0..sample).map(|i| i * all / sample).collect();
            paths.retain(|path| chosen.contains(&path.hinge));
        }
        let _held = run_folder::hold(&self.out)?;
        let service = &self.solve.service(&self.out)?;
        let windows = ElementWindows { tier, service };
        let of_design = (paths, name);
        let replay = Replay::new(&windows, of_design, &scene.material, surrogate);
        let replay = replay.map_err(task_error)?;
        let document = replay.document();
        run_folder::write(&self.out, "replay.md", &document.markdown())?;
        self.print_text(&document);
        Ok(())
    }

    fn print_text(&self, document: &Document) {
        println!("{document}\nwritten to {}", self.out.display());
    }
}
