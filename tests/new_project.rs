//! A project of one's own: its files, for a material with weights and for one without.

mod common;

use common::Workplace;
use std::path::Path;

/// A folder with the film's weights, for a sheet of another thickness.
fn weights() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let weights = root.join("data/pet-0.5mm/medium.safetensors");
    weights.display().to_string()
}

/// The keys of a scene as a table.
fn keys(work: &Workplace, scene: &str) -> toml_edit::DocumentMut {
    let text = std::fs::read_to_string(work.path(scene)).unwrap();
    text.parse().unwrap()
}

#[test]
fn a_project_with_weights_is_designed_at_once() {
    let work = Workplace::new();
    let said = work.output(&format!(
        "init sheet --thickness 0.1 --size 210x297 --weights {}",
        weights()
    ));
    assert!(said.contains("kirigami design sheet/scene.toml"), "{said}");
    // The shipped sheet of A4 is the project of this size.
    let [project, shipped] =
        ["sheet/scene.toml", "configs/scenes/a4-polyester.toml"].map(|file| keys(&work, file));
    for (section, key) in [
        ("sheet", "panels"),
        ("ligament", "range"),
        ("process", "r_win"),
        ("supports", "panel"),
        ("loads", "panel"),
    ] {
        let of = |scene: &toml_edit::DocumentMut| match scene[section].as_array_of_tables() {
            Some(tables) => tables.get(0).unwrap()[key].to_string(),
            None => scene[section][key].to_string(),
        };
        assert_eq!(of(&project), of(&shipped), "{section}.{key}");
    }
    // That of the rigid panels opened by 25 degrees; the shipped sheet has a target and a stroke of its own.
    let stroke = project["drive"]["stroke"].as_float().unwrap();
    assert!((stroke - 30.4).abs() < 0.1, "{stroke}");

    work.output("design sheet/scene.toml --steps 2");
    assert!(work.path("sheet/design/cut.dxf").exists());
    let message = work.error("init sheet --thickness 0.1");
    assert!(message.contains("sheet exists already"), "{message}");
}

#[test]
fn a_project_without_weights_begins_with_its_campaign() {
    let work = Workplace::new();
    let steel = "--material configs/materials/s235-1.5mm.toml";
    let message = work.error(&format!("init steel {steel} --weights no.safetensors"));
    assert!(message.contains("there is no no.safetensors"), "{message}");
    let message = work.error("init film --thickness 0.5 --size 210x297");
    assert!(
        message.contains("at most 0.10 mm for this size), or a plate from 2 mm on"),
        "{message}"
    );
    let said = work.output(&format!("init steel {steel} --size 3300x4600"));
    assert!(
        said.contains("kirigami campaign run steel/campaign.toml"),
        "{said}"
    );
    // Lengths of the campaign are those of the film, times the ratio of the thicknesses.
    let campaign = keys(&work, "steel/campaign.toml");
    assert_eq!(campaign["design"]["r_win"].as_float(), Some(300.0));
    let message = work.error("design steel/scene.toml");
    assert!(
        message.contains("there is no file") && message.contains("weights.safetensors"),
        "{message}"
    );
    let small = [
        ("tier = \"default\"", "tier = \"tiny\""),
        ("count = 1500", "count = 6"),
        ("theta_deg = [-5.0, 75.0]", "theta_deg = [-5.0, 15.0]"),
        ("median_deg = 25.0", "median_deg = 10.0"),
    ];
    work.edit("steel/campaign.toml", &small);
    work.edit("steel/training.toml", &[("epochs = 80", "epochs = 2")]);
    // Its hinges alone: an hour is not for a test.
    let (_, campaign) = said.split_once("train weights from nothing").unwrap();
    assert!(
        said.contains("kirigami material learn steel/material.toml"),
        "{said}"
    );
    let lines = campaign
        .lines()
        .filter(|line| line.starts_with("kirigami "));
    for line in lines.filter(|line| !line.contains(" verify ")) {
        let command = line.split(" #").next().unwrap().trim();
        let command = command.strip_prefix("kirigami ").unwrap();
        match command.starts_with("design") {
            true => work.output(&format!("{command} --steps 1 --force")),
            false => work.output(command),
        };
    }
}

#[test]
fn a_drawing_becomes_the_target() {
    let work = Workplace::new();
    let said = work.output(&format!(
        "init leaf --thickness 0.1 --size 420x594 --target configs/targets/leaf.svg --weights {}",
        weights()
    ));
    assert!(said.contains("kirigami verify leaf/scene.toml"), "{said}");
    let scene = keys(&work, "leaf/scene.toml");
    let svg = &scene["target"]["svg"];
    assert!(Path::new(svg["file"].as_str().unwrap()).is_absolute());
    work.output("design leaf/scene.toml --steps 1 --force");
    let message = work.error("init other --target none.svg");
    assert!(message.contains("there is no none.svg"), "{message}");
    assert!(!work.path("other").exists());
}

