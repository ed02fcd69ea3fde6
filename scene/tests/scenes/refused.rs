//! Shipped scenes are read; invalid scenes give a message with the key and the reason.

use crate::shipped;
use scene::target::TARGET_POINTS;
use scene::{Scene, SceneConfig};

/// Fails unless a copy of a shipped scene is refused after each change of a table. A row has the
/// text of the scene, without comments, what stands in its place, and a part of the message; `|` is
/// a line break of the scene.
fn assert_refused(name: &str, table: &str) {
    let scene = std::fs::read_to_string(shipped(name)).unwrap();
    let bare = |line: &str| line.split(" #").next().unwrap().trim_end().to_owned();
    let scene = scene.lines().map(bare).collect::<Vec<_>>().join("\n");
    let folder = tempfile::tempdir().unwrap();
    for part in ["materials", "scenes"] {
        std::fs::create_dir(folder.path().join(part)).unwrap();
    }
    let film = "materials/pet-0.5mm.toml";
    std::fs::copy(shipped("..").join(film), folder.path().join(film)).unwrap();
    let path = folder.path().join("scenes").join(name);
    for row in table.trim().lines() {
        let cells = row.split(" => ").map(|cell| cell.trim().replace('|', "\n"));
        let cells: Vec<String> = cells.collect();
        let [from, to, expected] = &cells[..] else {
            panic!("{row}");
        };
        assert!(scene.contains(from), "{from} is not in {name}");
        std::fs::write(&path, scene.replacen(from, to, 1)).unwrap();
        let message = Scene::read(&path).unwrap_err().to_string();
        assert!(message.contains(expected), "{to}: {message}");
        assert!(message.contains(name), "{message}");
    }
}

#[test]
fn the_linear_scene_is_read_and_needs_no_weights() {
    let scene = Scene::read(&shipped("linear-7x7.toml")).unwrap();
    assert!(scene.surrogate().is_none());
    assert_eq!(scene.target.points.len(), TARGET_POINTS);
    assert_eq!(scene.material.thickness, 0.5);
    assert!(scene.output().ends_with("runs/linear-7x7"));
}

#[test]
fn slips_of_names_units_and_signs_are_named() {
    let table = r#"
fillet_ratio => filet_ratio => linear-7x7.toml:22: unknown key `filet_ratio`; did you mean `fillet_ratio`?
size = [2800.0, 2800.0] => size = [2.8, 2.8] => did you mean 2800 mm
size = [2800.0, 2800.0] => size = [57708.8, 57708.8] => did you mean 57.7088 mm
start = 18.0 => start = 0.018 => ligament.start
range = [10.0, 26.0] => range = [0.010, 0.026] => did you mean 10 mm
range = [10.0, 26.0] => range = [26.0, 10.0] => minimum < maximum
slit_width = 0.2 => slit_width = -0.2 => 0 < slit_width
slit_width = 0.2 => kerf = 0.2 => `kerf`: is now two keys: process.slit_width
kerf = 0.2 => kerf = 0.21 => 0 < kerf <= process.slit_width = 0.2 mm
kerf = 0.2 => kerf = nan => cutting.kerf = NaN mm
r_win = 70.0 => r_win = 0.1 => r_win > 2.5 w_lig
r_win = 70.0 => r_win = 70000.0 => did you mean 70 mm
k_theta = 300.0 => k_theta = -300.0 => linear.k_theta
k_a = 400.0 => k_a = 4e8 => did you mean 400000 N/mm
k_a = 400.0|k_s = 250.0|k_theta = 300.0 => k_a = 1e6|k_s = 1e6|k_theta = 1e-3 => lost in the rounding
force = [40.0, 0.0] => force = [nan, 0.0] => loads[0].force
radius = 2268.0 => radius = 2.268 => did you mean 14250
radius = 2268.0 => radius = -2268.0 => target.circle.radius = -2268 mm
learning_rate = 0.05 => learning_rate = 0.0 => optimiser.learning_rate
load_steps = 10 => load_steps = 0 => 1 <= load_steps
panel = [6, 3] => panel = [7, 3] => loads[0].panel = [7, 3] violates column < 7
panel = [6, 3] => panel = [3, 3] => prevents the motion of this load
panels = [7, 7] => panels = [1, 7] => 2 <= sheet.panels
kind = "clamp" => kind = "glue" => glue
"#;
    assert_refused("linear-7x7.toml", table);
    let table = "
symmetric_difference = 10.0 => symmetric_difference = -1.0 => objective.symmetric_difference
held = true => hold = true => did you mean `held`?
";
    assert_refused("compact-11x11.toml", table);
}

#[test]
fn a_hinge_law_without_what_it_needs_is_refused() {
    let table = r#"
size = => size = => surrogate.weights: there is no file
[surrogate]|weights => [ignored]|weights => unknown key `ignored`
level = "standard" => level = "linear"|linear = { k_a = 400.0, k_s = 250.0, k_theta = 300.0 } => objective.domain needs
"#;
    assert_refused("pet-3x3.toml", table);
    let table = r#"
[linear]|k_a = 400.0|k_s = 250.0|k_theta = 300.0|  =>  => needs the section [linear]
level = "linear" => level = "standard"|posture = { kind = "free" } => needs the section [surrogate]
[optimiser] => [objective]|damage = 1.0||[optimiser] => only the learned hinge law predicts damage
"#;
    assert_refused("linear-7x7.toml", table);
}

