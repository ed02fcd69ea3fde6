//! `kirigami verify`: a designed sheet by finite elements.

use crate::{
    commands::{inspect::scene_args::Inspected, pipeline::solve_args::SolveArgs},
    ui::{self, count::count},
};
use anyhow::{Context, Result, ensure};
use app::{design_checks::record, run_folder, solves::task_error, whole_sheet::WholeSheetTask};
use clap::Args;
use design::pattern::design_vector::DesignVector;
use mesher::{Panels, Tier};
use output::drawing;
use scene::{Posture, Scene};
use serde::{Serialize, de::DeserializeOwned};
use std::path::PathBuf;
use support::document::Document;
use verification::{ElementWindows, SheetErrors, balanced, verification_tier};

/// Compare a design with finite elements
///
/// --equilibrium solves the hinges along their paths in the sheet, and balances the sheet with their
/// forces: the error of its deployed shape. Writes equilibrium.md. --sheet solves the whole sheet:
/// whether its panels stay in their plane, and what that changes. Writes sheet.md. Without --design
/// the design of the scene's run is verified, or the start design if the scene has no run. Example:
/// kirigami verify configs/scenes/a4-plate.toml --equilibrium
#[derive(Args)]
pub(crate) struct VerifyCommand {
    #[command(flatten)]
    inspected: Inspected,
    /// Mesh tier of the windows [default: the tier of the weights' database, or the finer tier that
    /// the database was corrected to; of a whole sheet small, or plate for a plate]; a window of
    /// the tier reference takes two minutes on one core
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    /// Deploy the sheet with finite elements for its hinges, which are solved several times
    #[arg(long, group = "mode", required_unless_present = "sheet")]
    equilibrium: bool,
    /// Maximum number of times that all hinges are solved on the mesh of --tier; before `reference`
    /// and `plate-reference` the sheet is balanced on the cheaper `default` and `plate`
    #[arg(long, value_name = "N", default_value_t = 6, requires = "equilibrium", value_parser = count::<usize>)]
    rounds: usize,
    /// Solve the whole sheet: minutes. Panels are `rigid`, and only the windows of the hinges
    /// deform; or `meshed`: everything deforms, in up to ten times the time. Compares corners, load,
    /// openings, energies and forces of supports, and reports whether the panels stay in their plane.
    /// Writes sheet.md, sheet.vtu and pictures from above and from the side. Rewrites report and
    /// page of the run with what was found
    #[arg(long, value_name = "PANELS", group = "mode", num_args = 0..=1, default_missing_value = "rigid", value_parser = named::<Panels>)]
    sheet: Option<Panels>,
    /// What keeps the panels of the whole sheet in their plane: held-flat, mounted (on a board),
    /// lying (on a table; meshed panels), hanging, free [default: the posture of the scene]
    #[arg(long, value_name = "SUPPORT", requires = "sheet", value_parser = named::<Posture>)]
    support: Option<Posture>,
    /// The flanks of cuts touch in the whole sheet of meshed panels, instead of passing through each
    /// other; several times the time. Where they meet, the solve may end early
    #[arg(long, requires = "sheet")]
    contact: bool,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
    /// Folder for the tables and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/verify")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

impl VerifyCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, name) = self.inspected.chosen().read()?;
        if let Some(panels) = self.sheet {
            return self.whole_sheet(&scene, &design, &name, panels);
        }
        let surrogate = scene
            .surrogate()
            .context("only a surrogate can be verified: set level = \"standard\" in the scene")?;
        let tier = verification_tier(self.tier, surrogate)?;
        let _held = run_folder::hold(&self.out)?;
        let service = &self.solve.solves()?.service(&self.out)?;
        let windows = ElementWindows { tier, service };
        let found = balanced(&scene, &design, &windows, self.rounds);
        let (found, _) = found.map_err(task_error)?;
        let picture = drawing::deployed(&scene, found.by_elements());
        run_folder::write(&self.out, "deployed.svg", &picture)?;
        let budget = found.budget(&scene)?;
        let equilibrium = SheetErrors::new(&found, name, budget.as_ref());
        let document = equilibrium.document();
        run_folder::write(&self.out, "equilibrium.md", &document.markdown())?;
        self.print(&equilibrium, &document)
    }

    /// Solves the whole sheet, and says what it found.
    fn whole_sheet(
        &self,
        scene: &Scene,
        design: &DesignVector,
        name: &str,
        panels: Panels,
    ) -> Result<()> {
        let sheet = WholeSheetTask {
            tier: self.tier,
            support: self.support,
            panels,
            contact: self.contact,
            out: &self.out,
            solves: self.solve.solves()?,
        };
        let check = sheet.check(scene, design, name)?;
        self.print(&check, &check.document())?;
        if let Some(found) = check.summary().filter(|_| self.inspected.chosen().is_run(scene)) {
            record(scene, design, |checks| checks.whole_sheet = Some(found))?;
        }
        ensure!(
            !check.path.is_empty(),
            "no increment of the sheet converged; see {}",
            self.out.display()
        );
        Ok(())
    }

    fn print(&self, found: &impl Serialize, document: &Document) -> Result<()> {
        let text = format!("{document}\nwritten to {}", self.out.display());
        ui::print(self.json, found, text)
    }
}

/// Reads a value by its name in a scene.
fn named<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_value(text.into()).map_err(|error| error.to_string())
}
