//! DXF R2000 (AC1015) in millimetres, one layer per tool.
//!
//! A DXF file is a list of pairs, a group code and a value, in the sections HEADER, TABLES, BLOCKS,
//! ENTITIES and OBJECTS. Every object has a hexadecimal handle and names its owner's. Reference:
//! Autodesk, DXF Reference (AutoCAD 2000).

use crate::cut_file::cut_drawing::{CutDrawing, Layer};
use crate::display::{Anchor, Shape, Text};
use scene::drawing::bulged::Vertex;
use std::fmt::{Display, Write};

/// The file of a drawing, identical for identical drawings.
pub fn dxf(drawing: &CutDrawing) -> String {
    let extent = drawing.bounds();
    let mut body = Pairs::default();
    let model_space = body.tables(drawing);
    body.section("ENTITIES");
    for (layer, shape) in &drawing.shapes {
        body.entity(model_space, *layer, shape);
    }
    body.pair(0, "ENDSEC");
    body.objects();
    body.pair(0, "EOF");

    let mut file = Pairs::default();
    file.header(extent, body.handles + 1);
    file.text + &body.text
}

/// The pairs written so far, and the last handle.
#[derive(Default)]
struct Pairs {
    text: String,
    handles: u32,
}

impl Pairs {
    fn pair(&mut self, code: u16, value: impl Display) {
        // Writing to a String cannot fail.
        let _ = write!(self.text, "{code:>3}\n{value}\n");
    }

    fn pairs<const N: usize>(&mut self, pairs: [(u16, &str); N]) {
        (pairs.iter()).for_each(|(code, value)| self.pair(*code, value));
    }

    fn handle(&mut self, code: u16, handle: u32) {
        self.pair(code, format_args!("{handle:X}"));
    }

    /// The coordinates of a point, x with the given code.
    fn point(&mut self, code: u16, [x, y]: [f64; 2]) {
        for (axis, value) in [x, y, 0.0].into_iter().enumerate() {
            self.pair(code + 10 * axis as u16, value);
        }
    }

    fn section(&mut self, name: &str) {
        self.pairs([(0, "SECTION"), (2, name)]);
    }

    /// Begins an object with a new handle, which is returned.
    fn object(&mut self, kind: &str, owner: u32, classes: &[&str]) -> u32 {
        self.handles += 1;
        self.pair(0, kind);
        // Code 5 is another value of a dimension style.
        let code = if kind == "DIMSTYLE" { 105 } else { 5 };
        self.handle(code, self.handles);
        self.handle(330, owner);
        classes.iter().for_each(|class| self.pair(100, class));
        self.handles
    }

    fn header(&mut self, [low, high]: [[f64; 2]; 2], next_handle: u32) {
        self.section("HEADER");
        self.pairs([(9, "$ACADVER"), (1, "AC1015")]);
        self.pairs([(9, "$DWGCODEPAGE"), (3, "ANSI_1252")]);
        self.pairs([(9, "$HANDSEED"), (5, &format!("{next_handle:X}"))]);
        // Millimetres, metric.
        self.pairs([(9, "$INSUNITS"), (70, "4")]);
        self.pairs([(9, "$MEASUREMENT"), (70, "1")]);
        for (name, corner) in [("$EXTMIN", low), ("$EXTMAX", high)] {
            self.pair(9, name);
            self.point(10, corner);
        }
        self.pair(0, "ENDSEC");
    }

