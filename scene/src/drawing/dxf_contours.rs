//! The lines in the model space of a DXF file as contours; arcs and splines are approximated by
//! segments.
//!
//! A DXF file is a list of pairs of lines, a group code and a value; code 0 begins a record. Read
//! are LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE, POLYLINE and the blocks of INSERT, on layers
//! that are shown. Reference: Autodesk, DXF Reference (AutoCAD 2000).

use crate::drawing::{
    bulged::{Vertex, arc, flattened},
    contour::{Contour, WELD},
    spline,
};
use design::geometry::{
    plane::{I, complex, point},
    polygon,
};
use faer::c64;
use std::{collections::HashMap, f64::consts::TAU, ops::Range};
use support::{Fault, Point, ensure, refuse};

/// Difference of an angle from a full circle at which it is one, written with few digits (rad).
const FULL: f64 = 1e-3;
/// Maximum number of blocks in each other.
const MOST_NESTED: usize = 16;
/// Maximum number of records that are drawn, each as often as its block is inserted.
const MOST_RECORDS: usize = 1_000_000;
/// Lengths of the units of `$INSUNITS` (mm): none, inch, foot, mile, mm, cm, m, km, microinch, mil,
/// yard, angstrom, nm, micron, dm, dam, hm.
const UNITS: [f64; 17] = [
    0.0,
    25.4,
    304.8,
    1_609_344.0,
    1.0,
    10.0,
    1e3,
    1e6,
    2.54e-5,
    0.0254,
    914.4,
    1e-7,
    1e-6,
    1e-3,
    1e2,
    1e4,
    1e5,
];
/// The US survey foot, the unit 21 (mm).
const SURVEY_FOOT: f64 = 1_200_000.0 / 3937.0;
/// Entities that are no part of an outline.
const NOTES: [&str; 22] = [
    "TEXT",
    "MTEXT",
    "ATTDEF",
    "ATTRIB",
    "DIMENSION",
    "ARC_DIMENSION",
    "LARGE_RADIAL_DIMENSION",
    "LEADER",
    "MULTILEADER",
    "TOLERANCE",
    "HATCH",
    "POINT",
    "VIEWPORT",
    "IMAGE",
    "WIPEOUT",
    "OLE2FRAME",
    "ACAD_TABLE",
    "PDFUNDERLAY",
    "RAY",
    "XLINE",
    "SEQEND",
    "VERTEX",
];

/// A record: its kind and its pairs.
struct DxfRecord<'a> {
    kind: &'a str,
    pairs: Vec<(i32, &'a str)>,
}

impl<'a> DxfRecord<'a> {
    fn text(&self, code: i32) -> &'a str {
        let mut pairs = self.pairs.iter();
        pairs.find(|pair| pair.0 == code).map_or("", |pair| pair.1)
    }

    /// The name of a layer or a block, whose case does not count.
    fn name(&self, code: i32) -> String {
        self.text(code).to_uppercase()
    }

    /// All values of a code; [`records`] has checked that they are numbers.
    fn numbers(&self, code: i32) -> impl Iterator<Item = f64> {
        let pairs = self.pairs.iter().filter(move |pair| pair.0 == code);
        pairs.map(|pair| pair.1.parse().unwrap_or_default())
    }

    fn number(&self, code: i32) -> f64 {
        self.numbers(code).next().unwrap_or_default()
    }

    fn flag(&self, code: i32, bit: i64) -> bool {
        self.number(code) as i64 & bit != 0
    }

    fn points(&self, code: i32) -> Vec<Point> {
        let ordinates = self.numbers(code + 10);
        self.numbers(code).zip(ordinates).map(<Point>::from).collect()
    }

    /// The first point of a code.
    fn at(&self, code: i32) -> c64 {
        c64::new(self.number(code), self.number(code + 10))
    }

    fn unread(&self, kind: &str) -> Fault {
        format!(
            "an entity of the kind {kind} on the layer `{}` is not read; explode it in the drawing program, or switch its \
             layer off if it is no part of the outline",
            self.text(8)
        )
        .into()
    }
}

/// Where the coordinates of a block are: the images of the unit vectors and of the origin.
#[derive(Clone, Copy)]
struct BlockTransform {
    x: c64,
    y: c64,
    origin: c64,
}

impl BlockTransform {
    fn along(self, p: c64) -> c64 {
        self.x * p.re + self.y * p.im
    }

    fn of(self, p: c64) -> c64 {
        self.along(p) + self.origin
    }
}

