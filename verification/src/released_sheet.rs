//! An unloaded sheet, with finite elements for its hinges.
//!
//! Every hinge is solved along its path in the deployed sheet, and from there straight to its state
//! without loads by the law of released hinges: it is elastic on the way, and the way does not
//! matter. The deformation at which the law is without forces is moved until the law has the forces
//! of the finite elements there, and the sheet is unloaded again; this is repeated until the panels
//! stay where they are.

use crate::balanced_sheet::{BALANCED, Balanced, size};
use crate::recorded_path::paths_of;
use crate::releases::solved;
use crate::replay::{ElementWindows, SolvedPaths, UnsolvedHinge};
use crate::verification_error::VerificationError;
use design::equilibrium::unloading::ReleasedSheet;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::sheet::kinematics::corner_distances;
use hinge::{HingeDeformation, ReleasedHinge};
use scene::Scene;
use scene::analysis::springback::{ResidualShape, unload};
use serde::Serialize;
use std::array::from_fn;
use support::document::Document;
use support::statistics::rms_and_maximum;
use support::table::Table;
use surrogate::Springback;

/// The results of finite elements for an unloaded sheet.
#[derive(Clone, Debug, Serialize)]
pub struct ReleasedByElements {
    /// Residual opening by the law of released hinges.
    pub by_law: ResidualShape,
    /// Residual opening by finite elements.
    pub by_elements: ResidualShape,
    /// Distance of the panel corners between the two: root mean square and maximum (mm).
    pub corners: [f64; 2],
    /// Largest movement of a panel corner in every round (mm).
    pub movements: Vec<f64>,
    /// Whether the last of them is below [`BALANCED`] times the size of the sheet.
    pub is_balanced: bool,
    /// Largest share of the load that hinges carry without loads, of root mean square forces (F_a,
    /// F_s, M_theta / w_lig): what the hinges do to each other.
    pub own_forces: f64,
    /// Hinges that were not solved in the last round: the law stands for them.
    pub unsolved: Vec<UnsolvedHinge>,
}

/// Lets a balanced sheet go, in at most `rounds` rounds.
pub fn released_by_elements(
    scene: &Scene,
    found: &Balanced,
    problem: &DesignProblem,
    law: &Springback,
    windows: &ElementWindows,
    rounds: usize,
) -> Result<ReleasedByElements, VerificationError> {
    let deployed = found.by_elements();
    let (mut released, by_law) = unload(scene, problem, law, deployed)?;
    let distances = |from: &[[f64; 3]], to: &[[f64; 3]]| {
        rms_and_maximum(corner_distances(&deployed.sheet, from, to))
    };
    let first = released.last().configuration.clone();
    let mut last = first.clone();
    let mut movements = Vec::new();
    let (mut own_forces, mut unsolved) = (0.0, Vec::new());
    for _ in 0..rounds {
        let ends = solved_back(scene, deployed, &released, windows)?;
        unsolved = ends.unsolved;
        let ends = ends.samples.iter();
        let ends: Vec<_> =
            ends.map(|samples| Some(samples.as_ref()?.last()?.forces().to_array())).collect();
        own_forces = share(deployed, found, &ends);
        let states = &released.last().deformations;
        let hinges = (released.hinges.iter().zip(states).zip(&ends))
            .map(|((hinge, state), forces)| {
                // A hinge that was not solved stays as it is.
                let Some(forces) = forces else {
                    return Ok(*hinge);
                };
                let back = solved(hinge.stiffness, *forces).ok_or(VerificationError::NotElastic)?;
                let state = state.to_array();
                let rest = from_fn(|i| state[i] - back[i]);
                Ok(ReleasedHinge { rest: rest.into(), ..*hinge })
            })
            .collect::<Result<_, VerificationError>>()?;
        released = problem.unload(deployed, hinges)?;
        let now = released.last().configuration.clone();
        let [_, movement] = distances(&last, &now);
        movements.push(movement);
        last = now;
        if movement <= BALANCED * size(deployed) {
            break;
        }
    }
    Ok(ReleasedByElements {
        by_elements: ResidualShape::new(problem, deployed, &released)?,
        by_law,
        corners: distances(&first, &last),
        is_balanced: movements.last().is_some_and(|last| *last <= BALANCED * size(deployed)),
        movements,
        own_forces,
        unsolved,
    })
}