#[test]
fn a_project_like_a_scene_is_similar_to_it() {
    let work = Workplace::new();
    let like = "configs/scenes/pet-3x3.toml";
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    work.edit(like, &[("../../data", &data.display().to_string())]);
    let init = format!(
        "init thin --like {like} --thickness 0.1 --weights {}",
        weights()
    );
    let message = work.error(&format!("{init} --size 300x300"));
    assert!(message.contains("another ratio"), "{message}");
    work.output(&init);
    let scene = keys(&work, "thin/scene.toml");
    let close = |item: &toml_edit::Item, expected: f64, tolerance: f64| {
        let found = item.as_float().unwrap();
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{found} {expected}"
        );
    };
    // A fifth of every length.
    for (side, expected) in [(0, 487.68), (1, 243.84)] {
        close(
            &scene["sheet"]["size"]
                .as_array()
                .unwrap()
                .get(side)
                .unwrap()
                .clone()
                .into(),
            expected,
            1e-9,
        );
    }
    close(&scene["ligament"]["start"], 3.6, 1e-9);
    close(&scene["process"]["r_win"], 20.0, 1e-9);
    close(&scene["target"]["rectangle"]["rotation_deg"], -15.4, 1e-9);
    // A similar sheet carries forces in proportion to the square of its lengths; its kerf is that of the same tool, and
    // the factor is found to 0.6 %.
    let force = scene["loads"].as_array_of_tables().unwrap().get(0).unwrap()["force"]
        .as_array()
        .unwrap();
    close(&force.get(0).unwrap().clone().into(), 27.85 / 25.0, 0.02);
    work.output("design thin/scene.toml --steps 1 --force");
    assert!(work.path("thin/design/cut.dxf").exists());
}

/// Without further options, `--like` keeps thickness, material and weights of the scene.
#[test]
fn a_project_like_a_scene_has_its_sheet() {
    let work = Workplace::new();
    let like = "configs/scenes/a2-polypropylene.toml";
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    work.edit(like, &[("../../data", &data.display().to_string())]);
    let said = work.output(&format!("init same --like {like}"));
    assert!(said.contains("The material has weights"), "{said}");
    let [project, shipped] = ["same/scene.toml", like].map(|file| keys(&work, file));
    assert_eq!(project["thickness"].as_float(), Some(0.2));
    for (section, key) in [("sheet", "panels"), ("process", "r_win")] {
        let [new, old] = [&project, &shipped].map(|scene| &scene[section][key]);
        let value = |item: &toml_edit::Item| {
            let item = item.to_string();
            let value = item.split('#').next().unwrap_or_default();
            value.replace(".0", "").replace(' ', "")
        };
        assert_eq!(value(new), value(old), "{section}.{key}");
    }
    let weights = project["surrogate"]["weights"].as_str().unwrap();
    assert!(
        weights.ends_with("polypropylene-0.8mm/weights.safetensors"),
        "{weights}"
    );
    // A scene whose loads are dead keeps them, and its ensemble.
    let dead = "configs/scenes/pet-3x3.toml";
    work.edit(dead, &[("../../data", &data.display().to_string())]);
    work.output(&format!("init dead --like {dead}"));
    let [project, shipped] = ["dead/scene.toml", dead].map(|file| keys(&work, file));
    let force = |scene: &toml_edit::DocumentMut| {
        let load = scene["loads"].as_array_of_tables().unwrap().get(0).unwrap();
        load["force"].as_array().unwrap().get(0).unwrap().as_float()
    };
    assert_eq!(force(&project), force(&shipped));
    let networks = |scene: &toml_edit::DocumentMut| {
        let networks = scene["surrogate"]
            .get("ensemble")
            .and_then(|list| list.as_array());
        networks.map_or(0, toml_edit::Array::len)
    };
    assert_eq!(networks(&project), networks(&shipped));
    let material = std::fs::read_to_string(work.path("same/material.toml")).unwrap();
    assert!(material.contains("polypropylene-0.8mm"), "{material}");
    work.output("design same/scene.toml --steps 1 --force");
}

/// `init FOLDER` alone gives a project that can be designed: a plate of A4. A film of 0.5 mm is larger.
#[test]
fn a_project_with_all_defaults_is_designed() {
    let work = Workplace::new();
    let plate = weights().replace("pet-0.5mm", "polypropylene-3mm");
    let said = work.output(&format!("init plate --weights {plate}"));
    assert!(said.contains("Nothing holds its panels there"), "{said}");
    work.output(&format!(
        "init film --thickness 0.5 --weights {}",
        weights()
    ));
    for (project, thickness, sides) in [
        ("plate", 3.0, "[210.0, 297.0]"),
        ("film", 0.5, "[1050.0, 1485.0]"),
    ] {
        let scene = keys(&work, &format!("{project}/scene.toml"));
        assert_eq!(scene["thickness"].as_float(), Some(thickness));
        let size = scene["sheet"]["size"].to_string();
        assert!(size.contains(sides), "{size}");
        work.output(&format!("design {project}/scene.toml --steps 1 --force"));
    }
}

