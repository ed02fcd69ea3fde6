//! Solves by a fake solver, for the tests of this crate.

use crate::solve::solver::{Solver, ToolVersions};
use crate::solve::window_solve::WindowSolve;
use hinge::HingeDeformation;
use std::path::Path;

#[path = "../../tests/common/fake_solver.rs"]
mod fake_solver;

use crate::solve::deformation_path::Ray;
use crate::solve::solver::Solve;
use crate::solve::window_solve::WindowProblem;
pub use fake_solver::{FakeSolver, Fault};
use hinge::{HingeConstants, Regime, SheetMaterial};
use mesher::Tier;

/// A ray of the paper's hinge that ends at the rotation `theta` (rad).
pub fn ray_to(theta: f64) -> Ray {
    let design = HingeConstants::PAPER.hinge(18.0, 1.5);
    let end = HingeDeformation::from_eta(-0.1, 0.05, theta, 18.0);
    Ray { design, end }
}

/// The solve of a ray with the fake solver.
pub fn solve_to(theta: f64) -> WindowSolve {
    let film = "name = \"film\"\nthickness = 0.5\nyoung = 3000.0\npoisson = 0.4\n\
        density_kg_m3 = 1390.0\nfracture_strain = 1.784\nplastic = [[44.0, 0.0]]\n";
    let film: SheetMaterial = support::toml_file::parse(film, Path::new("film.toml")).unwrap();
    let problem = WindowProblem::new(ray_to(theta).driven(Regime::Film), &film, Tier::Default);
    WindowSolve::new(problem, &healthy().versions())
}

/// The solve of a ray on the mesh of a tier.
pub fn solve_on(tier: Tier) -> WindowSolve {
    let solve = solve_to(0.5);
    let problem = WindowProblem { tier, ..solve.problem };
    WindowSolve::new(problem, &solve.tools)
}

pub const STIFFNESS: [f64; 3] = [3.0, 5.0, 200.0];

/// A solver without faults.
pub fn healthy() -> FakeSolver<fn(&WindowSolve) -> Option<Fault>> {
    FakeSolver::new(STIFFNESS, |_| None)
}

#[test]
fn the_forces_are_the_gradient_of_the_energy() {
    let (solver, h) = (healthy(), 1e-5);
    let state = [0.3, -0.2, 0.7];
    let forces = solver.sample(1.0, state.into()).forces();
    for (i, force) in forces.into_iter().enumerate() {
        let w = |step: f64| {
            let mut moved = state;
            moved[i] += step;
            solver.sample(1.0, moved.into()).w
        };
        assert!((force - (w(h) - w(-h)) / (2.0 * h)).abs() < 1e-8 * (1.0 + force.abs()));
    }
}

#[test]
fn the_identity_depends_on_every_input() {
    let solve = solve_to(0.5);
    assert_eq!(solve.id(), solve_to(0.5).id());
    let newer = |gmsh: &str, ccx: &str| ToolVersions { gmsh: gmsh.to_owned(), ccx: ccx.to_owned() };
    let mut others = vec![solve_to(0.6), solve_on(Tier::Tiny)];
    others.extend([newer("none", "faker"), newer("other", "fake")].map(|tools| {
        let problem = solve.problem.clone();
        WindowSolve::new(problem, &tools)
    }));
    let vary = |change: &dyn Fn(&mut WindowSolve)| {
        let mut other = solve.clone();
        change(&mut other);
        other
    };
    others.push(vary(&|solve| solve.mesh.layers += 1));
    others.push(vary(&|solve| solve.problem.step.greatest *= 2.0));
    others.push(vary(&|solve| solve.problem.material.young += 1.0));
    let ids: std::collections::BTreeSet<String> =
        others.iter().chain([&solve]).map(WindowSolve::id).collect();
    assert_eq!(ids.len(), 1 + others.len());
}
