//! The lines in the model space of a DXF file as contours; arcs and splines are approximated by
//! segments.
//!
//! A DXF file is a list of pairs of lines, a group code and a value; code 0 begins a record. Read
//! are LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE and POLYLINE on layers that are shown.
//! Reference: Autodesk, DXF Reference (AutoCAD 2000).

use crate::drawing::bulged::{Vertex, arc, flattened};
use crate::drawing::contour::{Contour, DrawingError, WELD};
use design::geometry::plane::{I, point};
use design::geometry::polygon;
use faer::c64;
use std::f64::consts::TAU;

/// Number of segments of a spline between two knots.
const SPLINE_SEGMENTS: usize = 32;
/// Values of `$INSUNITS` with their length (mm): inch, foot, mm, cm, m.
const UNITS: [(&str, f64); 5] = [("1", 25.4), ("2", 304.8), ("4", 1.0), ("5", 10.0), ("6", 1000.0)];
/// Entities that are no part of an outline.
const NOTES: [&str; 14] = [
    "TEXT",
    "MTEXT",
    "ATTDEF",
    "DIMENSION",
    "LEADER",
    "MULTILEADER",
    "TOLERANCE",
    "HATCH",
    "POINT",
    "VIEWPORT",
    "IMAGE",
    "WIPEOUT",
    "SEQEND",
    "VERTEX",
];

/// A record: its kind and its pairs.
struct Record<'a> {
    kind: &'a str,
    pairs: Vec<(u16, &'a str)>,
}

impl<'a> Record<'a> {
    fn text(&self, code: u16) -> &'a str {
        let mut pairs = self.pairs.iter();
        pairs.find(|pair| pair.0 == code).map_or("", |pair| pair.1)
    }

    /// All values of a code; [`records`] has checked that they are numbers.
    fn numbers(&self, code: u16) -> impl Iterator<Item = f64> {
        let pairs = self.pairs.iter().filter(move |pair| pair.0 == code);
        pairs.map(|pair| pair.1.parse().unwrap_or_default())
    }

    fn number(&self, code: u16) -> f64 {
        self.numbers(code).next().unwrap_or_default()
    }

    fn flag(&self, code: u16, bit: i64) -> bool {
        self.number(code) as i64 & bit != 0
    }

    fn points(&self, code: u16) -> Vec<[f64; 2]> {
        let ordinates = self.numbers(code + 10);
        self.numbers(code).zip(ordinates).map(<[f64; 2]>::from).collect()
    }

    /// The first point of a code.
    fn at(&self, code: u16) -> c64 {
        c64::new(self.number(code), self.number(code + 10))
    }
}

/// The contours of a DXF text, and whether they are in mm: in the unit of the file if it states
/// none.
pub(super) fn read(text: &str) -> Result<(Vec<Contour>, bool), DrawingError> {
    let records = records(text)?;
    let mut section = "";
    let mut unit = None;
    let mut hidden = Vec::new();
    let mut contours = Vec::new();
    for (i, record) in records.iter().enumerate() {
        match record.kind {
            "SECTION" => {
                section = record.text(2);
                let mut pairs = record.pairs.iter().skip_while(|pair| pair.1 != "$INSUNITS");
                let stated = pairs.nth(1).map(|pair| pair.1);
                let known = UNITS.iter().find(|(code, _)| Some(*code) == stated);
                unit = unit.or(known.map(|(_, length)| *length));
            }
            "ENDSEC" => section = "",
            // A layer that is off has a negative colour; flag 1 is frozen.
            "LAYER" if section == "TABLES" && (record.number(62) < 0.0 || record.flag(70, 1)) => {
                hidden.push(record.text(2));
            }
            _ if section == "ENTITIES" => {
                let shown = !record.flag(60, 1) && !record.flag(67, 1);
                if shown && !hidden.contains(&record.text(8)) {
                    contours.extend(contour(record, &records[i + 1..])?);
                }
            }
            _ => {}
        }
    }
    let all = contours.iter().flat_map(|(points, _)| points.iter().copied());
    let [low, high] = polygon::bounds(all);
    let scale = unit.unwrap_or(1.0);
    let rounding = WELD * scale * f64::max(high[0] - low[0], high[1] - low[1]);
    let contours = contours.into_iter().map(|(points, closed)| Contour {
        points: points.into_iter().map(|p| p.map(|x| scale * x)).collect(),
        closed,
        filled: false,
        rounding,
    });
    Ok((contours.collect(), unit.is_some()))
}

