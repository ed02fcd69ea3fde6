//! `report.pdf`: the deployed sheet, the flat sheet with its cuts, and the lines of `report.txt`, on A4 in portrait.

use crate::cut_file::CutLines;
use crate::display::pdf::{self, Font, draw, page, place};
use crate::display::{Canvas, Style, Text};
use crate::drawing::page::{INK, MUTED, Sketch, round_below};
use crate::drawing::{deployed_on_paper, flat_on_paper};
use crate::report::Report;
use design::geometry::polygon::bounds;
use design::scene::design_run::Designed;
use design::scene::{Paper, Scene};
use pdf_writer::Content;

/// White border of a page (mm).
const BORDER: f64 = 15.0;
/// Size of the title's font, and an upper bound of the mean width of its characters over that (mm).
const TITLE: f64 = 5.0;
const TITLE_CHARACTER: f64 = 0.6;
/// Number of characters on a line of the report. No line of its tables is longer.
const COLUMNS: usize = 114;
/// Width of a character of Courier over the size of the font, and the distance of two lines over it.
const COURIER: f64 = 0.6;
const LINE: f64 = 1.2;
/// Height of the drawings and the distance between them (mm).
const HEIGHT: f64 = 128.0;
const GAP: f64 = 10.0;
/// Height of the capitals of captions (mm).
const CAPTION: f64 = 2.0;
/// The unit of strokes, symbols and labels (mm).
const UNIT: f64 = 0.17;

/// The pages of a run. Without `cuts` the flat sheet is not drawn.
pub(crate) fn report_pdf(
    scene: &Scene,
    designed: &Designed,
    report: &Report,
    cuts: Option<&CutLines>,
) -> Vec<u8> {
    let size = Paper::A4.size();
    let mut first = page();
    let mut top = size[1] - BORDER;
    pdf::colour(&mut first, INK);
    let longest = (size[0] - 2.0 * BORDER) / (TITLE_CHARACTER * TITLE);
    let text = report.to_string();
    let (title, rest) = text.split_once('\n').unwrap_or((&text, ""));
    for part in wrapped(title, longest as usize) {
        top -= TITLE;
        pdf::write(&mut first, Font::Bold, TITLE, [BORDER, top], &part);
        top -= 0.3 * TITLE;
    }
    top = drawings(&mut first, top - 3.0, scene, designed, cuts);

    let pages = text_pages(first, top - 4.0, size, rest);
    let count = pages.len();
    let numbered = pages.into_iter().zip(1..).map(|(mut page, number)| {
        let text = format!("page {number} of {count}");
        let at = [size[0] - BORDER - 18.0, 0.6 * BORDER];
        pdf::colour(&mut page, MUTED);
        pdf::write(&mut page, Font::Sans, 2.6, at, &text);
        page
    });
    let fonts = [Font::Sans, Font::Bold, Font::Fixed];
    pdf::file(size, &fonts, None, numbered.collect())
}

/// Places of drawings of the same scale on a page.
struct Layout {
    scale: f64,
    /// Whether they stand beside each other, not one above the other.
    beside: bool,
    /// Their height (mm).
    height: f64,
}

impl Layout {
    /// The arrangement in which drawings of the given bounding boxes are larger.
    fn new(boxes: &[[[f64; 2]; 2]]) -> Self {
        let sum = |axis: usize| boxes.iter().map(|corners| side(corners, axis)).sum::<f64>();
        let sides = |axis: usize| boxes.iter().map(move |corners| side(corners, axis));
        let most = |axis: usize| sides(axis).fold(0.0, f64::max);
        let gaps = GAP * (boxes.len() - 1) as f64;
        let width = Paper::A4.size()[0] - 2.0 * BORDER;
        let beside = f64::min((width - gaps) / sum(0), HEIGHT / most(1));
        let stacked = f64::min(width / most(0), (HEIGHT - gaps) / sum(1));
        if beside >= stacked {
            Self {
                scale: beside,
                beside: true,
                height: beside * most(1),
            }
        } else {
            Self {
                scale: stacked,
                beside: false,
                height: stacked * sum(1) + gaps,
            }
        }
    }
}

fn side([low, high]: &[[f64; 2]; 2], axis: usize) -> f64 {
    high[axis] - low[axis]
}

/// Draws the deployed and the flat sheet at the same scale with their captions and a scale bar. Returns the lower end.
fn drawings(
    content: &mut Content,
    top: f64,
    scene: &Scene,
    designed: &Designed,
    cuts: Option<&CutLines>,
) -> f64 {
    let deployment = &designed.best.deployment;
    let (sheet, compared) = (&deployment.sheet, deployment.compared());
    let sketches = |scale: f64| -> Vec<Sketch> {
        let unit = UNIT / scale;
        let deployed = deployed_on_paper(scene, sheet, compared, unit);
        let flat = cuts.map(|cuts| flat_on_paper(sheet, cuts, unit));
        [deployed].into_iter().chain(flat).collect()
    };
    let boxes = |sketches: &[Sketch]| -> Vec<_> {
        sketches
            .iter()
            .map(|sketch| sketch.canvas.bounds())
            .collect()
    };
    // Symbols and labels have a size on the page: in the sheet they are the larger the smaller the drawing is.
    let mut layout = Layout::new(&vec![
        bounds(sheet.outline.corners);
        1 + usize::from(cuts.is_some())
    ]);
    for _ in 0..8 {
        layout = Layout::new(&boxes(&sketches(layout.scale)));
    }
    let scale = layout.scale;
    let sketches = sketches(scale);
    let carries_load = scene.hinge.carries_load();
    let deployed = if deployment.released.is_some() {
        "Loads taken off, panels in the plane".to_owned()
    } else if carries_load {
        let factor = compared.load_factor;
        format!("Deployed, panels in the plane, load factor {factor:.4}")
    } else {
        "Deployed".to_owned()
    };
    let flat = "Flat: cuts, panels (P) and hinges by number".to_owned();
    let mut corner = [BORDER, top];
    let mut captions = Canvas::default();
    for ((sketch, corners), caption) in sketches.iter().zip(boxes(&sketches)).zip([deployed, flat])
    {
        let below = [corner[0], corner[1] - CAPTION];
        captions.add(Style::fill(MUTED), Text::line(below, CAPTION, &caption));
        let origin = [
            corner[0] - scale * corners[0][0],
            corner[1] - 2.5 * CAPTION - scale * corners[1][1],
        ];
        content.save_state();
        place(content, scale, origin);
        draw(content, sketch.canvas.styled());
        content.restore_state();
        if layout.beside {
            corner[0] += scale * side(&corners, 0) + GAP;
        } else {
            corner[1] -= scale * side(&corners, 1) + GAP;
        }
    }
    let bottom = top - 2.5 * CAPTION - layout.height - 4.0;
    scale_bar(&mut captions, [BORDER, bottom], scale);
    draw(content, captions.styled());
    bottom
}

