//! The cut lines as a DXF drawing in millimetres, one layer per tool.

use crate::output::cut_file::cut_lines::{ANNOTATION, CUT, CutLines, HOLES, OUTLINE};
use crate::output::cut_file::fabrication_error::FabricationError;
use ::dxf::entities::{Circle, Entity, EntityType, Line, LwPolyline, Text};
use ::dxf::enums::{AcadVersion, DrawingUnits, HorizontalTextJustification, Units};
use ::dxf::tables::Layer;
use ::dxf::{Color, Drawing, LwPolylineVertex, Point};
use std::path::Path;

/// Layers with their AutoCAD colour index.
const LAYERS: [(&str, u8); 4] = [(CUT, 1), (HOLES, 5), (OUTLINE, 7), (ANNOTATION, 8)];

/// Writes the cut lines. The file is replaced atomically and is identical for identical cut lines.
pub fn write_dxf(path: &Path, cuts: &CutLines) -> Result<(), FabricationError> {
    let mut text = Vec::new();
    drawing(cuts)
        .save(&mut text)
        .map_err(|source| FabricationError::Dxf {
            path: path.to_owned(),
            source,
        })?;
    support::whole_file::write(path, &text).map_err(|source| FabricationError::Write {
        path: path.to_owned(),
        source,
    })
}

fn drawing(cuts: &CutLines) -> Drawing {
    let mut drawing = Drawing::new();
    let header = &mut drawing.header;
    // Formats before R2000 do not support light-weight polylines.
    header.version = AcadVersion::R2000;
    header.default_drawing_units = Units::Millimeters;
    header.drawing_units = DrawingUnits::Metric;
    // Fixed values, so that the same design gives the same file.
    header.creation_date = Default::default();
    header.creation_date_universal = Default::default();
    header.update_date = Default::default();
    header.update_date_universal = Default::default();
    header.fingerprint_guid = Default::default();
    header.version_guid = Default::default();

    let outline = cuts.tool_outline();
    let extreme = |axis: usize, of: fn(f64, f64) -> f64| {
        let along = outline.iter().map(|corner| corner[axis]);
        along.reduce(of).unwrap_or_default()
    };
    header.minimum_drawing_extents = point([0, 1].map(|axis| extreme(axis, f64::min)));
    header.maximum_drawing_extents = point([0, 1].map(|axis| extreme(axis, f64::max)));

    for (name, colour) in LAYERS {
        drawing.add_layer(Layer {
            name: name.into(),
            color: Color::from_index(colour),
            ..Default::default()
        });
    }
    let mut add = |layer: &str, shape| {
        let mut entity = Entity::new(shape);
        entity.common.layer = layer.into();
        drawing.add_entity(entity);
    };
    for slit in &cuts.slits {
        let [from, to] = slit.ends.map(point);
        add(CUT, EntityType::Line(Line::new(from, to)));
    }
    for hole in &cuts.holes {
        let circle = Circle::new(point(hole.centre), cuts.tool_radius(hole));
        add(HOLES, EntityType::Circle(circle));
    }
    let mut edge = LwPolyline {
        vertices: outline.map(vertex).to_vec(),
        ..Default::default()
    };
    edge.set_is_closed(true);
    add(OUTLINE, EntityType::LwPolyline(edge));
    for label in &cuts.labels {
        let text = Text {
            location: point(label.at),
            second_alignment_point: point(label.at),
            horizontal_text_justification: HorizontalTextJustification::Center,
            text_height: label.height,
            value: label.text.clone(),
            ..Default::default()
        };
        add(ANNOTATION, EntityType::Text(text));
    }
    drawing
}

fn point([x, y]: [f64; 2]) -> Point {
    Point::new(x, y, 0.0)
}

fn vertex([x, y]: [f64; 2]) -> LwPolylineVertex {
    LwPolylineVertex {
        x,
        y,
        ..Default::default()
    }
}
