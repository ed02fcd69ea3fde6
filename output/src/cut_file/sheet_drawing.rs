//! The drawing of a whole sheet: its cuts in cutting order, numbers, scale, instructions and
//! registration marks.

use crate::{
    cut_file::{
        cut_drawing::{CutDrawing, Layer},
        cut_lines::CutLines,
        numbers::numbers,
        totals::Totals,
    },
    display::{Shape, Text},
};
use design::{geometry::polygon::size, sheet::cut_sheet::Sheet};
use hinge::SheetMaterial;
use support::Joined;

/// Height of the instructions relative to the size of the sheet, and its minimum (mm).
const NOTE_HEIGHT: f64 = 0.012;
const MIN_NOTE_HEIGHT: f64 = 2.0;
/// Length of the scale bar (mm).
const SCALE_BAR: f64 = 100.0;

/// The drawing of a sheet and its totals.
pub struct SheetDrawing {
    /// Cuts, and the numbers of panels and hinges.
    pub numbered: CutDrawing,
    /// What is written below the sheet: one line each.
    pub notes: Vec<String>,
    /// The amount of cutting.
    pub totals: Totals,
    over_run: f64,
}

impl SheetDrawing {
    /// The drawing of the cuts of `sheet`, cut from `material`.
    pub fn new(cuts: &CutLines, sheet: &Sheet, material: &SheetMaterial) -> Self {
        let home = cuts.tool_outlines()[0][0];
        let mut numbered = cuts.drawing().in_cutting_order(home);
        let totals = Totals::new(&numbered, home);
        let (panels, hinges) = numbers(cuts, sheet);
        for text in panels.into_iter().chain(hinges) {
            numbered.add(Layer::Annotation, Shape::Text(text));
        }
        let (kerf, slit) = (cuts.kerf(), cuts.slit_width);
        let layers = numbered.layers().filter(|layer| layer.is_cut()).map(Layer::name);
        let order = layers.joined(", ");
        let [paths, ends] = if cuts.is_one_pass(kerf) {
            [
                "CUT is one pass of the tool; HOLES and OUTLINE are paths of its centre".to_owned(),
                format!(" Slits over-run the outline by {} mm.", cuts.cutting.over_run),
            ]
        } else {
            [
                format!("CUT and OUTLINE are paths of the tool around slits of {slit} mm"),
                String::new(),
            ]
        };
        let notes = vec![
            format!(
                "{}, {} mm thick, 1:1 in mm. Panels P0 to P{}, {} columns x {} rows; hinges 0 to {}.",
                material.name,
                material.thickness,
                sheet.panels.len() - 1,
                sheet.topology.grid.m,
                sheet.topology.grid.n,
                sheet.hinges.len() - 1
            ),
            format!("Kerf {kerf} mm: {paths}, {} mm off the finished edge.", 0.5 * kerf),
            format!("Order: {order}.{ends}"),
            format!("{totals}."),
        ];
        Self { numbered, notes, totals, over_run: cuts.cutting.over_run }
    }

    /// The drawing of a cut file: with scale, instructions and registration marks.
    pub fn annotated(&self) -> CutDrawing {
        let mut drawing = self.numbered.clone();
        registration_marks(&mut drawing, self.over_run);
        note(&mut drawing, &self.notes);
        drawing
    }
}

/// Three crosses in circles, at all corners of the bounding box but one, so that a turned sheet is
/// noticed.
pub(super) fn registration_marks(drawing: &mut CutDrawing, over_run: f64) {
    let [low, high] = Shape::extent(drawing.on(Layer::Outline));
    let [width, height] = size([low, high]);
    let radius = (0.004 * width.max(height)).clamp(1.0, 5.0);
    let off = over_run + 4.0 * radius;
    let (low, high) = (low.map(|x| x - off), high.map(|x| x + off));
    for centre in [low, [high[0], low[1]], [low[0], high[1]]] {
        drawing.add_cross(Layer::Registration, centre, 1.6 * radius);
        drawing.add(Layer::Registration, Shape::Circle { centre, radius });
    }
}

/// The height of lines of text of which the longest is at most as wide as the cuts of a drawing
/// (mm).
fn text_height(drawing: &CutDrawing, lines: &[String]) -> f64 {
    let [left, right] = Shape::extent(drawing.cuts()).map(|corner| corner[0]);
    let width = right - left;
    let widths = lines.iter().map(|line| Text::line([0.0; 2], 1.0, line).size()[0]);
    let longest = widths.fold(0.0, f64::max);
    f64::min(NOTE_HEIGHT * width, width / longest).max(MIN_NOTE_HEIGHT)
}

/// A scale bar and lines of text below the drawing.
pub(super) fn note(drawing: &mut CutDrawing, lines: &[String]) {
    let left = Shape::extent(drawing.cuts())[0][0];
    let [[_, bottom], _] = drawing.bounds();
    let text = |at, height, text: &str| Shape::Text(Text::line(at, height, text));
    let height = text_height(drawing, lines);

    let mut y = bottom - 2.5 * height;
    let tick = 0.4 * height;
    let ends = [left, left + SCALE_BAR];
    let bar = [[ends[0], y], [ends[1], y]];
    drawing.add(Layer::Annotation, Shape::Line(bar));
    for x in ends {
        let line = [[x, y - tick], [x, y + tick]];
        drawing.add(Layer::Annotation, Shape::Line(line));
    }
    let name = text([ends[1] + height, y - 0.5 * height], height, "100 mm");
    drawing.add(Layer::Annotation, name);
    y -= height;
    for line in lines {
        y -= 2.0 * height;
        drawing.add(Layer::Annotation, text([left, y], height, line));
    }
}

/// The first line of the mark of files that were written although the design has errors.
pub const FORCED: &str = "FORCED, NOT TO BE CUT: the design has errors";

/// Writes the errors of a design above its drawing, on a layer of their own, which is not cut.
/// Without errors the drawing stays as it is.
pub fn mark_errors(drawing: &mut CutDrawing, errors: &[String]) {
    if errors.is_empty() {
        return;
    }
    let lines: Vec<String> =
        std::iter::once(FORCED.to_owned()).chain(errors.iter().cloned()).collect();
    let height = text_height(drawing, &lines);
    let left = Shape::extent(drawing.cuts())[0][0];
    let top = drawing.bounds()[1][1];
    for (i, line) in lines.iter().rev().enumerate() {
        let y = top + 2.0 * height * (i + 1) as f64;
        drawing.add(Layer::Errors, Shape::Text(Text::line([left, y], height, line)));
    }
}
