//! A small chart in a rectangle of a picture: axes with round ticks, and positions of values.

use crate::{
    display::{Anchor, Canvas, Style, trimmed},
    drawing::page::{INK, MUTED, round_below},
};
use support::Point;

/// A rectangle of the page with one value range along x and one along y.
pub(super) struct Chart {
    low: Point,
    high: Point,
    ranges: [[f64; 2]; 2],
}

impl Chart {
    /// Draws the frame, the ticks and the names of the axes of a chart between the corners `low`
    /// and `high` of the page (mm). `ticks` selects the axes that have ticks.
    pub(super) fn new(
        canvas: &mut Canvas,
        [low, high]: [Point; 2],
        ranges: [[f64; 2]; 2],
        names: [&str; 2],
        ticks: [bool; 2],
    ) -> Self {
        let chart = Self { low, high, ranges };
        let u = canvas.unit;
        let (axis, muted) = (canvas.stroke(MUTED, 1.0), Style::fill(MUTED));
        canvas.line(low, [high[0], low[1]], axis);
        canvas.line(low, [low[0], high[1]], axis);
        let offsets = [([0.0, -4.0], [0.0, -18.0]), ([-4.0, 0.0], [-20.0, -4.0])];
        for (i, (end, label)) in offsets.into_iter().enumerate().filter(|(i, _)| ticks[*i]) {
            for value in chart.ticks(i) {
                let mut place = ranges.map(|[from, _]| from);
                place[i] = value;
                let [x, y] = chart.at(place);
                let shifted = |[dx, dy]: Point| [x + dx * u, y + dy * u];
                canvas.line([x, y], shifted(end), axis);
                canvas.text(shifted(label), 12.0 * u, Anchor::Middle, muted, &trimmed(value, 3));
            }
        }
        let ink = Style::fill(INK);
        let middle = [(low[0] + high[0]) / 2.0, low[1] - 36.0 * u];
        canvas.text(middle, 13.0 * u, Anchor::Middle, ink, names[0]);
        let above = [low[0] - 30.0 * u, high[1] + 10.0 * u];
        canvas.text(above, 13.0 * u, Anchor::Start, ink, names[1]);
        chart
    }

    /// The position of a pair of values on the page.
    pub(super) fn at(&self, values: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| {
            let [from, to] = self.ranges[i];
            self.low[i] + (values[i] - from) / (to - from) * (self.high[i] - self.low[i])
        })
    }

    /// About five round values of an axis.
    fn ticks(&self, axis: usize) -> Vec<f64> {
        let [from, to] = self.ranges[axis];
        let step = round_below((to - from) / 3.0);
        let first = (from / step - 1e-9).ceil() as i64;
        let last = (to / step + 1e-9).floor() as i64;
        (first..=last).map(|i| i as f64 * step).collect()
    }
}
