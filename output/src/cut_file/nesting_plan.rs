//! The picture of nested designs: every sheet of stock with its margin and its pieces, and the name of each.

use crate::cut_file::cut_drawing::Layer;
use crate::cut_file::nesting::{NestedDesign, NestedSheet, NestingStock, Place};
use crate::display::{Anchor, Canvas, Colour, Shape, Style, rectangle};

/// Sizes relative to the longer side of the stock.
const TEXT: f64 = 0.022;
const LINE: f64 = 0.0012;
/// Width of a character relative to the size of the font.
const CHARACTER: f64 = 0.62;
/// Width of the picture (px).
const WIDTH: f64 = 1000.0;

const INK: Colour = [40, 40, 40];
const STOCK: Colour = [150, 150, 150];
const PIECE: Colour = [226, 238, 240];

/// The SVG of all sheets, the first at the top. A name is as wide as its piece at most.
pub fn nesting_plan(
    designs: &[NestedDesign],
    stock: &NestingStock,
    sheets: &[NestedSheet],
) -> String {
    let [width, height] = stock.size;
    let (text, line) = (TEXT * width.max(height), LINE * width.max(height));
    let pitch = height + 3.0 * text;
    let corners = [
        [-text, height - pitch * sheets.len() as f64 + text],
        [width + text, height + 2.5 * text],
    ];
    let mut canvas = Canvas::on_white(corners);
    for (i, sheet) in sheets.iter().enumerate() {
        let by = [0.0, -pitch * i as f64];
        let mut add = |style: Style, mut shape: Shape| {
            shape.shift(by);
            canvas.shapes.push((style, shape));
        };
        let border = |inset: f64| {
            let corners = [[inset; 2], stock.size.map(|side| side - inset)];
            Shape::Polygon(rectangle(corners).to_vec())
        };
        add(Style::stroke(STOCK, 2.0 * line), border(0.0));
        if stock.margin > 0.0 {
            let dashed = Style::stroke(STOCK, line).dashed(5.0 * line, 5.0 * line);
            add(dashed, border(stock.margin));
        }
        for outline in sheet.drawing.on(Layer::Outline) {
            add(Style::fill(PIECE), outline.clone());
        }
        for (style, shape) in sheet.drawing.coloured(line) {
            add(style, shape.clone());
        }
        let [x, y] = by;
        let title = format!("Sheet {} of {}", i + 1, sheets.len());
        let at = [x, y + height + 0.7 * text];
        canvas.text(at, text, Anchor::Start, Style::fill(INK), &title);
        for place in &sheet.places {
            let label = label(designs, place);
            let wide = CHARACTER * label.chars().count() as f64;
            let size = text.min(0.9 * place.size[0] / wide);
            let middle = [0, 1].map(|axis| by[axis] + place.corner[axis] + 0.5 * place.size[axis]);
            let style = Style::fill(INK).bold().haloed(0.3 * size);
            canvas.text(middle, size, Anchor::Centre, style, &label);
        }
    }
    canvas.svg(corners, WIDTH, "px")
}

fn label(designs: &[NestedDesign], place: &Place) -> String {
    let design = &designs[place.design];
    let copy = match design.copies {
        1 => String::new(),
        _ => format!(" #{}", place.copy),
    };
    let turned = if place.turned { ", turned" } else { "" };
    format!("{}{copy}{turned}", design.name)
}
