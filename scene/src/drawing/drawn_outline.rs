//! The outline in a drawing, an SVG file (also compressed, SVGZ) or a DXF file: one of its
//! contours with the holes in it, closed and free of crossings.
//!
//! If the drawing has several pieces the outline is named by its number among the contours, the
//! largest first.

use crate::drawing::{
    contour::{Contour, LISTED, rounded},
    dxf_contours, holes,
    joined_lines::joined,
    svg_path,
};
use std::path::{Path, PathBuf};
use support::{Fault, Joined, Point, at, refuse, text_file};

/// First bytes of a file that is compressed by gzip.
const GZIP: &[u8] = b"\x1F\x8B";
/// How texts begin that are other drawings, and what they are.
const OTHERS: [(&str, &str); 6] = [
    ("IN;", "a plotter file (HPGL)"),
    ("PU", "a plotter file (HPGL)"),
    ("\u{1b}%", "a plotter file (HPGL)"),
    ("G2", "a program of a machine (G-code)"),
    ("G9", "a program of a machine (G-code)"),
    ("ISO-10303", "a STEP file"),
];

/// The outline in a drawing.
#[derive(Debug)]
pub(crate) struct DrawnOutline {
    /// Its vertices, y upwards.
    pub vertices: Vec<Point>,
    /// The vertices of its holes.
    pub holes: Vec<Vec<Point>>,
    /// Length of the line that closes an open path that is filled; 0 for a closed one.
    pub gap: f64,
    /// Whether the vertices are in mm.
    pub has_unit: bool,
    /// What of the drawing could not be read or is left out.
    pub warnings: Vec<String>,
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
pub(crate) fn of_file(bytes: &[u8], number: Option<usize>) -> Result<DrawnOutline, Fault> {
    of_text(&text_of(bytes)?, number)
}

/// The number of a piece of a drawing, and its vertices, y upwards.
pub type NumberedPiece = (usize, Vec<Point>);

/// The pieces of a drawing, the largest first.
pub fn pieces(bytes: &[u8]) -> Result<Vec<NumberedPiece>, Fault> {
    let drawn = Drawn::read(&text_of(bytes)?)?;
    let upright = |piece: usize| {
        let points = drawn.contours[piece].points.iter();
        (piece + 1, points.map(|at| drawn.upright(*at)).collect())
    };
    Ok(drawn.pieces().into_iter().map(upright).collect())
}

fn text_of(bytes: &[u8]) -> Result<String, Fault> {
    let decoded = |bytes: &[u8]| text_file::decoded(bytes).map_err(at("the file is no drawing"));
    match bytes.starts_with(GZIP) {
        true => decoded(&usvg::decompress_svgz(bytes).map_err(svg_path::not_svg)?),
        false => decoded(bytes),
    }
}

pub(super) fn of_text(text: &str, number: Option<usize>) -> Result<DrawnOutline, Fault> {
    let mut drawn = Drawn::read(text)?;
    let chosen = drawn.chosen(number)?;
    let gap = drawn.contours[chosen].check()?;
    let (holes, left_out) = holes::of(chosen, &drawn.contours, &drawn.around)?;
    let mut points = |contour: usize| -> Vec<Point> {
        let points = std::mem::take(&mut drawn.contours[contour].points);
        points.into_iter().map(|at| drawn.upright(at)).collect()
    };
    let vertices = points(chosen);
    let holes = holes.into_iter().map(points).collect();
    let warnings = drawn.warnings.into_iter().chain(left_out).collect();
    Ok(DrawnOutline { vertices, holes, gap, has_unit: drawn.has_unit, warnings })
}

/// The contours of a drawing.
struct Drawn {
    /// The largest first.
    contours: Vec<Contour>,
    /// The contours before each one that it lies in.
    around: Vec<Vec<usize>>,
    /// Whether their points are in mm.
    has_unit: bool,
    /// Whether y is downwards.
    downwards: bool,
    /// What could not be read.
    warnings: Vec<String>,
}

impl Drawn {
    fn read(text: &str) -> Result<Self, Fault> {
        let first = text.lines().find(|line| !line.trim().is_empty());
        let Some(first) = first.map(str::trim) else {
            refuse!("the file is empty; draw one closed outline and save it as SVG or DXF");
        };
        // Group code 0 begins a section, 999 is a comment.
        let is_dxf = ["0", "999"].contains(&first);
        if !is_dxf && !first.starts_with('<') {
            let known = OTHERS.iter().find(|(start, _)| first.starts_with(start));
            let start: String = first.chars().take(20).collect();
            let what = known.map_or("no drawing that is read", |(_, what)| what);
            refuse!(
                "the file begins with `{}`: it is {what}; export the drawing as SVG or DXF",
                start.escape_debug()
            );
        }
        let (contours, has_unit, warnings) = if is_dxf {
            let (contours, has_unit) = dxf_contours::read(text)?;
            (contours, has_unit, Vec::new())
        } else {
            let (contours, warnings) = svg_path::contours(text)?;
            (contours, false, warnings)
        };
        let mut contours = joined(contours);
        let area = |contour: &Contour| {
            let [width, height] = contour.size();
            width * height
        };
        contours.sort_by(|a, b| area(b).total_cmp(&area(a)));
        let around = holes::around(&contours);
        Ok(Self { contours, around, has_unit, downwards: !is_dxf, warnings })
    }

    /// A point with y upwards.
    fn upright(&self, [x, y]: Point) -> Point {
        [x, if self.downwards { -y } else { y }]
    }

    /// The contours that lie in no other one.
    fn pieces(&self) -> Vec<usize> {
        (0..self.contours.len()).filter(|i| self.around[*i].is_empty()).collect()
    }

    /// The contour with a number; without one the only piece of the drawing.
    fn chosen(&self, number: Option<usize>) -> Result<usize, Fault> {
        let contours = &self.contours;
        let found = contours.len();
        let pieces = self.pieces();
        match (number, &pieces[..]) {
            (_, []) => Err(svg_path::no_path("")),
            (None, [piece]) => Ok(*piece),
            (None, _) => {
                let branch = contours.iter().find(|contour| contour.branches);
                if let Some(branch) = branch.filter(|_| !contours.iter().any(Contour::is_whole)) {
                    branch.check()?;
                }
                refuse!(
                    "the drawing has {} pieces, by size {}; a sheet is one of them: delete the others, or write the number of one \
                     behind the name of the file, as in `drawing.svg#1`, which takes it with its holes",
                    pieces.len(),
                    listed(pieces.iter().map(|piece| (*piece, &contours[*piece])))
                )
            }
            (Some(number), _) if number == 0 || number > found => refuse!(
                "there is no contour {number}: the drawing has {found}, by size {}",
                listed(contours.iter().enumerate())
            ),
            (Some(number), _) => Ok(number - 1),
        }
    }
}

/// Numbers, sizes and places of the first contours.
pub(super) fn listed<'a>(contours: impl Iterator<Item = (usize, &'a Contour)>) -> String {
    let words = contours.take(LISTED).map(|(i, contour)| {
        let [width, height] = contour.size().map(rounded);
        let [x, y] = contour.bounds()[0].map(rounded);
        let open = match (contour.closed, contour.branches) {
            (true, _) => "",
            (_, true) => " (branches)",
            _ => " (open)",
        };
        format!("#{} {width} x {height} at ({x}, {y}){open}", i + 1)
    });
    words.joined(", ")
}

#[cfg(test)]
mod tests;
