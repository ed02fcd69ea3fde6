//! Common parts of the pictures: the page with its title and scale bar, the colours, the colour
//! scale.

use crate::display::{Anchor, Canvas, Colour, Style, rectangle, trimmed};
use design::{
    geometry::{
        polygon::{bounds, size},
        region::Ring,
    },
    sheet::{cut_sheet::Sheet, hinge_window::HingeWindow, topology::Topology},
};
use support::{Extremes, Point};

/// Colour of main lines and titles.
pub const INK: Colour = [31, 41, 51];
/// Colour of secondary texts.
pub const MUTED: Colour = [102, 114, 127];
/// Colour of what a picture emphasises.
pub const ACCENT: Colour = [194, 65, 12];
/// Second colour of emphasis.
pub const TEAL: Colour = [15, 118, 110];
/// Colours of panels with even and odd column + row, which rotate in opposite senses.
const PANELS: [Colour; 2] = [[234, 240, 246], [246, 240, 228]];

/// Width of a picture on a screen (px).
const WIDTH_PX: f64 = 1400.0;

/// Mean width of a character of DejaVu Sans Bold and DejaVu Sans, relative to the height of the
/// font, at its upper end.
const BOLD_WIDTH: f64 = 0.72;
const PLAIN_WIDTH: f64 = 0.62;
/// Height below which a text is cut off instead of becoming smaller.
const SMALLEST: f64 = 12.0;

/// A text that is at most `wide`, and its height: smaller than `size` if it is long, and cut off if
/// it is very long.
fn fitted(text: &str, size: f64, character: f64, wide: f64) -> (f64, String) {
    let count = text.chars().count();
    let fits = wide / (character * count.max(1) as f64);
    if fits >= SMALLEST {
        return (size.min(fits), text.to_owned());
    }
    let room = (wide / (character * SMALLEST)) as usize;
    let kept: String = text.chars().take(room.saturating_sub(1)).collect();
    (SMALLEST, kept + "\u{2026}")
}

/// A picture: a drawing with margins for texts.
pub(crate) struct Page {
    pub canvas: Canvas,
    /// Lower and upper corner of the drawn content, without the margins (mm).
    low: Point,
    high: Point,
    /// Lower and upper corner of the page (mm).
    corners: [Point; 2],
}

/// Draws the panels of a sheet, which have these boundaries (mm) and lines of this style.
pub(crate) fn panels(
    canvas: &mut Canvas,
    topology: &Topology,
    boundaries: impl IntoIterator<Item = Ring>,
    line: Style,
) {
    for (k, boundary) in boundaries.into_iter().enumerate() {
        canvas.polygon(&boundary, line.filled(panel_colour(topology, k)));
    }
}

/// Draws each hinge window of a sheet in two parts, which are `moved` with their panels, in the
/// `style` of its hinge.
pub(super) fn windows(
    canvas: &mut Canvas,
    sheet: &Sheet,
    style: impl Fn(usize) -> Style,
    moved: impl Fn(usize, Point) -> Point,
) {
    for (h, (hinge, window)) in sheet.hinges.iter().zip(HingeWindow::of_sheet(sheet)).enumerate() {
        for k in hinge.panels() {
            let part = window.inside(&sheet.panels[k]).map(|point| moved(k, point));
            part.contours().for_each(|contour| canvas.polygon(contour, style(h)));
        }
    }
}

/// The colour of a panel.
pub(crate) fn panel_colour(topology: &Topology, panel: usize) -> Colour {
    PANELS[usize::from(!topology.is_even(panel))]
}

impl Canvas {
    /// A line with the given width in units.
    pub(crate) fn stroke(&self, colour: Colour, width: f64) -> Style {
        Style::stroke(colour, width * self.unit).round()
    }

    /// As [`stroke`](Self::stroke), dashed.
    pub(crate) fn dashed(&self, colour: Colour, width: f64, dash: f64) -> Style {
        let dash = dash * self.unit;
        self.stroke(colour, width).dashed(dash, 0.7 * dash)
    }

