//! Equilibria and deployments with a closed-form solution.

use crate::prelude::*;
use std::f64::consts::FRAC_PI_4;

/// Moments in equilibrium with the same M_theta at every hinge: the moment on each panel is one
/// M_theta per hinge, with the sign of its ideal rotation. The clamped panel needs none.
pub fn opening_moments(sheet: &Sheet, clamped: usize, m_theta: f64) -> Vec<Load> {
    let mut moments = vec![0.0; sheet.panels.len()];
    for hinge in &sheet.hinges {
        moments[hinge.panel_a()] -= m_theta;
        moments[hinge.panel_b()] += m_theta;
    }
    let moments = moments.into_iter().enumerate();
    let moments = moments.filter(|(panel, _)| *panel != clamped);
    let moments = moments.map(|(panel, value)| load(panel, Dof::Phi, value));
    moments.collect()
}

/// With M_theta = k_theta theta and a = s = 0 at every hinge the ideal deployment is an equilibrium
/// of any pattern, for any k_a and k_s.
#[test]
fn moments_in_balance_open_any_pattern_ideally() {
    let (k_theta, theta, steps) = (0.8, 1.2, 6);
    for name in ["p0_3x3_uniform", "p1_3x3_random", "p2_4x7_random"] {
        let sheet = sheet_of(name);
        let law = uniform([90.0, 40.0, k_theta], &sheet);
        let loads = opening_moments(&sheet, 4, k_theta * theta);
        let path = path(&sheet, &law, &clamp(4), &loads, steps);
        assert_eq!(path.len(), steps);
        for step in &path {
            assert_eq!(step.status, Status::Converged);
            for deformation in &step.deformations {
                assert!(deformation.a.abs().max(deformation.s.abs()) < 1e-9);
                assert_close(deformation.theta, step.load_factor * theta, 1e-9);
            }
            // An error of the opening by 1e-9 changes the energy of every hinge by M_theta times
            // that.
            let hinges = sheet.hinges.len() as f64;
            let stored = 0.5 * k_theta * (step.load_factor * theta).powi(2);
            let total: f64 = step.energies.iter().sum();
            assert_close(total, hinges * stored, hinges * k_theta * theta * 1e-9);
        }
    }
}

/// (6): lambda(theta) = cos(psi - theta/2) / cos(psi), with psi = 45 degrees for square panels.
#[test]
fn the_pitch_of_a_uniform_sheet_follows_its_panel_diagonal() {
    let sheet = sheet_of("p0_3x3_uniform");
    for theta in [0.2, 0.9, 2.0 * FRAC_PI_4, 2.2] {
        let q = ideal_deployment(&sheet, theta);
        let pitch = (FRAC_PI_4 - 0.5 * theta).cos() / FRAC_PI_4.cos();
        for hinge in &sheet.hinges {
            let panels = [hinge.panel_a(), hinge.panel_b()];
            assert_close(apart(&sheet, &q, panels), pitch, 1e-13);
        }
    }
}

#[test]
fn the_response_to_small_loads_is_linear() {
    let sheet = sheet_of("p1_3x3_random");
    let law = uniform(SPRINGS, &sheet);
    let response = |force: f64| {
        let path = path(&sheet, &law, &clamp(3), &[pull(5, force)], 1);
        assert_eq!(path[0].status, Status::Converged);
        path[0].configuration[5][0] / force
    };
    assert_ratio(response(1e-9), response(1e-6), 1e-4);
}
