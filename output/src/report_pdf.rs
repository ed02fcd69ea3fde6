//! `report.pdf`: the deployed sheet, the flat sheet with its cuts, and the lines of `report.txt`, on A4 in portrait.

use crate::cut_file::pdf_tiles::{draw, write};
use crate::cut_file::{CutDrawing, CutLines, Paper, Text};
use crate::drawing::flat::number_place;
use crate::drawing::load_marks::{Mark, marks};
use crate::drawing::page::{bounds, round_below};
use crate::pdf::{self, Font, colour, filled, line, page, polygon, polyline};
use crate::report::Report;
use design::equilibrium::load_step::LoadStep;
use design::scene::Scene;
use design::scene::design_run::Designed;
use design::scene::placement::placed;
use design::sheet::cut_sheet::Sheet;
use design::sheet::hinge_window::Window;
use design::sheet::kinematics::deployed_corners;
use design::sheet::topology::is_even;
use pdf_writer::Content;
use std::collections::BTreeSet;

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
/// Height of the capitals of captions and of labels (mm).
const CAPTION: f64 = 2.0;
const LABEL: f64 = 1.7;
/// The unit of symbols of supports and loads (mm).
const UNIT: f64 = 0.17;

const WHITE: [u8; 3] = [255; 3];
const INK: [u8; 3] = [31, 41, 51];
const MUTED: [u8; 3] = [102, 114, 127];
const ACCENT: [u8; 3] = [194, 65, 12];
const TEAL: [u8; 3] = [15, 118, 110];
const PANELS: [[u8; 3]; 2] = [[234, 240, 246], [246, 240, 228]];