/// The contours of a DXF text, and whether they are in mm: in the unit of the file if it states
/// none.
pub(super) fn read(text: &str) -> Result<(Vec<Contour>, bool), Fault> {
    let records = records(text)?;
    let mut section = "";
    let mut unit = 0.0;
    let mut drawing = DxfDrawing {
        // AutoCAD never plots it.
        hidden: vec!["DEFPOINTS".into()],
        blocks: HashMap::new(),
        records: &records,
        drawn: 0,
        contours: Vec::new(),
    };
    let mut start = 0;
    let mut entities = 0..0;
    for (i, record) in records.iter().enumerate() {
        match record.kind {
            "SECTION" => {
                start = i + 1;
                section = record.text(2);
                if section == "ENTITIES" {
                    entities = start..records.len();
                }
                let mut pairs = record.pairs.iter().skip_while(|pair| pair.1 != "$INSUNITS");
                let code = pairs.nth(1).and_then(|pair| pair.1.parse().ok());
                match code {
                    Some(21) => unit = SURVEY_FOOT,
                    Some(code) => unit = UNITS.get(code).copied().unwrap_or_default(),
                    None => {}
                }
            }
            "ENDSEC" if section == "ENTITIES" => entities = start..i,
            // A layer that is off has a negative colour; flag 1 is frozen; 290 is plotted.
            "LAYER"
                if section == "TABLES"
                    && (record.number(62) < 0.0
                        || record.flag(70, 1)
                        || record.text(290) == "0") =>
            {
                drawing.hidden.push(record.name(2));
            }
            "BLOCK" if section == "BLOCKS" => start = i,
            "ENDBLK" if section == "BLOCKS" => {
                drawing.blocks.insert(records[start].name(2), start..i);
            }
            _ => {}
        }
    }
    let whole = BlockTransform { x: 1.0.into(), y: I, origin: 0.0.into() };
    drawing.draw(entities, whole, 0)?;
    let contours = drawing.contours;
    let all = contours.iter().flat_map(|(points, _)| points.iter().copied());
    let [width, height] = polygon::size(polygon::bounds(all));
    let scale = if unit > 0.0 { unit } else { 1.0 };
    let rounding = WELD * scale * width.max(height);
    let contours = contours.into_iter().map(|(points, closed)| Contour {
        points: points.into_iter().map(|p| p.map(|x| scale * x)).collect(),
        closed,
        rounding,
        ..Contour::default()
    });
    Ok((contours.collect(), unit > 0.0))
}

/// The records of a file, which must be whole; what follows its end is not read.
fn records(text: &str) -> Result<Vec<DxfRecord<'_>>, Fault> {
    let mut records: Vec<DxfRecord> = Vec::new();
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let blank = lines.iter().take_while(|line| line.is_empty()).count();
    for (i, pair) in lines[blank..].chunks_exact(2).enumerate() {
        let line = blank + 2 * i + 1;
        let [code, value] = [pair[0], pair[1]];
        let Ok(group) = code.parse::<i32>() else {
            refuse!("line {line} of the DXF file: `{code}` is no group code");
        };
        ensure!(
            !matches!(group, 10..=79 | 210..=239) || value.parse().is_ok_and(f64::is_finite),
            "line {} of the DXF file: `{value}` is no number",
            line + 1
        );
        match records.last_mut() {
            _ if (group, value) == (0, "EOF") => return Ok(records),
            _ if group == 0 => records.push(DxfRecord { kind: value, pairs: Vec::new() }),
            Some(record) => record.pairs.push((group, value)),
            None => {}
        }
    }
    refuse!("line {} of the DXF file: the file ends without EOF; export it again", lines.len())
}

/// Points, and whether they are closed.
type Points = (Vec<Point>, bool);

/// What is drawn of a file.
struct DxfDrawing<'a> {
    records: &'a [DxfRecord<'a>],
    /// Names of layers.
    hidden: Vec<String>,
    /// Where the records of a block are, from its name on.
    blocks: HashMap<String, Range<usize>>,
    /// Count of the records so far.
    drawn: usize,
    contours: Vec<Points>,
}

impl DxfDrawing<'_> {
    /// Adds the entities among records that are shown, `depth` blocks deep.
    fn draw(
        &mut self,
        among: Range<usize>,
        place: BlockTransform,
        depth: usize,
    ) -> Result<(), Fault> {
        let records = self.records;
        self.drawn += 1 + among.len();
        for i in among {
            let entity = &records[i];
            let shown = !entity.flag(60, 1) && !entity.flag(67, 1);
            if !shown || self.hidden.contains(&entity.name(8)) {
                continue;
            }
            if depth > MOST_NESTED || self.drawn > MOST_RECORDS {
                return Err(entity.unread("INSERT, in each other or repeated too often,"));
            }
            if entity.kind == "INSERT" {
                self.insert(entity, place, depth)?;
                continue;
            }
            let Some((points, closed)) = contour(entity, &records[i + 1..])? else {
                continue;
            };
            let points: Vec<_> = points.into_iter().map(|p| point(place.of(complex(p)))).collect();
            if !points.as_flattened().iter().all(|x| x.is_finite()) {
                return Err(entity.unread(&format!("{} with infinite coordinates", entity.kind)));
            }
            self.contours.push((points, closed));
        }
        Ok(())
    }

    /// Adds a block, in rows and columns.
    fn insert(
        &mut self,
        insert: &DxfRecord,
        place: BlockTransform,
        depth: usize,
    ) -> Result<(), Fault> {
        let Some(block) = self.blocks.get(&insert.name(2)).cloned() else {
            let name = insert.text(2);
            return Err(
                insert.unread(&format!("INSERT of the block `{name}`, which is not in the file,"))
            );
        };
        let base = self.records[block.start].at(10);
        let [sx, sy] = [41, 42].map(|code| insert.numbers(code).next().unwrap_or(1.0));
        let [columns, rows] = [70, 71].map(|code| insert.number(code).max(1.0) as usize);
        let turn = c64::cis(insert.number(50).to_radians());
        for k in 0..columns.saturating_mul(rows) {
            let cell = c64::new(
                (k % columns) as f64 * insert.number(44),
                (k / columns) as f64 * insert.number(45),
            );
            let mut own = BlockTransform {
                x: turn * sx,
                y: turn * I * sy,
                origin: insert.at(10) + turn * cell,
            };
            own.origin -= own.along(base);
            if insert.number(230) < 0.0 {
                let [x, y, origin] = [own.x, own.y, own.origin].map(|z| -z.conj());
                own = BlockTransform { x, y, origin };
            }
            let x = place.along(own.x);
            let inner = BlockTransform { x, y: place.along(own.y), origin: place.of(own.origin) };
            self.draw(block.start + 1..block.end, inner, depth + 1)?;
        }
        Ok(())
    }
}