    /// A text that remains readable over lines.
    pub(crate) fn haloed(&self, colour: Colour) -> Style {
        Style::fill(colour).haloed(4.0 * self.unit)
    }
}

impl Page {
    /// A page around `points`, with space for a title above, a scale bar below and, if requested, a
    /// colour scale at the right.
    pub(crate) fn around(
        points: impl IntoIterator<Item = Point>,
        title: &str,
        subtitle: &str,
        colour_scale: bool,
    ) -> Self {
        let [low, high] = bounds(points);
        let right = if colour_scale { 130.0 } else { 40.0 };
        let [width, height] = size([low, high]);
        let content = f64::max(width, 0.8 * height);
        let unit = content / (1000.0 - 40.0 - right);
        let slack = (content - width) / 2.0;
        let page_low = [low[0] - slack - 40.0 * unit, low[1] - 90.0 * unit];
        let page_high = [high[0] + slack + right * unit, high[1] + 100.0 * unit];
        let corners = [page_low, page_high];
        let mut canvas = Canvas::on_white(corners);
        let left = page_low[0] + 40.0 * unit;
        let ink = Style::fill(INK).bold();
        let top = page_high[1];
        let wide = (page_high[0] - left) / unit - 20.0;
        let (size, title) = fitted(title, 24.0, BOLD_WIDTH, wide);
        canvas.text([left, top - 44.0 * unit], size * unit, Anchor::Start, ink, &title);
        let muted = Style::fill(MUTED);
        let below = [left, top - 70.0 * unit];
        let (size, subtitle) = fitted(subtitle, 15.0, PLAIN_WIDTH, wide);
        canvas.text(below, size * unit, Anchor::Start, muted, &subtitle);
        canvas.unit = unit;
        let mut page = Self { canvas, low, high, corners };
        page.scale_bar([left, page_low[1] + 32.0 * unit]);
        page
    }

    pub(crate) fn finish(self) -> String {
        self.canvas.svg(self.corners, WIDTH_PX, "px")
    }

    /// Draws a scale bar with a round length between a tenth and a quarter of the picture's width.
    fn scale_bar(&mut self, at: Point) {
        let length = round_below((self.corners[1][0] - self.corners[0][0]) / 4.0);
        let (height, end) = (5.0 * self.canvas.unit, at[0] + length);
        let stroke = self.canvas.stroke(INK, 1.6);
        self.canvas.line(at, [end, at[1]], stroke);
        for x in [at[0], end] {
            self.canvas.line([x, at[1] - height], [x, at[1] + height], stroke);
        }
        let text = format!("{length} mm");
        let at = [end + 12.0 * self.canvas.unit, at[1] - 5.0 * self.canvas.unit];
        let muted = Style::fill(MUTED);
        self.canvas.text(at, 15.0 * self.canvas.unit, Anchor::Start, muted, &text);
    }

    /// Draws the colours of `scale` from bottom to top at the right edge, with its ticks.
    pub(crate) fn colour_scale(&mut self, scale: &ColourScale, name: &str) {
        const BANDS: usize = 60;
        let u = self.canvas.unit;
        let right = self.corners[1][0];
        let (x0, x1) = (right - 88.0 * u, right - 68.0 * u);
        let middle = (self.low[1] + self.high[1]) / 2.0;
        let height = f64::min(0.7 * (self.high[1] - self.low[1]), 340.0 * u);
        let bottom = middle - height / 2.0;
        let at = |fraction: f64| bottom + fraction * height;
        for band in 0..BANDS {
            let [f0, f1] = [band, band + 1].map(|edge| edge as f64 / BANDS as f64);
            // Neighbouring bands overlap slightly so that no seam is visible.
            let y1 = at((f1 + 0.3 / BANDS as f64).min(1.0));
            let band = rectangle([[x0, at(f0)], [x1, y1]]);
            self.canvas.polygon(&band, Style::fill(viridis((f0 + f1) / 2.0)));
        }
        let muted = Style::fill(MUTED);
        for tick in 0..=scale.steps() {
            let value = scale.low + scale.step * tick as f64;
            let y = at(tick as f64 / scale.steps() as f64);
            let stroke = self.canvas.stroke(MUTED, 1.0);
            self.canvas.line([x1, y], [x1 + 4.0 * u, y], stroke);
            let text = trimmed(value, 3);
            let at = [x1 + 9.0 * u, y - 5.0 * u];
            self.canvas.text(at, 14.0 * u, Anchor::Start, muted, &text);
        }
        let above = [(x0 + x1) / 2.0, at(1.0) + 16.0 * u];
        self.canvas.text(above, 14.0 * u, Anchor::Middle, muted, name);
    }
}