/// A scale bar, and what the dashes of the drawings above it show.
fn scale_bar(canvas: &mut Canvas, [x, y]: [f64; 2], scale: f64) {
    let length = round_below(40.0 / scale);
    let (end, line) = (x + scale * length, Style::stroke(INK, 0.25));
    canvas.line([x, y], [end, y], line);
    for x in [x, end] {
        canvas.line([x, y - 1.0], [x, y + 1.0], line);
    }
    let label = format!("{length} mm; dashed: target");
    canvas.add(
        Style::fill(INK),
        Text::line([end + 2.0, y - 0.9], CAPTION, &label),
    );
}

/// The lines of a text, on the first page below `top`, then on further pages. A block between two empty lines is not
/// divided if it fits on a page.
fn text_pages(first: Content, top: f64, size: [f64; 2], text: &str) -> Vec<Content> {
    let font = (size[0] - 2.0 * BORDER) / (COURIER * COLUMNS as f64);
    let pitch = LINE * font;
    let rows = |height: f64| (height / pitch) as usize;
    let most = rows(size[1] - 2.0 * BORDER);
    let mut pages = vec![first];
    let mut left = rows(top - BORDER);
    let mut y = top;
    for block in text.split("\n\n") {
        let lines: Vec<String> = block
            .trim_matches('\n')
            .lines()
            .flat_map(|line| wrapped(line, COLUMNS))
            .collect();
        let whole = lines.len() <= most;
        for (place, line) in lines.iter().enumerate() {
            let needed = if whole { lines.len() - place } else { 1 };
            if needed > left {
                pages.push(page());
                (left, y) = (most, size[1] - BORDER);
            }
            y -= pitch;
            left -= 1;
            if let Some(content) = pages.last_mut() {
                pdf::colour(content, INK);
                pdf::write(content, Font::Fixed, font, [BORDER, y], line);
            }
        }
        y -= pitch;
        left = left.saturating_sub(1);
    }
    pages
}

/// A line in pieces of at most `columns` characters, divided at spaces; the second and later ones are indented as far as
/// the value of a row of names and values, or as the text of an item of a list.
fn wrapped(line: &str, columns: usize) -> Vec<String> {
    let characters: Vec<char> = line.chars().collect();
    let spaces = characters.windows(2).position(|pair| pair == [' ', ' ']);
    let indent = match spaces {
        Some(begin) => (begin..characters.len()).find(|&i| characters[i] != ' '),
        None => line.starts_with("- ").then_some(2),
    };
    let indent = indent.filter(|&indent| indent <= columns / 2).unwrap_or(0);
    let mut pieces = Vec::new();
    let mut rest = &characters[..];
    loop {
        let (room, from) = if pieces.is_empty() {
            (columns, indent)
        } else {
            (columns - indent, 0)
        };
        if rest.len() <= room {
            break;
        }
        // A word that is longer than the line is divided.
        let space = (from + 1..=room).rev().find(|&i| rest[i] == ' ');
        let (piece, after) = rest.split_at(space.unwrap_or(room));
        pieces.push(piece.iter().collect::<String>());
        rest = &after[usize::from(space.is_some())..];
    }
    pieces.push(rest.iter().collect());
    for piece in pieces.iter_mut().skip(1) {
        piece.insert_str(0, &" ".repeat(indent));
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::wrapped;

    #[test]
    fn long_lines_are_divided_at_spaces_and_indented() {
        assert_eq!(wrapped("short", 5), ["short"]);
        assert_eq!(wrapped("", 5), [""]);
        assert_eq!(
            wrapped("mass  one two three", 12),
            ["mass  one", "      two", "      three"]
        );
        assert_eq!(wrapped("- ab cde fg", 8), ["- ab cde", "  fg"]);
        assert_eq!(wrapped("0123456789ab", 5), ["01234", "56789", "ab"]);
        for columns in 4..40 {
            for line in [
                "- a text of \u{3b8} and others",
                "x  y z",
                "aaaaaaaaaaaaa b",
            ] {
                let pieces = wrapped(line, columns);
                assert!(
                    pieces.iter().all(|piece| piece.chars().count() <= columns),
                    "{pieces:?}"
                );
                let words = |text: &str| text.split_whitespace().collect::<String>();
                assert_eq!(words(&pieces.join(" ")), words(line));
            }
        }
    }
}
