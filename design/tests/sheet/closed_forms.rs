//! Equilibria and deployments with a closed-form solution.

use crate::cases::{self, case};
use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::{LoadStep, Status};
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{HingeLaw, LinearLaw};
use design::sheet::cut_sheet::Sheet;
use design::sheet::ideal_deployment::ideal_deployment;
use std::f64::consts::FRAC_PI_4;

/// Moments in equilibrium with the same M_theta at every hinge: the moment on each panel is one
/// M_theta per hinge, with the sign of its ideal rotation. The clamped panel needs none.
pub fn opening_moments(sheet: &Sheet, clamped: usize, m_theta: f64) -> Vec<Load> {
    let mut moments = vec![0.0; sheet.panels.len()];
    for hinge in &sheet.hinges {
        moments[hinge.panel_a()] -= m_theta;
        moments[hinge.panel_b()] += m_theta;
    }
    let load = |(panel, value)| Load {
        panel,
        dof: Dof::Phi,
        value,
    };
    let moments = moments.into_iter().enumerate();
    moments
        .filter(|(panel, _)| *panel != clamped)
        .map(load)
        .collect()
}

pub fn clamp(panel: usize) -> [Support; 3] {
    Dof::ALL.map(|dof| Support {
        panel,
        dof,
        value: 0.0,
    })
}

pub fn path(
    sheet: &Sheet,
    law: &dyn HingeLaw,
    supports: &[Support],
    loads: &[Load],
    steps: usize,
) -> Vec<LoadStep> {
    let settings = SolverSettings::default();
    let solver = EquilibriumSolver::new(sheet.grid, supports, loads, steps, settings).unwrap();
    let law = law.prepare(&sheet.designs());
    solver.path(HingedSheet {
        sheet,
        law: &*law,
        contact: None,
        damage_gradient: true,
    })
}

/// With M_theta = k_theta theta and a = s = 0 at every hinge the ideal deployment is an equilibrium
/// of any pattern, for any k_a and k_s.
#[test]
fn moments_in_balance_open_any_pattern_ideally() {
    let (k_theta, theta, steps) = (0.8, 1.2, 6);
    for name in ["p0_3x3_uniform", "p1_3x3_random", "p2_4x7_random"] {
        let sheet = cases::sheet(&case(name));
        let law = LinearLaw::uniform([90.0, 40.0, k_theta], sheet.hinges.len());
        let loads = opening_moments(&sheet, 4, k_theta * theta);
        let path = path(&sheet, &law, &clamp(4), &loads, steps);
        assert_eq!(path.len(), steps);
        for step in &path {
            assert_eq!(step.status, Status::Converged);
            for deformation in &step.deformations {
                assert!(deformation.a.abs().max(deformation.s.abs()) < 1e-9);
                assert!((deformation.theta - step.load_factor * theta).abs() < 1e-9);
            }
            // An error of the opening by 1e-9 changes the energy of every hinge by M_theta times that.
            let hinges = sheet.hinges.len() as f64;
            let stored = 0.5 * k_theta * (step.load_factor * theta).powi(2);
            let total: f64 = step.energies.iter().sum();
            assert!((total - hinges * stored).abs() < hinges * k_theta * theta * 1e-9);
        }
    }
}

/// (6): lambda(theta) = cos(psi - theta/2) / cos(psi), with psi = 45 degrees for square panels.
#[test]
fn the_pitch_of_a_uniform_sheet_follows_its_panel_diagonal() {
    let sheet = cases::sheet(&case("p0_3x3_uniform"));
    for theta in [0.2, 0.9, 2.0 * FRAC_PI_4, 2.2] {
        let q = ideal_deployment(&sheet, theta);
        let pitch = (FRAC_PI_4 - 0.5 * theta).cos() / FRAC_PI_4.cos();
        for hinge in &sheet.hinges {
            let centre = |k: usize| [0, 1].map(|c| sheet.panels[k].centroid[c] + q[k][c]);
            let ([ax, ay], [bx, by]) = (centre(hinge.panel_a()), centre(hinge.panel_b()));
            assert!(((bx - ax).hypot(by - ay) - pitch).abs() < 1e-13);
        }
    }
}

#[test]
fn the_response_to_small_loads_is_linear() {
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let law = LinearLaw::uniform([90.0, 40.0, 0.8], sheet.hinges.len());
    let response = |force: f64| {
        let load = Load {
            panel: 5,
            dof: Dof::UX,
            value: force,
        };
        let path = path(&sheet, &law, &clamp(3), &[load], 1);
        assert_eq!(path[0].status, Status::Converged);
        path[0].configuration[5][0] / force
    };
    let (tiny, small) = (response(1e-9), response(1e-6));
    assert!((tiny / small - 1.0).abs() < 1e-4, "{tiny} {small}");
}
