//! `kirigami verify --sheet`: the whole sheet by finite elements.

use crate::{
    commands::{
        solve_args::{FeSolver, task_error},
        verify::VerifyCommand,
    },
    ui::interrupt,
};
use anyhow::{Result, anyhow, ensure};
use app::{
    design_checks::record,
    output_file, picture,
    progress::{announce, duration, watched},
    run_folder,
};
use design::pattern::design_vector::DesignVector;
use fe_driver::{SheetSolve, Solve, sheet_reached};
use mesher::Panels;
use output::drawing::{Surface, View, surface};
use scene::{Posture, Scene};
use std::time::Duration;
use support::memory;
use verification::{SheetCheck, SheetCost, SheetTask, usual_sheet_tier};

/// Width of the pictures (px).
const WIDTH: u32 = 1400;
/// Time limit of the solve.
const LIMIT: Duration = Duration::from_secs(86_400);

/// Reads the value of `--support`.
pub(super) fn support(text: &str) -> Result<Posture, String> {
    serde_json::from_value(text.into())
        .map_err(|_| "choose held-flat, mounted, lying, hanging or free".to_owned())
}

/// Reads the value of `--sheet`.
pub(super) fn panels(text: &str) -> Result<Panels, String> {
    serde_json::from_value(text.into()).map_err(|_| "choose rigid or meshed".to_owned())
}

impl VerifyCommand {
    /// Solves the whole sheet, and writes what it found.
    pub(super) fn whole_sheet(
        &self,
        scene: &Scene,
        design: &DesignVector,
        name: &str,
        panels: Panels,
    ) -> Result<()> {
        let tier = self.tier.unwrap_or_else(|| usual_sheet_tier(scene));
        let task = SheetTask::new(scene, design, self.support, tier, panels);
        let mut task = task.map_err(task_error)?;
        task.contact = self.contact;
        let calculix = FeSolver::find()?;
        let solve = task.solve(&calculix.versions()).map_err(task_error)?;
        let _held = run_folder::hold(&self.out)?;
        self.state_cost(&calculix, &solve)?;
        let mut service = self.solve.service_of(calculix, &self.out, |_, _| {})?;
        service.limit = LIMIT;
        let folder = service.store.solve(&solve.id());
        let solves = [solve];
        let solved = watched(1, || sheet_reached(&folder), || service.solve(&solves));
        let solved = solved.map_err(|error| task_error(error.into()))?;
        let check = task.check(name, &solved[0]);
        let document = check.document();
        run_folder::write(&self.out, "sheet.md", &document.markdown())?;
        let json = serde_json::to_string_pretty(&check)?;
        run_folder::write(&self.out, "sheet.json", &json)?;
        self.draw(scene, &check)?;
        self.print(&check, &document)?;
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

    /// Meshes the sheet once, and says what its solves cost before they begin.
    fn state_cost(&self, calculix: &FeSolver, solve: &SheetSolve) -> Result<()> {
        let folder = self.out.join("mesh");
        output_file::create_folder(&folder)?;
        let limit = Duration::from_secs(600);
        let stop = interrupt::stop_flag()?;
        let problem = &solve.problem;
        let mesh = problem.shape.mesh(&folder, &calculix.gmsh, limit, stop)?;
        let cost = SheetCost::of(&mesh, problem.restraint);
        let needed = cost.memory_mib;
        announce(&format!(
            "{} unknowns; about {} of CPU time and {needed:.0} MiB of memory; kept in {}",
            cost.unknowns,
            duration(cost.cpu_seconds),
            self.out.join("solves").display()
        ));
        match memory::available_mib() {
            Some(available) if needed > available => Err(anyhow!(
                "the solve needs about {needed:.0} MiB of memory, and {available:.0} MiB are available: use a coarser --tier, or \
                 rigid panels"
            )),
            _ => Ok(()),
        }
    }

    /// Pictures and the ParaView file of the end of the path.
    fn draw(&self, scene: &Scene, check: &SheetCheck) -> Result<()> {
        let Some(last) = check.last() else {
            return Ok(());
        };
        let (points, tilts) = (check.surface.deformed(), check.surface.tilts_deg());
        let seen = Surface {
            points: &points,
            faces: &check.surface.faces,
            values: &tilts,
            // Ligaments twist by more than the panels tilt.
            largest: last.tilt_deg,
            name: "tilt (deg)",
        };
        let subtitle = format!(
            "By finite elements, at {:.0} % of the path; panels tilt by up to {:.2}\u{b0}",
            100.0 * last.fraction,
            last.tilt_deg
        );
        for (view, name) in [(View::Above, "above"), (View::Front, "front"), (View::Side, "side")] {
            let svg = surface(&seen, view, &scene.config.title, &subtitle);
            picture::save(&svg, &self.out.join(format!("sheet-{name}")), WIDTH)?;
        }
        run_folder::write(&self.out, "sheet.vtu", &check.surface.grid().to_vtu())
    }
}