/// Weights of ligaments that buckle do not serve those that bend in the plane.
#[test]
fn weights_of_a_film_do_not_serve_a_plate() {
    let work = Workplace::new();
    let film = "--material configs/materials/pet-0.5mm.toml";
    let said = work.output(&format!("init plate {film} --thickness 3"));
    assert!(
        said.contains("kirigami campaign run plate/campaign.toml"),
        "{said}"
    );
    let campaign = keys(&work, "plate/campaign.toml");
    assert_eq!(campaign["tier"].as_str(), Some("plate"));
    // In the thickness of the film's weights, the law is theirs.
    work.edit(
        "plate/material.toml",
        &[("thickness = 3.0", "thickness = 0.5")],
    );
    let message = work.error(&format!("design plate/scene.toml --weights {}", weights()));
    assert!(message.contains("no law holds for both"), "{message}");
    // Weights that are named decide what the sheet is, and it is too small for a film.
    let message = work.error(&format!(
        "init film {film} --thickness 3 --size 210x297 --weights {}",
        weights()
    ));
    assert!(message.contains("with film ligaments"), "{message}");
    let message = work.error(&format!(
        "init other --material configs/materials/petg-3mm.toml --weights {}",
        weights()
    ));
    assert!(message.contains("for another material"), "{message}");
}

/// A scene that is refused is written, and the reason is the message.
#[test]
fn a_project_that_needs_a_change_says_so() {
    let work = Workplace::new();
    let message = work.error(&format!(
        "init thin --like {}/configs/scenes/a4-plate.toml --thickness 1",
        env!("CARGO_MANIFEST_DIR")
    ));
    assert!(message.contains("needs a change"), "{message}");
    assert!(message.contains("violates 0.5 <= w_lig"), "{message}");
    assert!(work.path("thin/scene.toml").is_file());
}

/// The sheet of a stock is smaller than the stock by its margins and by what is cut beyond its edge.
#[test]
fn a_project_fits_the_stock_that_it_is_cut_from() {
    let work = Workplace::new();
    let plate = weights().replace("pet-0.5mm", "polypropylene-3mm");
    work.output(&format!(
        "init plate --stock a4 --margin 5 --weights {plate}"
    ));
    let scene = keys(&work, "plate/scene.toml");
    assert_eq!(
        scene["sheet"]["size"].to_string().trim(),
        "[197.0, 284.0]      # mm; width and height"
    );
    assert_eq!(scene["cutting"]["stock"].as_str(), Some("a4"));
    let said = work.output("design plate/scene.toml --steps 1 --force");
    assert!(!said.contains("the stock has"), "{said}");
    let nest = "cut plate/design --force --for lightburn";
    let said = work.output(&format!("{nest} --stock a4"));
    assert!(
        said.contains("sheet 1 of 1, 210 x 297 mm: 1 of 1 pieces"),
        "{said}"
    );
    assert!(work.path("plate/nest/lightburn/stock-1.dxf").exists());
    // The margin is that of the scene.
    let message = work.error(&format!("{nest} --stock 210x295"));
    assert!(
        message.contains("plate/design takes 199.0 x 286.0 mm"),
        "{message}"
    );
    assert!(
        message.contains("200.0 x 285.0 mm inside its margin"),
        "{message}"
    );

    let like = "configs/scenes/pet-3x3.toml";
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    work.edit(like, &[("../../data", &data.display().to_string())]);
    let like = format!(
        "init like --like {like} --thickness 0.1 --weights {}",
        weights()
    );
    work.output(&format!("{like} --stock a3 --margin 5"));
    let scene = keys(&work, "like/scene.toml");
    let size = scene["sheet"]["size"].as_array().unwrap();
    let side = |i: usize| size.get(i).and_then(toml_edit::Value::as_float).unwrap();
    // 407 x 284 mm remain of A3 on its side; the sheet is twice as wide as high.
    assert!(side(0) <= 407.0 && side(0) > 406.0, "{size}");
    assert!((side(0) / side(1) - 2.0).abs() < 1e-4, "{size}");

    let message = work.error("init none --stock a4 --margin 105");
    assert!(
        message.contains("leaves nothing of a stock of 210 x 297 mm"),
        "{message}"
    );
    let output = work.program("init none --size a4").output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("use --stock a4"), "{message}");
}
