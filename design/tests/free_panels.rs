//! Free panel corners against the charts, on the shipped scene of section 3.1.

use design::free_panels::{Enforcement, FreePanels};
use design::kinematics::deployed_corners;
use design::scene::Scene;
use std::path::Path;

fn scene() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes/pin-7x7.toml");
    let mut scene = Scene::read(&path).unwrap();
    // Any deployable pattern.
    scene.config.optimiser.start_noise = 0.5;
    scene
}

/// Where the pattern is deployable, equal springs have nothing to pull.
#[test]
fn a_deployable_pattern_deploys_as_its_mechanism() {
    let scene = scene();
    let (problem, start) = (scene.problem().unwrap(), scene.start());
    let opening = start.opening.unwrap();
    let free = FreePanels::new(&problem, &start, opening, Enforcement::Tiling).unwrap();
    assert_eq!(free.coordinates(), 392 + 1);
    let found = free.search(0, 0.01);
    let defects = found.tessellation.defects();
    assert!(defects.gap.iter().all(|gap| *gap < 1e-14), "{defects:?}");
    assert!(defects.overlap.iter().all(|overlap| *overlap < 1e-14));
    assert!(defects.void < 1e-14);

    let deployment = problem.deploy(&start).unwrap();
    let exact = deployed_corners(&deployment.sheet, &deployment.final_step().configuration);
    let corner = |panels: &[[[f64; 2]; 4]]| panels[0][0];
    let shift =
        [0, 1].map(|axis| corner(&exact)[axis] - corner(&found.tessellation.deployed)[axis]);
    for (exact, found) in std::iter::zip(&exact, &found.tessellation.deployed) {
        for (exact, found) in std::iter::zip(exact, found) {
            for axis in 0..2 {
                assert!((exact[axis] - found[axis] - shift[axis]).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn what_is_enforced_holds_better_than_what_is_not() {
    let scene = scene();
    let (problem, start) = (scene.problem().unwrap(), scene.start());
    let run = |enforcement| {
        let opening = start.opening.unwrap();
        let free = FreePanels::new(&problem, &start, opening, enforcement).unwrap();
        let found = free.search(15, 0.005);
        let least = found.losses.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least < 0.9 * found.losses[0], "{enforcement:?}");
        found.tessellation.defects()
    };
    let torn = run(Enforcement::Nothing);
    let joined = run(Enforcement::Projection);
    assert!(torn.gap[0] > 0.01, "{torn:?}");
    assert!(joined.gap[0] < 1e-14, "{joined:?}");
    assert!(joined.overlap[0] < torn.overlap[0]);
}
