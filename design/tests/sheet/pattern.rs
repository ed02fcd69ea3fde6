//! Patterns, panels, hinges and ideal deployments against an independent implementation.

use crate::cases;
use crate::prelude::*;
use serde_json::Value;

const PATTERNS: [&str; 3] = ["p0_3x3_uniform", "p1_3x3_random", "p2_4x7_random"];

#[test]
fn charts_and_cut_endpoints() {
    for name in PATTERNS {
        let case = case(name);
        let pattern = cases::pattern(&case);
        let (r, tau): (Vec<f64>, [Vec<f64>; 4]) = (get(&case, "r"), get(&case, "tau"));
        let found = pattern.r.iter().chain(pattern.tau.iter().flatten());
        for (found, expected) in found.zip(r.iter().chain(tau.iter().flatten())) {
            assert_close(*found, *expected, 1e-14);
        }
        let x: Vec<[f64; 2]> = get(&case, "points_x");
        let x_prime: Vec<[f64; 2]> = get(&case, "points_xp");
        let pairs = std::iter::zip(x, x_prime);
        let expected: Vec<[f64; 2]> = pairs.flat_map(|(x, xp)| [x, xp]).collect();
        assert!(difference(&pattern.points, &expected) < 1e-12);
    }
}

#[test]
fn panels_and_hinges() {
    for name in PATTERNS {
        let case = case(name);
        let sheet = cases::sheet(&case);
        let corners: Vec<[[f64; 2]; 4]> = get(&case, "panel_corners");
        let centroids: Vec<[f64; 2]> = get(&case, "panel_centroid");
        let areas: Vec<f64> = get(&case, "panel_area");
        for (k, panel) in sheet.panels.iter().enumerate() {
            assert!(difference(&panel.corners, &corners[k]) < 1e-12);
            assert!(difference(&[panel.centroid], &[centroids[k]]) < 1e-12);
            assert_close(panel.area, areas[k], 1e-12);
        }
        let hinges: Vec<Value> = get(&case, "hinges");
        assert_eq!(sheet.hinges.len(), hinges.len());
        for (hinge, expected) in std::iter::zip(&sheet.hinges, &hinges) {
            let endpoint: String = get(expected, "endpoint");
            let corner = |keys: [&str; 2]| keys.map(|key| get::<usize>(expected, key));
            assert_eq!(hinge.site.vertex, get::<[usize; 2]>(expected, "vertex"));
            assert_eq!(hinge.site.endpoint == Endpoint::XPrime, endpoint == "x'");
            assert_eq!(hinge.site.a, corner(["k", "corner_k"]).into());
            assert_eq!(hinge.site.b, corner(["l", "corner_l"]).into());
            for (found, key) in
                [(hinge.corner, "position"), (hinge.e_sec, "e_sec"), (hinge.main, "m_hat")]
            {
                assert!(difference(&[found], &[get(expected, key)]) < 1e-12, "{key}");
            }
            assert_close(hinge.alpha, get(expected, "alpha"), 1e-12);
        }
    }
}

#[test]
fn ideal_deployments_and_outlines() {
    for name in PATTERNS {
        let case = case(name);
        let sheet = cases::sheet(&case);
        for expected in get::<Vec<Value>>(&case, "deployments") {
            let theta = get::<f64>(&expected, "theta_deg").to_radians();
            let configuration = ideal_deployment(&sheet, theta);
            assert!(difference(&configuration, &get::<Vec<_>>(&expected, "q")) < 1e-12);
            for deformation in hinge_deformations(&sheet, &configuration) {
                assert!(deformation.a.abs().max(deformation.s.abs()) < 1e-12);
                assert_close(deformation.theta, theta, 1e-12);
            }
            let all: Vec<(usize, usize)> = get(&expected, "outline_panel_corner");
            let free: Vec<(usize, usize)> = get(&expected, "outline_free_panel_corner");
            assert_eq!(sheet.outline_corners(), all);
            assert_eq!(sheet.free_outline_corners(), free);
            let vertex = |&(k, corner): &(usize, usize)| {
                let panel = &sheet.panels[k];
                deployed(panel, configuration[k], panel.corners[corner])
            };
            let vertices: Vec<[f64; 2]> = all.iter().map(vertex).collect();
            assert!(difference(&vertices, &get::<Vec<_>>(&expected, "outline_vertices")) < 1e-12);
        }
    }
}
