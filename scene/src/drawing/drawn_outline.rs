//! The outline in a drawing, an SVG file (also compressed, SVGZ) or a DXF file: one of its
//! contours, closed and free of crossings.
//!
//! Contours that are drawn twice, for the fill and for the stroke, count once, and open ones whose
//! ends meet are joined. If several remain the outline is named by its number, the largest first.

use crate::drawing::contour::{Contour, DrawingError, rounded};
use crate::drawing::{dxf_contours, svg_path};
use design::geometry::polygon;
use std::path::{Path, PathBuf};
use support::text_file;

/// Distance of two ends that meet, over the size of the drawing.
const JOINED: f64 = 1e-5;
/// Maximum number of open contours, whose ends are compared in pairs.
const MOST_PIECES: usize = 10_000;
/// Number of contours that a message lists.
const LISTED: usize = 5;
/// First bytes of a file that is compressed by gzip.
const GZIP: &[u8] = b"\x1F\x8B";

/// The outline in a drawing.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    /// Its vertices, y upwards.
    pub vertices: Vec<[f64; 2]>,
    /// Length of the line that closes an open path that is filled; 0 for a closed one.
    pub gap: f64,
    /// Whether the vertices are in mm.
    pub has_unit: bool,
}

/// The file of a drawing and the number of its outline that stands behind it, as in
/// `drawing.svg#2`.
pub fn numbered(name: &Path) -> (PathBuf, Option<usize>) {
    let split = |name: &str| {
        let (file, number) = name.rsplit_once('#')?;
        Some((file.into(), Some(number.parse().ok()?)))
    };
    let numbered = name.to_str().filter(|_| !name.is_file()).and_then(split);
    numbered.unwrap_or_else(|| (name.to_owned(), None))
}

/// The outline in the bytes of a drawing; if it has several, the one with the given number.
pub(crate) fn of_file(bytes: &[u8], number: Option<usize>) -> Result<Outline, DrawingError> {
    if bytes.starts_with(GZIP) {
        let svg = usvg::decompress_svgz(bytes).map_err(DrawingError::NotSvg)?;
        return of_text(&decoded(&svg)?, number);
    }
    of_text(&decoded(bytes)?, number)
}

fn decoded(bytes: &[u8]) -> Result<String, DrawingError> {
    text_file::decoded(bytes).map_err(DrawingError::NotText)
}

pub(super) fn of_text(text: &str, number: Option<usize>) -> Result<Outline, DrawingError> {
    let first = text.lines().find(|line| !line.trim().is_empty());
    let first = first.ok_or(DrawingError::Empty)?.trim();
    // Group code 0 begins a section, 999 is a comment.
    if ["0", "999"].contains(&first) {
        let (contours, has_unit) = dxf_contours::read(text)?;
        return outline(contours, number, has_unit);
    }
    let mut outline = outline(svg_path::contours(text)?, number, false)?;
    (outline.vertices.iter_mut()).for_each(|vertex| vertex[1] = -vertex[1]);
    Ok(outline)
}

fn outline(
    contours: Vec<Contour>,
    number: Option<usize>,
    has_unit: bool,
) -> Result<Outline, DrawingError> {
    let mut contours = joined(distinct(contours))?;
    let area = |contour: &Contour| {
        let [width, height] = contour.size();
        width * height
    };
    contours.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let found = contours.len();
    let chosen = match (number, found) {
        (_, 0) => return Err(DrawingError::NoPath),
        (None, 1) => 0,
        (None, _) => {
            let listed = listed(&contours);
            return Err(DrawingError::Several { found, listed });
        }
        (Some(number), _) if number == 0 || number > found => {
            let listed = listed(&contours);
            return Err(DrawingError::NoSuch { number, found, listed });
        }
        (Some(number), _) => number - 1,
    };
    let gap = contours[chosen].check()?;
    Ok(Outline { vertices: contours.swap_remove(chosen).points, gap, has_unit })
}

