//! The start designs of the shipped scenes have the losses, the cut files and the costs of
//! tests/command_line/golden.txt: a change of the code that is not meant to change a design does
//! not, and a path that takes more iterations is seen on any machine. With `KIRIGAMI_WRITE=1` the test writes the file instead, and the commit says why.

use crate::common::Workplace;
use design::geometry::polygon::bounds;
use design::sheet::kinematics::deployed_corners;
use scene::Scene;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Relative difference of a loss that is rounding.
const ROUNDING: f64 = 1e-10;
/// Relative difference of the iterations and factorisations of a path that is not.
const DEARER: f64 = 0.1;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The scenes in a folder, but for the scene of the demo, which reads the weights that the demo
/// trains.
fn scenes(folder: &str) -> Vec<PathBuf> {
    let folder = std::fs::read_dir(root().join(folder)).unwrap();
    let mut scenes: Vec<PathBuf> = folder.map(|file| file.unwrap().path()).collect();
    scenes.retain(|file| !file.ends_with("demo.toml") && file.extension().unwrap() == "toml");
    scenes.sort();
    scenes
}

#[test]
fn losses_and_cut_files_of_the_shipped_scenes_do_not_change() {
    let work = Workplace::new();
    let mut found = String::new();
    for scene in [scenes("configs/scenes"), scenes("configs/examples")].concat() {
        let [iterations, factorisations] = effort(&scene);
        let (name, scene) = (scene.file_stem().unwrap().to_str().unwrap(), scene.display());
        let listing = work.json(&format!("inspect gradient {scene} --design start"));
        work.output(&format!("cut {scene} --design start --out {name} --force"));
        let drawing = std::fs::read(work.path(name).join("cut.dxf")).unwrap();
        let (loss, hash) = (&listing["loss"], blake3::hash(&drawing).to_hex());
        writeln!(found, "{name} {loss} {hash} {iterations} {factorisations}").unwrap();
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
        assert!((loss / expected - 1.0).abs() < ROUNDING, "{found:?} {golden:?}");
        assert_eq!((found[0], found[2]), (golden[0], golden[2]));
        for column in [3, 4] {
            let [count, expected] =
                [&found, &golden].map(|cells| cells[column].parse::<f64>().unwrap());
            assert!((count - expected).abs() <= DEARER * expected, "{found:?} {golden:?}");
        }
    }
}

/// Iterations and factorisations of the path of the start design; zero with pin hinges.
fn effort(scene: &Path) -> [usize; 2] {
    let scene = Scene::read(scene).unwrap();
    let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
    let efforts = || deployment.path.iter().map(|step| step.effort);
    [efforts().map(|it| it.iterations).sum(), efforts().map(|it| it.factorisations).sum()]
}

/// The flat sheet, and the opened one on its target, side by side (SVG).
fn picture(scene: &Path) -> String {
    let scene = Scene::read(scene).unwrap();
    let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
    let sheet = &deployment.sheet;
    let flat = vec![[0.0; 3]; sheet.panels.len()];
    let states = [&flat, &deployment.final_step().configuration];
    let [flat, opened] = states.map(|state| deployed_corners(sheet, state));
    let target = scene.target.points.iter().step_by(4).copied().collect::<Vec<_>>();
    let path = |corners: &[[f64; 2]]| -> String {
        let corners = corners.iter().map(|[x, y]| format!("{x:.1} {:.1}", -y));
        format!("M{}Z", corners.collect::<Vec<_>>().join("L"))
    };
    let panels = |panels: &[[[f64; 2]; 4]]| panels.iter().map(|it| path(it)).collect::<String>();
    let [[x0, y0], [x1, y1]] = bounds([flat.concat(), opened.concat(), target.clone()].concat());
    let [width, height] = [x1 - x0, y1 - y0];
    let (gap, line) = (0.1 * width, 0.004 * width);
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='{x0:.1} {:.1} {:.1} {height:.1}' fill='#dcebea' stroke='#1f2933' \
         stroke-width='{line:.2}' stroke-linejoin='round'><path d='{}'/><g transform='translate({:.1})'><path d='{}'/><path d='{}' \
         fill='none' stroke='#c2410c' stroke-width='{:.2}' stroke-dasharray='{:.1}'/></g></svg>\n",
        -y1,
        2.0 * width + gap,
        panels(&flat),
        width + gap,
        panels(&opened),
        path(&target),
        2.0 * line,
        6.0 * line
    )
}

/// The pictures are written instead with `KIRIGAMI_WRITE=1`.
#[test]
fn the_pictures_of_the_finished_sheets_show_them() {
    for scene in scenes("configs/examples") {
        let file = scene.with_extension("svg");
        let drawn = picture(&scene);
        if std::env::var_os("KIRIGAMI_WRITE").is_some() {
            std::fs::write(&file, &drawn).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&file).unwrap(), drawn, "{}", file.display());
    }
}
