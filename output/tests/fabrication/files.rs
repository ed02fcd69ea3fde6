//! DXF, SVG and PDF read back by other libraries: the sheet that they describe is the one that was
//! simulated.

use super::*;
use design::geometry::polygon::{distance_to_segment, edges};
use output::cut_file::{Layer, Machines, Tiling, dxf, svg, tiles_pdf};
use scene::Paper;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// What a file says: ends of the lines, centre and radius of the circles, corners of the outline
/// (mm).
#[derive(Default)]
pub(super) struct Read {
    pub(super) slits: Vec<[[f64; 2]; 2]>,
    pub(super) holes: Vec<([f64; 2], f64)>,
    pub(super) outline: Vec<[f64; 2]>,
}

impl Read {
    /// Compares holes, ligament widths, lengths and panel areas with the simulated sheet.
    pub(super) fn is_sheet(&self, sheet: &Sheet, error: f64) {
        assert_eq!(self.holes.len(), sheet.hinges.len());
        let at = |p: [f64; 2], q: [f64; 2]| length([p, q]) < error;
        for hinge in &sheet.hinges {
            let mut holes = self.holes.iter();
            let (_, radius) = holes.find(|(centre, _)| at(*centre, hinge.tip)).unwrap();
            assert_close(radius + 0.5 * KERF, FILLET_RATIO * hinge.w_lig, error);
            let own = |slit: &&[[f64; 2]; 2]| slit.iter().any(|end| at(*end, hinge.tip));
            let others = self.slits.iter().filter(|slit| !own(slit));
            let to_slits = others.map(|slit| distance(hinge.tip, *slit) - 0.5 * KERF);
            let to_outline =
                edges(&self.outline).map(|(p, q)| distance(hinge.tip, [p, q]) - 0.5 * KERF);
            assert_close(least(to_slits.chain(to_outline)), hinge.w_lig, error);
        }
        // Each panel's edges are on slits or, half a kerf inwards, on the outline.
        for panel in &sheet.panels {
            for (p, q) in edges(&panel.corners) {
                let middle = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
                let to_slits = self.slits.iter().map(|slit| distance(middle, *slit));
                let outline = edges(&self.outline).map(|(p, q)| distance(middle, [p, q]));
                let to_outline = outline.map(|away| (away - 0.5 * KERF).abs());
                assert!(least(to_slits.chain(to_outline)) < error);
            }
        }
        let area: f64 = sheet.panels.iter().map(|panel| panel.area).sum();
        let [low, high] = [f64::min, f64::max]
            .map(|of| [0, 1].map(|axis| self.outline.iter().map(|p| p[axis]).reduce(of).unwrap()));
        let written = (high[0] - low[0] - KERF) * (high[1] - low[1] - KERF);
        assert_close(written / area, 1.0, error / 100.0);
    }

    fn slit_length(&self) -> f64 {
        self.slits.iter().map(|slit| length(*slit)).sum()
    }
}

/// The entities of a DXF with their layers, and the defects that ezdxf finds in it.
#[derive(Deserialize)]
pub(super) struct DxfContents {
    version: String,
    millimetres: bool,
    pub(super) defects: Vec<String>,
    pub(super) lines: Vec<(String, [[f64; 2]; 2])>,
    pub(super) circles: Vec<(String, [f64; 2], f64)>,
    pub(super) polylines: Vec<(String, bool, Vec<[f64; 2]>)>,
    texts: Vec<String>,
}

