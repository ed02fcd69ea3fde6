//! A whole sheet by finite elements, with its files.

use crate::{
    output_file, picture,
    progress::{announce, duration, watched},
    run_folder,
    solves::{Solves, task_error},
};
use anyhow::{Result, anyhow};
use design::pattern::design_vector::DesignVector;
use fe_driver::{CalculiX, SheetSolve, Solve, sheet_reached};
use mesher::{Panels, Tier};
use output::drawing::{Surface, View, surface};
use scene::{Posture, Scene};
use std::{path::Path, sync::atomic::AtomicBool, time::Duration};
use support::memory;
use verification::{SheetCheck, SheetCost, SheetTask, usual_sheet_tier};

/// Width of the pictures (px).
const WIDTH: u32 = 1400;
/// Time limit of the solve.
const LIMIT: Duration = Duration::from_secs(86_400);

/// How a whole sheet is solved.
pub struct WholeSheetTask<'a> {
    /// Mesh tier; `None` for the usual one.
    pub tier: Option<Tier>,
    /// What keeps the panels in their plane; `None` for the posture of the scene.
    pub support: Option<Posture>,
    /// Whether panels deform.
    pub panels: Panels,
    /// Whether the flanks of cuts touch.
    pub contact: bool,
    /// Folder of the files.
    pub out: &'a Path,
    /// What solves it.
    pub solves: Solves<'a>,
}

impl WholeSheetTask<'_> {
    /// Solves the sheet of a design, whose name is for a person, and writes what it found.
    pub fn check(&self, scene: &Scene, design: &DesignVector, name: &str) -> Result<SheetCheck> {
        let tier = self.tier.unwrap_or_else(|| usual_sheet_tier(scene));
        let task = SheetTask::new(scene, design, self.support, tier, self.panels);
        let mut task = task.map_err(task_error)?;
        task.contact = self.contact;
        let calculix = CalculiX::find()?;
        let solve = task.solve(&calculix.versions()).map_err(task_error)?;
        let _held = run_folder::hold(self.out)?;
        state_cost(self.out, &calculix, &solve, self.solves.stop)?;
        let mut service = self.solves.service_of(calculix, self.out, |_, _| {});
        service.limit = LIMIT;
        let folder = service.store.solve(&solve.id());
        let solves = [solve];
        let solved = watched(1, || sheet_reached(&folder), || service.solve(&solves));
        let solved = solved.map_err(|error| task_error(error.into()))?;
        let check = task.check(name, &solved[0]);
        run_folder::write(self.out, "sheet.md", &check.document().markdown())?;
        run_folder::write(self.out, "sheet.json", &serde_json::to_string_pretty(&check)?)?;
        draw(self.out, &scene.config.title, &check)?;
        Ok(check)
    }
}

/// Meshes the sheet once, and says what its solves cost before they begin.
fn state_cost(
    out: &Path,
    calculix: &CalculiX,
    solve: &SheetSolve,
    stop: &AtomicBool,
) -> Result<()> {
    let folder = out.join("mesh");
    output_file::create_folder(&folder)?;
    let limit = Duration::from_secs(600);
    let problem = &solve.problem;
    let mesh = problem.shape.mesh(&folder, &calculix.gmsh, limit, stop)?;
    let cost = SheetCost::of(&mesh, problem.restraint);
    let needed = cost.memory_mib;
    announce(&format!(
        "{} unknowns; about {} of CPU time and {needed:.0} MiB of memory; kept in {}",
        cost.unknowns,
        duration(cost.cpu_seconds),
        out.join("solves").display()
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
fn draw(out: &Path, title: &str, check: &SheetCheck) -> Result<()> {
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
        let svg = surface(&seen, view, title, &subtitle);
        picture::save(&svg, &out.join(format!("sheet-{name}")), WIDTH)?;
    }
    run_folder::write(out, "sheet.vtu", &check.surface.grid().to_vtu())
}
