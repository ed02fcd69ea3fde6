//! Pages of PDF in mm, in Helvetica, which every reader has. Styles are colours, widths and dashes:
//! no opacity, no halo.

use crate::display::{
    shape::{Anchor, Shape, Text},
    style::{Colour, Style},
};
use design::geometry::polygon::size;
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str};
use scene::drawing::bulged::flattened;

/// Points per mm.
const POINTS: f64 = 72.0 / 25.4;
/// Height of the capitals of Helvetica relative to the size of the font, and widths of digits and
/// of other characters.
const CAPITALS: f64 = 0.718;
const DIGIT: f64 = 0.556;
const LETTER: f64 = 0.6;

/// The name of the resource of the font.
const FONT: Name = Name(b"F");

/// A drawing that is written once and shown on any number of pages.
pub(crate) struct Form {
    /// Its name in `Content::x_object`.
    pub name: Name<'static>,
    /// Its content (mm).
    pub content: Vec<u8>,
    /// Lower left and upper right corner (mm).
    pub bounds: [[f64; 2]; 2],
}

/// A file of pages, each with its size (mm), with a form that they use.
pub(crate) fn file(form: &Form, pages: Vec<([f64; 2], Content)>) -> Vec<u8> {
    let mut ids = (1..).map(Ref::new);
    let mut next = || ids.next().expect("fewer objects than integers");
    let [catalog, tree, font, shared] = std::array::from_fn(|_| next());
    let mut file = Pdf::new();
    file.catalog(catalog).pages(tree);
    file.type1_font(font)
        .base_font(Name(b"Helvetica"))
        .encoding_predefined(Name(b"WinAnsiEncoding"));
    let [low, high] = form.bounds.map(|corner| corner.map(|x| x as f32));
    let mut object = file.form_xobject(shared, &form.content);
    object.bbox(Rect::new(low[0], low[1], high[0], high[1]));
    object.resources().fonts().pair(FONT, font);
    object.finish();
    let pages: Vec<_> = pages.into_iter().map(|page| (next(), next(), page)).collect();
    let kids = pages.iter().map(|(id, ..)| *id);
    file.pages(tree).count(pages.len() as i32).kids(kids);
    for (id, stream, (size, content)) in pages {
        let [width, height] = size.map(|x| (x * POINTS) as f32);
        let mut page = file.page(id);
        page.media_box(Rect::new(0.0, 0.0, width, height));
        page.parent(tree).contents(stream);
        let mut resources = page.resources();
        resources.fonts().pair(FONT, font);
        resources.x_objects().pair(form.name, shared);
        resources.finish();
        page.finish();
        file.stream(stream, &content.finish());
    }
    file.finish()
}

/// An empty page, whose unit is the mm.
pub(crate) fn page() -> Content {
    let mut content = Content::new();
    place(&mut content, POINTS, [0.0; 2]);
    content
}

/// Restricts what follows to a rectangle, until the state is restored.
pub(crate) fn clip(content: &mut Content, corners: [[f64; 2]; 2]) {
    let [[x, y], [width, height]] = [corners[0], size(corners)].map(|it| it.map(|x| x as f32));
    content.rect(x, y, width, height);
    content.clip_nonzero().end_path();
}

/// Sets what follows smaller or larger, and shifts its origin to a point (mm).
pub(crate) fn place(content: &mut Content, scale: f64, [x, y]: [f64; 2]) {
    let [scale, x, y] = [scale, x, y].map(|value| value as f32);
    content.transform([scale, 0.0, 0.0, scale, x, y]);
}

