//! Drawings with holes as targets.

use crate::shipped;
use design::geometry::plane::{complex, point};
use design::geometry::polygon::distance_to_outline;
use design::geometry::similarity::Similarity;
use faer::c64;
use scene::target::{Target, TargetShape};
use scene::{Scene, SceneConfig};
use std::path::Path;

/// A letter of 100 x 100; its hole is a triangle of 24 x 36.
const LETTER: &str = "<svg xmlns='http://www.w3.org/2000/svg'>\
    <path d='M0 100L36 0H64L100 100H74L68 80H32L26 100ZM38 60L50 24L62 60Z'/></svg>";

fn drawn(folder: &Path, name: &str, text: &str) -> TargetShape {
    std::fs::write(folder.join(name), text).unwrap();
    TargetShape::Svg {
        file: folder.join(name),
        centre: [0.0; 2],
        height: Some(100.0),
        rotation_deg: 0.0,
    }
}

fn sampled(shape: &TargetShape) -> Target {
    Target::sample(shape, Path::new(""), 1000).unwrap()
}

#[test]
fn a_letter_keeps_its_hole_where_it_is_placed() {
    let folder = tempfile::tempdir().unwrap();
    let shape = drawn(folder.path(), "letter.svg", LETTER);
    let letter = sampled(&shape);
    assert_eq!(letter.holes.len(), 1);
    let region = letter.region();
    assert!((region.area() - letter.area()).abs() < 1.0);
    assert!(region.contains([0.0, -20.0]) && !region.contains([0.0, 0.0]));
    let place = Similarity { turn: c64::cis(0.4) * 1.7, shift: c64::new(30.0, -12.0) };
    let moved = sampled(&shape.clone().placed(&place, &letter.points));
    for corner in &letter.holes[0] {
        let expected = point(place.of(complex(*corner)));
        assert!(distance_to_outline(expected, &moved.holes[0]) < 0.01);
    }
    // Without the hole it is another target.
    let filled = LETTER.replace("M38 60L50 24L62 60Z", "");
    let filled = sampled(&drawn(folder.path(), "filled.svg", &filled));
    assert_eq!(filled.points, letter.points);
    assert!((filled.area() - letter.area() - 432.0).abs() < 1e-3);
    assert_ne!(filled.hash(), letter.hash());
}

#[test]
fn a_ring_of_a_dxf_file_has_its_area() {
    let folder = tempfile::tempdir().unwrap();
    let circle = |radius: u32| format!("0 CIRCLE 10 5 20 5 40 {radius} ");
    let all = format!("0 SECTION 2 ENTITIES {}{}0 ENDSEC 0 EOF", circle(20), circle(50));
    let ring = sampled(&drawn(folder.path(), "ring.dxf", &all.replace(' ', "\n")));
    let expected = std::f64::consts::PI * (2500.0 - 400.0);
    assert!((ring.area() / expected - 1.0).abs() < 1e-3, "{}", ring.area());
}

#[test]
fn a_rectangle_of_panels_says_that_it_fills_the_holes() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::read(&shipped("linear-7x7.toml")).unwrap();
    let [low, high] = design::geometry::polygon::bounds(scene.target.points.iter().copied());
    let mut target = drawn(folder.path(), "letter.svg", LETTER);
    if let TargetShape::Svg { height, .. } = &mut target {
        *height = Some(high[1] - low[1]);
    }
    let config = SceneConfig { target, ..scene.config.clone() };
    let notes = scene.changed(config).unwrap().target.notes;
    assert!(notes[0].contains("fills its holes"), "{notes:?}");
}
