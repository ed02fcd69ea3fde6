//! A project of one's own: its files, for a material with weights and for one without.

use crate::common::Workplace;
use std::path::Path;
use toml_edit::{Array, value};

/// The keys of a scene as a table.
fn keys(work: &Workplace, scene: &str) -> toml_edit::DocumentMut {
    let text = work.read(scene);
    text.parse().unwrap()
}

#[test]
fn a_project_with_weights_is_designed_at_once() {
    let work = Workplace::new();
    work.prints("init sheet --thickness 0.1 --size 210x297", &["kirigami design sheet/scene.toml"]);
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
    // The stroke of the rigid panels opened by 25 degrees; the shipped sheet has a target and a
    // stroke of its own.
    let stroke = project["drive"]["stroke"].as_float().unwrap();
    assert!((stroke - 30.4).abs() < 0.1, "{stroke}");

    work.output("design sheet/scene.toml --steps 2");
    assert!(work.path("sheet/design/cut.dxf").exists());
    work.refuses("init sheet --thickness 0.1", &["sheet exists already"]);
}

#[test]
fn a_project_without_weights_begins_with_its_campaign() {
    let work = Workplace::new();
    let steel = "--material configs/materials/s235-1.5mm.toml";
    let said = work.output(&format!("init steel {steel} --size 3300x4600"));
    assert!(said.contains("kirigami campaign run steel/campaign.toml"), "{said}");
    // Lengths of the campaign are the lengths of the film, times the ratio of the thicknesses.
    let campaign = keys(&work, "steel/campaign.toml");
    assert_eq!(campaign["design"]["r_win"].as_float(), Some(300.0));
    work.refuses("design steel/scene.toml", &["there is no file", "weights.safetensors"]);
    work.edit_campaign(
        "steel/campaign.toml",
        |campaign| {
            assert_eq!(campaign["training"][0].as_str(), Some("training.toml"));
            campaign["tier"] = value("tiny");
            campaign.remove("finer_tier");
            campaign["spot_rays"] = value(4);
        },
        |place, rays| {
            let widest = rays["w_lig"][1].as_float();
            assert_eq!(widest, Some(75.0), "three times the film's");
            rays["count"] = value(if place == 0 { 6 } else { 1 });
            rays["finer"] = value(0);
            rays["theta_deg"] = value(Array::from_iter([-5.0, 15.0]));
            rays["median_deg"] = value(10.0);
        },
    );
    work.edit("steel/training.toml", &[("epochs = 80", "epochs = 2")]);
    // Its hinges alone: an hour is not for a test.
    let (_, campaign) = said.split_once("train weights from nothing").unwrap();
    assert!(said.contains("kirigami material learn steel/material.toml"), "{said}");
    let lines = campaign.lines().filter(|line| line.starts_with("kirigami "));
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
    work.prints(
        "init leaf --thickness 0.1 --size 420x594 --target configs/targets/leaf.svg",
        &["kirigami verify leaf/scene.toml"],
    );
    let scene = keys(&work, "leaf/scene.toml");
    let svg = &scene["target"]["svg"];
    // The scene says that its paths are relative.
    let paths = [&svg["file"], &scene["surrogate"]["weights"], &scene["surrogate"]["draft"]];
    assert!(paths.iter().all(|path| Path::new(path.as_str().unwrap()).is_relative()));
    work.output("design leaf/scene.toml --steps 1 --force");
}

/// `init FOLDER` alone gives a project that can be designed: a plate of A4. A film of 0.5 mm is
/// larger.
#[test]
fn a_project_with_all_defaults_is_designed() {
    let work = Workplace::new();
    work.prints("init plate", &["Nothing holds its panels there"]);
    // Boards hold a sheet that is fitted to a drawing.
    let heart = "init heart --target configs/targets/heart.svg --size 300x300";
    work.output(heart);
    let readme = work.read("heart/README.md");
    assert!(!readme.contains("Nothing holds"), "{readme}");
    work.output("init film --thickness 0.5");
    for (project, thickness, sides) in
        [("plate", 3.0, "[210.0, 297.0]"), ("film", 0.5, "[1050.0, 1485.0]")]
    {
        let scene = keys(&work, &format!("{project}/scene.toml"));
        assert_eq!(scene["thickness"].as_float(), Some(thickness));
        let size = scene["sheet"]["size"].to_string();
        assert!(size.contains(sides), "{size}");
        work.output(&format!("design {project}/scene.toml --steps 1 --force"));
    }
}

/// Ligaments of 0.93 thicknesses, as in the shipped plate of polypropylene, would let both leave
/// their plane.
#[test]
fn plates_of_other_materials_stay_in_their_plane() {
    let work = Workplace::new();
    for material in ["petg-3mm", "aluminium-2mm"] {
        work.output(&format!("init plate --material configs/materials/{material}.toml"));
        let widest = keys(&work, "plate/scene.toml")["ligament"]["range"][1].clone();
        assert!(widest.as_float().unwrap() < 2.2, "{widest}");
        work.prints("design plate/scene.toml", &["by themselves they stay"]);
        std::fs::remove_dir_all(work.path("plate")).unwrap();
    }
}

/// The same that `material check` says.
#[test]
fn a_material_that_tears_before_it_opens_is_refused() {
    let work = Workplace::new();
    let acrylic = "configs/materials/acrylic-3mm.toml";
    let message = work.error(&format!("init sheet --material {acrylic}"));
    assert!(message.contains("tears: the tip of a ligament strains"), "{message}");
    assert!(!work.path("sheet").exists());
    let checked = work.program(&format!("material check {acrylic}")).output().unwrap();
    let checked = String::from_utf8(checked.stdout).unwrap();
    let verdict = message.split(".toml: ").nth(1).unwrap().split("; choose").next().unwrap();
    assert!(checked.contains(verdict), "{checked}");
}

/// Weights of ligaments that buckle do not serve those that bend in the plane.
#[test]
fn weights_of_a_film_do_not_serve_a_plate() {
    let work = Workplace::new();
    let film = "--material configs/materials/pet-0.5mm.toml";
    work.prints(
        &format!("init plate {film} --thickness 3"),
        &["kirigami campaign run plate/campaign.toml"],
    );
    let campaign = keys(&work, "plate/campaign.toml");
    assert_eq!(campaign["tier"].as_str(), Some("plate"));
    // The law is the weights' own in their thickness.
    work.edit("plate/material.toml", &[("thickness = 3.0", "thickness = 0.5")]);
    work.refuses(
        "design plate/scene.toml --weights data/pet-0.5mm/medium.safetensors",
        &["no law holds for both"],
    );
}

/// The sheet of a stock is smaller than the stock by its margins and by what is cut beyond its
/// edge.
#[test]
fn a_project_fits_the_stock_that_it_is_cut_from() {
    let work = Workplace::new();
    work.output("init plate --stock a4 --margin 5");
    let scene = keys(&work, "plate/scene.toml");
    assert_eq!(
        scene["sheet"]["size"].to_string().trim(),
        "[197.0, 284.0]      # mm; width and height"
    );
    assert_eq!(scene["cutting"]["stock"].as_str(), Some("a4"));
    let said = work.output("design plate/scene.toml --steps 1 --force");
    assert!(!said.contains("the stock has"), "{said}");
}
