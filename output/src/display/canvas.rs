//! Pictures: shapes with styles, and their SVG: y upwards, 0.1 um resolution.

use crate::display::{
    shape::{Anchor, Shape, Text, rectangle},
    style::{Colour, Style},
};
use design::geometry::polygon::{distance, size};
use scene::drawing::bulged::{Vertex, centre};
use std::fmt::Write;
use support::{Joined, Point};

/// Height of the capitals of DejaVu Sans, relative to the size of the font.
const CAPITALS: f64 = 0.729;

/// Shapes with their styles, in the order in which they are drawn.
#[derive(Clone, Debug, Default)]
pub struct Canvas {
    pub(crate) shapes: Vec<(Style, Shape)>,
    /// The unit of lines and texts in a picture of a sheet: a thousandth of its width (mm).
    pub(crate) unit: f64,
}

impl Canvas {
    /// A white rectangle with the given lower left and upper right corner (mm).
    pub fn on_white(corners: [Point; 2]) -> Self {
        let mut canvas = Self::default();
        canvas.polygon(&rectangle(corners), Style::fill([255; 3]));
        canvas
    }

    /// A straight line between two points (mm).
    pub fn line(&mut self, from: Point, to: Point, style: Style) {
        self.shapes.push((style, Shape::Line([from, to])));
    }

    /// A cross with arms of a length (mm).
    pub(crate) fn cross(&mut self, at: Point, arm: f64, style: Style) {
        self.shapes.extend(Shape::cross(at, arm).map(|line| (style, line)));
    }

    /// A circle with its centre and radius in mm.
    pub fn circle(&mut self, centre: Point, radius: f64, style: Style) {
        self.shapes.push((style, Shape::Circle { centre, radius }));
    }

    /// A closed polygon.
    pub fn polygon(&mut self, points: &[Point], style: Style) {
        self.shapes.push((style, Shape::Polygon(points.to_vec())));
    }

    /// An open line through points.
    pub fn polyline(&mut self, points: &[Point], style: Style) {
        self.shapes.push((style, Shape::Polyline(points.to_vec())));
    }

    /// Text in a font of the given size (mm).
    pub fn text(&mut self, at: Point, size: f64, anchor: Anchor, style: Style, text: &str) {
        let text = Text { at, anchor, height: CAPITALS * size, text: text.to_owned() };
        self.add(style, text);
    }

    pub(crate) fn add(&mut self, style: Style, text: Text) {
        self.shapes.push((style, Shape::Text(text)));
    }

    pub(crate) fn styled(&self) -> impl Iterator<Item = (Style, &Shape)> {
        self.shapes.iter().map(|(style, shape)| (*style, shape))
    }

    /// The SVG of the rectangle from `low` to `high` (mm), `width` wide in an SVG unit such as `mm`
    /// or `px`.
    pub fn svg(&self, corners: [Point; 2], width: f64, unit: &str) -> String {
        let elements = self.shapes.iter();
        let body: String =
            elements.map(|(style, shape)| element(shape, &attributes(style, shape))).collect();
        document(corners, width, unit, &body)
    }
}

/// An SVG document of the rectangle from `low` to `high` (mm).
pub(crate) fn document(corners: [Point; 2], width: f64, unit: &str, body: &str) -> String {
    let (size, [low, high]) = (size(corners), corners);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}{unit}\" height=\"{}{unit}\" \
         viewBox=\"{} {} {} {}\">\n{body}</svg>\n",
        number(width),
        number(width * size[1] / size[0]),
        number(low[0]),
        number(-high[1]),
        number(size[0]),
        number(size[1]),
    )
}

/// A group of shapes, which have its colour; its lines have its width (mm).
pub(crate) fn group<'a>(
    id: &str,
    colour: Colour,
    width: f64,
    shapes: impl Iterator<Item = &'a Shape>,
) -> String {
    let line =
        format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"", hex(colour), number(width));
    let text = format!("fill=\"{}\" stroke=\"none\"", hex(colour));
    let elements = shapes.map(|shape| match shape {
        Shape::Text(_) => element(shape, &text),
        _ => element(shape, ""),
    });
    let elements: String = elements.collect();
    format!("<g id=\"{}\" {line}>\n{elements}</g>\n", escaped(id))
}

fn element(shape: &Shape, attributes: &str) -> String {
    let points = |points: &[Point]| {
        let points = points.iter();
        points.map(|[x, y]| format!("{},{}", number(*x), number(-y))).joined(" ")
    };
    let element = match shape {
        Shape::Line([from, to]) => format!(
            "line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"",
            number(from[0]),
            number(-from[1]),
            number(to[0]),
            number(-to[1]),
        ),
        Shape::Circle { centre, radius } => format!(
            "circle cx=\"{}\" cy=\"{}\" r=\"{}\"",
            number(centre[0]),
            number(-centre[1]),
            number(*radius),
        ),
        Shape::Polygon(corners) => format!("polygon points=\"{}\"", points(corners)),
        Shape::Polyline(through) => format!("polyline points=\"{}\"", points(through)),
        Shape::Contour(vertices) => format!("path d=\"{}\"", path_data(vertices)),
        Shape::Text(text) => return text_element(text, attributes),
    };
    format!("<{element} {attributes}/>\n")
}