/// The states of every hinge by finite elements, along its path in the deployed sheet and back.
fn solved_back(
    scene: &Scene,
    deployed: &Deployment,
    released: &ReleasedSheet,
    windows: &ElementWindows,
) -> Result<SolvedPaths, VerificationError> {
    /// States on the way back, each with the part of the path that a load step has.
    const BACK: usize = 5;
    let mut paths = paths_of(deployed);
    for path in &mut paths {
        let last = released.last();
        let [from, to] = [path.end(), last.deformations[path.hinge]].map(|state| state.to_array());
        path.states.extend((1..=BACK).map(|k| {
            let share = k as f64 / BACK as f64;
            HingeDeformation::from(from_fn(|i| from[i] + share * (to[i] - from[i])))
        }));
    }
    windows.solve(&paths, &scene.material)
}

/// Root mean square of forces over the root mean square of the forces under load.
fn share(deployed: &Deployment, found: &Balanced, forces: &[Option<[f64; 3]>]) -> f64 {
    let designs = deployed.sheet.designs();
    let square = |[a, s, m]: [f64; 3], w: f64| a * a + s * s + (m / w).powi(2);
    let (mut left, mut loaded) = (0.0, 0.0);
    for ((design, forces), end) in std::iter::zip(&designs, forces).zip(&found.hinges) {
        if let (Some(forces), Some(end)) = (forces, end) {
            left += square(*forces, design.w_lig);
            loaded += square(end.forces().to_array(), design.w_lig);
        }
    }
    (left / f64::max(loaded, f64::MIN_POSITIVE)).sqrt()
}

impl ReleasedByElements {
    /// The page of the unloaded sheet.
    pub fn document(&self) -> Document {
        let [law, elements] = [&self.by_law, &self.by_elements];
        let rotations = |stays: &ResidualShape| stays.mean_rotations().map(f64::to_degrees);
        let [loaded, stay] = std::array::from_fn(|i| [law, elements].map(|of| rotations(of)[i]));
        let mut page = Document::default();
        page.heading(1, "The unloaded sheet");
        let mut table = Table::new(["", "by the law", "by finite elements"]);
        let mut row = |what: String, pair: [f64; 2]| {
            let [law, elements] = pair.map(|value| format!("{value:.2}"));
            table.row([what, law, elements]);
        };
        row("mean rotation of the hinges under load, deg".into(), loaded);
        row("mean rotation that stays, deg".into(), stay);
        row(
            "movement of the panel corners, root mean square, mm".into(),
            [law.corners[0], elements.corners[0]],
        );
        if let (Some([_, by_law]), Some([_, by_elements])) =
            (law.displacement, elements.displacement)
        {
            let unit = law.displacement_unit;
            let what = format!("displacement along the loads that stays, {unit}");
            row(what, [by_law, by_elements]);
        }
        page.table(table);
        let [rms, most] = self.corners;
        page.text(format!(
            "Both begin with the sheet under load as finite elements have it, states and forces: what differs is the law of released hinges. It places \
             the corners of the sheet without loads {rms:.2} mm from finite elements (root mean square), at most {most:.2} mm."
        ));
        page.text(format!(
            "Without loads hinges hold each other with {:.0} % of the forces that they had under load.",
            100.0 * self.own_forces
        ));
        let movements = self.movements.iter().map(|movement| format!("{movement:.3}"));
        page.text(format!(
            "Rounds, largest movement of a corner, mm: {}{}",
            movements.collect::<Vec<_>>().join(", "),
            if self.is_balanced { "" } else { " (still moving: use more --rounds)" }
        ));
        page
    }
}