/// Reads a DXF by ezdxf. Debian's package serves Debian's Python, whichever other is first on PATH.
pub(super) fn read_dxf(path: &Path) -> DxfContents {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fabrication/read_dxf.py");
    let output = Command::new("/usr/bin/python3").args([Path::new(script), path]).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn tool_length(cuts: &CutLines) -> f64 {
    let slits = cuts.slits.iter();
    slits.map(|slit| length(cuts.tool_slit(slit))).sum()
}

#[test]
fn the_dxf_holds_the_simulated_sheet_in_millimetres() {
    let folder = tempfile::tempdir().unwrap();
    let [path, again] = ["a.dxf", "b.dxf"].map(|name| folder.path().join(name));
    for (sheet, cuts, drawing) in irregular_sheets() {
        std::fs::write(&path, dxf(&drawing.annotated())).unwrap();
        std::fs::write(&again, dxf(&drawing.annotated())).unwrap();
        assert!(std::fs::read(&path).unwrap() == std::fs::read(&again).unwrap());

        let file = read_dxf(&path);
        assert_eq!(file.version, "R2000");
        assert!(file.millimetres);
        assert_eq!(file.defects, [""; 0]);
        let mut read = Read::default();
        for (layer, ends) in &file.lines {
            match layer.as_str() {
                "CUT" => read.slits.push(*ends),
                other => assert!(["ANNOTATION", "REGISTRATION"].contains(&other), "{other}"),
            }
        }
        for (layer, centre, radius) in &file.circles {
            match layer.as_str() {
                "HOLES" => read.holes.push((*centre, *radius)),
                other => assert_eq!(other, "REGISTRATION"),
            }
        }
        for (layer, closed, corners) in &file.polylines {
            assert!(layer == "OUTLINE" && *closed, "{layer}");
            read.outline = corners.clone();
        }
        assert!(file.texts.iter().all(|layer| layer == "ANNOTATION"));
        read.is_sheet(&sheet, 1e-9);
        assert_close(read.slit_length(), tool_length(&cuts), 1e-9);
        // Panels, hinges, the name of the scale bar and four lines of instructions.
        let numbers = sheet.panels.len() + sheet.hinges.len();
        assert_eq!(file.texts.len(), numbers + 1 + drawing.notes.len());
    }
}

/// Readers of R2000 need unique handles, owners that exist, and a next handle above all others.
#[test]
fn the_handles_of_the_dxf_are_unique_and_owned() {
    let (_, _, drawing) = irregular_sheets().next().unwrap();
    let text = dxf(&drawing.annotated());
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let pairs: Vec<(&str, &str)> = lines.chunks(2).map(|pair| (pair[0], pair[1])).collect();
    let hex = |value: &str| u32::from_str_radix(value, 16).unwrap();
    let mut begins = pairs.iter();
    let seed = begins.position(|pair| *pair == ("9", "$HANDSEED")).unwrap();
    let (header, body) = pairs.split_at(seed + 2);
    let handles = (body.iter()).filter(|(code, _)| ["5", "105"].contains(code));
    let handles: Vec<u32> = handles.map(|(_, value)| hex(value)).collect();
    let unique: BTreeSet<u32> = handles.iter().copied().collect();
    assert_eq!(unique.len(), handles.len());
    assert!(hex(header[seed + 1].1) > *unique.last().unwrap());
    let owners = (body.iter()).filter(|(code, _)| ["330", "350"].contains(code));
    for owner in owners.map(|(_, value)| hex(value)) {
        assert!(owner == 0 || unique.contains(&owner), "{owner:X}");
    }
    let is_declared = |layer: &&str| body.contains(&("2", *layer));
    let all = Layer::all().map(Layer::name).filter(is_declared);
    let used = ["HOLES", "CUT", "OUTLINE", "REGISTRATION", "ANNOTATION"];
    assert_eq!(all.collect::<Vec<_>>(), used);
}

/// Points and circles of every group of an SVG, in mm.
fn svg_paths(svg: &str) -> BTreeMap<String, Vec<Vec<[f64; 2]>>> {
    fn walk(group: &usvg::Group, layer: &str, found: &mut BTreeMap<String, Vec<Vec<[f64; 2]>>>) {
        let own = Some(group.id()).filter(|id| !id.is_empty());
        let layer = own.unwrap_or(layer);
        for node in group.children() {
            match node {
                usvg::Node::Group(group) => walk(group, layer, found),
                usvg::Node::Path(path) => {
                    let path = path.data().clone().transform(path.abs_transform()).unwrap();
                    let mm = |x: f32| f64::from(x) * 25.4 / 96.0;
                    let points = path.points().iter().map(|p| [mm(p.x), mm(p.y)]);
                    let of_layer = found.entry(layer.to_owned()).or_default();
                    of_layer.push(points.collect());
                }
                _ => {}
            }
        }
    }
    let tree = usvg::Tree::from_str(svg, &usvg::Options::default()).unwrap();
    let mut found = BTreeMap::new();
    walk(tree.root(), "", &mut found);
    found
}

#[test]
fn the_svg_holds_the_simulated_sheet_at_one_to_one() {
    for (sheet, cuts, drawing) in irregular_sheets() {
        let drawing = drawing.annotated();
        let paths = svg_paths(&svg(&drawing));
        assert!(svg(&drawing).contains("viewBox=\"0 0 "));
        // The page begins 5 mm to the left of the drawing and above it, and y points down.
        let [low, high] = drawing.bounds();
        let in_sheet = |[x, y]: [f64; 2]| [x + low[0] - 5.0, high[1] + 5.0 - y];
        let mut read = Read::default();
        for points in &paths["CUT"] {
            read.slits.push([in_sheet(points[0]), in_sheet(points[1])]);
        }
        for points in &paths["HOLES"] {
            let points: Vec<_> = points.iter().copied().map(in_sheet).collect();
            let extreme = |axis: usize, of: fn(f64, f64) -> f64| {
                points.iter().map(|p| p[axis]).reduce(of).unwrap()
            };
            let [x, y] = [0, 1].map(|axis| [extreme(axis, f64::min), extreme(axis, f64::max)]);
            let centre = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])];
            read.holes.push((centre, 0.5 * (x[1] - x[0])));
        }
        let outline = paths["OUTLINE"][0][..4].iter();
        read.outline = outline.copied().map(in_sheet).collect();
        // usvg keeps lengths of 3 m in single precision: 2e-4 mm; the file has four decimals.
        read.is_sheet(&sheet, 2e-3);
        assert_close(read.slit_length() / tool_length(&cuts), 1.0, 1e-6);
        assert!(paths.contains_key("REGISTRATION") && paths.contains_key("ANNOTATION"));
    }
}