    /// Writes TABLES and BLOCKS; returns the handle of the model space, which owns the entities.
    fn tables(&mut self, drawing: &CutDrawing) -> u32 {
        let [low, high] = drawing.bounds();
        self.section("TABLES");
        let table = self.table("VPORT", 1);
        self.record("VPORT", table, "AcDbViewportTableRecord", "*Active");
        // The view that a reader opens: the whole drawing.
        let size = [high[0] - low[0], high[1] - low[1]];
        let centre = [low[0] + 0.5 * size[0], low[1] + 0.5 * size[1]];
        for (code, [x, y]) in [(10, [0.0, 0.0]), (11, [1.0, 1.0]), (12, centre)] {
            self.pair(code, x);
            self.pair(code + 10, y);
        }
        self.pair(40, 1.1 * size[1].max(0.5 * size[0]));
        self.pair(41, 2.0);
        self.pair(0, "ENDTAB");

        let table = self.table("LTYPE", 3);
        for name in ["ByBlock", "ByLayer", "Continuous"] {
            self.record("LTYPE", table, "AcDbLinetypeTableRecord", name);
            self.pairs([(3, ""), (72, "65"), (73, "0"), (40, "0")]);
        }
        self.pair(0, "ENDTAB");

        let layers: Vec<_> = drawing.layers().collect();
        let table = self.table("LAYER", 1 + layers.len());
        let layers = layers.into_iter().map(|layer| (layer.name(), drawing.pen(layer).1));
        for (name, colour) in [("0", 7)].into_iter().chain(layers) {
            self.record("LAYER", table, "AcDbLayerTableRecord", name);
            self.pair(62, colour);
            self.pair(6, "Continuous");
        }
        self.pair(0, "ENDTAB");

        let table = self.table("STYLE", 1);
        self.record("STYLE", table, "AcDbTextStyleTableRecord", "Standard");
        self.pairs([(40, "0"), (41, "1"), (50, "0"), (71, "0"), (42, "2.5")]);
        self.pairs([(3, "txt"), (4, ""), (0, "ENDTAB")]);

        for empty in ["VIEW", "UCS"] {
            self.table(empty, 0);
            self.pair(0, "ENDTAB");
        }
        let table = self.table("APPID", 1);
        self.record("APPID", table, "AcDbRegAppTableRecord", "ACAD");
        self.pair(0, "ENDTAB");
        let table = self.table("DIMSTYLE", 1);
        self.pair(100, "AcDbDimStyleTable");
        self.record("DIMSTYLE", table, "AcDbDimStyleTableRecord", "Standard");
        self.pair(0, "ENDTAB");

        let table = self.table("BLOCK_RECORD", 2);
        let spaces = ["*Model_Space", "*Paper_Space"].map(|name| {
            let handle = self.object(
                "BLOCK_RECORD",
                table,
                &["AcDbSymbolTableRecord", "AcDbBlockTableRecord"],
            );
            self.pair(2, name);
            self.pair(340, 0);
            (name, handle)
        });
        self.pairs([(0, "ENDTAB"), (0, "ENDSEC")]);
        self.blocks(spaces);
        spaces[0].1
    }

    fn table(&mut self, name: &str, entries: usize) -> u32 {
        self.pair(0, "TABLE");
        self.pair(2, name);
        self.handles += 1;
        self.handle(5, self.handles);
        self.handle(330, 0);
        self.pair(100, "AcDbSymbolTable");
        self.pair(70, entries);
        self.handles
    }

    fn record(&mut self, kind: &str, table: u32, class: &str, name: &str) {
        self.object(kind, table, &["AcDbSymbolTableRecord", class]);
        self.pairs([(2, name), (70, "0")]);
    }

    fn blocks(&mut self, spaces: [(&str, u32); 2]) {
        self.section("BLOCKS");
        for (name, space) in spaces {
            for (kind, class) in [("BLOCK", "AcDbBlockBegin"), ("ENDBLK", "AcDbBlockEnd")] {
                self.object(kind, space, &["AcDbEntity"]);
                if name == "*Paper_Space" {
                    self.pair(67, 1);
                }
                self.pair(8, 0);
                self.pair(100, class);
                if kind == "BLOCK" {
                    self.pairs([(2, name), (70, "0")]);
                    self.point(10, [0.0; 2]);
                    self.pairs([(3, name), (1, "")]);
                }
            }
        }
        self.pair(0, "ENDSEC");
    }

    fn entity(&mut self, space: u32, layer: Layer, shape: &Shape) {
        let (kind, class) = match shape {
            Shape::Line(_) => ("LINE", "AcDbLine"),
            Shape::Circle { .. } => ("CIRCLE", "AcDbCircle"),
            Shape::Polyline(_) | Shape::Polygon(_) | Shape::Contour(_) => {
                ("LWPOLYLINE", "AcDbPolyline")
            }
            Shape::Text(_) => ("TEXT", "AcDbText"),
        };
        self.object(kind, space, &["AcDbEntity"]);
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
        for ([x, y], bulge) in vertices {
            self.pair(10, x);
            self.pair(20, y);
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

    fn objects(&mut self) {
        self.section("OBJECTS");
        let root = self.object("DICTIONARY", 0, &["AcDbDictionary"]);
        self.pairs([(281, "1"), (3, "ACAD_GROUP")]);
        self.handle(350, root + 1);
        self.object("DICTIONARY", root, &["AcDbDictionary"]);
        self.pairs([(281, "1"), (0, "ENDSEC")]);
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
