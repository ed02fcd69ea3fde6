//! Time of one design step of shipped scenes: the path of equilibria, the path with the gradient,
//! and a draft next to a known path, as in the studio. Springs of 7 x 7 and 15 x 10 panels; learned
//! hinges of 3 x 3, 7 x 7 and 16 x 22 panels.

use design::{DesignProblem, DesignVector};
use divan::{Bencher, black_box};
use scene::Scene;
use std::path::Path;

fn main() {
    divan::main();
}

const SCENES: [&str; 5] = ["linear-7x7", "actuation-1", "pet-3x3", "pet-7x7", "pet-bell-16x22"];

fn scene(name: &str) -> (DesignProblem, DesignVector) {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let scene = Scene::read(&configs.join(name).with_extension("toml")).unwrap();
    (scene.problem().unwrap(), scene.start())
}

#[divan::bench(args = SCENES, sample_count = 10, max_time = 10)]
fn equilibria(bencher: Bencher, name: &str) {
    let (problem, design) = scene(name);
    problem.deploy(&design).unwrap().at_full_load().unwrap();
    bencher.bench(|| problem.deploy(black_box(&design)).unwrap());
}

#[divan::bench(args = SCENES, sample_count = 10, max_time = 10)]
fn equilibria_and_gradient(bencher: Bencher, name: &str) {
    let (problem, design) = scene(name);
    bencher.bench(|| problem.evaluate(black_box(&design)).unwrap());
}

/// The equilibrium at full load of a sheet whose ligaments are wider than the ligaments of the
/// sheet whose path is known.
#[divan::bench(args = SCENES, sample_count = 10, max_time = 10)]
fn draft(bencher: Bencher, name: &str) {
    let (problem, design) = scene(name);
    let known = problem.deploy(&design).unwrap().warm_start();
    let mut wider = design;
    wider.omega.iter_mut().for_each(|omega| *omega += 0.02);
    bencher.bench(|| problem.draft(black_box(&wider), Some(&known)).unwrap());
}
