//! Whole runs of small scenes: the outer loop, the learned hinge law, the files and the page of a run.

mod actuation_curve;
mod branches;
mod drawn_loads;
mod findings;
mod learned;
mod outer_loop;
mod results;
mod run_page;
mod sections;

use design::optimise::outer_loop::SearchState;
use design::scene::Scene;
use design::scene::design_run::{Designed, InverseDesignError, inverse_design};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// A 3 x 3 sheet of a film, clamped left and pulled right, with linear hinges.
const SCENE: &str = r#"
title = "Test sheet"
material = "film.toml"
hinge = "linear"
load_steps = 4
output = "run"

[sheet]
size = [1200.0, 1200.0]
panels = [3, 3]

[ligament]
start = 18.0
range = [10.0, 26.0]

[process]
fillet_ratio = 0.16
kerf = 0.2
r_win = 100.0

[linear]
k_a = 400.0
k_s = 250.0
k_theta = 300.0

[[supports]]
panel = [0, 1]
kind = "clamp"

[[loads]]
panel = [2, 1]
force = [2.0, 0.0]

[target.circle]
centre = [700.0, 550.0]
radius = 750.0

[objective]
compression = 0.01

[optimiser]
steps = 25
learning_rate = 0.03
start_noise = 0.05
seed = 3
"#;

const FILM: &str = "name = \"film\"\nthickness = 0.5\nyoung = 3000.0\npoisson = 0.4\n\
    density_kg_m3 = 1390.0\nfracture_strain = 1.784\nplastic = [[44.0, 0.0]]\n";

/// The scene text with replacements, each of which must apply.
fn with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SCENE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

/// Writes scene and material into a folder and reads them.
fn read(folder: &Path, text: &str) -> Scene {
    std::fs::write(folder.join("film.toml"), FILM).unwrap();
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    Scene::read(&path).unwrap()
}

fn run(scene: &Scene, stop_after: Option<usize>) -> Result<Designed, InverseDesignError> {
    let stop = AtomicBool::new(false);
    let mut watch = |search: &SearchState| {
        let record = search.last();
        stop.store(
            stop_after.is_some_and(|step| record.step >= step),
            Ordering::Relaxed,
        );
    };
    inverse_design(scene, &stop, &mut watch)
}
