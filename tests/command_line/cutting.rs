//! `kirigami cut`: files of a finished run, and what it refuses.

use crate::common::Workplace;

const SCENE: &str = "configs/scenes/pin-7x7.toml";

#[test]
fn a_design_of_another_scene_is_not_cut_unless_it_is_named() {
    let work = Workplace::new();
    work.output(&format!("design {SCENE} --steps 1"));
    work.output(&format!("cut {SCENE}"));
    work.edit(SCENE, &[("steps = 150", "steps = 3")]);
    work.output(&format!("cut {SCENE}"));
    work.edit(SCENE, &[("slit_width = 0.2", "slit_width = 0.3")]);
    work.error(&format!("cut {SCENE}"));
    // The run has its own copy of the scene.
    work.output("cut runs/pin-7x7");
    work.output(&format!("cut {SCENE} --design runs/pin-7x7/state.json"));
}

#[test]
fn a_designed_sheet_is_cut_on_paper() {
    let work = Workplace::new();
    work.output(&format!("design {SCENE} --steps 3 --out run"));
    let cut = format!("cut {SCENE} --design run/state.json --out files");
    work.prints(&format!("{cut} --paper a3"), &["84 holes, 48 slits", "rows x "]);
    for name in
        ["cut.dxf", "cut.svg", "cut-list.csv", "attachments.csv", "cut-summary.csv", "tiles-a3.pdf"]
    {
        assert!(work.path("files").join(name).exists(), "{name}");
    }
    // Files of the last call do not remain.
    work.edit(SCENE, &[("[cutting]", "[cutting]\nmargin = 3.0")]);
    let json = work.json(&format!("{cut} --json"));
    assert_eq!(json["totals"]["holes"], 84);
    assert!(!work.path("files/tiles-a3.pdf").exists());
    // Other cutting settings are not another run.
    work.output(&format!("design {SCENE} --steps 3 --out run"));
}

/// The files of the machines are measured in output/tests/fabrication; here they are asked for.
#[test]
fn a_sheet_is_cut_for_a_machine() {
    let work = Workplace::new();
    // Before the search.
    work.prints(
        &format!("cut {SCENE} --for laser-service --design start"),
        &["SendCutSend refuses", "(process.slit_width)"],
    );
    let said = work.output(
        "cut configs/scenes/a4-plate-service.toml --for laser-service --design start --out drilled",
    );
    assert!(said.contains("SendCutSend: no published limit"), "{said}");
    assert!(said.contains("smallest hole 1.60 mm"), "{said}");
    let folder = "runs/pin-7x7/cut/laser-service";
    for name in ["cut.dxf", "cut.svg"] {
        assert!(work.path(folder).join(name).exists(), "{name}");
    }
    let json = work.json(&format!("cut {SCENE} --for knife --design start --json"));
    assert_eq!(json["features"]["slot"], 0.2);
    assert_eq!(json["services"], serde_json::json!([]));
}

/// A laser cuts around the slots of a sheet for a service: the finished sheet is the same.
#[test]
fn a_sheet_for_a_service_is_cut_by_a_laser_of_its_own_kerf() {
    let work = Workplace::new();
    let scene = "configs/scenes/a4-plate-service.toml";
    let cut = format!("cut {scene} --design start --out cut");
    for machine in ["ponoko", "lightburn", "knife"] {
        work.refuses(&format!("{cut} --for {machine}"), &["set cutting.kerf"]);
    }
    work.edit(scene, &[("[surrogate]", "[cutting]\nkerf = 0.2\n\n[surrogate]")]);
    for machine in ["ponoko", "lightburn"] {
        work.output(&format!("{cut} --for {machine}"));
        let file = work.read("cut/cut.svg");
        // The page is 5 mm larger on each side than the path of the beam.
        assert!(file.contains("width=\"220.2mm\" height=\"307.2mm\""), "{machine}");
        // Slits and outline alone: no hole is a path of its own.
        assert!(!file.contains("HOLES"), "{machine}");
    }
    work.refuses(&format!("{cut} --for knife"), &["1.5 mm wide", "lines of 0.2 mm"]);
}

#[test]
fn a_file_that_every_service_refuses_is_not_written() {
    let work = Workplace::new();
    let cut = "cut configs/scenes/a4-plate.toml --for laser-service --design start --out files";
    work.refuses(cut, &["no service cuts this sheet: SendCutSend refuses"]);
    assert!(!work.path("files").exists());
    work.output(&format!("{cut} --force"));
}

#[test]
fn a_sheet_larger_than_its_stock_is_a_warning() {
    let work = Workplace::new();
    let design = format!("design {SCENE} --steps 1 --restart");
    let stock = |width: f64| format!("[cutting]\nstock = [{width}, 2900.0]\nmargin = 10.0");
    work.edit(SCENE, &[("[cutting]", &stock(2823.0))]);
    assert!(!work.output(&design).contains("the stock has"));
    work.edit(SCENE, &[("2823", "2821")]);
    work.prints(&design, &["the stock has 2801.0 x 2880.0 mm"]);
}

/// The stock of a scene is also the name of a paper.
#[test]
fn a_stock_is_a_paper_or_two_sides() {
    let work = Workplace::new();
    work.edit(SCENE, &[("[cutting]", "[cutting]\nstock = \"a0\"")]);
    work.prints(&format!("design {SCENE} --steps 1"), &["the stock has 841.0 x 1189.0 mm"]);
}
