//! How a sheet and a target that has no place yet are fitted to each other: the size and the
//! rotation of the target, and the corners of the sheet in the stock that it is cut from. Corner i
//! is
//!
//! ```text
//! c + sigma(u_i) (s_i - c),     sigma: the logistic function by components,
//! ```
//!
//! between the middle c of the stock and its corner s_i.

use crate::pattern::{coordinates::logistic, cut_pattern::Outline};
use serde::{Deserialize, Serialize};
use std::array::from_fn;
use support::Point;

/// The variables of a fit, or a gradient in them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitVariables {
    /// Logarithm of the size of the target over its size in the file.
    pub ln_size: f64,
    /// Rotation of the target about its centre, counter-clockwise (rad).
    pub rotation: f64,
    /// u of the corners SW, SE, NE, NW.
    pub corners: [Point; 4],
}

impl FitVariables {
    /// All coordinates, in the order of the fields.
    pub(crate) fn coordinates_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        let corners = self.corners.as_flattened_mut();
        [&mut self.ln_size, &mut self.rotation].into_iter().chain(corners)
    }

    /// The outline of the sheet in a rectangular stock.
    pub fn outline(&self, stock: &Outline) -> Outline {
        let middle = middle(stock);
        Outline {
            corners: from_fn(|i| {
                let along = |c: usize| stock.corners[i][c] - middle[c];
                [0, 1].map(|c| middle[c] + logistic(self.corners[i][c]) * along(c))
            }),
        }
    }

    /// The gradient in the variables from those in size and rotation of the target and in the
    /// corners of the outline.
    pub(crate) fn pullback(
        &self,
        stock: &Outline,
        [ln_size, rotation]: [f64; 2],
        by_outline: &[Point; 4],
    ) -> Self {
        let middle = middle(stock);
        let by_u = |i: usize, c: usize| {
            let fraction = logistic(self.corners[i][c]);
            by_outline[i][c] * fraction * (1.0 - fraction) * (stock.corners[i][c] - middle[c])
        };
        Self { ln_size, rotation, corners: from_fn(|i| [by_u(i, 0), by_u(i, 1)]) }
    }
}

fn middle(stock: &Outline) -> Point {
    let [sw, _, ne, _] = stock.corners;
    [0, 1].map(|c| 0.5 * (sw[c] + ne[c]))
}