/// The pages of a run. Without `cuts` the flat sheet is not drawn.
pub(super) fn report_pdf(
    scene: &Scene,
    designed: &Designed,
    report: &Report,
    cuts: Option<&CutLines>,
) -> Vec<u8> {
    let size = Paper::A4.size();
    let deployment = &designed.best.deployment;
    let (sheet, last) = (&deployment.sheet, deployment.final_step());
    let mut first = page();
    let mut top = size[1] - BORDER;
    colour(&mut first, INK);
    let longest = (size[0] - 2.0 * BORDER) / (TITLE_CHARACTER * TITLE);
    let text = report.to_string();
    let (title, rest) = text.split_once('\n').unwrap_or((&text, ""));
    for part in wrapped(title, longest as usize) {
        top -= TITLE;
        pdf::write(&mut first, Font::Bold, TITLE, [BORDER, top], &part);
        top -= 0.3 * TITLE;
    }
    let drawn = Deployed { scene, sheet, last };
    let flat = cuts.map(CutLines::drawing);
    top = drawings(&mut first, top - 3.0, &drawn, flat.as_ref());

    let pages = text_pages(first, top - 4.0, size, rest);
    let count = pages.len();
    let numbered = pages.into_iter().zip(1..).map(|(mut page, number)| {
        let text = format!("page {number} of {count}");
        let at = [size[0] - BORDER - 18.0, 0.6 * BORDER];
        colour(&mut page, MUTED);
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
    fn of(boxes: &[[[f64; 2]; 2]]) -> Self {
        let sum = |axis: usize| boxes.iter().map(|it| side(it, axis)).sum::<f64>();
        let most = |axis: usize| boxes.iter().map(|it| side(it, axis)).fold(0.0, f64::max);
        let gaps = GAP * (boxes.len() - 1) as f64;
        let width = Paper::A4.size()[0] - 2.0 * BORDER;
        let beside = f64::min((width - gaps) / sum(0), HEIGHT / most(1));
        let stacked = f64::min(width / most(0), (HEIGHT - gaps) / sum(1));
        match beside >= stacked {
            true => Self {
                scale: beside,
                beside: true,
                height: beside * most(1),
            },
            false => Self {
                scale: stacked,
                beside: false,
                height: stacked * sum(1) + gaps,
            },
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
    deployed: &Deployed,
    flat: Option<&CutDrawing>,
) -> f64 {
    let boxes = |deployed| {
        let flat = flat.map(CutDrawing::bounds);
        [deployed].into_iter().chain(flat).collect::<Vec<_>>()
    };
    // Arrows have a length on the page: in the sheet they are the longer the smaller the drawing is.
    let mut layout = Layout::of(&boxes(bounds(deployed.points())));
    for _ in 0..8 {
        layout = Layout::of(&boxes(deployed.bounds(layout.scale)));
    }
    let scale = layout.scale;
    let boxes = boxes(deployed.bounds(scale));
    let mut corner = [BORDER, top];
    for (place, outline) in boxes.iter().enumerate() {
        let caption = match place {
            0 => deployed.caption(),
            _ => "Flat: cuts, panels (P) and hinges by number".to_owned(),
        };
        colour(content, MUTED);
        let below = [corner[0], corner[1] - CAPTION];
        write(content, &text(below, CAPTION, false, &caption));
        let origin = [
            corner[0] - scale * outline[0][0],
            corner[1] - 2.5 * CAPTION - scale * outline[1][1],
        ];
        content.save_state();
        let factor = scale as f32;
        let [x, y] = origin.map(|x| x as f32);
        content.transform([factor, 0.0, 0.0, factor, x, y]);
        match (place, flat) {
            (1.., Some(flat)) => {
                content.set_line_width((0.2 / scale) as f32);
                draw(content, flat);
                flat_numbers(content, deployed.sheet, scale);
            }
            _ => deployed.draw(content, scale),
        }
        content.restore_state();
        match layout.beside {
            true => corner[0] += scale * side(outline, 0) + GAP,
            false => corner[1] -= scale * side(outline, 1) + GAP,
        }
    }
    let bottom = top - 2.5 * CAPTION - layout.height - 4.0;
    scale_bar(content, [BORDER, bottom], scale, deployed.shown());
    bottom
}

/// A scale bar, and what the drawings above it show.
fn scale_bar(content: &mut Content, [x, y]: [f64; 2], scale: f64, shown: &str) {
    let length = round_below(40.0 / scale);
    let end = x + scale * length;
    colour(content, INK);
    content.set_line_width(0.25);
    line(content, [[x, y], [end, y]]);
    for x in [x, end] {
        line(content, [[x, y - 1.0], [x, y + 1.0]]);
    }
    let label = format!("{length} mm; {shown}");
    write(content, &text([end + 2.0, y - 0.9], CAPTION, false, &label));
}

/// The numbers of panels and hinges on the flat sheet.
fn flat_numbers(content: &mut Content, sheet: &Sheet, scale: f64) {
    for (k, panel) in sheet.panels.iter().enumerate() {
        panel_number(content, sheet, k, &panel.corners, scale);
    }
    colour(content, TEAL);
    for (number, (hinge, window)) in sheet.hinges.iter().zip(Window::of_sheet(sheet)).enumerate() {
        let height = number_height(sheet.panels[hinge.panel_b()].area(), scale);
        let at = number_place(hinge, &window, f64::max(0.55 * window.radius, 1.3 * height));
        write(content, &text(at, height, true, &number.to_string()));
    }
}

/// The height of a number on a panel of the given area: that of labels, less on small panels.
fn number_height(area: f64, scale: f64) -> f64 {
    f64::min(LABEL / scale, 0.14 * area.sqrt())
}

/// The number of a panel in its middle.
fn panel_number(content: &mut Content, sheet: &Sheet, k: usize, at: &[[f64; 2]; 4], scale: f64) {
    let middle = [0, 1].map(|axis| 0.25 * at.iter().map(|corner| corner[axis]).sum::<f64>());
    let height = number_height(sheet.panels[k].area(), scale);
    colour(content, MUTED);
    write(content, &text(middle, height, true, &format!("P{k}")));
}

/// The deployed sheet in the last state of its path.
struct Deployed<'a> {
    scene: &'a Scene,
    sheet: &'a Sheet,
    last: &'a LoadStep,
}

impl Deployed<'_> {
    fn corners(&self) -> Vec<[[f64; 2]; 4]> {
        let configuration = placed(self.scene, self.sheet, &self.last.configuration);
        deployed_corners(self.sheet, &configuration)
    }

    /// Corners of the panels, and points of the target.
    fn points(&self) -> Vec<[f64; 2]> {
        let mut points = self.corners().concat();
        points.extend(self.scene.target.points());
        points
    }

    /// The bounding box of the drawing with its arrows and labels, on a page that shows 1 mm as `scale`.
    fn bounds(&self, scale: f64) -> [[f64; 2]; 2] {
        let mut points = self.points();
        for mark in marks(self.scene, self.sheet, self.last, UNIT / scale) {
            match mark {
                Mark::Support(corners) | Mark::Shaft(corners) | Mark::Head(corners) => {
                    points.extend(corners);
                }
                Mark::Label(at, label) => {
                    points.extend(text(at, LABEL / scale, true, &label).corners());
                }
            }
        }
        bounds(points)
    }

    /// What the drawings show besides the sheet.
    fn shown(&self) -> &'static str {
        if self.scene.hinge.carries_load() {
            "dashed: target; loads and supports act at the centroids of their panels"
        } else {
            "dashed: target"
        }
    }

    fn caption(&self) -> String {
        if self.scene.hinge.carries_load() {
            let factor = self.last.load_factor;
            format!("Deployed, panels held flat, load factor {factor:.4}")
        } else {
            "Deployed".to_owned()
        }
    }

    /// Panels, with the numbers of those that have no symbol, target, supports and loads, on a page that shows 1 mm as
    /// `scale`.
    fn draw(&self, content: &mut Content, scale: f64) {
        let on_paper = |length: f64| (length / scale) as f32;
        content.set_line_width(on_paper(0.15));
        content.set_line_join(pdf_writer::types::LineJoinStyle::RoundJoin);
        let actuation = self.scene.actuation();
        let supported = actuation.supports.iter().map(|support| support.panel);
        let loaded = actuation
            .boundary_loads()
            .into_iter()
            .map(|load| load.panel);
        let marked: BTreeSet<usize> = supported.chain(loaded).collect();
        for (k, corners) in self.corners().iter().enumerate() {
            colour(content, PANELS[usize::from(!is_even(self.sheet.grid, k))]);
            filled(content, corners);
            colour(content, INK);
            polygon(content, corners);
            if !marked.contains(&k) {
                panel_number(content, self.sheet, k, corners, scale);
            }
        }
        colour(content, ACCENT);
        content.set_line_width(on_paper(0.35));
        content.set_dash_pattern([on_paper(2.0), on_paper(1.4)], 0.0);
        polygon(content, self.scene.target.points());
        content.set_dash_pattern([], 0.0);
        content.set_line_width(on_paper(0.5));
        for mark in marks(self.scene, self.sheet, self.last, UNIT / scale) {
            let support = matches!(mark, Mark::Support(_));
            colour(content, if support { INK } else { ACCENT });
            match mark {
                Mark::Support(corners) | Mark::Head(corners) => filled(content, &corners),
                Mark::Shaft(points) => polyline(content, &points),
                Mark::Label(at, label) => {
                    let label = text(at, LABEL / scale, true, &label);
                    // Readable over lines.
                    let [[x0, y0], [x1, y1]] = label.corners();
                    colour(content, WHITE);
                    filled(content, &[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
                    colour(content, ACCENT);
                    write(content, &label);
                }
            }
        }
    }
}

fn text(at: [f64; 2], height: f64, centred: bool, text: &str) -> Text {
    Text {
        at,
        centred,
        height,
        text: text.to_owned(),
    }
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
                colour(content, INK);
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
        let (room, from) = match pieces.is_empty() {
            true => (columns, indent),
            false => (columns - indent, 0),
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
                    pieces.iter().all(|it| it.chars().count() <= columns),
                    "{pieces:?}"
                );
                let words = |text: &str| text.split_whitespace().collect::<String>();
                assert_eq!(words(&pieces.join(" ")), words(line));
            }
        }
    }
}