/// Values from `low` to `high` as colours.
pub(crate) struct ColourScale {
    low: f64,
    high: f64,
    /// Distance between two ticks.
    step: f64,
}

impl ColourScale {
    /// From zero, or the minimum if that is negative, to the maximum, both rounded outwards.
    pub(crate) fn covering(values: impl IntoIterator<Item = f64> + Clone) -> Self {
        let min = values.clone().into_iter().fold(0.0, f64::min);
        let max = values.into_iter().largest();
        let step = round_below(f64::max(max - min, 1e-3) / 4.0);
        Self { low: step * (min / step).floor(), high: step * (max / step).ceil().max(1.0), step }
    }

    fn steps(&self) -> usize {
        ((self.high - self.low) / self.step).round() as usize
    }

    pub(crate) fn colour(&self, value: f64) -> Colour {
        viridis((value - self.low) / (self.high - self.low))
    }
}

/// The largest of 1, 2, 5 times a power of ten that is not above `value`.
pub(crate) fn round_below(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0]
        .map(|digit| digit * decade)
        .into_iter()
        .find(|&round| round <= value)
        .unwrap_or(decade)
}

/// A perceptually uniform scale that remains readable in grey and with colour blindness.
fn viridis(fraction: f64) -> Colour {
    const STOPS: [[f64; 3]; 6] = [
        [68.0, 1.0, 84.0],
        [65.0, 68.0, 135.0],
        [42.0, 120.0, 142.0],
        [34.0, 168.0, 132.0],
        [122.0, 209.0, 81.0],
        [253.0, 231.0, 37.0],
    ];
    let position = fraction.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let stop = (position as usize).min(STOPS.len() - 2);
    let f = position - stop as f64;
    [0, 1, 2].map(|c| (STOPS[stop][c] + f * (STOPS[stop + 1][c] - STOPS[stop][c])) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_rounded_to_one_two_or_five() {
        for (value, expected) in [(1.0, 1.0), (4.9, 2.0), (600.0, 500.0), (0.03, 0.02)] {
            assert!((round_below(value) / expected - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn long_titles_become_smaller_and_very_long_ones_are_cut_off() {
        let width = |(size, text): &(f64, String)| size * BOLD_WIDTH * text.chars().count() as f64;
        for length in [1, 30, 60, 90, 107, 108, 500] {
            let title = "n".repeat(length);
            let found = fitted(&title, 24.0, BOLD_WIDTH, 930.0);
            let fits = width(&found) <= 930.0 + 1e-9;
            assert!(fits && found.0 >= SMALLEST, "{found:?}");
            assert_eq!(found.1 == title, length <= 107, "{found:?}");
        }
        let short = fitted("short", 24.0, BOLD_WIDTH, 930.0);
        assert_eq!(short, (24.0, "short".into()));
    }

    #[test]
    fn the_colour_scale_covers_its_values_and_zero() {
        let scale = ColourScale::covering([12.0, 27.3]);
        assert_eq!((scale.low, scale.high), (0.0, 30.0));
        let scale = ColourScale::covering([-3.0, 27.3]);
        assert!(scale.low <= -3.0 && scale.high >= 27.3);
        assert_eq!(scale.colour(1e9), [0xfd, 0xe7, 0x25]);
        // All values are zero: no division by zero.
        let zero = ColourScale::covering([0.0, 0.0]).colour(0.0);
        assert_eq!(zero, [0x44, 0x01, 0x54]);
    }
}
