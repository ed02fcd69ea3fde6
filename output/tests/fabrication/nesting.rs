//! Several designs on sheets of one stock: pieces are apart and inside the margins, and what is cut in each is its own design.

use super::files::{Read, read_dxf};
use super::order_and_numbers::undirected;
use super::{irregular_sheets, length};
use output::cut_file::{
    CutDrawing, FabricationError, Layer, Machines, NestedDesign, NestingStock, Place, dxf, nest,
};
use output::display::Shape;
use proptest::prelude::*;

/// Rounding of the packing, which is in whole micrometres (mm).
const ROUNDING: f64 = 2e-6;

/// A design whose only path is its outline, somewhere in its own frame.
fn rectangle(number: usize, [width, height]: [f64; 2], copies: usize, kerf: f64) -> NestedDesign {
    let mut paths = CutDrawing::default();
    let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
    let corners = corners.map(|[x, y]| [x - 17.0, y + 3.0]);
    paths.add(Layer::Outline, Shape::Polygon(corners.to_vec()));
    NestedDesign {
        name: format!("design {number}"),
        copies,
        paths,
        reach: 0.0,
        kerf,
        area: width * height,
    }
}

proptest! {
    #[test]
    fn pieces_are_apart_inside_the_margins_and_complete(
        sizes in prop::collection::vec(([20.0..290.0, 20.0..290.0], 1_usize..5), 1..6),
        margin in 0.0..20.0,
        gap in 0.0..10.0,
        kerf in 0.05..1.0,
        reach in 0.0..0.5,
        turns: bool,
    ) {
        let designs: Vec<NestedDesign> = (sizes.iter().enumerate())
            .map(|(i, (size, copies))| NestedDesign {
                reach,
                ..rectangle(i, *size, *copies, kerf)
            })
            .collect();
        let stock = NestingStock { size: [350.0, 330.0], margin, gap, turns };
        let sheets = nest(&designs, &stock).unwrap();
        let mut pieces = vec![Vec::new(); designs.len()];
        for sheet in &sheets {
            // The least that a sheet is for.
            prop_assert!(!sheet.places.is_empty());
            for (i, place) in sheet.places.iter().enumerate() {
                pieces[place.design].push(place.copy);
                let mut size = sizes[place.design].0;
                if place.turned {
                    prop_assert!(turns);
                    size.reverse();
                }
                prop_assert!(length([place.size, size]) < 1e-9);
                for (axis, side) in size.into_iter().enumerate() {
                    let [low, high] = [place.corner[axis], place.corner[axis] + side];
                    prop_assert!(low >= margin + reach - ROUNDING);
                    prop_assert!(high <= stock.size[axis] - margin - reach + ROUNDING);
                }
                for other in &sheet.places[..i] {
                    let apart = [0, 1].map(|axis| f64::max(
                        place.corner[axis] - other.corner[axis] - other.size[axis],
                        other.corner[axis] - place.corner[axis] - place.size[axis],
                    ));
                    let least = gap + kerf + 2.0 * reach;
                    prop_assert!(apart[0].max(apart[1]) >= least - ROUNDING, "{apart:?}");
                }
            }
        }
        for (found, design) in pieces.iter_mut().zip(&designs) {
            found.sort_unstable();
            prop_assert_eq!(&*found, &(1..=design.copies).collect::<Vec<_>>());
        }
    }
}

/// Counts that a person finds on squared paper.
#[test]
fn few_sheets_are_taken() {
    let stock = |size, turns| NestingStock {
        size,
        margin: 5.0,
        gap: 2.9,
        turns,
    };
    let sheets = |copies: &[([f64; 2], usize)], size, turns| {
        let designs: Vec<NestedDesign> = (copies.iter().enumerate())
            .map(|(i, (size, copies))| rectangle(i, *size, *copies, 0.1))
            .collect();
        nest(&designs, &stock(size, turns)).unwrap().len()
    };
    // Exactly four beside one another, and 0.01 mm too few.
    let four = [([97.0, 57.0], 4)];
    assert_eq!(
        sheets(&four, [2.0 * 97.0 + 13.0, 2.0 * 57.0 + 13.0], false),
        1
    );
    assert_eq!(
        sheets(&four, [2.0 * 97.0 + 12.99, 2.0 * 57.0 + 13.0], false),
        2
    );
    // Two that lie beside one another only if both are turned.
    assert_eq!(sheets(&[([100.0, 60.0], 2)], [133.0, 110.0], true), 1);
    assert_eq!(sheets(&[([100.0, 60.0], 2)], [133.0, 110.0], false), 2);
    // A pinwheel around a small square.
    let wheel = [([57.0, 37.0], 4), ([17.0, 17.0], 1)];
    assert_eq!(sheets(&wheel, [107.0, 107.0], true), 1);
}

/// The shapes of a file inside the rectangle of a piece, moved back to the frame of its design.
fn own(drawing: &CutDrawing, place: &Place, paths: &CutDrawing) -> CutDrawing {
    let [low, high] = paths.bounds();
    let inside = |[x, y]: [f64; 2]| {
        let [u, v] = [x - place.corner[0], y - place.corner[1]];
        (-1.0..=place.size[0] + 1.0).contains(&u) && (-1.0..=place.size[1] + 1.0).contains(&v)
    };
    let shapes = drawing.shapes.iter();
    let shapes = shapes.filter(|(_, shape)| inside(shape.ends()[0]));
    let mut own = CutDrawing {
        shapes: shapes.cloned().collect(),
    };
    own.shift(place.corner.map(|x| -x));
    if place.turned {
        // Three quarters of a turn more; the rectangle then lies below its corner.
        (0..3).for_each(|_| own.turn());
        own.shift([low[0], high[1]]);
    } else {
        own.shift(low);
    }
    own
}

