//! Limits of the ideal deployment and the validity of patterns, for several sizes, outlines, r and
//! tau.

use crate::cases;
use crate::prelude::*;
use design::sheet::opening_limits::{CONTACT, Span};
use design::sheet::topology::Topology;
use design::sheet::validity::{Validity, overlap};
use hinge::TrainingDomain;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

fn random(random: &mut Random, grid: Grid, size: f64) -> (CutPattern, Sheet) {
    let pattern = CutPattern::new(grid, TAPERED, &drawn(random, grid, size)).unwrap();
    let sheet = Sheet::new(&pattern, &vec![0.02; grid.hinge_count()], AT_CORNER).unwrap();
    (pattern, sheet)
}

#[test]
fn patterns_are_valid_and_open_without_overlap_up_to_the_second_contact() {
    let mut numbers = Random::new(5);
    for (m, n) in [(2, 2), (3, 3), (2, 7), (5, 4), (9, 8)] {
        for size in [0.5, 3.0] {
            let (pattern, sheet) = random(&mut numbers, Grid { m, n }, size);
            let valid = Validity::new(&pattern, &sheet, None);
            assert!(valid.area_error.abs() < 1e-13 && valid.overlap < 1e-12);
            assert!(valid.least_panel_area > 0.0 && valid.least_void_side > 0.0);
            let [min, max] = valid.alpha_deg;
            assert!(min > 0.0 && max < 180.0);
            for fraction in [0.02, 0.3, 0.6, 0.98] {
                let theta = CONTACT[0] + fraction * (CONTACT[1] - CONTACT[0]);
                assert!(overlap(&sheet, &ideal_deployment(&sheet, theta)) < 1e-12);
            }
            for beyond in [-0.05, PI + 0.05] {
                assert!(overlap(&sheet, &ideal_deployment(&sheet, beyond)) > 0.0);
            }
        }
    }
}

#[test]
fn a_grid_is_the_topology_of_all_its_voids() {
    let grid = Grid { m: 4, n: 3 };
    assert_eq!(Topology::of_voids(grid, &[true; 6]), *Arc::<Topology>::from(grid));
}

/// A panel with a hook around two others.
#[test]
fn a_part_of_a_panel_lies_over_a_panel_that_is_no_neighbour() {
    let grid = Grid { m: 4, n: 2 };
    let coordinates = PatternCoordinates::uniform(grid);
    let pattern = CutPattern::new(grid, Outline::rectangle(4.0, 2.0), &coordinates).unwrap();
    let mut topology = Topology::of_voids(grid, &[true; 3]);
    let hook = [[3.2, 1.2], [3.2, 0.5], [3.6, 0.5], [3.6, 1.4], [0.0, 1.4]];
    let boundary = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.2]].into_iter().chain(hook);
    topology.trims[4] = Some(boundary.collect());
    let sheet = Sheet::of_cells(&pattern, topology.into(), &[0.02; 10], AT_CORNER).unwrap();
    assert_close(overlap(&sheet, &[[0.0; 3]; 8]), 0.2 / 1.15, 1e-6);
}

#[test]
fn the_maximum_stretch_is_that_of_equation_six_and_no_opening_exceeds_it() {
    let square = sheet_of("p0_3x3_uniform");
    for span in Span::of_sheet(&square) {
        assert_close(span.lambda_max, SQRT_2, 1e-12);
        assert_close(span.theta_max, FRAC_PI_2, 1e-12);
    }
    let (_, sheet) = random(&mut Random::new(6), Grid { m: 4, n: 5 }, 1.0);
    for (from, to) in [(0, 19), (3, 16), (8, 11)] {
        let span = Span::between(&sheet, from, to);
        assert_close(span.stretch(span.theta_max), span.lambda_max, 1e-12);
        for i in 0..50 {
            let theta = f64::from(i) * PI / 50.0;
            let q = ideal_deployment(&sheet, theta);
            let stretch = apart(&sheet, &q, [from, to]) / span.flat;
            assert_close(stretch, span.stretch(theta), 1e-12);
            assert!(stretch <= span.lambda_max + 1e-12);
        }
    }
}

/// Neighbouring hinges of a uniform sheet are one pitch apart, their cuts at 90 degrees.
#[test]
fn windows_and_cut_angles_are_compared_with_the_hinges() {
    let pattern = cases::pattern(&case("p0_3x3_uniform"));
    let state = [[-0.1, 0.1], [-0.1, 0.1], [0.0, 1.0]];
    let domain = |alpha, w_lig| TrainingDomain::from_box(state, w_lig, alpha);
    let measured = |r_win: f64, domain: &TrainingDomain| {
        let mut options = AT_CORNER;
        options.process.r_win = r_win;
        let sheet = Sheet::new(&pattern, &[0.1; 12], options).unwrap();
        Validity::new(&pattern, &sheet, Some(domain))
    };
    let trained = domain([1.0, 2.0], [0.05, 0.2]);
    let roomy = measured(0.3, &trained);
    assert_eq!((roomy.crowded_hinges, roomy.untrained_hinges), (0, 0));
    assert_close(roomy.trained_alpha_deg.unwrap()[0], 1.0_f64.to_degrees(), 1e-12);
    assert_eq!(measured(0.8, &trained).crowded_hinges, 12);
    for (alpha, w_lig) in [([1.6, 2.0], [0.05, 0.2]), ([1.0, 2.0], [0.2, 0.3])] {
        assert_eq!(measured(0.3, &domain(alpha, w_lig)).untrained_hinges, 12);
    }
}
