//! Shipped scenes are read; invalid scenes give a message with the key and the reason.

use design::objective::terms::TARGET_POINTS;
use design::scene::{Scene, SceneConfig};
use std::path::{Path, PathBuf};

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../configs/scenes")
        .join(name)
}

/// The message for a copy of a shipped scene with one text replaced.
fn refusal(name: &str, text: &str, replacement: &str) -> String {
    let scene = std::fs::read_to_string(shipped(name)).unwrap();
    assert!(scene.contains(text), "{text} is not in {name}");
    let folder = tempfile::tempdir().unwrap();
    let materials = folder.path().join("materials");
    std::fs::create_dir_all(&materials).unwrap();
    let film = "pet-0.5mm.toml";
    let source = shipped("../materials").join(film);
    std::fs::copy(source, materials.join(film)).unwrap();
    let path = folder.path().join("scenes").join(name);
    std::fs::create_dir_all(folder.path().join("scenes")).unwrap();
    std::fs::write(&path, scene.replacen(text, replacement, 1)).unwrap();
    Scene::read(&path).unwrap_err().to_string()
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
fn an_unknown_key_names_its_line_and_the_nearest_key() {
    let message = refusal("linear-7x7.toml", "fillet_ratio", "filet_ratio");
    assert!(message.contains("linear-7x7.toml:"), "{message}");
    assert!(
        message.contains("`filet_ratio`; did you mean `fillet_ratio`?"),
        "{message}"
    );
}

#[test]
fn slips_of_units_and_signs_are_named() {
    let cases = [
        (
            "size = [2800.0, 2800.0]",
            "size = [2.8, 2.8]",
            "did you mean 2800 mm",
        ),
        (
            "size = [2800.0, 2800.0]",
            "size = [57708.8, 57708.8]",
            "did you mean 57.7088 mm",
        ),
        ("start = 18.0", "start = 0.018", "ligament.start"),
        (
            "range = [10.0, 26.0]",
            "range = [0.010, 0.026]",
            "did you mean 10 mm",
        ),
        (
            "range = [10.0, 26.0]",
            "range = [26.0, 10.0]",
            "minimum < maximum",
        ),
        ("kerf = 0.2", "kerf = -0.2", "0 < kerf"),
        ("r_win = 70.0", "r_win = 0.1", "r_win > 2.5 w_lig"),
        ("r_win = 70.0", "r_win = 70000.0", "did you mean 70 mm"),
        ("k_theta = 300.0", "k_theta = -300.0", "linear.k_theta"),
        ("k_a = 400.0", "k_a = 4e8", "did you mean 400000 N/mm"),
        (
            "k_a = 400.0                # N/mm\nk_s = 250.0                # N/mm\nk_theta = 300.0",
            "k_a = 1e6\nk_s = 1e6\nk_theta = 1e-3",
            "lost in the rounding",
        ),
        (
            "force = [40.0, 0.0]",
            "force = [nan, 0.0]",
            "loads[0].force",
        ),
        ("radius = 2268.0", "radius = 2.268", "did you mean 14250"),
        (
            "radius = 2268.0",
            "radius = -2268.0",
            "target.circle.radius = -2268 mm",
        ),
        (
            "learning_rate = 0.05",
            "learning_rate = 0.0",
            "optimiser.learning_rate",
        ),
        ("load_steps = 10", "load_steps = 0", "1 <= load_steps"),
    ];
    for (text, replacement, expected) in cases {
        let message = refusal("linear-7x7.toml", text, replacement);
        assert!(message.contains(expected), "{replacement}: {message}");
        assert!(message.contains("linear-7x7.toml"), "{message}");
    }
}

#[test]
fn invalid_panels_and_supports_are_named() {
    let cases = [
        (
            "panel = [6, 3]",
            "panel = [7, 3]",
            "loads[0].panel = [7, 3] violates column < 7",
        ),
        (
            "panel = [6, 3]",
            "panel = [3, 3]",
            "prevents the motion of this load",
        ),
        ("panels = [7, 7]", "panels = [1, 7]", "2 <= sheet.panels"),
        ("kind = \"clamp\"", "kind = \"glue\"", "glue"),
    ];
    for (text, replacement, expected) in cases {
        let message = refusal("linear-7x7.toml", text, replacement);
        assert!(message.contains(expected), "{replacement}: {message}");
    }
}

#[test]
fn a_hinge_law_without_what_it_needs_is_refused() {
    let message = refusal("pet-3x3.toml", "size =", "size =");
    assert!(
        message.contains("surrogate.weights: there is no file"),
        "{message}"
    );
    let message = refusal("pet-3x3.toml", "[surrogate]\nweights", "[ignored]\nweights");
    assert!(message.contains("unknown key `ignored`"), "{message}");
    let message = refusal(
        "pet-3x3.toml",
        "hinge = \"surrogate\"",
        "hinge = \"linear\"\nlinear = { k_a = 400.0, k_s = 250.0, k_theta = 300.0 }",
    );
    assert!(message.contains("objective.domain needs"), "{message}");
    let section = "[linear]\nk_a = 400.0                # N/mm\nk_s = 250.0                # N/mm\n\
                   k_theta = 300.0            # N mm/rad\n";
    let message = refusal("linear-7x7.toml", section, "");
    assert!(message.contains("needs the section [linear]"), "{message}");
    let message = refusal(
        "linear-7x7.toml",
        "hinge = \"linear\"",
        "hinge = \"surrogate\"\nposture = { kind = \"free\" }",
    );
    assert!(
        message.contains("needs the section [surrogate]"),
        "{message}"
    );
    let message = refusal(
        "linear-7x7.toml",
        "[optimiser]",
        "[objective]\ndamage = 1.0\n\n[optimiser]",
    );
    assert!(
        message.contains("only the learned hinge law predicts damage"),
        "{message}"
    );
}

/// How the sheet is held and where it is pulled: each of these keys excludes others.
#[test]
fn a_sheet_that_is_held_in_no_way_is_refused() {
    let posture = "kind = \"held-flat\"         # between plates or in a frame; or \"lying\", \"hanging\", \"free\"";
    for (from, to, expected) in [
        (
            "[posture]\nkind = \"held-flat\"",
            "[cutting]\nmargin = 1.0 # ",
            "say what keeps the panels in their plane",
        ),
        (
            posture,
            "kind = \"hanging\"",
            "posture.down: a hanging sheet needs",
        ),
        (
            posture,
            "kind = \"hanging\"\ndown = [0.0, 0.0]",
            "posture.down: a hanging sheet needs",
        ),
        (
            posture,
            "kind = \"lying\"\ndown = [0.0, -1.0]",
            "posture.down belongs to another kind than Lying",
        ),
        (
            "at = \"bottom\"",
            "at = \"middle\"",
            "expected \"centroid\", \"bottom\"",
        ),
        (
            "at = \"bottom\"",
            "at = [1.0, 2.0, 3.0]",
            "expected \"centroid\", \"bottom\"",
        ),
        (
            "at = \"bottom\"              # the force acts at the middle of its lower edge, about which the panel may turn\nclip = 10.0",
            "at = [105.0, 80.0]\nhole = 4.0",
            "loads[0].at = [105, 80] mm is outside panel [1, 0] of the start, which has the corners (70.0, 0.0)",
        ),
        (
            "at = \"bottom\"              # the force",
            "# the force",
            "loads[0].clip: a clip holds an edge",
        ),
        (
            "kind = \"clamp\"             # or",
            "kind = \"pin\" # or",
            "supports[0].clip: a clip keeps its panel from turning",
        ),
        (
            "force = [0.0, -1.0]",
            "mass_g = 50.0",
            "loads[0].mass_g: a weight pulls along gravity",
        ),
        (
            "[[loads]]",
            "[[loads]]\npanel = [1, 0]\nforce = [1.0, 0.0]\n\n[[loads]]",
            "panel [1, 0] is held or pulled at two points",
        ),
        (
            "clip = 10.0",
            "hole = 4.0 #",
            "loads[0].hole: a hole at the edge of a panel would be open",
        ),
        (
            "at = \"bottom\"              # the force acts at the middle of its lower edge, about which the panel may turn\nclip = 10.0",
            "at = [100.0, 30.0]\nhole = 0.1",
            "violates hole > process.kerf",
        ),
        (
            "panel = [1, 3]             # the middle one at the top, fixed",
            "panel = [1, 2]",
            "supports[0].clip: a clip holds an edge of the sheet",
        ),
        (
            "[[loads]]",
            "[[loads]]\npanel = [1, 0]\nat = \"bottom\"\nclip = 5.0\nforce = [1.0, 0.0]\n\n[[loads]]",
            "panel [1, 0] has two holes or clips",
        ),
        (
            "force = [0.0, -1.0]        # N; its direction, as the stroke is prescribed\n",
            "force = [0.0, -1.0]\n\n[[loads]]\npanel = [1, 3]\nat = \"top\"\nforce = [0.0, 1.0]\n",
            "prevents the motion of this load",
        ),
        (
            "[[loads]]",
            "[[edge_loads]]\nedge = \"bottom\"\ntraction = [0.0, -0.1]\n\n[[loads]]",
            "edge_loads act at the centroids",
        ),
    ] {
        let message = refusal("a4-polyester.toml", from, to);
        assert!(message.contains(expected), "{to}: {message}");
    }
    // A hung mass on a panel that is held does no work, no more than a force.
    let hanging = "kind = \"hanging\"\ndown = [0.0, -1.0]";
    let held = format!("{hanging}\n\n[[loads]]\npanel = [1, 3]\nat = \"top\"\nmass_g = 20.0");
    let message = refusal("a4-polyester.toml", posture, &held);
    assert!(
        message.contains("prevents the motion of this load"),
        "{message}"
    );
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
fn the_weight_of_an_area_is_not_negative() {
    let weight = "symmetric_difference = 10.0";
    let message = refusal("compact-11x11.toml", weight, "symmetric_difference = -1.0");
    assert!(
        message.contains("objective.symmetric_difference"),
        "{message}"
    );
    let held = "held = true";
    let message = refusal("compact-11x11.toml", held, "hold = true");
    assert!(message.contains("did you mean `held`?"), "{message}");
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

#[test]
fn a_scene_starts_at_a_design_from_any_folder() {
    let path = shipped("a4-polyester.toml");
    let scene = Scene::read(&path).unwrap();
    let mut design = scene.start();
    let wave = |(i, x): (usize, &mut f64)| *x += 0.2 * (i as f64).sin();
    design.omega.iter_mut().enumerate().for_each(wave);
    design.pattern.z.iter_mut().enumerate().for_each(wave);
    let folder = tempfile::tempdir().unwrap();
    let moved = SceneConfig {
        start: scene.starting_at(&design).start,
        ..scene.located().unwrap()
    };
    let moved = Scene::new(moved, &folder.path().join("scene.toml")).unwrap();
    assert_eq!(moved.model_hash(), scene.model_hash());
    let [loss, expected] = [
        moved.problem().unwrap().loss(&moved.start()).unwrap(),
        scene.problem().unwrap().loss(&design).unwrap(),
    ];
    assert!((loss / expected - 1.0).abs() < 1e-9, "{loss} {expected}");
}