/// The records of a file, which must be whole.
fn records(text: &str) -> Result<Vec<Record<'_>>, DrawingError> {
    let mut records: Vec<Record> = Vec::new();
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    for (i, pair) in lines.chunks_exact(2).enumerate() {
        let refused = |line, what: String| Err(DrawingError::NotDxf { line, what });
        let [code, value] = [pair[0], pair[1]];
        let Ok(group) = code.parse::<u16>() else {
            return refused(2 * i + 1, format!("`{code}` is no group code"));
        };
        let number = matches!(group, 10..=79 | 210..=239);
        if number && !value.parse::<f64>().is_ok_and(f64::is_finite) {
            return refused(2 * i + 2, format!("`{value}` is no number"));
        }
        if group == 0 {
            records.push(Record { kind: value, pairs: Vec::new() });
        } else if let Some(record) = records.last_mut() {
            record.pairs.push((group, value));
        }
    }
    if records.last().is_none_or(|record| record.kind != "EOF") {
        return Err(DrawingError::NotDxf {
            line: lines.len(),
            what: "the file ends without EOF; export it again".into(),
        });
    }
    Ok(records)
}

/// Points, and whether they are closed.
type Points = (Vec<[f64; 2]>, bool);

/// The points of an entity, and whether they are closed; `None` if it is a note. `further` are the
/// records after it.
fn contour(entity: &Record, further: &[Record]) -> Result<Option<Points>, DrawingError> {
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
            let at = |[x, y]: [f64; 2]| point(centre + x * long + y * short);
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
        "SPLINE" => (spline(entity)?, entity.flag(70, 1)),
        kind if NOTES.contains(&kind) => return Ok(None),
        kind => return Err(DrawingError::Unread { kind: kind.into() }),
    };
    if below && !["LINE", "ELLIPSE", "SPLINE"].contains(&entity.kind) {
        points.iter_mut().for_each(|point| point[0] = -point[0]);
    }
    Ok((points.len() > 1).then_some((points, closed)))
}

/// The angle from one direction counter-clockwise to another, above 0 (rad).
fn turned(from: f64, to: f64) -> f64 {
    let angle = (to - from).rem_euclid(TAU);
    if angle < 1e-9 { TAU } else { angle }
}

/// Points on a B-spline (de Boor), rational if its control points have weights.
fn spline(entity: &Record) -> Result<Vec<[f64; 2]>, DrawingError> {
    let degree = entity.number(71) as usize;
    let knots: Vec<f64> = entity.numbers(40).collect();
    let points = entity.points(10);
    let weights: Vec<f64> = entity.numbers(41).collect();
    if degree == 0 || points.len() <= degree || knots.len() != points.len() + degree + 1 {
        let kind = "SPLINE without control points and knots".into();
        return Err(DrawingError::Unread { kind });
    }
    let controls = points.iter().enumerate().map(|(i, [x, y])| {
        let weight = weights.get(i).copied().unwrap_or(1.0);
        [x * weight, y * weight, weight]
    });
    let controls: Vec<[f64; 3]> = controls.collect();
    let at = |span: usize, t: f64| {
        let mut level = controls[span - degree..=span].to_vec();
        for round in 1..=degree {
            for j in (round..=degree).rev() {
                let i = span - degree + j;
                let part = (t - knots[i]) / (knots[i + 1 + degree - round] - knots[i]);
                let before = level[j - 1];
                (0..3).for_each(|c| level[j][c] = (1.0 - part) * before[c] + part * level[j][c]);
            }
        }
        let [x, y, weight] = level[degree];
        [x / weight, y / weight]
    };
    let mut found = Vec::new();
    for span in (degree..points.len()).filter(|span| knots[span + 1] > knots[*span]) {
        let [from, to] = [knots[span], knots[span + 1]];
        let t = |i: usize| from + (to - from) * i as f64 / SPLINE_SEGMENTS as f64;
        found.extend((0..=SPLINE_SEGMENTS).map(|i| at(span, t(i))));
    }
    Ok(found)
}
