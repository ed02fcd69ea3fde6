//! The start designs of the shipped scenes have the losses and the cut files of tests/command_line/golden.txt: a change of the code that is
//! not meant to change a design does not. With `KIRIGAMI_WRITE=1` the test writes the file instead, and the commit says why.

use crate::common::Workplace;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Relative difference of a loss that is rounding.
const ROUNDING: f64 = 1e-10;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The shipped scenes, but for the scene of the demo, which reads the weights that the demo trains.
fn scenes() -> Vec<PathBuf> {
    let folder = std::fs::read_dir(root().join("configs/scenes")).unwrap();
    let mut scenes: Vec<PathBuf> = folder.map(|file| file.unwrap().path()).collect();
    scenes.retain(|file| !file.ends_with("demo.toml"));
    scenes.sort();
    scenes
}

#[test]
fn losses_and_cut_files_of_the_shipped_scenes_do_not_change() {
    let work = Workplace::new();
    let mut found = String::new();
    for scene in scenes() {
        let (name, scene) = (
            scene.file_stem().unwrap().to_str().unwrap(),
            scene.display(),
        );
        let listing = work.output(&format!("inspect gradient {scene} --design start --json"));
        let listing: serde_json::Value = serde_json::from_str(&listing).unwrap();
        work.output(&format!("cut {scene} --design start --out {name} --force"));
        let drawing = std::fs::read(work.path(name).join("cut.dxf")).unwrap();
        let (loss, hash) = (&listing["loss"], blake3::hash(&drawing).to_hex());
        writeln!(found, "{name} {loss} {hash}").unwrap();
    }
    let file = root().join("tests/command_line/golden.txt");
    if std::env::var_os("KIRIGAMI_WRITE").is_some() {
        std::fs::write(&file, &found).unwrap();
    }
    let golden = std::fs::read_to_string(&file).unwrap();
    assert_eq!(found.lines().count(), golden.lines().count());
    for (found, golden) in std::iter::zip(found.lines(), golden.lines()) {
        let [found, golden] = [found, golden].map(|line| line.split(' ').collect::<Vec<_>>());
        let [loss, expected] = [&found, &golden].map(|cells| cells[1].parse::<f64>().unwrap());
        assert!(
            (loss / expected - 1.0).abs() < ROUNDING,
            "{found:?} {golden:?}"
        );
        assert_eq!((found[0], found[2]), (golden[0], golden[2]));
    }
}
