//! How a sheet is mounted on a board: opened evenly by hand and released, then fastened in the order
//! of the supports of its scene.
//!
//! An opened sheet springs back, and its hinges are elastic about the residual opening. So the way
//! of a hole to its place is short, and no ligament is far from its state in the opened sheet.

use crate::springback::ReleasedSheet;
use design::equilibrium::load_step::{LoadStep, Status};
use design::geometry::polygon::bounds;
use design::hinge_law::{DamageMeasure, Order, PreparedLaw, ReleasedLaw};
use design::objective::design_problem::{Deployment, DesignProblem};
use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::{Configuration, corner_distances, deployed, deployed_boundaries};
use hinge::SheetMaterial;
use scene::placement::placed;
use scene::{Posture, Scene};
use serde::Serialize;
use std::collections::BTreeSet;

/// Border of a board around the opened sheet, and the length to which its size is rounded (mm).
const BORDER: f64 = 20.0;
const ROUND: f64 = 10.0;
/// Factor by which the pressure on the edge of a hole stays below the stress at which the material
/// yields.
const SAFETY: f64 = 2.0;

/// Residual opening over the opening up to which a released sheet is flat again.
const FLAT: f64 = 0.01;

/// The fasteners of a mounted sheet in the order in which they are put in.
#[derive(Clone, Debug)]
pub struct Mounting {
    /// Up to the first whose hole does not reach its place.
    pub fasteners: Vec<Fastener>,
    /// Number of fasteners.
    pub count: usize,
    /// Largest distance of a panel corner from where the sheet ends if all holes move at once (mm);
    /// infinite if a hole does not reach its place.
    pub apart: f64,
    /// The motions of the panels of the opened sheet on the board.
    pub opened: Configuration,
    /// How the sheet is opened before; `None` for elastic hinges, which pull it flat again.
    pub by_hand: Option<ByHand>,
}

/// The sheet is opened evenly and released.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ByHand {
    /// Mean rotation of the hinges in the opened sheet (rad).
    pub opened: f64,
    /// Mean rotation that stays (rad).
    pub stays: f64,
    /// Largest moment of a hinge of the opened sheet (N mm).
    pub moment: f64,
}

/// A fastener of a mounted sheet.
#[derive(Clone, Debug, Serialize)]
pub struct Fastener {
    /// Index of its panel.
    pub panel: usize,
    /// Diameter of its hole (mm).
    pub hole: Option<f64>,
    /// Its place on the board, where the opened sheet is (mm).
    pub place: [f64; 2],
    /// Length of the way of its hole to that place when it is put in (mm).
    pub way: f64,
    /// Largest force of the hand on that way (N).
    pub pull: f64,
    /// Force that it holds in the end (N).
    pub holds: f64,
    /// Largest peak damage of a hinge on that way; `None` if a state is outside the training domain,
    /// or if the law predicts no damage.
    pub damage: Option<f64>,
    /// Number of hinges that leave the training domain on that way.
    pub outside: usize,
    /// The motions of the panels when it is put in.
    #[serde(skip)]
    pub sheet: Configuration,
}

/// The force on the edge of a hole of some diameter (mm) that a sheet bears (N).
pub fn borne_by_hole(material: &SheetMaterial, diameter: f64) -> f64 {
    material.plastic[0][0] * material.thickness * diameter / SAFETY
}

impl Mounting {
    /// The mounting of a deployed sheet of a scene; `None` unless the scene says that it is mounted
    /// and only fasteners open it.
    pub fn new(scene: &Scene, problem: &DesignProblem, deployment: &Deployment) -> Option<Self> {
        let mechanics = problem.model.mechanics()?;
        let is_mounted = scene.config.posture?.kind == Posture::Mounted;
        if !is_mounted || mechanics.solver.fastened().is_empty() {
            return None;
        }
        let sheet = &deployment.sheet;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(sheet, &*law, false);
        let last = deployment.at_full_load().ok()?;
        let end = &last.configuration;
        let reactions = mechanics.solver.reactions(hinged, end);
        let attachments = mechanics.solver.attachment_points();
        let on_board = placed(scene, sheet, end);
        let free = ReleasedSheet::new(scene, mechanics, deployment).ok()?;
        let (released, rest) = (ReleasedLaw(&free.hinges), &free.end().configuration);
        let released = mechanics.hinged(sheet, &released, false);
        let steps = mechanics.solver.mounted(released, rest).ok()?;
        let count = mechanics.solver.fastened().len();
        let apart = steps.last().filter(|last| steps.len() == count && reaches(&last.path));
        let apart = apart.map_or(f64::INFINITY, |last| {
            corner_distances(sheet, &last.end, end).into_iter().fold(0.0, f64::max)
        });
        let fasteners = steps.into_iter().map(|step| {
            let panel = step.panel;
            let [x, y, _] = reactions[panel];
            let (outside, damage) = on_the_way(&*law, &step.path);
            let place =
                deployed(&sheet.panels[panel], on_board[panel], sheet.panels[panel].reference);
            Fastener {
                panel,
                hole: attachments.iter().find(|at| at.panel == panel).and_then(|at| at.hole),
                place,
                way: step.way,
                pull: step.force,
                holds: x.hypot(y),
                damage,
                outside,
                sheet: step.end,
            }
        });
        let fasteners = fasteners.collect();
        let [opened, stays] = [last, free.end()].map(LoadStep::mean_opening);
        let moments = law.energies(&last.deformations, Order::Forces).into_iter();
        let moment = moments.fold(0.0, |most, hinge| f64::max(most, hinge.forces[2].abs()));
        let by_hand = (stays > FLAT * opened).then_some(ByHand { opened, stays, moment });
        Some(Self { fasteners, count, apart, opened: on_board, by_hand })
    }

    /// Width and height of the smallest board behind the opened sheet (mm).
    pub fn board(&self, sheet: &Sheet) -> [f64; 2] {
        let [low, high] = bounds(deployed_boundaries(sheet, &self.opened).concat());
        [0, 1].map(|axis| ROUND * ((high[axis] - low[axis] + 2.0 * BORDER) / ROUND).ceil())
    }

    /// Whether every hole reaches its place.
    pub fn is_complete(&self) -> bool {
        self.apart.is_finite()
    }
}

fn reaches(path: &[LoadStep]) -> bool {
    path.last().is_none_or(|last| last.status != Status::Diverged)
}

/// Number of hinges outside the training domain on a way, and if there are none the largest peak
/// damage there; `None` for a law that predicts none.
fn on_the_way(law: &dyn PreparedLaw, path: &[LoadStep]) -> (usize, Option<f64>) {
    let (mut outside, mut most) = (BTreeSet::new(), Some(0.0));
    for LoadStep { deformations, .. } in path {
        let inside = law.inside(deformations).into_iter().enumerate();
        outside.extend(inside.filter(|(_, inside)| !inside).map(|(hinge, _)| hinge));
        let damage = law.damage(deformations, false).into_iter();
        let peaks = damage.map(|it| DamageMeasure::Peak.known(&it).unwrap_or(it.d));
        most = peaks.reduce(f64::max).zip(most).map(|(peak, most)| f64::max(peak, most));
    }
    (outside.len(), most.filter(|_| outside.is_empty()))
}
