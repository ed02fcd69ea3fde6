//! A drawing as PDF at 1:1, for hand cutting and desktop cutters: an overview, then one page a tile.
//!
//! Neighbouring tiles print the same strip. A dashed line in its middle with two crosses is at the same place of the
//! sheet on both: trim one of them there, lay it on the other, cross on cross.

use crate::output::cut_file::cut_drawing::{CutDrawing, Layer, Shape, Text};
use crate::output::cut_file::fabrication_error::FabricationError;
use crate::output::cut_file::tiling::{BORDER, FOOTER, OVERLAP, Tiling, cell_name};
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str};
use std::path::Path;

/// Points per mm.
const POINTS: f64 = 72.0 / 25.4;
/// Height of the capitals of Helvetica relative to the size of the font, and widths of digits and of other characters.
const CAPITALS: f64 = 0.718;
const DIGIT: f64 = 0.556;
const LETTER: f64 = 0.6;
/// Width of the lines of the drawing (mm).
const LINE: f64 = 0.2;
/// Crosses on the trim lines: their places along a tile, and their arms (mm).
const CROSSES: [f64; 2] = [0.25, 0.75];
const ARM: f64 = 3.0;
/// Length of the ruler (mm).
const RULER: u32 = 100;
/// Height of the title and of the other texts (mm).
const TITLE: f64 = 3.0;
const SMALL: f64 = 2.0;

const FONT: Name = Name(b"F");
const DRAWING: Name = Name(b"D");
const GREY: [u8; 3] = [128; 3];
const BLACK: [u8; 3] = [0; 3];

/// Writes an overview and the tiles of a drawing; `notes` are printed on the overview. The file is replaced atomically.
pub fn write_pdf(
    path: &Path,
    drawing: &CutDrawing,
    tiling: &Tiling,
    title: &str,
    notes: &[String],
) -> Result<(), FabricationError> {
    let bytes = pdf(drawing, tiling, title, notes);
    support::whole_file::write(path, &bytes).map_err(|source| FabricationError::Write {
        path: path.to_owned(),
        source,
    })
}

fn pdf(drawing: &CutDrawing, tiling: &Tiling, title: &str, notes: &[String]) -> Vec<u8> {
    let [rows, columns] = tiling.counts;
    let mut pages = vec![overview(tiling, title, notes)];
    for row in 0..rows {
        pages.extend((0..columns).map(|column| tile(tiling, row, column, title)));
    }
    let reference = |id: usize| Ref::new(id as i32 + 1);
    let [catalog, tree, font, shared] = [0, 1, 2, 3].map(reference);
    let mut file = Pdf::new();
    file.catalog(catalog).pages(tree);
    file.type1_font(font)
        .base_font(Name(b"Helvetica"))
        .encoding_predefined(Name(b"WinAnsiEncoding"));
    // Written once: every page shows its part of it.
    let content = shapes(drawing);
    let mut form = file.form_xobject(shared, &content);
    let [low, high] = drawing.bounds().map(|corner| corner.map(|x| x as f32));
    form.bbox(Rect::new(
        low[0] - 1.0,
        low[1] - 1.0,
        high[0] + 1.0,
        high[1] + 1.0,
    ));
    form.resources().fonts().pair(FONT, font);
    form.finish();
    let [width, height] = tiling.page.map(|x| (x * POINTS) as f32);
    let ids = |i: usize| [4 + 2 * i, 5 + 2 * i].map(reference);
    let kids = (0..pages.len()).map(|i| ids(i)[0]);
    file.pages(tree).count(pages.len() as i32).kids(kids);
    for (i, content) in pages.into_iter().enumerate() {
        let [id, stream] = ids(i);
        let mut page = file.page(id);
        page.media_box(Rect::new(0.0, 0.0, width, height));
        page.parent(tree).contents(stream);
        let mut resources = page.resources();
        resources.fonts().pair(FONT, font);
        resources.x_objects().pair(DRAWING, shared);
        resources.finish();
        page.finish();
        file.stream(stream, &content.finish());
    }
    file.finish()
}

/// The shapes in the coordinates of the drawing (mm).
fn shapes(drawing: &CutDrawing) -> Vec<u8> {
    let mut content = Content::new();
    for layer in Layer::ALL {
        colour(&mut content, layer.rgb());
        for shape in drawing.on(layer) {
            match shape {
                Shape::Line(ends) => line(&mut content, *ends),
                Shape::Circle { centre, radius } => circle(&mut content, *centre, *radius),
                Shape::Polygon(corners) => polygon(&mut content, corners),
                Shape::Text(text) => write(&mut content, text),
            }
        }
    }
    content.finish().to_vec()
}

