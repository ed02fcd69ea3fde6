//! A picture of every step in which a sheet is mounted, with what to do.

use crate::{
    display::{Canvas, Style, Text},
    drawing::page::{ACCENT, INK, MUTED, panels},
    report::{mounting_step, open_by_hand},
};
use analysis::mounting::{Fastener, Mounting};
use design::{
    geometry::polygon::bounds,
    sheet::{
        cut_sheet::Sheet,
        kinematics::{Configuration, deployed, deployed_boundaries},
    },
};
use support::Point;

/// Height of the letters, distance of lines, and width of a letter on the mean (mm).
const LETTERS: f64 = 2.3;
const LINES: f64 = 4.2;
const LETTER: f64 = 1.75;
/// Height of the text below a picture, and the distance of pictures (mm).
const TEXT: f64 = 6.0 * LINES;
const APART: f64 = 6.0;
/// Lines of panels, crosses and arrows, the arms of a cross, and the radius of a fastener (mm).
const THIN: f64 = 0.12;
const THICK: f64 = 0.5;
const ARM: f64 = 1.6;
const FASTENER: f64 = 0.9;
/// Length and half width of the head of an arrow (mm).
const HEAD: [f64; 2] = [2.4, 0.9];
/// What is done before.
const FIRST: &str = "Cut the sheet. Move every panel back and forth once, so that no panel sticks to the next. Draw the crosses of the template on the \
                     board. Holes have the numbers of their crosses.";
/// Columns of a picture of all steps, and the width of a cell there (mm).
const COLUMNS: usize = 3;
const CELL: [f64; 2] = [80.0, 95.0];

/// The steps of a mounted sheet.
pub(super) struct StepPictures<'a> {
    sheet: &'a Sheet,
    mounting: &'a Mounting,
    /// Lower left and upper right corner of all states (mm).
    extent: [Point; 2],
}

impl<'a> StepPictures<'a> {
    pub(super) fn new(sheet: &'a Sheet, mounting: &'a Mounting) -> Self {
        let states = mounting.fasteners.iter().map(|fastener| &fastener.sheet);
        let states = states.chain([&mounting.opened]);
        let corners = states.flat_map(|state| deployed_boundaries(sheet, state)).flatten();
        Self { sheet, mounting, extent: bounds(corners) }
    }

    /// Number of pictures: the flat sheet, the sheet opened by hand, and one a fastener.
    pub(super) fn count(&self) -> usize {
        self.mounting.fasteners.len() + self.before()
    }

    /// Number of pictures before the first fastener.
    fn before(&self) -> usize {
        1 + usize::from(self.mounting.by_hand.is_some())
    }

    /// Draws a step into a rectangle of a page (mm), its text below its picture.
    pub(super) fn draw(&self, canvas: &mut Canvas, step: usize, [low, high]: [Point; 2]) {
        let room = [high[0] - low[0], high[1] - low[1] - TEXT];
        let [from, to] = self.extent;
        let scale = f64::min(room[0] / (to[0] - from[0]), room[1] / (to[1] - from[1]));
        let [x, y] = [0, 1].map(|axis| 0.5 * (room[axis] - scale * (from[axis] + to[axis])));
        let place = |at: Point| [low[0] + x + scale * at[0], low[1] + TEXT + y + scale * at[1]];
        let flat = vec![[0.0; 3]; self.sheet.panels.len()];
        let count = (step + 1).saturating_sub(self.before());
        let put_in = &self.mounting.fasteners[..count];
        let (state, text) = match (put_in.last(), &self.mounting.by_hand) {
            (Some(fastener), _) => (&fastener.sheet, mounting_step(count, fastener)),
            (None, Some(by_hand)) if step > 0 => {
                let text = open_by_hand(by_hand);
                (
                    &self.mounting.opened,
                    format!("{text}. The numbered holes then lie over their crosses"),
                )
            }
            _ => (&flat, FIRST.to_owned()),
        };
        let boundaries = deployed_boundaries(self.sheet, state).into_iter();
        let placed = boundaries.map(|boundary| boundary.into_iter().map(place).collect());
        panels(canvas, &self.sheet.topology, placed, Style::stroke(MUTED, THIN));
        for (i, fastener) in self.mounting.fasteners.iter().enumerate() {
            self.mark(canvas, i + 1, fastener, i < count, place);
            if step == 0 {
                let hole = place(self.hole(fastener, state));
                canvas.circle(hole, FASTENER, Style::stroke(INK, THICK));
                canvas.add(
                    Style::fill(INK).haloed(0.8),
                    Text::line([hole[0] + ARM, hole[1] - ARM], LETTERS, &(i + 1).to_string()),
                );
            }
        }
        if let [.., before, last] = put_in {
            arrow(canvas, [self.hole(last, &before.sheet), last.place].map(place));
        }
        for (i, line) in lines(&text, (room[0] / LETTER) as usize).iter().enumerate() {
            let at = [low[0], low[1] + TEXT - LINES * (i + 1) as f64];
            canvas.add(Style::fill(INK), Text::line(at, LETTERS, line));
        }
    }