/// Every shape with its coordinates rounded to a nanometre, in an order that does not depend on that of the cuts.
fn sorted(drawing: &CutDrawing) -> Vec<(Layer, String)> {
    let round = |x: f64| (1e6 * x).round() / 1e6 + 0.0;
    let point = |p: [f64; 2]| p.map(round);
    let shapes = drawing.shapes.iter().map(|(layer, shape)| {
        let shape = match shape {
            Shape::Line(ends) => Shape::Line(ends.map(point)),
            Shape::Circle { centre, radius } => Shape::Circle {
                centre: point(*centre),
                radius: round(*radius),
            },
            Shape::Polygon(corners) => Shape::Polygon(corners.iter().map(|p| point(*p)).collect()),
            other => panic!("{other:?} in the file of a machine"),
        };
        (*layer, undirected(&shape))
    });
    let mut shapes: Vec<_> = shapes.collect();
    shapes.sort();
    shapes
}

/// Each file is read by ezdxf: the pieces in it have the ligaments of their own design, and the paths of its own file.
#[test]
fn every_piece_of_a_nested_file_is_its_design() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.dxf");
    let machines = Machines::read(None).unwrap();
    let sheets: Vec<_> = irregular_sheets().take(4).collect();
    let mut turned = 0;
    for machine in &machines.machine {
        let designs: Vec<NestedDesign> = (sheets.iter().enumerate())
            .map(|(i, (_, cuts, _))| NestedDesign {
                name: i.to_string(),
                copies: 2,
                paths: machine.paths(cuts).unwrap(),
                reach: machine.reach(cuts),
                kerf: cuts.kerf,
                area: 0.0,
            })
            .collect();
        let stock = NestingStock {
            size: [3000.0, 2100.0],
            margin: 10.0,
            gap: 5.0,
            turns: true,
        };
        for nested in nest(&designs, &stock).unwrap() {
            let layers: Vec<Layer> = nested.drawing.shapes.iter().map(|it| it.0).collect();
            assert!(layers.is_sorted(), "{}: {layers:?}", machine.name);
            let mut count = 0;
            for (i, place) in nested.places.iter().enumerate() {
                // What is left of the stock between two pieces, whichever edge the paths are.
                let half = 0.5 * super::KERF + machine.reach(&sheets[place.design].1);
                for other in &nested.places[..i] {
                    let apart = [0, 1].map(|axis| {
                        f64::max(
                            place.corner[axis] - other.corner[axis] - other.size[axis],
                            other.corner[axis] - place.corner[axis] - place.size[axis],
                        )
                    });
                    let left = apart[0].max(apart[1]) - 2.0 * half;
                    assert!(left >= stock.gap - ROUNDING, "{}: {left}", machine.name);
                }
                turned += usize::from(place.turned);
                let paths = &designs[place.design].paths;
                let found = own(&nested.drawing, place, paths);
                count += found.shapes.len();
                assert_eq!(sorted(&found), sorted(paths), "{}", machine.name);
            }
            assert_eq!(count, nested.drawing.shapes.len());
            if machine.name != "lightburn" {
                continue;
            }
            std::fs::write(&path, dxf(&nested.drawing)).unwrap();
            let file = read_dxf(&path);
            assert_eq!(file.defects, [""; 0]);
            for place in &nested.places {
                let mut drawing = CutDrawing::default();
                for (_, ends) in &file.lines {
                    drawing.add(Layer::Cut, Shape::Line(*ends));
                }
                for (_, centre, radius) in &file.circles {
                    let (centre, radius) = (*centre, *radius);
                    drawing.add(Layer::Holes, Shape::Circle { centre, radius });
                }
                for (_, _, corners) in &file.polylines {
                    drawing.add(Layer::Outline, Shape::Polygon(corners.clone()));
                }
                let mut read = Read::default();
                for (_, shape) in own(&drawing, place, &designs[place.design].paths).shapes {
                    match shape {
                        Shape::Line(ends) => read.slits.push(ends),
                        Shape::Circle { centre, radius } => read.holes.push((centre, radius)),
                        Shape::Polygon(corners) => read.outline = corners,
                        _ => {}
                    }
                }
                read.is_sheet(&sheets[place.design].0, 1e-8);
            }
        }
    }
    assert!(turned > 0, "no piece was turned");
}

#[test]
fn a_design_that_does_not_fit_is_named() {
    let designs = [
        rectangle(0, [50.0, 40.0], 1, 0.2),
        rectangle(1, [80.0, 90.0], 1, 0.2),
    ];
    let with = |size, margin, turns| {
        let stock = NestingStock {
            size,
            margin,
            gap: 3.0,
            turns,
        };
        nest(&designs, &stock)
    };
    assert!(with([100.0, 90.0], 5.0, true).is_ok());
    for (size, margin, turns) in [
        ([100.0, 90.0], 5.0, false),
        ([100.0, 89.9], 5.0, true),
        ([200.0, 200.0], 100.0, true),
        ([200.0, 200.0], 500.0, true),
    ] {
        let error = with(size, margin, turns).unwrap_err();
        assert!(
            matches!(&error, FabricationError::LargerThanStock { .. }),
            "{error}"
        );
        let largest = if margin < 50.0 {
            "design 1"
        } else {
            "design 0"
        };
        assert!(error.to_string().starts_with(largest), "{error}");
        let turns_it = error.to_string().contains("--no-turn");
        assert_eq!(turns_it, !turns && margin < 50.0, "{error}");
    }
}
