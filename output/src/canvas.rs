//! A small SVG writer in sheet coordinates: lengths in mm, y upwards, 0.1 um resolution.

use std::fmt::Write;

/// An SVG document of the rectangle from `low` to `high` (mm).
pub struct Canvas {
    low: [f64; 2],
    high: [f64; 2],
    body: String,
}

/// The point of a text that its position refers to.
#[derive(Clone, Copy)]
pub enum Anchor {
    /// The left end of the baseline.
    Start,
    /// The middle of the baseline.
    Middle,
}

impl Canvas {
    /// An empty document.
    pub fn new(low: [f64; 2], high: [f64; 2]) -> Self {
        let body = String::new();
        Self { low, high, body }
    }

    /// Opens a group with the given id and presentation attributes.
    pub fn open(&mut self, id: &str, attributes: &str) {
        self.push(format_args!("<g id=\"{}\" {attributes}>", escaped(id)));
    }

    /// Closes the group opened last.
    pub fn close(&mut self) {
        self.push(format_args!("</g>"));
    }

    /// A straight line between two points (mm).
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], attributes: &str) {
        self.push(format_args!(
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {attributes}/>",
            number(from[0]),
            number(-from[1]),
            number(to[0]),
            number(-to[1]),
        ));
    }

    /// A circle with its centre and radius in mm.
    pub fn circle(&mut self, centre: [f64; 2], radius: f64, attributes: &str) {
        self.push(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {attributes}/>",
            number(centre[0]),
            number(-centre[1]),
            number(radius),
        ));
    }

    /// A closed polygon.
    pub fn polygon(&mut self, points: &[[f64; 2]], attributes: &str) {
        self.points("polygon", points, attributes);
    }

    /// An open line through points.
    pub fn polyline(&mut self, points: &[[f64; 2]], attributes: &str) {
        self.points("polyline", points, attributes);
    }

    fn points(&mut self, element: &str, points: &[[f64; 2]], attributes: &str) {
        let points: Vec<String> = points
            .iter()
            .map(|[x, y]| format!("{},{}", number(*x), number(-y)))
            .collect();
        let points = points.join(" ");
        self.push(format_args!(
            "<{element} points=\"{points}\" {attributes}/>"
        ));
    }

    /// Text of the given height (mm).
    pub fn text(
        &mut self,
        at: [f64; 2],
        height: f64,
        anchor: Anchor,
        attributes: &str,
        text: &str,
    ) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
        };
        self.push(format_args!(
            "<text x=\"{}\" y=\"{}\" font-family=\"DejaVu Sans\" font-size=\"{}\" \
             text-anchor=\"{anchor}\" {attributes}>{}</text>",
            number(at[0]),
            number(-at[1]),
            number(height),
            escaped(text),
        ));
    }

    /// The document, `width` wide in an SVG unit such as `mm` or `px`.
    pub fn finish(self, width: f64, unit: &str) -> String {
        let size = [self.high[0] - self.low[0], self.high[1] - self.low[1]];
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}{unit}\" height=\"{}{unit}\" \
             viewBox=\"{} {} {} {}\">\n{}</svg>\n",
            number(width),
            number(width * size[1] / size[0]),
            number(self.low[0]),
            number(-self.high[1]),
            number(size[0]),
            number(size[1]),
            self.body,
        )
    }

    fn push(&mut self, element: std::fmt::Arguments) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.body, "{element}");
    }
}

/// Four decimals without trailing zeros, and never `-0`.
pub fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_owned()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn y_points_up_and_one_unit_is_one_millimetre() {
        let mut canvas = Canvas::new([0.0, 0.0], [200.0, 100.0]);
        canvas.line([0.0, 0.0], [10.0, 25.00001], "");
        let svg = canvas.finish(200.0, "mm");
        assert!(svg.contains("width=\"200mm\" height=\"100mm\" viewBox=\"0 -100 200 100\""));
        assert!(
            svg.contains("x1=\"0\" y1=\"0\" x2=\"10\" y2=\"-25\""),
            "{svg}"
        );
    }

    #[test]
    fn text_is_escaped() {
        let mut canvas = Canvas::new([0.0; 2], [1.0; 2]);
        canvas.text([0.0; 2], 1.0, Anchor::Start, "", "a < b & \"c\"");
        assert!(
            canvas
                .finish(1.0, "px")
                .contains("a &lt; b &amp; &quot;c&quot;")
        );
    }
}