#[test]
fn the_pdf_has_an_overview_and_a_page_of_paper_size_a_tile() {
    let (_, _, drawing) = irregular_sheets().nth(1).unwrap();
    let tiling = Tiling::new(Paper::A3, drawing.numbered.bounds()).unwrap();
    let bytes = tiles_pdf(&drawing.numbered, &tiling, "Sheet", &drawing.notes);
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.starts_with("%PDF-"));
    let boxes: Vec<&str> = text.split("/MediaBox [").skip(1).collect();
    // 1202 mm with the over-run, on tiles of 277 x 384 mm that overlap by 10 mm.
    assert_eq!(tiling.counts, [4, 5]);
    assert_eq!(boxes.len(), 20 + 1);
    for page in boxes {
        let sides = page.split(']').next().unwrap().split(' ');
        let sides: Vec<f64> = sides.map(|side| side.parse().unwrap()).collect();
        assert_close(sides[2] * 25.4 / 72.0, 297.0, 1e-3);
        assert_close(sides[3] * 25.4 / 72.0, 420.0, 1e-3);
    }
}

/// A point of the sheet is printed where its tile shows it, 72 points an inch.
#[test]
fn the_tiles_are_true_to_scale() {
    let (_, _, drawing) = irregular_sheets().next().unwrap();
    let drawing = drawing.numbered;
    let tiling = Tiling::new(Paper::A4, drawing.bounds()).unwrap();
    let bytes = tiles_pdf(&drawing, &tiling, "Sheet", &[]);
    let text = String::from_utf8_lossy(&bytes);
    let numbers = |line: &str| -> Vec<f64> {
        let words = line.split_whitespace();
        words.filter_map(|word| word.parse().ok()).collect()
    };
    // The drawing is written once, in mm; every slit with both of its ends.
    let form = text.split("/BBox").nth(1).unwrap();
    let form = form.split("endstream").next().unwrap();
    let lines: Vec<Vec<f64>> = form.lines().map(numbers).collect();
    for shape in drawing.on(Layer::Cut) {
        let ends = shape.ends();
        let written = lines.windows(2).any(|pair| {
            let near = |found: &Vec<f64>, end: [f64; 2]| {
                found.len() == 2 && (0..2).all(|axis| (found[axis] - end[axis]).abs() < 1e-3)
            };
            near(&pair[0], ends[0]) && near(&pair[1], ends[1])
        });
        assert!(written, "{ends:?}");
    }
    // Every tile shows it at one point a 72nd of an inch, shifted by the corner of the tile.
    let [rows, columns] = tiling.counts;
    let tiles = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let pages: Vec<&str> = text.split("/D Do").collect();
    assert_eq!(pages.len(), rows * columns + 1);
    for ((row, column), page) in tiles.zip(&pages) {
        let transforms = page.lines().filter(|line| line.ends_with(" cm"));
        let transforms: Vec<Vec<f64>> = transforms.map(numbers).collect();
        let [.., scale, shift] = &transforms[..] else { panic!("{page}") };
        assert_close(scale[0], 72.0 / 25.4, 1e-6);
        assert_eq!(scale[0], scale[3]);
        assert_eq!(shift[..4], [1.0, 0.0, 0.0, 1.0]);
        let [low, _] = tiling.tile(row, column);
        let corner = [10.0 - low[0], 26.0 - low[1]];
        assert_close(shift[4], corner[0], 1e-3);
        assert_close(shift[5], corner[1], 1e-3);
    }
}