/// Sizes and places of the largest contours.
fn listed(contours: &[Contour]) -> String {
    let words = contours.iter().take(LISTED).enumerate().map(|(i, contour)| {
        let [width, height] = contour.size().map(rounded);
        let [x, y] = polygon::bounds(contour.points.iter().copied())[0].map(rounded);
        let open = if contour.closed { "" } else { " (open)" };
        format!("#{} {width} x {height} at ({x}, {y}){open}", i + 1)
    });
    words.collect::<Vec<_>>().join(", ")
}

/// The contours without repeated points and without repetitions.
fn distinct(contours: Vec<Contour>) -> Vec<Contour> {
    let mut kept: Vec<Contour> = Vec::new();
    for contour in contours.into_iter().map(Contour::merged) {
        match kept.iter_mut().find(|twin| twin.points == contour.points) {
            Some(twin) => {
                twin.filled |= contour.filled;
                twin.closed |= contour.closed;
            }
            None => kept.push(contour),
        }
    }
    kept
}

/// The contours, those that end where others begin as one; an error where three ends meet.
fn joined(contours: Vec<Contour>) -> Result<Vec<Contour>, DrawingError> {
    let points = contours.iter().flat_map(|contour| &contour.points);
    let [low, high] = polygon::bounds(points.copied());
    let within = JOINED * f64::max(high[0] - low[0], high[1] - low[1]);
    let meet = |p: &[f64; 2], q: &[f64; 2]| polygon::distance(*p, *q) <= within;
    let (mut whole, mut open): (Vec<_>, Vec<_>) =
        (contours.into_iter()).partition(|contour| contour.closed || contour.filled);
    let found = open.len();
    if found > MOST_PIECES {
        return Err(DrawingError::TooManyPoints { found });
    }
    while let Some(mut contour) = open.pop() {
        let mut turns = 0;
        while turns < 2 && !contour.closed {
            let end = contour.points[contour.points.len() - 1];
            let at_end = |part: &Contour| {
                let points = &part.points;
                meet(&points[0], &end) || meet(&points[points.len() - 1], &end)
            };
            let next: Vec<usize> = (0..open.len()).filter(|i| at_end(&open[*i])).collect();
            let closes = contour.points.len() > 2 && meet(&contour.points[0], &end);
            match next[..] {
                [] if closes => {
                    contour.points.pop();
                    contour.closed = true;
                }
                [] => {
                    contour.points.reverse();
                    turns += 1;
                }
                [next] if !closes => {
                    let mut part = open.swap_remove(next);
                    if !meet(&part.points[0], &end) {
                        part.points.reverse();
                    }
                    contour.points.extend_from_slice(&part.points[1..]);
                }
                _ => {
                    let [x, y] = end.map(rounded);
                    return Err(DrawingError::Branch { x, y });
                }
            }
        }
        whole.push(contour);
    }
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    fn svg(content: &str) -> String {
        format!("<svg xmlns='http://www.w3.org/2000/svg' fill='none' stroke='#000'>{content}</svg>")
    }

    /// A DXF file with a unit and entities, their pairs separated by blanks.
    fn dxf(unit: &str, entities: &str) -> String {
        let mut text = String::new();
        let all = format!(
            "0 SECTION 2 HEADER 9 $INSUNITS 70 {unit} 0 ENDSEC \
             0 SECTION 2 TABLES 0 LAYER 2 OFF 70 0 62 -7 0 LAYER 2 FROZEN 70 1 62 7 0 ENDSEC \
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
        let pieces = "<path d='M0 0H10'/><line x1='10' y1='8' x2='10' y2='0' fill='#000'/><path d='M10 8H0V0'/>";
        assert_eq!(area(&svg(pieces)), 80.0);
        // Twice the same line is one line.
        assert_eq!(area(&svg(&format!("{pieces}<path d='M0 0H10'/>"))), 80.0);
        for (further, part) in [
            ("<path d='M10 8L20 20'/>", "branch at (10, 8)"),
            (
                "<path d='M30 0H40'/>",
                "2 contours, by size #1 10 x 8 at (0, 0), #2 10 x 0 at (30, 0) (open)",
            ),
        ] {
            let error = of_text(&svg(&format!("{pieces}{further}")), None).unwrap_err();
            assert!(error.to_string().contains(part), "{error}");
        }
    }

    #[test]
    fn one_of_several_outlines_is_chosen_by_its_number() {
        let text = svg("<circle r='1'/><rect x='9' width='6' height='4'/><path d='M0 0H1'/>");
        let chosen = of_text(&text, Some(1)).unwrap();
        assert_eq!(polygon::area(&chosen.vertices).abs(), 24.0);
        for (number, part) in [
            (None, "3 contours"),
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
            31, 139, 8, 0, 0, 0, 0, 0, 2, 3, 179, 41, 46, 75, 87, 168, 200, 205, 201, 43, 182, 85,
            207, 40, 41, 41, 176, 210, 215, 47, 47, 47, 215, 43, 55, 214, 203, 47, 74, 215, 55, 50,
            48, 48, 208, 7, 170, 80, 183, 179, 41, 74, 77, 46, 81, 40, 207, 76, 41, 201, 176, 85,
            55, 83, 87, 200, 72, 205, 76, 207, 40, 177, 85, 55, 81, 215, 183, 179, 1, 41, 177, 3,
            0, 242, 90, 246, 153, 74, 0, 0, 0,
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
        let rounded =
            "0 LWPOLYLINE 8 CUT 90 4 70 1 10 0 20 0 10 40 20 0 42 1 10 40 20 20 10 0 20 20 42 1";
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
        let notes = "0 TEXT 10 0 20 0 40 3 1 Name 0 LINE 8 OFF 10 0 20 0 11 9 21 9 0 CIRCLE 8 FROZEN 10 0 20 0 40 1";
        for (unit, entities, expected) in [
            ("4", rounded, slot),
            ("4", old, slot),
            ("4", pieces, slot),
            ("4", mirrored, slot),
            ("4", &format!("{notes} {pieces}"), slot),
            ("1", "0 CIRCLE 10 9 20 9 40 2", 4.0 * PI * 25.4 * 25.4),
            ("5", ellipse, 100.0 * PI * 200.0),
            ("4", &spline, PI),
        ] {
            let found = area(&dxf(unit, entities));
            assert!((found / expected - 1.0).abs() < 1e-3, "{entities}: {found} {expected}");
        }
        assert!(!of_text(&dxf("0", rounded), None).unwrap().has_unit);
    }

    #[test]
    fn what_a_dxf_file_holds_else_is_refused_by_its_name() {
        let circle = "0 CIRCLE 10 9 20 9 40 2";
        for (text, part) in [
            (dxf("4", &format!("{circle} 0 INSERT 2 PART 10 0 20 0")), "INSERT"),
            (
                dxf("4", &format!("{circle} {}", circle.replace("9", "3"))),
                "2 contours, by size #1 4 x 4 at (7, 7)",
            ),
            (dxf("4", "0 LINE 10 0 20 0 11 9 21 0"), "2 different points"),
            (dxf("4", "0 ARC 10 0 20 0 40 5 50 0 51 180"), "ends open at (-5, 0), 10 from"),
            (dxf("4", "0 CIRCLE 10 9 20 nine 40 2"), "`nine` is no number"),
            (dxf("4", circle).replace("EOF", "LINE"), "without EOF"),
            (dxf("4", "0 SPLINE 71 3 11 0 21 0"), "SPLINE without"),
            (dxf("4", ""), "no visible path"),
            ("0\nSECTION\nx\n".into(), "without EOF"),
        ] {
            let error = of_file(text.as_bytes(), None).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
