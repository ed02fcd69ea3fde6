//! A drawing as PDF at 1:1, for hand cutting and desktop cutters: an overview, then one page a tile.
//!
//! Neighbouring tiles print the same strip. A dashed line in its middle with two crosses is at the same place of the
//! sheet on both: trim one of them there, lay it on the other, cross on cross.

use crate::cut_file::cut_drawing::{CutDrawing, Layer, Shape, Text};
use crate::cut_file::fabrication_error::FabricationError;
use crate::cut_file::tiling::{BORDER, FOOTER, OVERLAP, Tiling, cell_name};
use crate::pdf::{self, Font, Form, circle, clip, colour, line, page, polygon};
use pdf_writer::{Content, Name};
use std::path::Path;

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
    let [low, high] = drawing.bounds();
    let mut shapes = Content::new();
    draw(&mut shapes, drawing);
    let form = Form {
        name: DRAWING,
        content: shapes.finish().to_vec(),
        bounds: [low.map(|x| x - 1.0), high.map(|x| x + 1.0)],
    };
    pdf::file(tiling.page, &[Font::Sans], Some(&form), pages)
}

/// Draws all shapes, in the coordinates of the drawing (mm).
pub(crate) fn draw(content: &mut Content, drawing: &CutDrawing) {
    for layer in Layer::ALL {
        colour(content, layer.rgb());
        for shape in drawing.on(layer) {
            match shape {
                Shape::Line(ends) => line(content, *ends),
                Shape::Circle { centre, radius } => circle(content, *centre, *radius),
                Shape::Polygon(corners) => polygon(content, corners),
                Shape::Text(text) => write(content, text),
            }
        }
    }
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

/// A text that begins at a point.
fn text(at: [f64; 2], height: f64, text: &str) -> Text {
    Text {
        at,
        centred: false,
        height,
        text: text.to_owned(),
    }
}

pub(crate) fn write(content: &mut Content, text: &Text) {
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
    pdf::write(content, Font::Sans, size, [x, y], &text.text);
}