/// Draws shapes one after the other.
pub(crate) fn draw<'a>(
    content: &mut Content,
    shapes: impl IntoIterator<Item = (Style, &'a Shape)>,
) {
    for (style, shape) in shapes {
        if let Some([r, g, b]) = style.fill.map(rgb) {
            content.set_fill_rgb(r, g, b);
        }
        if let Shape::Text(text) = shape {
            write(content, text);
            continue;
        }
        if let Some([r, g, b]) = style.stroke.map(rgb) {
            content.set_stroke_rgb(r, g, b);
            content.set_line_width(style.width as f32);
        }
        let dash = style.dash.iter().flatten().map(|length| *length as f32);
        content.set_dash_pattern(dash, 0.0);
        outline(content, shape);
        match (style.fill, style.stroke) {
            (Some(_), Some(_)) => content.fill_nonzero_and_stroke(),
            (Some(_), None) => content.fill_nonzero(),
            (None, Some(_)) => content.stroke(),
            (None, None) => content.end_path(),
        };
    }
}

fn rgb(colour: Colour) -> [f32; 3] {
    colour.map(|x| f32::from(x) / 255.0)
}

fn outline(content: &mut Content, shape: &Shape) {
    match shape {
        Shape::Line(ends) => trace(content, ends),
        Shape::Polyline(points) => trace(content, points),
        Shape::Polygon(corners) => {
            trace(content, corners);
            content.close_path();
        }
        Shape::Contour(vertices) => {
            trace(content, &flattened(vertices, true));
            content.close_path();
        }
        Shape::Circle { centre, radius } => circle(content, *centre, *radius),
        Shape::Text(_) => {}
    }
}

fn trace(content: &mut Content, points: &[[f64; 2]]) {
    for (i, [x, y]) in points.iter().enumerate() {
        match i {
            0 => content.move_to(*x as f32, *y as f32),
            _ => content.line_to(*x as f32, *y as f32),
        };
    }
}

/// A circle of four cubic curves, whose error is below 0.03 % of the radius.
fn circle(content: &mut Content, [x, y]: [f64; 2], radius: f64) {
    const HANDLE: f64 = 0.552_284_75;
    let at = |u: f64, v: f64| [(x + radius * u) as f32, (y + radius * v) as f32];
    let [begin_x, begin_y] = at(1.0, 0.0);
    content.move_to(begin_x, begin_y);
    for (c, s) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
        let [a, b] = at(c - HANDLE * s, s + HANDLE * c);
        let [d, e] = at(-s + HANDLE * c, c + HANDLE * s);
        let [f, g] = at(-s, c);
        content.cubic_to(a, b, d, e, f, g);
    }
    content.close_path();
}

fn write(content: &mut Content, text: &Text) {
    let size = text.height / CAPITALS;
    let characters = || text.text.chars();
    let widths = characters().map(|c| if c.is_ascii_digit() { DIGIT } else { LETTER });
    let [mut x, y] = text.baseline();
    if text.anchor != Anchor::Start {
        x -= 0.5 * size * widths.sum::<f64>();
    }
    let bytes: Vec<u8> = characters().map(|c| byte(c).unwrap_or(b'?')).collect();
    content
        .begin_text()
        .set_font(FONT, size as f32)
        .set_text_matrix([1.0, 0.0, 0.0, 1.0, x as f32, y as f32])
        .show(Str(&bytes))
        .end_text();
}

/// The place of a character in the code page of the fonts, Windows-1252.
fn byte(c: char) -> Option<u8> {
    const FROM_128: &str = "€\u{81}‚ƒ„…†‡ˆ‰Š‹Œ\u{8d}Ž\u{8f}\u{90}‘’“”•–—˜™š›œ\u{9d}žŸ";
    match FROM_128.chars().position(|other| other == c) {
        Some(place) => Some(128 + place as u8),
        None => u8::try_from(u32::from(c)).ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::byte;

    #[test]
    fn characters_are_those_of_windows_1252() {
        let cases = [
            ('a', Some(0x61)),
            ('\u{d7}', Some(0xd7)),
            ('\u{20ac}', Some(0x80)),
            ('\u{2013}', Some(0x96)),
            ('\u{178}', Some(0x9f)),
            ('\u{3b8}', None),
        ];
        for (c, expected) in cases {
            assert_eq!(byte(c), expected, "{c}");
        }
    }
}
