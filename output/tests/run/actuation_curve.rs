//! Load against displacement, and the forces that hold a sheet in its states.

use super::*;
use analysis::actuation_curve::{ActuationCurve, Mover};
use design::equilibrium::load_step::{LoadStep, Status};
use design::objective::design_problem::{Deployment, DesignProblem};

/// The deployment of a scene with another actuation, in many load steps.
fn deployed(actuation: &str) -> (DesignProblem, Deployment) {
    let folder = tempfile::tempdir().unwrap();
    let changes = [(PULL, actuation), ("load_steps = 4", "load_steps = 200")];
    let scene = read(folder.path(), &with(&changes));
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    (problem, deployment)
}

fn curve((problem, deployment): &(DesignProblem, Deployment)) -> Option<ActuationCurve> {
    ActuationCurve::new(problem.model.mechanics().unwrap(), deployment)
}

/// The area below the curve is the energy stored in the hinges, whatever moves the sheet.
#[test]
fn the_work_along_the_curve_is_the_stored_energy() {
    let load = "[[loads]]\npanel = [2, 1]\n";
    let support = "[[supports]]\npanel = [2, 1]\n";
    let corner = "[[loads]]\npanel = [2, 2]\nforce = [0.0, 1.0]\ncouple = 90.0";
    let moved = "kind = \"roller-y\"\ndisplacement = [40.0, 0.0]";
    let turned = "kind = \"clamp\"\nrotation_deg = -15.0";
    for (actuation, mover, translational) in [
        (format!("{load}force = [2.0, 0.0]"), Mover::Loads, true),
        (format!("{load}force = [1.0, 0.0]\n{corner}"), Mover::Loads, true),
        (format!("{load}couple = -300.0"), Mover::Loads, false),
        (format!("{support}{moved}"), Mover::Supports, true),
        (format!("{support}{turned}"), Mover::Supports, false),
    ] {
        let deployed = deployed(&actuation);
        let (curve, deployment) = (curve(&deployed).unwrap(), &deployed.1);
        // A jump past a limit point would dissipate energy.
        let smooth = |step: &LoadStep| step.status == Status::Converged;
        assert!(deployment.path.iter().all(smooth), "{actuation}");
        let found = (curve.mover, curve.translational);
        assert_eq!(found, (mover, translational), "{actuation}");
        assert_eq!((curve.points.len(), curve.points[0]), (201, [0.0; 2]));
        let trapezoids = curve.points.windows(2).map(|ends| {
            let [[x0, p0], [x1, p1]] = [ends[0], ends[1]];
            0.5 * (p0 + p1) * (x1 - x0)
        });
        let work: f64 = trapezoids.sum();
        let stored: f64 = deployment.final_step().energies.iter().sum();
        // The error of the trapezoids decreases with the square of their number.
        assert_close(work / stored, 1.0, 1e-3);
    }
}

/// The holding forces are the loads on free panels, and with the reactions they balance.
#[test]
fn loads_and_reactions_balance() {
    let (problem, deployment) =
        deployed("[[loads]]\npanel = [2, 1]\nforce = [1.2, 0.5]\ncouple = 80.0");
    let (mechanics, sheet) = (problem.model.mechanics().unwrap(), &deployment.sheet);
    let step = &deployment.path[100];
    let law = mechanics.law.prepare(&sheet.designs());
    let hinged = mechanics.hinged(sheet, &*law, false);
    let forces = mechanics.solver.holding_forces(hinged, step.weight, &step.configuration);
    let (mut sum, mut moment) = ([0.0; 2], 0.0);
    for (k, ([x, y, m], [u_x, u_y, _])) in std::iter::zip(&forces, &step.configuration).enumerate()
    {
        let [c_x, c_y] = sheet.panels[k].centroid;
        sum[0] += x;
        sum[1] += y;
        moment += m + (c_x + u_x) * y - (c_y + u_y) * x;
        // Panel 5 is loaded, panel 3 is clamped.
        let expected = match k {
            3 => continue,
            5 => [1.2, 0.5, 80.0].map(|load| step.load_factor * load),
            _ => [0.0; 3],
        };
        for (found, expected) in std::iter::zip([x, y, m], expected) {
            assert_close(*found, expected, 1e-5);
        }
    }
    assert!(sum[0].abs() < 1e-9 && sum[1].abs() < 1e-9 && moment.abs() < 1e-6);
    assert_close(forces[3][0], -1.2 * step.load_factor, 1e-5);
}

#[test]
fn a_sheet_that_nothing_moves_has_no_curve() {
    assert_eq!(curve(&deployed("")), None);
}
