//! Which panels are pulled, and where to, so that the sheet follows its kinematics from the flat
//! state on.
//!
//! A sheet of narrow ligaments is nearly a mechanism: every hinge opens by the same angle. A panel
//! that is to be pulled along a straight line must advance along it all the way. The steadiness of
//! a panel is its smallest advance between neighbouring openings, over the mean one.

use design::geometry::plane::{complex, point};
use design::geometry::polygon::distance_to_outline;
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{Panel, Sheet};
use design::sheet::ideal_deployment::ideal_deployment;
use design::sheet::kinematics::Configuration;
use faer::c64;

/// Number of openings between which panels advance.
const OPENINGS: usize = 12;

/// A pulled panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// [column, row].
    pub panel: [usize; 2],
    /// Displacement of its reference point in the opened sheet, while the held panel stays (mm).
    pub displacement: [f64; 2],
    /// Smallest advance along the displacement over the mean one; 1 for a motion at a constant rate
    /// along a straight line.
    pub steadiness: f64,
    /// Distance of its reference point from its edges, over the radius of a window.
    pub room: f64,
}

/// The opened sheet on pins while a panel stays where it is.
pub fn opened_about(sheet: &Sheet, held: usize, theta: f64) -> Configuration {
    let free = ideal_deployment(sheet, theta);
    let [x, y, phi] = free[held];
    let (back, fixed) = (c64::cis(-phi), complex(sheet.panels[held].reference));
    let moved = |(panel, [px, py, pphi]): (usize, &[f64; 3])| {
        let flat = complex(sheet.panels[panel].reference);
        let at = flat + c64::new(*px, *py) - fixed - c64::new(x, y);
        let [ux, uy] = point(back * at + fixed - flat);
        [ux, uy, pphi - phi]
    };
    free.iter().enumerate().map(moved).collect()
}

/// How every panel of the outline would be pulled, in order around the sheet.
pub fn candidates(sheet: &Sheet, grid: Grid, held: usize, theta: f64) -> Vec<Pull> {
    let openings = (0..=OPENINGS).map(|i| theta * i as f64 / OPENINGS as f64);
    let path: Vec<Configuration> =
        openings.map(|opening| opened_about(sheet, held, opening)).collect();
    let r_win = sheet.options.process.r_win;
    around(grid)
        .into_iter()
        .map(|[column, row]| {
            let panel = row * grid.m + column;
            let at = |i: usize| {
                let [x, y, _] = path[i][panel];
                c64::new(x, y)
            };
            let end = at(OPENINGS);
            let Panel { reference, corners, .. } = sheet.panels[panel];
            let along = end.conj() / end.norm().max(f64::MIN_POSITIVE);
            let advance = (0..OPENINGS).map(|i| ((at(i + 1) - at(i)) * along).re);
            let least = advance.fold(f64::INFINITY, f64::min);
            Pull {
                panel: [column, row],
                displacement: point(end),
                room: distance_to_outline(reference, &corners) / r_win,
                steadiness: least * OPENINGS as f64 / end.norm().max(f64::MIN_POSITIVE),
            }
        })
        .collect()
}

/// The panels along the outline, counter-clockwise from the lower left.
fn around(Grid { m, n }: Grid) -> Vec<[usize; 2]> {
    let bottom = (0..m).map(|i| [i, 0]);
    let right = (1..n).map(|j| [m - 1, j]);
    let top = (0..m - 1).rev().map(|i| [i, n - 1]);
    let left = (1..n - 1).rev().map(|j| [0, j]);
    bottom.chain(right).chain(top).chain(left).collect()
}

/// The steadiest far panel with room for a hook of each of `count` equal parts of the outline.
pub fn pulls(candidates: &[Pull], count: usize) -> Vec<Pull> {
    let length = |pull: &Pull| complex(pull.displacement).norm();
    let farthest = candidates.iter().map(length).fold(0.0, f64::max);
    let worth = |pull: &Pull| {
        let far = length(pull) / (0.5 * farthest);
        pull.steadiness * far.min(1.0) * pull.room.min(1.0)
    };
    let best = |part: &[Pull]| {
        let best = part.iter().max_by(|one, other| worth(one).total_cmp(&worth(other)));
        best.copied()
    };
    let parts = candidates.chunks(candidates.len().div_ceil(count));
    parts.filter_map(best).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use design::pattern::coordinates::PatternCoordinates;
    use design::pattern::cut_pattern::{CutPattern, Outline};
    use design::sheet::cut_sheet::{HingePoint, SheetOptions};
    use hinge::HingeConstants;

    const GRID: Grid = Grid { m: 4, n: 3 };

    /// Squares of 50 mm.
    fn squares() -> Sheet {
        let outline = Outline::rectangle(200.0, 150.0);
        let pattern = CutPattern::new(GRID, outline, &PatternCoordinates::uniform(GRID)).unwrap();
        let options =
            SheetOptions { hinge_point: HingePoint::Corner, process: HingeConstants::PAPER.into() };
        Sheet::new(&pattern, &vec![2.0; GRID.hinge_count()], options).unwrap()
    }

    #[test]
    fn panels_of_squares_move_apart_as_the_pitch_grows() {
        let (sheet, theta, held) = (squares(), 1.0, 5);
        let opened = opened_about(&sheet, held, theta);
        assert!(opened[held].iter().all(|motion| motion.abs() < 1e-12));
        // Two panels to the right: the pitch of (6), turned by the held panel.
        let [x, y, turned] = opened[held + 2];
        let pitch = 50.0 * (0.5 * theta).sin_cos().0 + 50.0 * (0.5 * theta).cos();
        assert!(((x + 100.0).hypot(y) - 2.0 * pitch).abs() < 1e-9);
        assert!(turned.abs() < 1e-12);
    }

    #[test]
    fn every_part_of_the_outline_has_its_steadiest_far_panel() {
        let candidates = candidates(&squares(), GRID, 5, 1.0);
        assert_eq!(candidates.len(), 10);
        assert_eq!(candidates[3].panel, [3, 0]);
        for count in [1, 2, 4] {
            let chosen = pulls(&candidates, count);
            assert_eq!(chosen.len(), count);
            for pull in &chosen {
                assert!(pull.steadiness > 0.5 && pull.steadiness <= 1.0, "{pull:?}");
            }
        }
    }
}
