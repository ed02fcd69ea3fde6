//! The even pattern: squares of side 1 that hang together at corners, all hinges open by one angle.
//!
//! Square (i, j) is the cell in column i and row j, of side 1, and turns by -theta/2 if i + j is
//! even and by theta/2 if it is odd, about its centre, which moves from c to p c with the pitch
//!
//! ```text
//! p = cos(theta/2) + (1 - 2 s) sin(theta/2)
//! ```
//!
//! where s is the distance from the corner to the point about which neighbours turn: a ligament
//! turns about a point within it, a pin at the corner has s = 0.

use design::geometry::plane::{complex, point};
use design::geometry::similarity::Similarity;
use faer::c64;
use std::collections::BTreeSet;

/// Column and row of a square; or of its lower left corner.
pub(super) type GridIndex = [i32; 2];

/// Two squares that hang together; the second is to the right of or above the first.
pub(super) type HingedSquares = [GridIndex; 2];

/// How far the pattern is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opening {
    /// theta (rad).
    pub angle: f64,
    /// s.
    pub set_back: f64,
}

impl Opening {
    /// The growth of the pattern in both directions.
    pub(super) fn pitch(self) -> f64 {
        let (sin, cos) = (0.5 * self.angle).sin_cos();
        cos + (1.0 - 2.0 * self.set_back) * sin
    }

    /// The square whose place has a point.
    pub(super) fn square_at(self, at: [f64; 2]) -> GridIndex {
        at.map(|x| (x / self.pitch()).floor() as i32)
    }

    /// A part of the opening.
    pub(super) fn part(self, part: f64) -> Self {
        Self { angle: part * self.angle, ..self }
    }

    /// The motion of a square when the pattern opens.
    pub(super) fn motion(self, cell: GridIndex) -> Similarity {
        let half = if is_even(cell) { -0.5 * self.angle } else { 0.5 * self.angle };
        let (turn, centre) = (c64::cis(half), complex(centre(cell)));
        Similarity { turn, shift: self.pitch() * centre - turn * centre }
    }

    /// The motion of one square as another sees it.
    pub(super) fn relative_motion(self, of: GridIndex, seen_by: GridIndex) -> Similarity {
        let (one, other) = (self.motion(of), self.motion(seen_by));
        Similarity { turn: one.turn / other.turn, shift: (one.shift - other.shift) / other.turn }
    }
}

fn is_even([i, j]: GridIndex) -> bool {
    (i + j).rem_euclid(2) == 0
}

/// The image of a point under a motion.
pub(super) fn moved(motion: Similarity, at: [f64; 2]) -> [f64; 2] {
    point(motion.of(complex(at)))
}

/// The corner at which two squares hang together.
pub(super) fn hinge([first, second]: HingedSquares) -> GridIndex {
    let [i, j] = first;
    match (second[0] > i, is_even(first)) {
        (true, true) => [i + 1, j + 1],
        (true, false) => [i + 1, j],
        (false, true) => [i, j + 1],
        (false, false) => [i + 1, j + 1],
    }
}

/// The four hinged pairs of the loop whose lower left square has these numbers.
pub(super) fn pairs([i, j]: GridIndex) -> [HingedSquares; 4] {
    [
        [[i, j], [i + 1, j]],
        [[i, j + 1], [i + 1, j + 1]],
        [[i, j], [i, j + 1]],
        [[i + 1, j], [i + 1, j + 1]],
    ]
}

/// Two squares next to each other in their order.
pub(super) fn pair(one: GridIndex, other: GridIndex) -> HingedSquares {
    [one.min(other), one.max(other)]
}

/// The squares next to one.
pub(super) fn neighbours([i, j]: GridIndex) -> [GridIndex; 4] {
    [[i + 1, j], [i - 1, j], [i, j + 1], [i, j - 1]]
}

/// The squares of loops.
pub(super) fn squares(loops: &BTreeSet<GridIndex>) -> BTreeSet<GridIndex> {
    let of_loop = |&[i, j]: &GridIndex| [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]];
    loops.iter().flat_map(of_loop).collect()
}

/// The corners of a square, counter-clockwise from the lower left.
pub(super) fn corners(cell: GridIndex) -> Vec<[f64; 2]> {
    let [x, y] = cell.map(f64::from);
    vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]]
}

/// The centre of a square.
pub(super) fn centre(cell: GridIndex) -> [f64; 2] {
    cell.map(|i| f64::from(i) + 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_hang_together_at_their_hinges() {
        for angle in [0.0, 0.3, 1.0, 1.5] {
            let opening = Opening { angle, set_back: 0.0 };
            for first in [[0, 0], [3, 2], [-4, 1]] {
                for second in [[first[0] + 1, first[1]], [first[0], first[1] + 1]] {
                    let hinge = hinge([first, second]).map(f64::from);
                    let [p, q] = [first, second].map(|cell| moved(opening.motion(cell), hinge));
                    assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 1e-12, "{first:?} {second:?}");
                }
            }
        }
    }
}