/// What the tool of each machine leaves, measured in its files: the outline of the slots and the
/// paths of a tool.
#[test]
fn the_files_of_every_machine_leave_the_solved_ligaments() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.dxf");
    let machines = Machines::shipped();
    for (_, cuts, _) in irregular_sheets() {
        for machine in &machines.machine {
            let drawing = machine.drawing(&cuts).unwrap();
            std::fs::write(&path, dxf(&drawing)).unwrap();
            let file = read_dxf(&path);
            assert_eq!(file.defects, [""; 0], "{}", machine.name);
            let paths = svg_paths(&svg(&drawing));
            let drawn = file.lines.len() + file.circles.len() + file.polylines.len();
            let found: usize = paths.values().map(Vec::len).sum();
            assert_eq!(found, drawn, "{}", machine.name);
            match &*machine.name {
                "laser-service" => contours_leave_the_ligaments(&file, &cuts),
                "lightburn" | "ponoko" => {
                    // A path of the tool half a kerf inside the hole, and slits half a kerf from
                    // their flanks.
                    for (_, centre, radius) in &file.circles {
                        let mut holes = cuts.holes.iter();
                        let hole = holes.find(|hole| length([hole.centre, *centre]) < 1e-9);
                        assert_close(radius + 0.5 * cuts.kerf(), hole.unwrap().radius, 1e-9);
                    }
                    assert_eq!(file.circles.len(), cuts.holes.len());
                    assert!(file.texts.is_empty());
                }
                "plain" => {
                    let radii = file.circles.iter().map(|(.., radius)| *radius);
                    let nominal: f64 = cuts.holes.iter().map(|hole| hole.radius).sum();
                    assert_close(radii.sum(), nominal, 1e-6 * nominal);
                }
                "knife" => {
                    let holes = cuts.holes.iter();
                    let small = holes.filter(|hole| 2.0 * hole.radius < 5.0).count();
                    let punched = file.lines.iter().filter(|(layer, _)| layer == "PUNCH");
                    assert_eq!(punched.count(), 2 * small);
                    let cut = file.circles.iter().filter(|(layer, ..)| layer == "HOLES");
                    assert_eq!(cut.count(), cuts.holes.len() - small);
                }
                other => panic!("the machine {other} has no test"),
            }
        }
    }
}

/// Slits that are wider than the tool are cut around, by every machine whose file has paths of a
/// tool: what remains is the finished sheet. A machine that cuts lines alone refuses them, and so
/// does one whose tool is not known.
#[test]
fn a_tool_cuts_around_slits_that_are_wider() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.dxf");
    let machines = Machines::shipped();
    let drawing = |name: &str, cuts: &CutLines| {
        let machine = machines.machine.iter().find(|it| it.name == name).unwrap();
        machine.drawing(cuts)
    };
    for (_, mut cuts, _) in irregular_sheets() {
        let kerf = 0.25 * KERF;
        cuts.cutting.kerf = Some(kerf);
        // A sheet whose finished edges are the paths.
        let mut paths = cuts.clone();
        paths.slit_width -= kerf;
        paths.outlines = cuts.tool_outlines();
        paths.holes.iter_mut().for_each(|hole| hole.radius -= 0.5 * kerf);
        for drawn in [drawing("ponoko", &cuts), drawing("lightburn", &cuts), Ok(cuts.drawing())] {
            std::fs::write(&path, dxf(&drawn.unwrap())).unwrap();
            contours_leave_the_ligaments(&read_dxf(&path), &paths);
        }
        let refused =
            |machine: &str, cuts: &CutLines| drawing(machine, cuts).unwrap_err().to_string();
        assert!(refused("knife", &cuts).starts_with("the slits are"));
        cuts.cutting.kerf = None;
        assert!(refused("lightburn", &cuts).contains("set cutting.kerf"));
        assert!(drawing("laser-service", &cuts).is_ok());
    }
}

