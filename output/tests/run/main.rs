//! Whole runs of small scenes: the outer loop, the learned hinge law, the files and the page of a
//! run.

mod actuation_curve;
mod branches;
mod drawn_loads;
mod findings;
mod learned;
mod mounted;
mod outer_loop;
mod results;
mod run_page;
mod sections;

use analysis::refinement::inverse_design;
use design::optimise::outer_loop::SearchState;
use output::report::{Report, Warning};
use output::run_results::write_results;
use scene::design_run::Designed;
use scene::{Level, Scene, SceneConfig};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use support::Fault;
use tempfile::TempDir;
use testkit::derivatives::assert_close;

/// A 3 x 3 sheet of a film, clamped left and pulled right, with linear hinges.
const SCENE: &str = r#"
title = "Test sheet"
material = "film.toml"
level = "linear"
load_steps = 4
output = "run"
sheet = { size = [1200.0, 1200.0], panels = [3, 3] }
ligament = { start = 18.0, range = [10.0, 26.0] }

[process]
fillet_ratio = 0.16
slit_width = 0.2
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

/// Parts of the scene that tests replace.
const SUPPORT: &str = "[[supports]]\npanel = [0, 1]\nkind = \"clamp\"";
const PULL: &str = "[[loads]]\npanel = [2, 1]\nforce = [2.0, 0.0]";
const LAW: &str = "[linear]\nk_a = 400.0\nk_s = 250.0\nk_theta = 300.0";
const TARGET: &str = "[target.circle]\ncentre = [700.0, 550.0]\nradius = 750.0";
/// As few steps as possible.
const QUICK: (&str, &str) = ("steps = 25", "steps = 1");
/// Panels on pins, which nothing holds and loads.
const ON_PINS: [(&str, &str); 5] = [
    ("level = \"linear\"", "level = \"pin\""),
    (LAW, "[pin]\nopening_deg = 30.0"),
    (SUPPORT, ""),
    (PULL, ""),
    ("compression = 0.01", ""),
];

/// The scene text with replacements, each of which must apply.
fn with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SCENE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

/// Writes scene and material into a folder; the path of the scene.
fn written(folder: &Path, text: &str) -> PathBuf {
    std::fs::write(folder.join("film.toml"), FILM).unwrap();
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    path
}

fn read(folder: &Path, text: &str) -> Scene {
    Scene::read(&written(folder, text)).unwrap()
}

/// The message for a scene that is refused.
fn refusal(folder: &Path, text: &str) -> String {
    let refused = Scene::read(&written(folder, text));
    refused.unwrap_err().to_string()
}

/// A scene that was run, and its results.
struct Finished {
    /// Where the scene is; removed with this value.
    folder: TempDir,
    scene: Scene,
    designed: Designed,
    report: Report,
}

impl Finished {
    fn new(text: &str) -> Self {
        Self::within(tempfile::tempdir().unwrap(), text)
    }

    /// The same in a folder with further files, such as weights.
    fn within(folder: TempDir, text: &str) -> Self {
        let scene = read(folder.path(), text);
        Self::of(folder, scene)
    }

    /// A shipped scene after a change, with as few steps as possible.
    fn shipped(name: &str, change: impl Fn(&mut SceneConfig)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = shipped(name, |config| {
            config.optimiser.steps = 1;
            config.output = folder.path().join("run");
            change(config);
        });
        Self::of(folder, scene)
    }

    fn of(folder: TempDir, scene: Scene) -> Self {
        let designed = run(&scene, None).unwrap();
        let report = write_results(&scene, &designed, false).unwrap();
        Self { folder, scene, designed, report }
    }

    /// The text of a file in the run folder.
    fn file(&self, name: &str) -> String {
        std::fs::read_to_string(self.scene.output().join(name)).unwrap()
    }
}

fn shipped(name: &str, change: impl FnOnce(&mut SceneConfig)) -> Scene {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let path = scenes.join(name).with_extension("toml");
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    change(&mut config);
    Scene::new(config, &path).unwrap()
}

/// The value of a fact.
fn value<'a>(report: &'a Report, label: &str) -> &'a serde_json::Value {
    &report.facts.iter().find(|fact| fact.label == label).unwrap().value
}

/// The warnings of one kind.
fn found<'a>(report: &'a Report, concern: &str) -> Vec<&'a Warning> {
    let found = report.warnings.iter();
    found.filter(|warning| warning.concern == concern).collect()
}

/// The only warning of one kind.
#[track_caller]
fn one<'a>(report: &'a Report, concern: &str) -> &'a Warning {
    let [warning] = found(report, concern)[..] else {
        panic!("{concern}: {:?}", report.warnings);
    };
    warning
}

#[track_caller]
fn assert_says(text: &str, part: &str) {
    assert!(text.contains(part), "{part} is not in {text}");
}

/// Runs a scene, which is stopped after a step.
fn run(scene: &Scene, stop_after: Option<usize>) -> Result<Designed, Fault> {
    let stop = AtomicBool::new(false);
    let mut watch = |_: Level, search: &SearchState| {
        let enough = stop_after.is_some_and(|step| search.last().step >= step);
        stop.store(enough, Ordering::Relaxed);
    };
    inverse_design(scene, &stop, &mut watch)
}
