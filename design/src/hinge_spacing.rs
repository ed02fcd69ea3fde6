//! How far apart the hinges of a panel lie: each is a window of the sheet, and their energies add up only
//! while windows are disjoint. The penalty on crowded hinges is the mean over all pairs that share a panel of
//!
//! ```text
//! max(0, l_min/l - 1)^2,      l: distance of the two corners
//! ```

use crate::plane::{add, complex};
use crate::sheet::Sheet;

/// The distance of each hinge to the nearest other one of its two panels (mm).
pub(crate) fn hinge_spacings(sheet: &Sheet) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; sheet.hinges.len()];
    for [one, other] in neighbours(sheet) {
        let [p, q] = [one, other].map(|h| complex(sheet.hinges[h].corner));
        let apart = (q - p).norm();
        least[one] = least[one].min(apart);
        least[other] = least[other].min(apart);
    }
    least
}

/// The penalty on hinges closer than `least` (mm); its gradient times `weight` is added to that in the
/// corners of every panel.
pub(crate) fn crowding(
    sheet: &Sheet,
    least: f64,
    weight: f64,
    by_corners: &mut [[[f64; 2]; 4]],
) -> f64 {
    let pairs = neighbours(sheet);
    let share = 1.0 / pairs.len().max(1) as f64;
    let mut value = 0.0;
    for [one, other] in pairs {
        let [p, q] = [one, other].map(|h| complex(sheet.hinges[h].corner));
        let apart = (q - p).norm();
        let lacking = f64::max(least / apart - 1.0, 0.0);
        value += share * lacking * lacking;
        let slope = -2.0 * weight * share * lacking * least / (apart * apart);
        for (h, direction) in [(one, p - q), (other, q - p)] {
            let (panel, corner) = sheet.hinges[h].site.a;
            add(&mut by_corners[panel][corner], direction * (slope / apart));
        }
    }
    value
}

/// The pairs of hinges that share a panel.
fn neighbours(sheet: &Sheet) -> Vec<[usize; 2]> {
    let mut of_panel = vec![Vec::new(); sheet.panels.len()];
    for (h, hinge) in sheet.hinges.iter().enumerate() {
        of_panel[hinge.panel_a()].push(h);
        of_panel[hinge.panel_b()].push(h);
    }
    let mut pairs = Vec::new();
    for hinges in of_panel {
        for (i, &one) in hinges.iter().enumerate() {
            pairs.extend(hinges[..i].iter().map(|&other| [one, other]));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charts::PatternCoordinates;
    use crate::grid::Grid;
    use crate::pattern::{CutPattern, Outline};
    use crate::sheet::{Centroid, HingePoint, SheetOptions};
    use hinge::HingeConstants;

    /// Three by three squares of 200 mm.
    fn sheet() -> Sheet {
        let grid = Grid { m: 3, n: 3 };
        let coordinates = PatternCoordinates::uniform(grid);
        let outline = Outline::rectangle(600.0, 600.0);
        let pattern = CutPattern::new(grid, outline, &coordinates).unwrap();
        let options = SheetOptions {
            hinge_point: HingePoint::CutTip,
            centroid: Centroid::Area,
            process: HingeConstants::PAPER,
        };
        Sheet::new(&pattern, &[18.0; 12], options).unwrap()
    }

    #[test]
    fn only_hinges_closer_than_asked_are_crowded() {
        let sheet = sheet();
        let least = hinge_spacings(&sheet)
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let value = |spacing: f64| crowding(&sheet, spacing, 0.0, &mut [[[0.0; 2]; 4]; 9]);
        assert_eq!(value(0.999 * least), 0.0);
        // The nearest pairs alone cost (3/2 - 1)^2, and others less.
        assert!(value(1.5 * least) > 0.0 && value(1.5 * least) < 0.25 + 1e-12);
        assert!(value(2.0 * least) > value(1.5 * least));
    }

    #[test]
    fn the_gradient_pushes_crowded_hinges_apart_and_moves_nothing() {
        let sheet = sheet();
        let mut gradient = [[[0.0; 2]; 4]; 9];
        crowding(&sheet, 500.0, 1.0, &mut gradient);
        let sum = gradient
            .as_flattened()
            .iter()
            .fold([0.0; 2], |sum, by| [sum[0] + by[0], sum[1] + by[1]]);
        assert!(sum.iter().all(|x: &f64| x.abs() < 1e-15), "{sum:?}");
        // A sheet that grows is less crowded: dV/d(scale) < 0.
        let by_scale: f64 = std::iter::zip(&sheet.panels, &gradient)
            .flat_map(|(panel, by)| std::iter::zip(&panel.corners, by))
            .map(|(x, by)| x[0] * by[0] + x[1] * by[1])
            .sum();
        assert!(by_scale < 0.0, "{by_scale}");
    }
}
