//! What becomes of a deployed sheet if one thing is not as designed: it is balanced again.

use design::equilibrium::warm_start::WarmStart;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::objective::response::{Conditions, Response};
use design::pattern::design_vector::{DesignVector, WidthChart};
use design::sheet::kinematics::corner_distances;
use scene::placement::seen;
use scene::{Scene, SceneConfig};
use serde::Serialize;
use support::statistics::rms_and_maximum;

/// Relative changes of all stresses, of the thickness and of the loads.
const STRESS: f64 = 0.2;
const THICKNESS: f64 = 0.05;
const LOADS: f64 = 0.1;
/// Change of the width of the ligaments, and distance of a hole from its place (mm).
const WIDTH: f64 = 0.1;
const HOLE: f64 = 0.5;

/// A sheet with one thing changed.
#[derive(Debug, Serialize)]
pub struct WhatIf {
    /// What is changed.
    pub change: String,
    /// How the sheet ends; `None` if no equilibrium is found.
    pub end: Option<ChangedSheet>,
}

/// The end of a sheet with one thing changed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ChangedSheet {
    /// How much of the target is seen, from 0 to 1.
    pub seen: f64,
    /// Distances of the panel corners from the design (mm): root mean square and maximum.
    pub corners: [f64; 2],
    /// Mean opening without and with the change (rad).
    pub openings: [f64; 2],
}

/// A deployed sheet that is changed.
struct Unchanged<'a> {
    scene: &'a Scene,
    problem: &'a DesignProblem,
    design: &'a DesignVector,
    deployment: &'a Deployment,
    /// Its path, from which the changed sheets are corrected.
    known: WarmStart,
}

/// The changes of a design whose fasteners or dead loads open it; none for other sheets.
pub fn what_if(
    scene: &Scene,
    problem: &DesignProblem,
    design: &DesignVector,
    deployment: &Deployment,
) -> Vec<WhatIf> {
    let Some(mechanics) = problem.model.mechanics() else { return Vec::new() };
    let is_mounted = !mechanics.solver.fastened().is_empty();
    if !is_mounted && (!scene.config.has_loads() || scene.config.drive.is_some()) {
        return Vec::new();
    }
    let known = deployment.warm_start();
    let of = Unchanged { scene, problem, design, deployment, known };
    let scaled = |what: &str, part: f64, words: [&str; 2], under: &dyn Fn(f64) -> Conditions| {
        [(words[0], 1.0 - part), (words[1], 1.0 + part)].map(|(word, factor)| {
            let change = format!("{what} {:.0} % {word}", 100.0 * part);
            of.row(change, problem.under(&under(factor)).ok(), design)
        })
    };
    let others = Conditions::default;
    let stresses = scaled("all stresses", STRESS, ["lower", "higher"], &|stress| Conditions {
        stress,
        ..others()
    });
    let thicknesses = scaled("the sheet", THICKNESS, ["thinner", "thicker"], &|thickness| {
        Conditions { thickness, ..others() }
    });
    let cut = stresses.into_iter().chain(thicknesses).chain([of.narrower()]);
    if is_mounted {
        return cut.chain(of.fasteners()).flatten().collect();
    }
    let loads = scaled("the loads", LOADS, ["lower", "higher"], &|factor| {
        let scaled = |load: &[f64; 3]| load.map(|component| factor * component);
        let loads = mechanics.solver.loads().iter().map(scaled).collect();
        Conditions { loads: Some(loads), ..others() }
    });
    loads.into_iter().chain(cut).flatten().collect()
}

impl Unchanged<'_> {
    /// Ligaments that are narrower, as by a wider kerf.
    fn narrower(&self) -> Option<WhatIf> {
        let WidthChart { w_minus, w_plus } = self.problem.widths;
        let mut problem = self.problem.under(&Conditions::default()).ok()?;
        let mut design = self.design.clone();
        problem.widths = WidthChart { w_minus: 0.5 * w_minus, w_plus };
        for (omega, hinge) in design.omega.iter_mut().zip(&self.deployment.sheet.hinges) {
            *omega = problem.widths.omega(hinge.w_lig - WIDTH);
        }
        self.row(format!("all ligaments {WIDTH} mm narrower"), Some(problem), &design)
    }

    /// The first fastener to the side of its place, and without the last one.
    fn fasteners(&self) -> [Option<WhatIf>; 2] {
        let changed = |change: String, edit: fn(&mut SceneConfig)| {
            let mut config = self.scene.config.clone();
            edit(&mut config);
            let problem = self.scene.changed(config).ok().and_then(|scene| scene.problem().ok());
            self.row(change, problem, self.design)
        };
        [
            changed(format!("hole 1 off by {HOLE} mm"), |config| {
                config.supports[0].displacement[0] += HOLE;
            }),
            changed("without the last fastener".to_owned(), |config| {
                config.supports.pop();
            }),
        ]
    }

    /// A changed problem; `None` if the law does not know it.
    fn row(
        &self,
        change: String,
        problem: Option<DesignProblem>,
        design: &DesignVector,
    ) -> Option<WhatIf> {
        let response = problem?.response(design, Some(&self.known)).ok();
        Some(WhatIf { change, end: response.map(|response| self.end(&response)) })
    }

    fn end(&self, response: &Response) -> ChangedSheet {
        let (designed, changed) = (self.deployment.final_step(), response.state());
        let off = corner_distances(
            &response.deployment.sheet,
            &changed.configuration,
            &designed.configuration,
        );
        ChangedSheet {
            seen: seen(self.scene, &response.deployment),
            corners: rms_and_maximum(off),
            openings: [designed, changed].map(|step| step.mean_opening()),
        }
    }
}
