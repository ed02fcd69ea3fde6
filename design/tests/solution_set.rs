//! The curvature of the shape term at the start of a shipped scene.

use design::analysis::solution_set::curvatures;
use design::scene::Scene;
use std::path::Path;

/// A constant added to all logits of an edge changes nothing: there is one flat direction per edge, and at a
/// random pattern no other.
#[test]
fn only_the_shifts_of_the_logits_are_exactly_flat() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes/solutions-7x7.toml");
    let scene = Scene::read(&path).unwrap();
    let values = curvatures(&scene.problem().unwrap(), &scene.start()).unwrap();
    // 36 aspect ratios, 4 edges of 7 intervals, the opening.
    assert_eq!(values.len(), 36 + 28 + 1);
    assert!(values.windows(2).all(|pair| pair[0] >= pair[1]));
    let flat = values.iter().filter(|value| value.abs() < 1e-8 * values[0]);
    assert_eq!(flat.count(), 4, "{values:?}");
}