/// Lines and arcs from vertex to vertex, back to the first.
fn path_data(vertices: &[Vertex]) -> String {
    let at = |[x, y]: Point| format!("{},{}", number(x), number(-y));
    let mut data = String::new();
    for (i, &(from, bulge)) in vertices.iter().enumerate() {
        let to = vertices[(i + 1) % vertices.len()].0;
        if i == 0 {
            data = format!("M{}", at(from));
        }
        data += &if bulge == 0.0 {
            format!(" L{}", at(to))
        } else {
            let radius = number(distance(centre(from, to, bulge), from));
            let (large, clockwise) = (u8::from(bulge.abs() > 1.0), u8::from(bulge < 0.0));
            format!(" A{radius} {radius} 0 {large} {clockwise} {}", at(to))
        };
    }
    data + " Z"
}

fn text_element(text: &Text, attributes: &str) -> String {
    let anchor = match text.anchor {
        Anchor::Start => "start",
        Anchor::Middle | Anchor::Centre => "middle",
    };
    let [x, y] = text.baseline();
    format!(
        "<text x=\"{}\" y=\"{}\" font-family=\"DejaVu Sans\" font-size=\"{}\" \
         text-anchor=\"{anchor}\" {attributes}>{}</text>\n",
        number(x),
        number(-y),
        number(text.height / CAPITALS),
        escaped(&text.text),
    )
}

fn attributes(style: &Style, shape: &Shape) -> String {
    let mut text = match style.fill {
        Some(colour) => format!("fill=\"{}\"", hex(colour)),
        None => "fill=\"none\"".to_owned(),
    };
    // Writing to a String cannot fail.
    let mut add = |name: &str, value: &str| _ = write!(text, " {name}=\"{value}\"");
    if style.fill_opacity < 1.0 {
        add("fill-opacity", &number(style.fill_opacity));
    }
    if let Some(colour) = style.stroke {
        add("stroke", &hex(colour));
        add("stroke-width", &number(style.width));
    }
    if style.stroke_opacity < 1.0 {
        add("stroke-opacity", &number(style.stroke_opacity));
    }
    // A closed line has ends only if it is dashed. Lines thinner than a pixel would show them.
    let closed = matches!(shape, Shape::Polygon(_) | Shape::Contour(_) | Shape::Circle { .. });
    if style.round {
        if !closed || style.dash.is_some() {
            add("stroke-linecap", "round");
        }
        add("stroke-linejoin", "round");
    }
    if let Some([dash, gap]) = style.dash {
        add("stroke-dasharray", &format!("{} {}", number(dash), number(gap)));
    }
    if style.bold {
        add("font-weight", "bold");
    }
    if let Some(width) = style.halo {
        add("stroke", "#ffffff");
        add("stroke-width", &number(width));
        add("stroke-opacity", "0.9");
        add("stroke-linejoin", "round");
        add("paint-order", "stroke");
    }
    text
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn number(value: f64) -> String {
    trimmed(value, 4)
}

/// A number with at most this many decimals, without trailing zeros, and never `-0`.
pub(crate) fn trimmed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_owned()
}

fn escaped(text: &str) -> String {
    text_of_element(text).replace('"', "&quot;")
}

/// Text of an element of HTML or SVG.
pub(crate) fn text_of_element(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn y_points_up_and_one_unit_is_one_millimetre() {
        let mut canvas = Canvas::default();
        canvas.line([0.0, 0.0], [10.0, 25.00001], Style::stroke([0; 3], 1.0));
        let svg = canvas.svg([[0.0, 0.0], [200.0, 100.0]], 200.0, "mm");
        assert!(svg.contains("width=\"200mm\" height=\"100mm\" viewBox=\"0 -100 200 100\""));
        let line = "x1=\"0\" y1=\"0\" x2=\"10\" y2=\"-25\"";
        assert!(svg.contains(line), "{svg}");
    }

    #[test]
    fn text_is_escaped() {
        let mut canvas = Canvas::default();
        let style = Style::fill([0; 3]);
        canvas.text([0.0; 2], 1.0, Anchor::Start, style, "a < b & \"c\"");
        let svg = canvas.svg([[0.0; 2], [1.0; 2]], 1.0, "px");
        assert!(svg.contains("a &lt; b &amp; &quot;c&quot;"));
    }
}
