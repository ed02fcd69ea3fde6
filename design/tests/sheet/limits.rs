//! Limits of the ideal deployment and the validity of patterns, for several sizes, outlines, r and
//! tau.

use crate::prelude::*;
use design::geometry::polygon::area;
use design::sheet::topology::Topology;
use design::sheet::validity::overlap;
use std::f64::consts::PI;

#[test]
fn patterns_are_valid_and_open_without_overlap_up_to_the_second_contact() {
    let mut numbers = Random::new(5);
    for (m, n) in [(2, 2), (3, 3), (2, 7), (5, 4), (9, 8)] {
        for size in [0.5, 3.0] {
            let grid = Grid { m, n };
            let pattern = CutPattern::new(grid, TAPERED, &drawn(&mut numbers, grid, size)).unwrap();
            let sheet = Sheet::new(&pattern, &vec![0.02; grid.hinge_count()], AT_CORNER).unwrap();
            let panels: f64 = sheet.panels.iter().map(|panel| panel.area).sum();
            let outline: f64 = sheet.outlines().iter().map(|outline| area(outline)).sum();
            assert!((panels / outline - 1.0).abs() < 1e-13);
            assert!(sheet.panels.iter().all(|panel| panel.area > 0.0));
            assert!(sheet.hinges.iter().all(|hinge| hinge.alpha > 0.0 && hinge.alpha < PI));
            for fraction in [0.0, 0.02, 0.3, 0.6, 0.98] {
                assert!(overlap(&sheet, &ideal_deployment(&sheet, fraction * PI)) < 1e-12);
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
fn the_stretch_of_a_uniform_sheet_is_that_of_equation_six() {
    let square = sheet_of("p0_3x3_uniform");
    for theta in (0..50).map(|i| f64::from(i) * PI / 50.0) {
        let stretch = apart(&square, &ideal_deployment(&square, theta), [3, 5]) / 2.0;
        assert_close(stretch, (0.5 * theta).cos() + (0.5 * theta).sin(), 1e-12);
    }
}