/// The page of a tile: its part of the drawing, trim lines with crosses, its name and a ruler.
fn tile(tiling: &Tiling, row: usize, column: usize, title: &str) -> Content {
    let [rows, columns] = tiling.counts;
    let [low, high] = tiling.tile(row, column);
    let mut content = page();
    let frame = [low, high].map(|[x, y]| [x - low[0] + BORDER, y - low[1] + BORDER + FOOTER]);
    content.save_state();
    clip(&mut content, frame);
    let [x, y] = [frame[0][0] - low[0], frame[0][1] - low[1]];
    content.transform([1.0, 0.0, 0.0, 1.0, x as f32, y as f32]);
    content.set_line_width(LINE as f32).x_object(DRAWING);
    content.restore_state();

    colour(&mut content, GREY);
    content.set_line_width(0.15);
    let inner = [
        frame[0].map(|x| x + 0.5 * OVERLAP),
        frame[1].map(|x| x - 0.5 * OVERLAP),
    ];
    // Neighbours at the left, at the right, below and above.
    let sides = [
        (column > 0, 0, inner[0][0]),
        (column + 1 < columns, 0, inner[1][0]),
        (row + 1 < rows, 1, inner[0][1]),
        (row > 0, 1, inner[1][1]),
    ];
    for (_, axis, at) in sides.into_iter().filter(|(neighbour, ..)| *neighbour) {
        trim_line(&mut content, frame, axis, at);
    }
    let name = format!(
        "{}    {rows} rows x {columns} columns",
        cell_name(row, column)
    );
    footer(&mut content, tiling, &name, title);
    content
}

/// A dashed line across a tile at the coordinate `at` of an axis, with crosses.
fn trim_line(content: &mut Content, [low, high]: [[f64; 2]; 2], axis: usize, at: f64) {
    let point = |along: f64| match axis {
        0 => [at, along],
        _ => [along, at],
    };
    let (begin, end) = (low[1 - axis], high[1 - axis]);
    content.set_dash_pattern([2.0, 2.0], 0.0);
    line(content, [point(begin), point(end)]);
    content.set_dash_pattern([], 0.0);
    for place in CROSSES {
        let [x, y] = point(begin + place * (end - begin));
        line(content, [[x - ARM, y], [x + ARM, y]]);
        line(content, [[x, y - ARM], [x, y + ARM]]);
        circle(content, [x, y], 0.5 * ARM);
    }
}

/// The whole drawing, as large as the page allows, with the tiles and their names.
fn overview(tiling: &Tiling, title: &str, notes: &[String]) -> Content {
    let [rows, columns] = tiling.counts;
    let mut content = page();
    let mut y = tiling.page[1] - BORDER - TITLE;
    colour(&mut content, BLACK);
    write(&mut content, &text([BORDER, y], TITLE, title));
    y -= 0.5 * TITLE;
    let lines = [
        format!(
            "{rows} rows x {columns} columns of tiles, which overlap by {OVERLAP} mm: trim at the dashed lines, lay \
             cross on cross."
        ),
        "Overview, not to scale; the tiles are 1:1. Cut HOLES (blue), then CUT (red), OUTLINE (black) last.".into(),
    ];
    for note in notes.iter().chain(&lines) {
        y -= 2.0 * SMALL;
        write(&mut content, &text([BORDER, y], SMALL, note));
    }
    let (low, high) = (tiling.tile(rows - 1, 0)[0], tiling.tile(0, columns - 1)[1]);
    let room = [
        tiling.page[0] - 2.0 * BORDER,
        y - 2.0 * SMALL - BORDER - FOOTER,
    ];
    let scale = f64::min(room[0] / (high[0] - low[0]), room[1] / (high[1] - low[1]));
    let on_page = |[x, y]: [f64; 2]| {
        [
            BORDER + scale * (x - low[0]),
            BORDER + FOOTER + scale * (y - low[1]),
        ]
    };
    content.set_line_width(0.15);
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let [low, high] = tiling.tile(row, column).map(on_page);
        let middle = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
        colour(&mut content, [200; 3]);
        polygon(
            &mut content,
            &[low, [high[0], low[1]], high, [low[0], high[1]]],
        );
        let name = cell_name(row, column);
        let size = [high[0] - low[0], high[1] - low[1]];
        let height = f64::min(0.3 * size[0], 0.4 * size[1]).min(20.0);
        let label = Text {
            centred: true,
            ..text(middle, height, &name)
        };
        colour(&mut content, [225; 3]);
        write(&mut content, &label);
    }
    content.save_state();
    let [x, y] = on_page([0.0; 2]);
    let factor = scale as f32;
    content.transform([factor, 0.0, 0.0, factor, x as f32, y as f32]);
    content
        .set_line_width((LINE / scale) as f32)
        .x_object(DRAWING);
    content.restore_state();
    footer(&mut content, tiling, "Overview", title);
    content
}