/// How the sheet is held and where it is pulled: each of these keys excludes others.
#[test]
fn a_sheet_that_is_held_in_no_way_is_refused() {
    let table = r#"
[posture]|kind = "held-flat" =>  => say what keeps the panels in their plane
kind = "held-flat" => kind = "hanging" => posture.down: a hanging sheet needs
kind = "held-flat" => kind = "hanging"|down = [0.0, 0.0] => posture.down: a hanging sheet needs
kind = "held-flat" => kind = "lying"|down = [0.0, -1.0] => posture.down: only a hanging sheet
at = "bottom" => at = "middle" => expected "centroid", "bottom"
at = "bottom" => at = [1.0, 2.0, 3.0] => expected "centroid", "bottom"
at = "bottom"|clip = 10.0 => at = [105.0, 80.0]|hole = 4.0 => loads[0].at = [105, 80] mm is outside panel [1, 0] of the start, which has the corners (70.0, 0.0)
at = "bottom" =>  => loads[0].clip: a clip holds an edge
kind = "clamp" => kind = "pin" => supports[0].clip: a clip keeps its panel from turning
force = [0.0, -1.0] => mass_g = 50.0 => loads[0].mass_g: a weight pulls along gravity
[[loads]] => [[loads]]|panel = [1, 0]|force = [1.0, 0.0]||[[loads]] => panel [1, 0] is held or pulled at two points
clip = 10.0 => hole = 4.0 => loads[0].hole: a hole at the edge of a panel would be open
at = "bottom"|clip = 10.0 => at = [100.0, 30.0]|hole = 0.1 => violates hole > 0.1 mm, the kerf of the tool (cutting.kerf)
panel = [1, 3] => panel = [1, 2] => supports[0].clip: a clip holds an edge of the sheet
[[loads]] => [[loads]]|panel = [1, 0]|at = "bottom"|clip = 5.0|force = [1.0, 0.0]||[[loads]] => panel [1, 0] has two holes or clips
force = [0.0, -1.0] => force = [0.0, -1.0]||[[loads]]|panel = [1, 3]|at = "top"|force = [0.0, 1.0] => prevents the motion of this load
kind = "held-flat" => kind = "hanging"|down = [0.0, -1.0]||[[loads]]|panel = [1, 3]|at = "top"|mass_g = 20.0 => prevents the motion of this load
[[loads]] => [[edge_loads]]|edge = "bottom"|traction = [0.0, -0.1]||[[loads]] => edge_loads act at the centroids
"#;
    assert_refused("a4-polyester.toml", table);
}

#[test]
fn a_held_opening_is_no_design_variable() {
    let scene = Scene::read(&shipped("compact-11x11.toml")).unwrap();
    let (problem, start) = (scene.problem().unwrap(), scene.start());
    assert_eq!(start.opening, None);
    let opening = problem.opening(&start).unwrap();
    assert_eq!(opening, std::f64::consts::PI);
    let free = Scene::read(&shipped("pin-7x7.toml")).unwrap();
    let opening = free.problem().unwrap().opening(&free.start()).unwrap();
    assert_eq!(free.start().opening, Some(opening));
}

#[test]
fn a_changed_scene_is_the_one_that_would_be_read() {
    let path = shipped("a4-plate.toml");
    let scene = Scene::read(&path).unwrap();
    let thinner = |config: &mut SceneConfig| {
        config.thickness = Some(2.4);
        config.process.r_win = 9.6;
        config.ligament.range = [0.8, 2.2];
    };
    let changes: [&dyn Fn(&mut SceneConfig); 5] = [
        &|config| config.drive.as_mut().unwrap().stroke = 30.0,
        &|config| config.ligament.range = [1.1, 2.7],
        &thinner,
        &|config| config.process.r_win = 11.0,
        &|config| config.surrogate.as_mut().unwrap().weights = "nothing.safetensors".into(),
    ];
    let mut refused = 0;
    for change in changes {
        let mut config = scene.config.clone();
        change(&mut config);
        let scenes = [scene.changed(config.clone()), Scene::new(config, &path)];
        let [changed, read] = scenes.map(|scene| {
            let scene = scene.map_err(|error| error.to_string())?;
            let loss = scene.problem().unwrap().loss(&scene.start()).unwrap();
            Ok::<_, String>((scene.hash(), scene.model_hash(), loss))
        });
        assert_eq!(changed, read);
        refused += usize::from(read.is_err());
    }
    assert_eq!(refused, 2);
}

/// A search drives widths so near to a bound that they round to it.
#[test]
fn a_scene_starts_at_widths_on_their_bounds() {
    let scene = Scene::read(&shipped("a4-plate-service.toml")).unwrap();
    let mut design = scene.start();
    design.omega[0] = 60.0;
    design.omega[1] = -60.0;
    let moved = scene.changed(scene.starting_at(&design)).unwrap();
    let [narrowest, widest] = scene.config.ligament.range;
    let start = moved.config.start.w_lig.unwrap();
    assert!((start[0] - widest).abs() < 1e-8 && (start[1] - narrowest).abs() < 1e-8);
}

#[test]
fn a_scene_starts_at_a_design_from_any_folder() {
    let path = shipped("a4-polyester.toml");
    let scene = Scene::read(&path).unwrap();
    let mut design = scene.start();
    let wave = |(i, x): (usize, &mut f64)| *x += 0.2 * (i as f64).sin();
    design.omega.iter_mut().enumerate().for_each(wave);
    design.pattern.z.iter_mut().enumerate().for_each(wave);
    let folder = tempfile::tempdir().unwrap();
    let moved = SceneConfig { start: scene.starting_at(&design).start, ..scene.located().unwrap() };
    let moved = Scene::new(moved, &folder.path().join("scene.toml")).unwrap();
    assert_eq!(moved.model_hash(), scene.model_hash());
    let [loss, expected] = [
        moved.problem().unwrap().loss(&moved.start()).unwrap(),
        scene.problem().unwrap().loss(&design).unwrap(),
    ];
    assert!((loss / expected - 1.0).abs() < 1e-9, "{loss} {expected}");
}