    /// The hole of a fastener in a state of the sheet.
    fn hole(&self, fastener: &Fastener, state: &Configuration) -> Point {
        let panel = &self.sheet.panels[fastener.panel];
        deployed(panel, state[fastener.panel], panel.reference)
    }

    /// A fastener that is put in, or the cross of one that is not, with its number.
    fn mark(
        &self,
        canvas: &mut Canvas,
        number: usize,
        fastener: &Fastener,
        is_in: bool,
        place: impl Fn(Point) -> Point,
    ) {
        let [x, y] = place(fastener.place);
        if is_in {
            canvas.circle([x, y], FASTENER, Style::fill(INK));
        } else {
            canvas.cross([x, y], ARM, Style::stroke(ACCENT, THICK));
        }
        let at = [x + ARM, y + 0.5 * ARM];
        let colour = if is_in { INK } else { ACCENT };
        let text = Text::line(at, LETTERS, &number.to_string());
        canvas.add(Style::fill(colour).bold().haloed(0.8), text);
    }
}

/// The way of a hole.
fn arrow(canvas: &mut Canvas, [from, to]: [Point; 2]) {
    let length = f64::hypot(to[0] - from[0], to[1] - from[1]);
    if length < HEAD[0] {
        return;
    }
    let [c, s] = [0, 1].map(|axis| (to[axis] - from[axis]) / length);
    let at =
        |along: f64, aside: f64| [from[0] + along * c - aside * s, from[1] + along * s + aside * c];
    let neck = length - HEAD[0];
    canvas.line(from, at(neck, 0.0), Style::stroke(ACCENT, THICK));
    canvas.polygon(&[to, at(neck, HEAD[1]), at(neck, -HEAD[1])], Style::fill(ACCENT));
}

/// A text in lines of at most so many letters.
pub(super) fn lines(text: &str, letters: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.last_mut().expect("there is a line");
        if last.is_empty() {
            last.push_str(word);
        } else if last.chars().count() + 1 + word.chars().count() <= letters {
            last.push(' ');
            last.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// All steps on one picture.
pub(crate) fn steps_svg(sheet: &Sheet, mounting: &Mounting) -> String {
    let pictures = StepPictures::new(sheet, mounting);
    let columns = COLUMNS.min(pictures.count());
    let rows = pictures.count().div_ceil(columns);
    let [width, height] = [0, 1].map(|axis| CELL[axis] + APART);
    let size = [columns as f64 * width + APART, rows as f64 * height + APART];
    let mut canvas = Canvas::on_white([[0.0; 2], size]);
    for step in 0..pictures.count() {
        let left = APART + (step % columns) as f64 * width;
        let low = [left, size[1] - (step / columns + 1) as f64 * height];
        pictures.draw(&mut canvas, step, [low, [low[0] + CELL[0], low[1] + CELL[1]]]);
    }
    canvas.svg([[0.0; 2], size], 4.0 * size[0], "px")
}
