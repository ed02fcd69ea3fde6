//! The kit as PDF: what to buy and the steps, the board on tiles at 1:1, and the board on one page.

use crate::{
    cut_file::{Tiling, form, tile_pages},
    display::{
        Canvas, Style, Text,
        pdf::{self, draw, page, place},
    },
    drawing::page::{INK, MUTED},
    mounting_kit::{
        board::board,
        step_pictures::{StepPictures, lines},
    },
};
use analysis::mounting::Mounting;
use design::{geometry::polygon::size, sheet::cut_sheet::Sheet};
use pdf_writer::Content;
use scene::Paper;
use support::Fault;

/// Border of the pages, columns and rows of pictures, their distance, and the height of the head
/// (mm).
const BORDER: f64 = 15.0;
const GRID: [usize; 2] = [2, 2];
const APART: f64 = 8.0;
const HEAD: f64 = 48.0;
/// Height of title and texts, the distance of lines, and the width of a letter on the mean (mm).
const TITLE: f64 = 5.0;
const LETTERS: f64 = 2.6;
const LINES: f64 = 5.0;
const LETTER: f64 = 2.0;

/// The kit of a sheet on a paper.
pub(crate) fn kit_pdf(
    title: &str,
    sheet: &Sheet,
    mounting: &Mounting,
    paper: Paper,
) -> Result<Vec<u8>, Fault> {
    let drawing = board(sheet, mounting);
    let [low, high] = drawing.bounds();
    let tiling = Tiling::new(paper, [low, high])?;
    let portrait = paper.size();
    let steps = step_pages(title, sheet, mounting, &tiling, portrait);
    let mut pages: Vec<([f64; 2], Content)> = steps.into_iter().map(|it| (portrait, it)).collect();
    let tiles = tile_pages(&tiling, title);
    pages.extend(tiles.into_iter().map(|tile| (tiling.page, tile)));
    let mut whole = page();
    place(&mut whole, 1.0, low.map(|x| BORDER - x));
    let form = form(&drawing);
    whole.x_object(form.name);
    pages.push((size([low, high]).map(|side| side + 2.0 * BORDER), whole));
    Ok(pdf::file(&form, pages))
}

/// What to buy, and the steps.
fn step_pages(
    title: &str,
    sheet: &Sheet,
    mounting: &Mounting,
    tiling: &Tiling,
    [width, height]: [f64; 2],
) -> Vec<Content> {
    let pictures = StepPictures::new(sheet, mounting);
    let all: Vec<usize> = (0..pictures.count()).collect();
    let [columns, rows] = GRID;
    let head = |canvas: &mut Canvas| {
        let mut y = height - BORDER - TITLE;
        canvas.add(Style::fill(INK), Text::line([BORDER, y], TITLE, title));
        let letters = ((width - 2.0 * BORDER) / LETTER) as usize;
        for line in shopping(sheet, mounting, tiling).iter().flat_map(|text| lines(text, letters)) {
            y -= LINES;
            canvas.add(Style::fill(MUTED), Text::line([BORDER, y - 1.0], LETTERS, &line));
        }
    };
    let pages = all.chunks(columns * rows).enumerate().map(|(number, steps)| {
        let mut canvas = Canvas::default();
        if number == 0 {
            head(&mut canvas);
        }
        let top = height - BORDER - HEAD;
        let room = [width - 2.0 * BORDER, top - BORDER];
        let cell = [room[0] / columns as f64 - APART, room[1] / rows as f64 - APART];
        for (i, step) in steps.iter().enumerate() {
            let low = [
                BORDER + (i % columns) as f64 * (cell[0] + APART),
                top - (i / columns + 1) as f64 * (cell[1] + APART),
            ];
            pictures.draw(&mut canvas, *step, [low, [low[0] + cell[0], low[1] + cell[1]]]);
        }
        let mut content = page();
        draw(&mut content, canvas.styled());
        content
    });
    pages.collect()
}

/// What a person needs, and how the template is used.
fn shopping(sheet: &Sheet, mounting: &Mounting, tiling: &Tiling) -> Vec<String> {
    let [width, height] = mounting.board(sheet);
    let count = mounting.count;
    let hole = mounting.fasteners.iter().find_map(|fastener| fastener.hole);
    let screws = match hole {
        Some(hole) => format!("{count} screws for holes of {hole} mm"),
        None => format!("{count} pins"),
    };
    let [rows, columns] = tiling.counts;
    vec![
        format!("You need: a board of {width:.0} x {height:.0} mm, {screws}, {count} spacers of one length, {} washers.", 2 * count),
        format!("Template: {rows} x {columns} pages at 100 %, trimmed at the dashed lines and joined cross on cross; the last page of this file is the \
             template in one piece. It is seen from the front, as the drawing stands."),
        "Each screw goes through a washer, the panel, a washer and a spacer; tighten it so far that the panel still turns.".to_owned(),
    ]
}
