//! Sheets split into parts: together they are the sheet, each fits on the bed, and every ligament is whole.

use super::{distance, irregular, irregular_sheets, length, uniform, uniform_cuts};
use design::pattern::grid::Grid;
use output::cut_file::{FabricationError, Layer, Part, split};
use output::display::Shape;

/// The lines of a layer of a part, in the sheet.
fn lines(part: &Part, layer: Layer) -> Vec<[[f64; 2]; 2]> {
    let in_sheet = |p: [f64; 2]| [p[0] + part.origin[0], p[1] + part.origin[1]];
    let shapes = part.drawing.on(layer);
    shapes.map(|shape| shape.ends().map(in_sheet)).collect()
}

fn points([a, b]: [[f64; 2]; 2]) -> impl Iterator<Item = [f64; 2]> {
    (0..=20).map(move |i| {
        let f = f64::from(i) / 20.0;
        [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])]
    })
}

fn on(point: [f64; 2], lines: &[[[f64; 2]; 2]]) -> bool {
    lines.iter().any(|line| distance(point, *line) < 1e-6)
}

#[test]
fn the_parts_of_random_sheets_are_together_the_whole_sheet() {
    for (sheet, cuts, _) in irregular_sheets() {
        for bed in [[1000.0, 1000.0], [2000.0, 900.0], [1100.0, f64::INFINITY]] {
            let split = split(&cuts, &sheet, bed, 10.0).unwrap();
            let parts = &split.parts;
            let area: f64 = parts.iter().map(|part| part.area).sum();
            assert!((area / sheet.outline.area() - 1.0).abs() < 1e-9, "{area}");
            for part in parts {
                assert!(
                    part.size[0] <= bed[0] && part.size[1] <= bed[1],
                    "{:?}",
                    part.size
                );
                assert!(part.area < part.size[0] * part.size[1]);
            }
            // Every hole once.
            let mut holes: Vec<[f64; 2]> = parts
                .iter()
                .flat_map(|part| lines(part, Layer::Holes))
                .map(|[centre, _]| centre)
                .collect();
            assert_eq!(holes.len(), cuts.holes.len());
            for hole in &cuts.holes {
                let at = holes
                    .iter()
                    .position(|centre| length([*centre, hole.centre]) < 1e-9);
                holes.swap_remove(at.unwrap());
            }
            // All slits and nothing else is cut; so is the outline.
            let all =
                |layer| -> Vec<_> { parts.iter().flat_map(|part| lines(part, layer)).collect() };
            let slits: Vec<_> = cuts.slits.iter().map(|slit| cuts.tool_slit(slit)).collect();
            let outline = cuts.tool_outline();
            let outline: Vec<_> = (0..4).map(|k| [outline[k], outline[(k + 1) % 4]]).collect();
            for (layer, whole) in [(Layer::Cut, slits), (Layer::Outline, outline)] {
                let pieces = all(layer);
                assert!(
                    whole
                        .iter()
                        .copied()
                        .flat_map(points)
                        .all(|p| on(p, &pieces))
                );
                assert!(
                    pieces
                        .iter()
                        .copied()
                        .flat_map(points)
                        .all(|p| on(p, &whole))
                );
            }
            // A seam is cut in two parts; the first of them has the hole.
            assert_eq!(all(Layer::Joint).len(), 2 * split.joints.len());
            for (seam, parts_of) in &split.joints {
                let [keeper, joined] = parts_of.map(|part| &parts[part]);
                let hole = cuts.holes[seam.hinge].centre;
                let drills = |part: &Part| {
                    let holes = lines(part, Layer::Holes);
                    holes
                        .iter()
                        .any(|[centre, _]| length([*centre, hole]) < 1e-9)
                };
                assert!(drills(keeper) && !drills(joined));
                let middle = [0, 1].map(|axis| 0.5 * (seam.ends[0][axis] + seam.ends[1][axis]));
                for part in [keeper, joined] {
                    assert!(on(middle, &lines(part, Layer::Joint)));
                }
                // The tape, 10 mm wide on either side, keeps clear of the ligament.
                let clear = distance(hole, seam.ends) - 10.0;
                assert!(
                    clear >= 2.5 * sheet.hinges[seam.hinge].w_lig - 1e-9,
                    "{clear}"
                );
            }
            assert_eq!(split.joint_list().lines().count(), 1 + split.joints.len());
        }
    }
}

/// The material on either side of the line, with the triangles that go with the ligaments.
#[test]
fn the_uniform_sheet_is_split_after_its_second_column() {
    let (_, sheet) = uniform(18.0);
    let split = split(&uniform_cuts(), &sheet, [950.0, 1300.0], 20.0).unwrap();
    let [left, right] = &split.parts[..] else {
        panic!("{} parts", split.parts.len());
    };
    // Three hinges between the second and the third column, with right angles: each seam cuts two edges at
    // 18.1 + (2.5 x 18 + 20) sqrt 2 = 110.0 mm, but 0.1 mm less where the ligament is on the outline.
    assert_eq!(split.joints.len(), 3);
    for (seam, _) in &split.joints {
        let leg = length(seam.ends) / 2.0_f64.sqrt();
        assert!((leg - 110.0).abs() < 0.2, "{leg}");
    }
    // The triangle at a hinge goes to the part that keeps the ligament.
    let triangles = split.joints.iter().map(|(seam, [keeper, _])| {
        let area = length(seam.ends).powi(2) / 4.0;
        if *keeper == 0 { area } else { -area }
    });
    let given: f64 = triangles.sum();
    assert!((left.area - (2.0 * 1200.0 * 400.0 + given)).abs() < 1e-6);
    assert!((right.area - (1200.0 * 400.0 - given)).abs() < 1e-6);
    let seam = 110.2;
    assert!(right.origin[0] > 800.0 - seam && left.size[0] < 801.0 + seam);
}

#[test]
fn a_sheet_that_fits_has_one_part_and_no_joint() {
    let (_, sheet) = uniform(18.0);
    let split = split(&uniform_cuts(), &sheet, [1300.0, 1300.0], 20.0).unwrap();
    assert_eq!((split.parts.len(), split.joints.len()), (1, 0));
    let outline: f64 = split.parts[0]
        .drawing
        .on(Layer::Outline)
        .map(Shape::length)
        .sum();
    assert!((outline - 4800.8).abs() < 1e-9, "{outline}");
}

#[test]
fn beds_and_tapes_that_leave_no_room_are_refused() {
    let grid = Grid { m: 4, n: 3 };
    let (pattern, sheet) = irregular(grid, 5);
    let cuts = super::cut_lines(&pattern, &sheet);
    let error = split(&cuts, &sheet, [300.0, 5000.0], 5.0).unwrap_err();
    assert!(
        matches!(error, FabricationError::PartTooLarge { .. }),
        "{error}"
    );
    // The tape that a message states has room at that hinge; following the messages leads to parts.
    let mut lap = 190.0;
    let mut refused = 0;
    while let Err(error) = split(&cuts, &sheet, [1000.0, 5000.0], lap) {
        let FabricationError::NoRoomForSeam { widest, .. } = error else {
            panic!("{error}");
        };
        assert!(0.0 < widest && widest < lap, "{error}");
        let stated = format!(
            "use --lap {}, or a larger bed",
            (10.0 * widest).floor() / 10.0
        );
        assert!(error.to_string().contains(&stated), "{error}");
        lap = widest - 1e-9;
        refused += 1;
    }
    assert!(refused > 0);
}
