//! A drawing as PDF at 1:1, for hand cutting and desktop cutters: an overview, then one page a
//! tile.
//!
//! Neighbouring tiles print the same strip. A dashed line in its middle with two crosses is at the
//! same place of the sheet on both: trim one of them there, lay it on the other, cross on cross.

use crate::{
    cut_file::{
        cut_drawing::CutDrawing,
        tiling::{BORDER, FOOTER, OVERLAP, Tiling, cell_name},
    },
    display::{
        Canvas, Colour, Style, Text,
        pdf::{self, Form, clip, draw, page, place},
        rectangle,
    },
};
use design::geometry::polygon::{mean, size};
use pdf_writer::{Content, Name};
use support::Point;

/// Width of the lines of the drawing and of the marks around it (mm).
const LINE: f64 = 0.2;
const THIN: f64 = 0.15;
/// Crosses on the trim lines: their places along a tile, and their arms (mm).
const CROSSES: [f64; 2] = [0.25, 0.75];
const ARM: f64 = 3.0;
/// Length of the ruler (mm).
const RULER: u32 = 100;
/// Height of the title and of the other texts (mm).
const TITLE: f64 = 3.0;
const SMALL: f64 = 2.0;

const DRAWING: Name = Name(b"D");
const GREY: Colour = [128; 3];
const BLACK: Colour = [0; 3];

/// An overview and the tiles of a drawing; `notes` are printed on the overview.
pub fn tiles_pdf(drawing: &CutDrawing, tiling: &Tiling, title: &str, notes: &[String]) -> Vec<u8> {
    let mut pages = vec![overview(drawing, tiling, title, notes)];
    pages.extend(tile_pages(tiling, title));
    pdf::file(&form(drawing), pages.into_iter().map(|page| (tiling.page, page)).collect())
}

/// The pages of the tiles of a drawing, row by row from the top.
pub(crate) fn tile_pages(tiling: &Tiling, title: &str) -> Vec<Content> {
    let [rows, columns] = tiling.counts;
    let tiles = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    tiles.map(|(row, column)| tile(tiling, row, column, title)).collect()
}

/// A drawing that tiles show.
pub(crate) fn form(drawing: &CutDrawing) -> Form {
    let [low, high] = drawing.bounds();
    let mut shapes = Content::new();
    draw(&mut shapes, drawing.coloured(LINE));
    Form {
        name: DRAWING,
        content: shapes.finish().to_vec(),
        bounds: [low.map(|x| x - 1.0), high.map(|x| x + 1.0)],
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
    let shift = [frame[0][0] - low[0], frame[0][1] - low[1]];
    place(&mut content, 1.0, shift);
    content.x_object(DRAWING);
    content.restore_state();

    let inner = [frame[0].map(|x| x + 0.5 * OVERLAP), frame[1].map(|x| x - 0.5 * OVERLAP)];
    // Neighbours at the left, at the right, below and above.
    let sides = [
        (column > 0, 0, inner[0][0]),
        (column + 1 < columns, 0, inner[1][0]),
        (row + 1 < rows, 1, inner[0][1]),
        (row > 0, 1, inner[1][1]),
    ];
    let mut marks = Canvas::default();
    for (_, axis, at) in sides.into_iter().filter(|(neighbour, ..)| *neighbour) {
        trim_line(&mut marks, frame, axis, at);
    }
    draw(&mut content, marks.styled());
    let name = format!("{}    {rows} rows x {columns} columns", cell_name(row, column));
    footer(&mut content, tiling, &name, title);
    content
}

/// A dashed line across a tile at the coordinate `at` of an axis, with crosses.
fn trim_line(canvas: &mut Canvas, [low, high]: [Point; 2], axis: usize, at: f64) {
    let point = |along: f64| match axis {
        0 => [at, along],
        _ => [along, at],
    };
    let (begin, end) = (low[1 - axis], high[1 - axis]);
    let thin = Style::stroke(GREY, THIN);
    canvas.line(point(begin), point(end), thin.dashed(2.0, 2.0));
    for place in CROSSES {
        let at = point(begin + place * (end - begin));
        canvas.cross(at, ARM, thin);
        canvas.circle(at, 0.5 * ARM, thin);
    }
}

/// The whole drawing, as large as the page allows, with the tiles and their names.
fn overview(drawing: &CutDrawing, tiling: &Tiling, title: &str, notes: &[String]) -> Content {
    let [rows, columns] = tiling.counts;
    let black = Style::fill(BLACK);
    let mut canvas = Canvas::default();
    let mut y = tiling.page[1] - BORDER - TITLE;
    canvas.add(black, Text::line([BORDER, y], TITLE, title));
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
        canvas.add(black, Text::line([BORDER, y], SMALL, note));
    }
    let (low, high) = (tiling.tile(rows - 1, 0)[0], tiling.tile(0, columns - 1)[1]);
    let room = [tiling.page[0] - 2.0 * BORDER, y - 2.0 * SMALL - BORDER - FOOTER];
    let [width, height] = size([low, high]);
    let scale = f64::min(room[0] / width, room[1] / height);
    let origin = [BORDER - scale * low[0], BORDER + FOOTER - scale * low[1]];
    let on_page = |[x, y]: Point| [origin[0] + scale * x, origin[1] + scale * y];
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let corners = tiling.tile(row, column).map(on_page);
        canvas.polygon(&rectangle(corners), Style::stroke([200; 3], THIN));
        let (middle, [width, height]) = (mean(&corners), size(corners));
        let height = f64::min(0.3 * width, 0.4 * height).min(20.0);
        let name = Text::centred(middle, height, cell_name(row, column));
        canvas.add(Style::fill([225; 3]), name);
    }
    let mut content = page();
    draw(&mut content, canvas.styled());
    content.save_state();
    place(&mut content, scale, origin);
    draw(&mut content, drawing.coloured(LINE / scale));
    content.restore_state();
    footer(&mut content, tiling, "Overview", title);
    content
}

/// The name of the page and a ruler.
fn footer(content: &mut Content, tiling: &Tiling, name: &str, title: &str) {
    let (line, black) = (Style::stroke(BLACK, LINE), Style::fill(BLACK));
    let mut canvas = Canvas::default();
    let [x, y] = [BORDER, BORDER + 6.0];
    canvas.line([x, y], [x + f64::from(RULER), y], line);
    for at in (0..=RULER).step_by(10) {
        let tick = if at % 50 == 0 { 3.0 } else { 1.8 };
        let x = x + f64::from(at);
        canvas.line([x, y], [x, y + tick], line);
    }
    for (at, label) in [(0, "0"), (50, "50"), (RULER, "100 mm")] {
        let middle = [x + f64::from(at), y - 2.5];
        canvas.add(black, Text::centred(middle, SMALL, label.to_owned()));
    }
    draw(content, canvas.styled());
    let left = x + f64::from(RULER) + 12.0;
    let right = tiling.page[0] - BORDER;
    clip(content, [[left, 0.0], [right, BORDER + FOOTER]]);
    let check = "Print at 100 %: the ruler is 100 mm long.";
    let mut names = Canvas::default();
    names.add(black, Text::line([left, y + 1.0], TITLE, name));
    names.add(black, Text::line([left, y - 3.5], SMALL, check));
    names.add(black, Text::line([left, y - 7.5], SMALL, title));
    draw(content, names.styled());
}