/// Ponoko cuts blue lines and engraves red ones; a layer has one colour, in both files.
#[test]
fn cuts_and_marks_have_the_colours_of_the_machine() {
    let machines = Machines::shipped();
    let named = |name: &str| machines.machine.iter().find(|it| it.name == name).unwrap();
    let (_, cuts, _) = irregular_sheets().next().unwrap();
    for (machine, strokes, indices) in [
        ("ponoko", &["#0000ff"; 3][..], &["5"; 3][..]),
        ("lightburn", &["#0000ff", "#ff0000", "#000000"][..], &["5", "1", "7"][..]),
    ] {
        let drawing = named(machine).drawing(&cuts).unwrap();
        let file = svg(&drawing);
        let groups = file.split("stroke=\"").skip(1);
        let found: Vec<&str> = groups.map(|rest| &rest[..7]).collect();
        assert_eq!(found, strokes, "{machine}");
        let file = dxf(&drawing);
        let layers = file.split("AcDbLayerTableRecord").skip(2);
        let found: Vec<&str> = layers
            .map(|record| record.split(" 62\n").nth(1).unwrap().lines().next().unwrap())
            .collect();
        assert_eq!(found, indices, "{machine}");
    }
}

/// Nothing but closed contours, whose edges are the edges of the finished sheet.
fn contours_leave_the_ligaments(file: &DxfContents, cuts: &CutLines) {
    assert!(file.lines.is_empty() && file.circles.is_empty() && file.texts.is_empty());
    assert!(file.polylines.iter().all(|(_, closed, _)| *closed));
    let polylines = file.polylines.iter();
    let outlines = polylines.filter(|(layer, ..)| layer == "OUTLINE");
    assert_eq!(outlines.count(), 1);
    let contours: Vec<_> = file.polylines.iter().map(|(.., points)| points).collect();
    for (hinge, hole) in cuts.holes.iter().enumerate() {
        let from_centre = |point: [f64; 2]| length([point, hole.centre]);
        let on_hole = |points: &&&Vec<[f64; 2]>| {
            let near = |point: &&[f64; 2]| (from_centre(**point) - hole.radius).abs() < 1e-9;
            points.iter().filter(near).count() > 100
        };
        assert_eq!(contours.iter().filter(on_hole).count(), 1, "hinge {hinge}");
        // From the tip to all contours but the hole, along the material.
        let far = |end: [f64; 2]| from_centre(end) > 1.2 * hole.radius;
        let outside = |(p, q): &([f64; 2], [f64; 2])| far(*p) && far(*q);
        let others = contours.iter().flat_map(|points| edges(points));
        let others = others.filter(outside);
        let others = others.filter(|(p, q)| !own_flank(cuts, hinge, [*p, *q]));
        let apart = least(others.map(|(p, q)| distance_to_segment(hole.centre, p, q)));
        assert_close(apart - hole.radius, cuts.caliper(hinge), 1e-6);
    }
}

/// Whether an edge of a contour is on the slit of a hinge.
fn own_flank(cuts: &CutLines, hinge: usize, edge: [[f64; 2]; 2]) -> bool {
    let mut slits = cuts.slits.iter();
    let own = slits.find(|slit| slit.hinges.contains(&Some(hinge)));
    let [p, q] = own.unwrap().ends;
    let on_slit = |end: &[f64; 2]| distance_to_segment(*end, p, q) < 0.6 * cuts.slit_width;
    edge.iter().all(on_slit)
}