/// The name of the page and a ruler.
fn footer(content: &mut Content, tiling: &Tiling, name: &str, title: &str) {
    colour(content, BLACK);
    content.set_line_width(LINE as f32);
    let [x, y] = [BORDER, BORDER + 6.0];
    line(content, [[x, y], [x + f64::from(RULER), y]]);
    for at in (0..=RULER).step_by(10) {
        let tick = if at % 50 == 0 { 3.0 } else { 1.8 };
        let x = x + f64::from(at);
        line(content, [[x, y], [x, y + tick]]);
    }
    for (at, label) in [(0, "0"), (50, "50"), (RULER, "100 mm")] {
        let middle = [x + f64::from(at), y - 2.5];
        let label = Text {
            centred: true,
            ..text(middle, SMALL, label)
        };
        write(content, &label);
    }
    let left = x + f64::from(RULER) + 12.0;
    clip(
        content,
        [[left, 0.0], [tiling.page[0] - BORDER, BORDER + FOOTER]],
    );
    write(content, &text([left, y + 1.0], TITLE, name));
    let check = "Print at 100 %: the ruler is 100 mm long.";
    write(content, &text([left, y - 3.5], SMALL, check));
    write(content, &text([left, y - 7.5], SMALL, title));
}

fn page() -> Content {
    let mut content = Content::new();
    let scale = POINTS as f32;
    content.transform([scale, 0.0, 0.0, scale, 0.0, 0.0]);
    content
}

fn clip(content: &mut Content, [low, high]: [[f64; 2]; 2]) {
    let size = [high[0] - low[0], high[1] - low[1]].map(|x| x as f32);
    content.rect(low[0] as f32, low[1] as f32, size[0], size[1]);
    content.clip_nonzero().end_path();
}

fn colour(content: &mut Content, rgb: [u8; 3]) {
    let [r, g, b] = rgb.map(|x| f32::from(x) / 255.0);
    content.set_stroke_rgb(r, g, b).set_fill_rgb(r, g, b);
}

fn line(content: &mut Content, [from, to]: [[f64; 2]; 2]) {
    content.move_to(from[0] as f32, from[1] as f32);
    content.line_to(to[0] as f32, to[1] as f32).stroke();
}

fn polygon(content: &mut Content, corners: &[[f64; 2]]) {
    for (i, [x, y]) in corners.iter().enumerate() {
        match i {
            0 => content.move_to(*x as f32, *y as f32),
            _ => content.line_to(*x as f32, *y as f32),
        };
    }
    content.close_path().stroke();
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
    content.close_path().stroke();
}

/// A text that begins at a point.
fn text(at: [f64; 2], height: f64, text: &str) -> Text {
    Text {
        at,
        centred: false,
        height,
        text: text.to_owned(),
    }
}

fn write(content: &mut Content, text: &Text) {
    let size = text.height / CAPITALS;
    let widths = text.text.chars().map(|c| match c.is_ascii_digit() {
        true => DIGIT,
        false => LETTER,
    });
    let [mut x, mut y] = text.at;
    if text.centred {
        x -= 0.5 * size * widths.sum::<f64>();
        y -= 0.5 * text.height;
    }
    // The code page of the font has the characters of Latin-1 at their code points.
    let latin = |c: char| u8::try_from(u32::from(c)).unwrap_or(b'?');
    let bytes: Vec<u8> = text.text.chars().map(latin).collect();
    content.begin_text().set_font(FONT, size as f32);
    content.set_text_matrix([1.0, 0.0, 0.0, 1.0, x as f32, y as f32]);
    content.show(Str(&bytes)).end_text();
}
