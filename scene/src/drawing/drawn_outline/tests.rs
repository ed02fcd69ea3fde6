use super::*;
use design::geometry::polygon;
use std::fmt::Write;

fn svg(content: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' fill='none' stroke='#000'>{content}</svg>")
}

/// A slot of 40 between its centres and 20 wide.
const SLOT: &str =
    "0 LWPOLYLINE 8 CUT 90 4 70 1 10 0 20 0 10 40 20 0 42 1 10 40 20 20 10 0 20 20 42 1";

/// A DXF file with a unit and entities, their pairs separated by blanks.
fn dxf(unit: &str, entities: &str) -> String {
    let mut text = String::new();
    let all = format!(
        "0 SECTION 2 HEADER 9 $INSUNITS 70 {unit} 0 ENDSEC \
         0 SECTION 2 TABLES 0 LAYER 2 OFF 70 0 62 -7 0 LAYER 2 FROZEN 70 1 62 7 \
         0 LAYER 2 UNPLOTTED 70 0 62 7 290 0 0 ENDSEC \
         0 SECTION 2 BLOCKS 0 BLOCK 2 SLOT 10 5 20 0 {SLOT} 0 ENDBLK \
         0 BLOCK 2 OUTER 10 0 20 0 0 INSERT 2 Slot 10 0 20 7 50 90 0 ENDBLK \
         0 BLOCK 2 ENDLESS 10 0 20 0 0 INSERT 2 ENDLESS 10 0 20 0 0 ENDBLK 0 ENDSEC \
         0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
    );
    for part in all.split_whitespace() {
        let _ = writeln!(text, "  {part}\r");
    }
    text
}

fn area(text: &str) -> f64 {
    let outline = of_file(text.as_bytes(), None).unwrap_or_else(|error| panic!("{error}"));
    polygon::area(&outline.vertices).abs()
}

