//! Pages of PDF in mm, with fonts that every reader has.

use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str};

/// Points per mm.
const POINTS: f64 = 72.0 / 25.4;

/// A font.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Font {
    /// Helvetica.
    Sans,
    /// Helvetica Bold.
    Bold,
    /// Courier, in which every character is 0.6 times as wide as the font is high.
    Fixed,
}

impl Font {
    /// The name of its resource, and of the font.
    fn names(self) -> [Name<'static>; 2] {
        match self {
            Self::Sans => [Name(b"F"), Name(b"Helvetica")],
            Self::Bold => [Name(b"B"), Name(b"Helvetica-Bold")],
            Self::Fixed => [Name(b"C"), Name(b"Courier")],
        }
    }
}

/// A drawing that is written once and shown on any number of pages.
pub(super) struct Form {
    /// Its name in `Content::x_object`.
    pub name: Name<'static>,
    /// Its content (mm).
    pub content: Vec<u8>,
    /// Lower left and upper right corner (mm).
    pub bounds: [[f64; 2]; 2],
}

/// A file of pages of the given size (mm), with the fonts and the form that they use.
pub(super) fn file(
    size: [f64; 2],
    fonts: &[Font],
    form: Option<&Form>,
    pages: Vec<Content>,
) -> Vec<u8> {
    let mut ids = (1..).map(Ref::new);
    let mut next = || ids.next().expect("fewer objects than integers");
    let [catalog, tree] = [next(), next()];
    let fonts: Vec<(Font, Ref)> = fonts.iter().map(|font| (*font, next())).collect();
    let mut file = Pdf::new();
    file.catalog(catalog).pages(tree);
    for (font, id) in &fonts {
        file.type1_font(*id)
            .base_font(font.names()[1])
            .encoding_predefined(Name(b"WinAnsiEncoding"));
    }
    let form = form.map(|form| {
        let id = next();
        let [low, high] = form.bounds.map(|corner| corner.map(|x| x as f32));
        let mut object = file.form_xobject(id, &form.content);
        object.bbox(Rect::new(low[0], low[1], high[0], high[1]));
        let mut resources = object.resources();
        let mut dictionary = resources.fonts();
        for (font, id) in &fonts {
            dictionary.pair(font.names()[0], *id);
        }
        (form.name, id)
    });
    let pages: Vec<(Ref, Ref, Content)> = (pages.into_iter())
        .map(|page| (next(), next(), page))
        .collect();
    let kids = pages.iter().map(|(id, ..)| *id);
    file.pages(tree).count(pages.len() as i32).kids(kids);
    let [width, height] = size.map(|x| (x * POINTS) as f32);
    for (id, stream, content) in pages {
        let mut page = file.page(id);
        page.media_box(Rect::new(0.0, 0.0, width, height));
        page.parent(tree).contents(stream);
        let mut resources = page.resources();
        let mut dictionary = resources.fonts();
        for (font, id) in &fonts {
            dictionary.pair(font.names()[0], *id);
        }
        dictionary.finish();
        if let Some((name, id)) = form {
            resources.x_objects().pair(name, id);
        }
        resources.finish();
        page.finish();
        file.stream(stream, &content.finish());
    }
    file.finish()
}

/// An empty page, whose unit is the mm.
pub(super) fn page() -> Content {
    let mut content = Content::new();
    let scale = POINTS as f32;
    content.transform([scale, 0.0, 0.0, scale, 0.0, 0.0]);
    content
}

/// Restricts what follows to a rectangle, until the state is restored.
pub(super) fn clip(content: &mut Content, [low, high]: [[f64; 2]; 2]) {
    let size = [high[0] - low[0], high[1] - low[1]].map(|x| x as f32);
    content.rect(low[0] as f32, low[1] as f32, size[0], size[1]);
    content.clip_nonzero().end_path();
}

/// The colour of lines, areas and texts, 0 to 255.
pub(super) fn colour(content: &mut Content, rgb: [u8; 3]) {
    let [r, g, b] = rgb.map(|x| f32::from(x) / 255.0);
    content.set_stroke_rgb(r, g, b).set_fill_rgb(r, g, b);
}

pub(super) fn line(content: &mut Content, ends: [[f64; 2]; 2]) {
    polyline(content, &ends);
}

pub(super) fn polyline(content: &mut Content, points: &[[f64; 2]]) {
    trace(content, points);
    content.stroke();
}

pub(super) fn polygon(content: &mut Content, corners: &[[f64; 2]]) {
    trace(content, corners);
    content.close_path().stroke();
}

pub(super) fn filled(content: &mut Content, corners: &[[f64; 2]]) {
    trace(content, corners);
    content.close_path().fill_nonzero();
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
pub(super) fn circle(content: &mut Content, [x, y]: [f64; 2], radius: f64) {
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
    content.close_path().stroke();
}

/// A text that begins at a point, in a font of the given size (mm).
pub(super) fn write(content: &mut Content, font: Font, size: f64, [x, y]: [f64; 2], text: &str) {
    let bytes: Vec<u8> = text.chars().map(|c| byte(c).unwrap_or(b'?')).collect();
    content
        .begin_text()
        .set_font(font.names()[0], size as f32)
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
