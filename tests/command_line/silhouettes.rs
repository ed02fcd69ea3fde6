//! Drawings that a sheet is asked to become: nothing is edited between `init` and the cut file.

use crate::common::Workplace;
use serde_json::Value;

/// Side of the space for the sheet (mm).
const SIDE: f64 = 180.0;

#[test]
fn a_drawing_becomes_a_sheet_with_a_cut_file() {
    let work = Workplace::new();
    // Plates of 2 mm, and the thinnest one.
    let plates = [("leaf", 2, 0.94), ("vase", 2, 0.95), ("bell", 2, 0.91), ("shield", 2, 0.94)];
    for (drawing, thickness, least) in plates.into_iter().chain([("star", 1, 0.92)]) {
        let side = 0.5 * f64::from(thickness) * SIDE;
        let said = work.output(&format!(
            "init {drawing} --target configs/targets/{drawing}.svg --thickness {thickness} --size {side}x{side}"
        ));
        assert!(said.contains("of the target (common area"), "{said}");
        assert!(said.contains("opened by 60 deg"), "{said}");
        work.output(&format!("design {drawing}/scene.toml"));
        assert!(work.path(&format!("{drawing}/design/cut.dxf")).exists(), "{drawing}");
        let report = work.read(&format!("{drawing}/design/report.json"));
        let report: Value = serde_json::from_str(&report).unwrap();
        let seen = report["seen"].as_f64().unwrap();
        assert!(seen > least, "{drawing}: {seen}");
        let mut found = report["warnings"].as_array().unwrap().iter();
        assert_eq!(found.find(|it| it["severity"] != "note"), None, "{drawing}");
    }
    // A film in another thickness than its weights opens as far.
    let film = "init film --target configs/targets/star.svg --thickness 0.1 --size 450x450";
    assert!(work.output(film).contains("opened by 60 deg"));
}

/// What is narrower than two panels is named, with what would show it; a sheet that hides its
/// drawing is not made.
#[test]
fn lost_parts_are_named_and_a_hidden_drawing_is_refused() {
    let work = Workplace::new();
    let drawing = |file: &str, path: &str| {
        let svg = format!("<svg xmlns='http://www.w3.org/2000/svg'><path d='{path}'/></svg>");
        std::fs::write(work.path(file), svg).unwrap();
    };
    drawing(
        "flag.svg",
        "M0 0 L60 0 L60 60 L31 60 L31 80 L50 80 L50 120 L10 120 L10 80 L29 80 L29 60 L0 60 Z",
    );
    let said = work.output("init flag --target flag.svg --thickness 2 --size 150x150 --anyway");
    assert!(said.contains("not shown: a part") && said.contains("at the bottom"), "{said}");
    drawing(
        "frame.svg",
        "M0 0 L30 0 L30 30 L94 30 L94 0 L100 0 L100 100 L94 100 L94 36 L24 36 L24 100 L0 100 Z",
    );
    let refused = work.error("-q init frame --target frame.svg --thickness 2 --size 150x150");
    assert!(refused.contains("would not recognise it"), "{refused}");
    assert!(!work.path("frame").exists());
}

/// The sheet of a ring is a ring: its middle rows of voids have a gap.
#[test]
fn a_ring_becomes_a_sheet_with_a_hole() {
    let work = Workplace::new();
    let circle = |radius: u32| format!("<circle r='{radius}' cx='90' cy='90'/>");
    let ring = circle(90) + &circle(40);
    let ring = format!("<svg xmlns='http://www.w3.org/2000/svg'>{ring}</svg>");
    std::fs::write(work.path("ring.svg"), ring).unwrap();
    work.output("init ring --target ring.svg --thickness 2 --size 360x360");
    let scene = work.read("ring/scene.toml").parse::<toml_edit::DocumentMut>().unwrap();
    let voids = scene["cells"]["voids"].as_array().unwrap();
    let middle = voids.get(voids.len() / 2).and_then(|row| row.as_str()).unwrap();
    assert!(middle.trim_matches('.').contains('.'), "{voids}");
}

/// An even pattern needs no search: one that shows less of the drawing is a warning.
#[test]
fn a_search_after_which_less_is_seen_is_a_warning() {
    let work = Workplace::new();
    work.output("init star --target configs/targets/star.svg --thickness 2 --size 180x180");
    work.prints(
        "design star/scene.toml --level draft --steps 10",
        &["warning: after the search 95.4 % of the target is seen, before it 95.6 %"],
    );
}

/// The fit does not depend on chance or on the number of cores: the same command writes the same
/// scene.
#[test]
fn the_same_drawing_becomes_the_same_scene() {
    let work = Workplace::new();
    let scene = |folder: &str| {
        work.output(&format!(
            "init {folder} --target configs/targets/leaf.svg --thickness 3 --size 210x297"
        ));
        work.read(&format!("{folder}/scene.toml"))
    };
    assert_eq!(scene("one"), scene("other"));
}