#[test]
fn pieces_whose_ends_meet_are_one_outline() {
    let pieces =
        "<path d='M0 0H10'/><line x1='10' y1='8' x2='10' y2='0' fill='#000'/><path d='M10 8H0V0'/>";
    assert_eq!(area(&svg(pieces)), 80.0);
    // Twice the same line is one line.
    assert_eq!(area(&svg(&format!("{pieces}<path d='M0 0H10'/>"))), 80.0);
    for (further, part) in [
        (
            "<path d='M10 8L20 21'/>",
            "2 pieces, by size #1 10 x 13 at (10, 8) (branches), #2 10 x 8 at (0, 0)",
        ),
        ("<path d='M10 8L0 0'/>", "branch at (10, 8)"),
        (
            "<path d='M30 0H40'/>",
            "2 pieces, by size #1 10 x 8 at (0, 0), #2 10 x 0 at (30, 0) (open)",
        ),
    ] {
        let error = of_text(&svg(&format!("{pieces}{further}")), None).unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
}

/// A line of no length, a line twice, also backwards or along a closed contour, and what is
/// drawn elsewhere.
#[test]
fn lines_that_do_not_matter_do_not_stop_the_file() {
    let pieces = "<path d='M0 0H10'/><path d='M10 0V8'/><path d='M10 8H0V0'/>";
    for further in [
        "<path d='M10 0H10'/>",
        "<path d='M5 0l0.00001 0'/>",
        "<path d='M4 4h0'/>",
        "<path d='M10 0H0'/><path d='M10 8V0'/>",
        "<path d='M0 0 L10 0 L10.00002 8'/>",
        "<path d='M10 8H0V0H10Z'/>",
    ] {
        assert_eq!(area(&svg(&format!("{pieces}{further}"))), 80.0, "{further}");
    }
    let star = "<path d='M30 0H35'/><path d='M35 0V3'/><path d='M35 0L37 -3'/>";
    let text = svg(&format!("{pieces}{star}"));
    let named = of_text(&text, Some(1)).unwrap();
    assert_eq!(polygon::area(&named.vertices).abs(), 80.0);
    let branch = of_text(&text, Some(2)).unwrap_err().to_string();
    assert!(branch.contains("branch at (35, 0)"), "{branch}");
}

#[test]
fn files_that_are_no_drawings_are_named_with_the_way_out() {
    let light_burn = "<?xml version='1.0'?><LightBurnProject AppVersion='1.4'/>";
    for (bytes, part) in [
        (&b"\x89PNG\r\n\x1a\n\0\0"[..], "a picture (PNG): `init --target` traces it"),
        (b"\xFF\xD8\xFF\xE0\0", "a picture (JPEG)"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n", "PostScript (EPS)"),
        (b"AC1027\0", "a DWG drawing: save it as DXF"),
        (b"IN;SP1;PU0,0;PD9,9;", "begins with `IN;SP1;PU0,0;PD9,9;`: it is a plotter file"),
        (b"G21\nG90\n", "it is a program of a machine"),
        (b"12,5\n", "it is no drawing that is read"),
        (light_burn.as_bytes(), "a document of the kind `LightBurnProject`; export"),
    ] {
        let error = of_file(bytes, None).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn one_of_several_outlines_is_chosen_by_its_number() {
    let text = svg("<circle r='1'/><rect x='9' width='6' height='4'/><path d='M0 0H1'/>");
    let chosen = of_text(&text, Some(1)).unwrap();
    assert_eq!(polygon::area(&chosen.vertices).abs(), 24.0);
    for (number, part) in [
        (None, "3 pieces"),
        (Some(4), "no contour 4"),
        (Some(0), "no contour 0"),
        (Some(3), "2 different"),
    ] {
        let error = of_text(&text, number).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    let split = |name: &str| numbered(Path::new(name));
    assert_eq!(split("a/b.dxf#2"), ("a/b.dxf".into(), Some(2)));
    assert_eq!(split("a#1/b.dxf"), ("a#1/b.dxf".into(), None));
}

#[test]
fn a_compressed_drawing_is_read() {
    // <svg xmlns='http://www.w3.org/2000/svg'><rect width='6' height='4'/></svg>
    let svgz = [
        31, 139, 8, 0, 0, 0, 0, 0, 2, 3, 179, 41, 46, 75, 87, 168, 200, 205, 201, 43, 182, 85, 207,
        40, 41, 41, 176, 210, 215, 47, 47, 47, 215, 43, 55, 214, 203, 47, 74, 215, 55, 50, 48, 48,
        208, 7, 170, 80, 183, 179, 41, 74, 77, 46, 81, 40, 207, 76, 41, 201, 176, 85, 55, 83, 87,
        200, 72, 205, 76, 207, 40, 177, 85, 55, 81, 215, 183, 179, 1, 41, 177, 3, 0, 242, 90, 246,
        153, 74, 0, 0, 0,
    ];
    let outline = of_file(&svgz, None).unwrap();
    assert_eq!(polygon::area(&outline.vertices).abs(), 24.0);
}

#[test]
fn a_filled_path_that_ends_open_is_closed_and_its_gap_known() {
    let filled = svg("<path fill='#000' d='M0 0H30V40'/>");
    let outline = of_text(&filled, None).unwrap();
    assert_eq!(outline.gap, 50.0);
    assert_eq!(polygon::area(&outline.vertices).abs(), 600.0);
}

/// Areas in mm^2 of entities in mm and inches.
#[test]
fn the_outline_of_a_dxf_file_has_its_area() {
    use std::f64::consts::PI;
    let rounded = SLOT;
    let old = "0 POLYLINE 8 0 70 1 0 VERTEX 10 0 20 0 0 VERTEX 10 40 20 0 42 1 0 VERTEX 10 40 20 20 0 VERTEX 10 0 20 20 42 1 0 SEQEND";
    let pieces = "0 LINE 10 0 20 0 11 40 21 0 0 ARC 10 40 20 10 40 10 50 -90 51 90 \
                  0 LINE 10 0 20 20 11 40 21 20 0 ARC 10 0 20 10 40 10 50 90 51 270";
    let ellipse = "0 ELLIPSE 10 5 20 5 11 20 21 0 40 0.5 41 0 42 6.283185307179586";
    // Four quarters of a circle as rational quadratics.
    let knots = "40 0 40 0 40 0 40 1 40 1 40 2 40 2 40 3 40 3 40 4 40 4 40 4";
    let corners = "10 1 20 0 10 1 20 1 10 0 20 1 10 -1 20 1 10 -1 20 0 10 -1 20 -1 10 0 20 -1 10 1 20 -1 10 1 20 0";
    let half = 0.5_f64.sqrt();
    let weights = format!("41 1 41 {half} 41 1 41 {half} 41 1 41 {half} 41 1 41 {half} 41 1");
    let spline = format!("0 SPLINE 70 1 71 2 {knots} {weights} {corners}");
    let slot = 800.0 + 100.0 * PI;
    // Seen from below: x and the sense of the arcs are reversed.
    let mirrored = "0 LINE 10 0 20 0 11 40 21 0 0 ARC 230 -1 10 -40 20 10 40 10 50 90 51 270 \
                    0 LINE 10 0 20 20 11 40 21 20 0 ARC 230 -1 10 0 20 10 40 10 50 -90 51 90";
    let notes = "0 TEXT 10 0 20 0 40 3 1 Name 0 LINE 8 OFF 10 0 20 0 11 9 21 9 0 CIRCLE 8 Frozen 10 0 20 0 40 1 \
                 0 CIRCLE 8 UNPLOTTED 10 0 20 0 40 1 0 CIRCLE 8 Defpoints 10 0 20 0 40 1 0 XLINE 10 0 20 0 11 1 21 0 \
                 0 LINE 10 3 20 3 11 3 21 3";
    let around = |end: &str| format!("0 ELLIPSE 10 5 20 5 11 20 21 0 40 0.5 41 0 42 {end}");
    let circle = "0 ARC 10 9 20 9 40 2 50 0 51 360";
    for (unit, entities, expected) in [
        ("4", rounded, slot),
        ("4", old, slot),
        ("4", pieces, slot),
        ("4", mirrored, slot),
        ("4", &format!("{notes} {pieces}"), slot),
        ("1", "0 CIRCLE 10 9 20 9 40 2", 4.0 * PI * 25.4 * 25.4),
        ("5", ellipse, 100.0 * PI * 200.0),
        ("4", &spline, PI),
        ("4", &around("6.28319"), 200.0 * PI),
        ("4", &around("6.283"), 200.0 * PI),
        ("4", circle, 4.0 * PI),
        // A block scaled, mirrored, turned, in another one, seen from below, and in a row.
        ("4", "0 INSERT 2 SLOT 10 3 20 4 41 2 42 -3 50 30", 6.0 * slot),
        ("4", "0 INSERT 2 OUTER 10 3 20 4 41 2 42 0.5 230 -1", slot),
        ("4", "0 INSERT 2 OUTER 10 3 20 4 70 3 71 2 44 0 45 0", slot),
        ("8", rounded, slot * 2.54e-5 * 2.54e-5),
        ("9", rounded, slot * 0.0254 * 0.0254),
        ("10", rounded, slot * 914.4 * 914.4),
        ("13", rounded, slot * 1e-6),
        ("14", rounded, slot * 1e4),
        ("21", rounded, slot * 304.800_609_6 * 304.800_609_6),
    ] {
        let found = area(&dxf(unit, entities));
        assert!((found / expected - 1.0).abs() < 1e-3, "{entities}: {found} {expected}");
    }
    assert!(!of_text(&dxf("0", rounded), None).unwrap().has_unit);
    for around in ["\n\n", "\nwords\nand words\nmore\n"] {
        let text = format!("\n{}{around}", dxf("4", rounded));
        assert!(of_text(&text, None).unwrap().has_unit);
    }
}

/// Blocks are where their insertion says: the lower left corners of their bounding boxes.
#[test]
fn inserted_blocks_are_in_their_places() {
    for (insert, [x, y]) in [
        ("2 SLOT 10 3 20 4", [-12.0, 4.0]),
        ("2 OUTER 10 3 20 4", [-17.0, -4.0]),
        ("2 OUTER 10 3 20 4 50 90", [-49.0, -16.0]),
        ("2 SLOT 10 3 20 4 230 -1", [-48.0, 4.0]),
    ] {
        let text = dxf("4", &format!("0 INSERT {insert}"));
        let outline = of_text(&text, None).unwrap();
        let [low, _] = polygon::bounds(outline.vertices);
        assert!(polygon::distance(low, [x, y]) < 0.02, "{insert}: {low:?}");
    }
    let row = dxf("4", "0 INSERT 2 SLOT 10 3 20 4 50 90 70 2 44 100");
    let error = of_text(&row, None).unwrap_err().to_string();
    assert!(error.contains("2 pieces"), "{error}");
}

/// The spline through points of a circle with chords of different lengths, closed, and open
/// with straight ends.
#[test]
fn a_spline_through_points_is_read() {
    use std::f64::consts::PI;
    let points = |degrees: &[f64]| -> String {
        let at = degrees.iter().map(|degrees| degrees.to_radians().sin_cos());
        at.map(|(sin, cos)| format!(" 11 {} 21 {}", 100.0 * cos, 100.0 * sin)).collect()
    };
    let all: Vec<f64> = (0..=12).map(|i| f64::from(30 * i + 8 * (i % 2))).collect();
    let closed = format!("0 SPLINE 70 9 71 3 74 13 {}", points(&all));
    let half = format!("0 SPLINE 70 8 71 3 {}", points(&all[..7]));
    let straight = "0 LINE 10 -100 20 0 11 100 21 0";
    for (entities, expected, error) in
        [(closed, 1e4 * PI, 3e-3), (format!("{half} {straight}"), 0.5e4 * PI, 8e-3)]
    {
        let found = area(&dxf("4", &entities));
        assert!((found / expected - 1.0).abs() < error, "{found} {expected}");
    }
}

#[test]
fn what_a_dxf_file_holds_else_is_refused_by_its_name() {
    let circle = "0 CIRCLE 10 9 20 9 40 2";
    for (text, part) in [
        (dxf("4", &format!("{circle} 0 INSERT 2 PART 10 0 20 0")), "INSERT"),
        (
            dxf("4", &format!("{circle} {}", circle.replace("9", "3"))),
            "2 pieces, by size #1 4 x 4 at (7, 7)",
        ),
        (dxf("4", "0 LINE 10 0 20 0 11 9 21 0"), "2 different points"),
        (dxf("4", "0 ARC 10 0 20 0 40 5 50 0 51 180"), "ends open at (-5, 0), 10 from"),
        (dxf("4", "0 CIRCLE 10 9 20 nine 40 2"), "`nine` is no number"),
        (dxf("4", circle).replace("EOF", "LINE"), "without EOF"),
        (dxf("4", "0 SPLINE 71 3 11 0 21 0"), "SPLINE without"),
        (dxf("4", "0 REGION 8 PART"), "REGION on the layer `PART`"),
        (dxf("4", "0 INSERT 2 ENDLESS 10 0 20 0"), "INSERT, in each other or repeated too often"),
        (
            dxf("4", "0 INSERT 2 SLOT 10 0 20 0 70 32000 71 32000"),
            "INSERT, in each other or repeated too often",
        ),
        (dxf("4", &circle.replace("CIRCLE", "CIRCLE 8 OFF")), "a layer that is on"),
        (dxf("4", ""), "no visible path"),
        ("0\nSECTION\nx\n".into(), "without EOF"),
    ] {
        let error = of_file(text.as_bytes(), None).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}
