//! DXF R2000 (AC1015) in millimetres, one layer per tool.
//!
//! A DXF file is a list of pairs, a group code and a value, in the sections HEADER, TABLES, BLOCKS,
//! ENTITIES and OBJECTS. Every object has a hexadecimal handle and names its owner's. What is the
//! same in every file is in `dxf.txt`, where `+NAME` is a new handle and `@NAME` that handle again. Reference:
//! Autodesk, DXF Reference (AutoCAD 2000).

use crate::{
    cut_file::cut_drawing::{CutDrawing, Layer},
    display::{Anchor, Shape, Text},
};
use design::geometry::polygon::size;
use scene::drawing::bulged::Vertex;
use std::{collections::HashMap, fmt::Display};
use support::{Point, add_line};

const TEMPLATE: &str = include_str!("dxf.txt");

/// The file of a drawing, identical for identical drawings.
pub fn dxf(drawing: &CutDrawing) -> String {
    let bounds = drawing.bounds();
    let ([low, high], [width, height]) = (bounds, size(bounds));
    let layers: Vec<Layer> = drawing.layers().collect();
    let handles = TEMPLATE.matches("\n+").count() + layers.len() + drawing.shapes.len();
    let mut file = Pairs::default();
    for line in TEMPLATE.lines() {
        match line {
            "{seed}" => file.line(format_args!("{:X}", handles + 1)),
            "{groups}" => file.line(format_args!("{handles:X}")),
            "{low}" => file.point(10, low),
            "{high}" => file.point(10, high),
            // The view that a reader opens: the whole drawing.
            "{view}" => {
                file.ordinates(12, [low[0] + 0.5 * width, low[1] + 0.5 * height]);
                file.pair(40, 1.1 * height.max(0.5 * width));
            }
            "{count}" => file.line(1 + layers.len()),
            "{layers}" => layers.iter().for_each(|layer| file.layer(drawing, *layer)),
            "{entities}" => {
                (drawing.shapes.iter()).for_each(|(layer, shape)| file.entity(*layer, shape));
            }
            line => file.fixed(line),
        }
    }
    file.text
}

/// The pairs written so far, the last handle, and the handles of the template.
#[derive(Default)]
struct Pairs {
    text: String,
    handles: u32,
    named: HashMap<&'static str, u32>,
}

impl Pairs {
    fn line(&mut self, value: impl Display) {
        add_line!(self.text, "{value}");
    }

    fn pair(&mut self, code: u16, value: impl Display) {
        add_line!(self.text, "{code:>3}\n{value}");
    }

    /// A line of the template.
    fn fixed(&mut self, line: &'static str) {
        if let Some(name) = line.strip_prefix('+') {
            self.handles += 1;
            self.named.insert(name, self.handles);
        }
        match line.strip_prefix(['+', '@']) {
            Some(name) => {
                let handle = self.named[name];
                self.line(format_args!("{handle:X}"));
            }
            None => self.line(line),
        }
    }

    /// x and y of a point, x with the given code.
    fn ordinates(&mut self, code: u16, [x, y]: Point) {
        self.pair(code, x);
        self.pair(code + 10, y);
    }

    /// The coordinates of a point, x with the given code.
    fn point(&mut self, code: u16, at: Point) {
        self.ordinates(code, at);
        self.pair(code + 20, 0);
    }

    /// Begins an object, which belongs to an object of the template, with a new handle.
    fn object(&mut self, kind: &str, owner: &str, classes: &[&str]) {
        self.handles += 1;
        self.pair(0, kind);
        for (code, handle) in [(5, self.handles), (330, self.named[owner])] {
            self.pair(code, format_args!("{handle:X}"));
        }
        classes.iter().for_each(|class| self.pair(100, class));
    }

    fn layer(&mut self, drawing: &CutDrawing, layer: Layer) {
        self.object("LAYER", "layers", &["AcDbSymbolTableRecord", "AcDbLayerTableRecord"]);
        self.pair(2, layer.name());
        self.pair(70, 0);
        self.pair(62, drawing.pen(layer).1);
        self.pair(6, "Continuous");
    }

    fn entity(&mut self, layer: Layer, shape: &Shape) {
        let (kind, class) = match shape {
            Shape::Line(_) => ("LINE", "AcDbLine"),
            Shape::Circle { .. } => ("CIRCLE", "AcDbCircle"),
            Shape::Polyline(_) | Shape::Polygon(_) | Shape::Contour(_) => {
                ("LWPOLYLINE", "AcDbPolyline")
            }
            Shape::Text(_) => ("TEXT", "AcDbText"),
        };
        self.object(kind, "model", &["AcDbEntity"]);
        self.pair(8, layer.name());
        self.pair(100, class);
        match shape {
            Shape::Line([from, to]) => {
                self.point(10, *from);
                self.point(11, *to);
            }
            Shape::Circle { centre, radius } => {
                self.point(10, *centre);
                self.pair(40, radius);
            }
            Shape::Polyline(points) => self.vertices(false, points.iter().map(|p| (*p, 0.0))),
            Shape::Polygon(points) => self.vertices(true, points.iter().map(|p| (*p, 0.0))),
            Shape::Contour(vertices) => self.vertices(true, vertices.iter().copied()),
            Shape::Text(text) => self.text(text, class),
        }
    }

    fn vertices(&mut self, closed: bool, vertices: impl ExactSizeIterator<Item = Vertex>) {
        self.pair(90, vertices.len());
        self.pair(70, u8::from(closed));
        for (at, bulge) in vertices {
            self.ordinates(10, at);
            if bulge != 0.0 {
                self.pair(42, bulge);
            }
        }
    }

    fn text(&mut self, text: &Text, class: &str) {
        self.point(10, text.at);
        self.pair(40, text.height);
        self.pair(1, escaped(&text.text));
        // Horizontally: from the left, or centred; vertically: on the baseline, or centred.
        let [horizontal, vertical] = match text.anchor {
            Anchor::Start => [0, 0],
            Anchor::Middle => [1, 0],
            Anchor::Centre => [1, 2],
        };
        self.pair(72, horizontal);
        if text.anchor != Anchor::Start {
            self.point(11, text.at);
        }
        self.pair(100, class);
        self.pair(73, vertical);
    }
}

/// A text of a file in the code page ANSI_1252, with the other characters as `\U+` and four
/// hexadecimal digits.
fn escaped(text: &str) -> String {
    let mut units = [0; 2];
    let escape = |c: char| {
        if c.is_ascii() {
            c.to_string()
        } else {
            (c.encode_utf16(&mut units).iter()).map(|unit| format!("\\U+{unit:04X}")).collect()
        }
    };
    text.chars().map(escape).collect()
}