/// The points of an entity, and whether they are closed; `None` if it is a note. `further` are the
/// records after it.
fn contour(entity: &DxfRecord, further: &[DxfRecord]) -> Result<Option<Points>, Fault> {
    let centre = entity.at(10);
    // Arcs and polylines that are seen from below are mirrored.
    let below = entity.number(230) < 0.0;
    let (mut points, closed) = match entity.kind {
        "LINE" => (vec![point(centre), point(entity.at(11))], false),
        "CIRCLE" => (arc(centre, entity.number(40).into(), TAU), true),
        "ARC" => {
            let [from, to] = [50, 51].map(|code| entity.number(code).to_radians());
            let start = entity.number(40) * c64::cis(from);
            (arc(centre, start, turned(from, to)), false)
        }
        "ELLIPSE" => {
            let [from, to] = [41, 42].map(|code| entity.number(code));
            let long = entity.at(11);
            let short = entity.number(40) * long * if below { -I } else { I };
            let on_circle = arc(0.0.into(), c64::cis(from), turned(from, to));
            let at = |[x, y]: Point| point(centre + x * long + y * short);
            (on_circle.into_iter().map(at).collect(), false)
        }
        "LWPOLYLINE" => {
            let mut vertices: Vec<Vertex> = Vec::new();
            for &(code, value) in &entity.pairs {
                let value = value.parse().unwrap_or_default();
                match (code, vertices.last_mut()) {
                    (10, _) => vertices.push(([value, 0.0], 0.0)),
                    (20, Some((at, _))) => at[1] = value,
                    (42, Some((_, bulge))) => *bulge = value,
                    _ => {}
                }
            }
            let closed = entity.flag(70, 1);
            (flattened(&vertices, closed), closed)
        }
        // Flags 16 and 64 are meshes; flag 16 of a vertex is a point of the frame of a spline.
        "POLYLINE" if !entity.flag(70, 16 | 64) => {
            let vertices = further.iter().take_while(|it| it.kind == "VERTEX");
            let vertices = vertices.filter(|vertex| !vertex.flag(70, 16));
            let vertices: Vec<_> = vertices.map(|it| (point(it.at(10)), it.number(42))).collect();
            let closed = entity.flag(70, 1);
            (flattened(&vertices, closed), closed)
        }
        "SPLINE" => (spline_points(entity)?, entity.flag(70, 1)),
        kind if NOTES.contains(&kind) => return Ok(None),
        kind => return Err(entity.unread(kind)),
    };
    if below && !["LINE", "ELLIPSE", "SPLINE"].contains(&entity.kind) {
        points.iter_mut().for_each(|point| point[0] = -point[0]);
    }
    Ok((points.len() > 1).then_some((points, closed)))
}

/// The angle from one direction counter-clockwise to another, above 0 (rad).
fn turned(from: f64, to: f64) -> f64 {
    let angle = to - from;
    if angle == 0.0 || (angle.abs() - TAU).abs() < FULL { TAU } else { angle.rem_euclid(TAU) }
}

/// Points on a B-spline or on a spline through points.
fn spline_points(entity: &DxfRecord) -> Result<Vec<Point>, Fault> {
    let degree = entity.number(71) as usize;
    let knots: Vec<f64> = entity.numbers(40).collect();
    let points = entity.points(10);
    let weights: Vec<f64> = entity.numbers(41).collect();
    let mut fit: Vec<c64> = entity.points(11).into_iter().map(complex).collect();
    if points.is_empty() && fit.len() > 1 {
        fit.dedup();
        let closed = entity.flag(70, 1);
        if closed && fit.len() > 2 && fit[0] == fit[fit.len() - 1] {
            fit.pop();
        }
        return Ok(spline::through(&fit, closed && fit.len() > 2));
    }
    let sorted = knots.is_sorted() && weights.iter().all(|weight| *weight > 0.0);
    if degree == 0 || points.len() <= degree || knots.len() != points.len() + degree + 1 || !sorted
    {
        return Err(entity.unread("SPLINE without fitting control points and knots"));
    }
    Ok(spline::b_spline(degree, &knots, &points, &weights))
}
