//! A sheet that fasteners open on a board.

use super::*;
use std::fmt::Write;

/// The places of three middles when hinges open by 0.6 rad: panels of 400 mm move away from the
/// first by a quarter.
const FASTENERS: [([usize; 2], [f64; 2]); 3] =
    [([0, 0], [0.0, 0.0]), ([2, 2], [200.7, 200.7]), ([2, 0], [200.7, 0.0])];

fn mounted() -> Finished {
    let mut fasteners = "[posture]\nkind = \"mounted\"\n".to_owned();
    for (panel, displacement) in FASTENERS {
        write!(
            fasteners,
            "[[supports]]\npanel = {panel:?}\nkind = \"pin\"\nhole = 20.0\ndisplacement = {displacement:?}\n"
        )
        .unwrap();
    }
    Finished::new(&with(&[(SUPPORT, &fasteners), (PULL, ""), QUICK]))
}

/// The polygons of a layer of a DXF file.
fn polygons(dxf: &str, layer: &str) -> Vec<Vec<[f64; 2]>> {
    let lines: Vec<&str> = dxf.lines().map(str::trim).collect();
    let pairs: Vec<(&str, &str)> = lines.chunks(2).map(|pair| (pair[0], pair[1])).collect();
    let entities = pairs.split(|(code, _)| *code == "0");
    let on_layer = entities.filter(|entity| {
        entity.contains(&("8", layer)) && entity.contains(&("100", "AcDbPolyline"))
    });
    let of = |entity: &[(&str, &str)], code: &str| -> Vec<f64> {
        let values = entity.iter().filter(|(found, _)| *found == code);
        values.map(|(_, value)| value.parse().unwrap()).collect()
    };
    on_layer
        .map(|entity| {
            std::iter::zip(of(entity, "10"), of(entity, "20")).map(|(x, y)| [x, y]).collect()
        })
        .collect()
}

fn centroid(corners: &[[f64; 2]]) -> [f64; 2] {
    let (mut twice, mut sums) = (0.0, [0.0; 2]);
    for (i, p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let cross = p[0] * q[1] - p[1] * q[0];
        twice += cross;
        (0..2).for_each(|axis| sums[axis] += cross * (p[axis] + q[axis]));
    }
    sums.map(|sum| sum / (3.0 * twice))
}

#[test]
fn the_kit_of_a_mounted_sheet_has_its_holes_on_the_crosses() {
    let run = mounted();
    // A film leaves its plane between the fasteners: its files are forced.
    write_results(&run.scene, &run.designed, true).unwrap();
    let mounting = run.report.mounting.as_ref().unwrap();
    assert!(mounting.is_complete() && mounting.apart < 1e-3, "{}", mounting.apart);
    let panels: Vec<usize> = mounting.fasteners.iter().map(|fastener| fastener.panel).collect();
    assert_eq!(panels, [0, 8, 2]);
    // The holes are at the centroids of the panels, opened in the other file.
    let opened = polygons(&run.file("deployed.dxf"), "PANELS");
    let board = run.file("mount.dxf");
    assert_eq!(polygons(&board, "PANELS"), opened);
    for fastener in &mounting.fasteners {
        for (place, middle) in std::iter::zip(fastener.place, centroid(&opened[fastener.panel])) {
            assert!((place - middle).abs() < 0.1, "{place} {middle}");
        }
        let [x, y] = fastener.place;
        assert!(board.contains(&format!(" 10\n{}\n 20\n{y}\n", x - 8.0)), "{board}");
    }
    let list = run.file("attachments.csv");
    assert!(
        list.starts_with("attachment,panel,x_mm,y_mm,hole_diameter_mm,clip_width_mm,board_x_mm,")
    );
    let kit = std::fs::read(run.scene.output().join("mount.pdf")).unwrap();
    assert!(kit.starts_with(b"%PDF") && run.file("mount.svg").contains("pull panel P8 by"));
}

/// Forces that open a sheet of linear hinges grow with its stresses, and its shape does not change.
#[test]
fn a_mounted_sheet_is_as_strong_as_its_material_and_as_open() {
    let run = mounted();
    let steps: Vec<&str> = (run.report.facts.iter())
        .filter(|fact| fact.label == "mounting")
        .map(|fact| fact.text.as_str())
        .collect();
    assert_eq!(steps.len(), 3);
    assert!(steps[1].starts_with("2: pull panel P8 by 28"), "{steps:?}");
    let what_if = |change: &str| {
        let mut rows = run.report.facts.iter().filter(|fact| fact.label == "what if");
        let row = rows.find(|fact| fact.text.starts_with(change));
        row.unwrap_or_else(|| panic!("{change}")).value["end"]["corners"][1].as_f64().unwrap()
    };
    assert!(what_if("all stresses 20 % lower") < 1e-6);
    let off = what_if("hole 1 off by 0.5 mm");
    assert!((0.1..5.0).contains(&off), "{off}");
    assert!(what_if("without the last fastener") > 0.0);
}
