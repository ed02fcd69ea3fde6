//! A drawing on pages of paper, which overlap.

use scene::Paper;
use support::{Fault, Point, ensure};

/// Border that printers leave white (mm).
pub(super) const BORDER: f64 = 10.0;
/// Height of the line below each tile, with its name and a ruler (mm).
pub(super) const FOOTER: f64 = 16.0;
/// Width that two neighbouring tiles share (mm).
pub const OVERLAP: f64 = 10.0;
/// Maximum number of pages of a file.
const MAX_PAGES: usize = 2000;

/// The tiles of a drawing.
#[derive(Clone, Debug)]
pub struct Tiling {
    /// Width and height of a page (mm).
    pub page: [f64; 2],
    /// Number of rows and columns.
    pub counts: [usize; 2],
    /// Lower left corner of all tiles (mm).
    origin: Point,
}

impl Tiling {
    /// Tiles for a drawing from `low` to `high` (mm), in the orientation that takes fewer pages.
    pub fn new(paper: Paper, [low, high]: [Point; 2]) -> Result<Self, Fault> {
        let [width, height] = paper.size();
        let tilings = [[width, height], [height, width]].map(|page| {
            let window = window(page);
            let count = |axis: usize| {
                let steps = (high[axis] - low[axis] - OVERLAP) / (window[axis] - OVERLAP);
                steps.ceil().max(1.0) as usize
            };
            let columns_rows = [count(0), count(1)];
            // The drawing is in the middle of its tiles.
            let origin = [0, 1].map(|axis| {
                let length = columns_rows[axis] as f64 * (window[axis] - OVERLAP) + OVERLAP;
                0.5 * (low[axis] + high[axis] - length)
            });
            Self { page, counts: [columns_rows[1], columns_rows[0]], origin }
        });
        let [portrait, landscape] = tilings;
        let tiling = if landscape.pages() < portrait.pages() { landscape } else { portrait };
        let pages = tiling.pages();
        ensure!(
            pages <= MAX_PAGES,
            "the drawing takes {pages} pages, more than {MAX_PAGES}: choose a larger paper"
        );
        Ok(tiling)
    }

    /// Number of tiles.
    pub fn pages(&self) -> usize {
        self.counts[0].saturating_mul(self.counts[1])
    }

    /// Lower left and upper right corner of a tile in the drawing (mm); row 0 is at the top.
    pub fn tile(&self, row: usize, column: usize) -> [Point; 2] {
        let window = window(self.page);
        let steps = [column, self.counts[0] - 1 - row];
        let low =
            [0, 1].map(|axis| self.origin[axis] + steps[axis] as f64 * (window[axis] - OVERLAP));
        [low, [low[0] + window[0], low[1] + window[1]]]
    }
}

/// Width and height of a page's tile (mm).
fn window([width, height]: [f64; 2]) -> [f64; 2] {
    [width - 2.0 * BORDER, height - 2.0 * BORDER - FOOTER]
}

/// The name of a tile: letters for the row from the top, a number for the column.
pub(super) fn cell_name(row: usize, column: usize) -> String {
    let letter = char::from(b'A' + (row % 26) as u8);
    let before = match row / 26 {
        0 => String::new(),
        more => char::from(b'A' + ((more - 1) % 26) as u8).to_string(),
    };
    format!("{before}{letter}{}", column + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every point of the drawing is on a tile, neighbours share the overlap, and no page is
    /// superfluous.
    #[test]
    fn the_tiles_cover_the_drawing_with_the_overlap() {
        for paper in [Paper::A4, Paper::A3, Paper::Letter] {
            let sizes = [[50.0, 30.0], [190.0, 261.0], [300.0, 200.0], [2800.0, 1234.5]];
            for [width, height] in sizes {
                let [low, high] = [[-7.0, 3.0], [width - 7.0, height + 3.0]];
                let tiling = Tiling::new(paper, [low, high]).unwrap();
                let [rows, columns] = tiling.counts;
                let bottom_left = tiling.tile(rows - 1, 0)[0];
                let top_right = tiling.tile(0, columns - 1)[1];
                for axis in 0..2 {
                    assert!(bottom_left[axis] <= low[axis] + 1e-9);
                    assert!(top_right[axis] >= high[axis] - 1e-9);
                    let slack = top_right[axis] - bottom_left[axis] - (high[axis] - low[axis]);
                    assert!(slack < window(tiling.page)[axis], "{slack}");
                }
                for column in 1..columns {
                    let [left, right] = [column - 1, column].map(|column| tiling.tile(0, column));
                    assert!((left[1][0] - right[0][0] - OVERLAP).abs() < 1e-9);
                }
                for row in 1..rows {
                    let [above, below] = [row - 1, row].map(|row| tiling.tile(row, 0));
                    assert!((below[1][1] - above[0][1] - OVERLAP).abs() < 1e-9);
                }
            }
        }
        for (width, pages) in [(190.0, 1), (191.0, 2)] {
            let tiling = Tiling::new(Paper::A4, [[0.0; 2], [width, 261.0]]);
            assert_eq!(tiling.unwrap().pages(), pages);
        }
    }

    #[test]
    fn a_drawing_of_too_many_pages_is_refused() {
        let error = Tiling::new(Paper::A4, [[0.0; 2], [2e4, 2e4]]).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("choose a larger paper"), "{message}");
    }

    #[test]
    fn names_go_on_after_the_last_letter() {
        assert_eq!(cell_name(0, 0), "A1");
        assert_eq!(cell_name(25, 9), "Z10");
        assert_eq!(cell_name(26, 0), "AA1");
    }
}
