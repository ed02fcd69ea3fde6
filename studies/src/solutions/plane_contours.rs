//! The loss on the plane of the principal components, at the opening that is best for each pattern.

use crate::charts::PlaneValues;
use design::analysis::solution_set::PrincipalPlane;
use design::objective::design_problem::DesignProblem;
use design::pattern::coordinates::PatternCoordinates;
use design::pattern::design_vector::DesignVector;

/// Number of points along each axis of the plane.
const POINTS: usize = 41;
/// Openings (deg) among which the best begins to be searched.
const OPENINGS: std::ops::RangeInclusive<usize> = 1..=14;
const STEP_DEG: f64 = 10.0;
/// Number of refinements of the best opening; each reduces its interval to 0.62 of it.
const REFINEMENTS: usize = 10;

/// The roots of the losses, relative to the sheet's side, on the rectangle around `places`; NaN where the plane leaves the
/// patterns. `design` has the ligament widths.
pub fn losses(
    problem: &DesignProblem,
    design: &DesignVector,
    plane: &PrincipalPlane,
    places: Vec<[f64; 2]>,
    side: f64,
) -> PlaneValues {
    let axes = [0, 1].map(|axis| {
        let range = kirigami::ui::charts::padded(places.iter().map(|place| place[axis]));
        let step = (range.end - range.start) / (POINTS - 1) as f64;
        (0..POINTS)
            .map(|i| range.start + step * i as f64)
            .collect::<Vec<_>>()
    });
    let value = |x: f64, y: f64| {
        let values = plane.point([x, y]);
        let Ok(pattern) = PatternCoordinates::from_values(problem.grid, &values) else {
            return f64::NAN;
        };
        let design = DesignVector {
            pattern,
            ..design.clone()
        };
        best_loss(problem, &design).sqrt() / side
    };
    let row = |y: &f64| axes[0].iter().map(|x| value(*x, *y)).collect();
    let values = axes[1].iter().map(row).collect();
    PlaneValues { axes, values }
}

/// The loss (mm^2) at the best opening, by a golden-section search around the best of [`OPENINGS`].
fn best_loss(problem: &DesignProblem, design: &DesignVector) -> f64 {
    let loss = |opening_deg: f64| {
        let opened = DesignVector {
            opening: Some(opening_deg.to_radians()),
            ..design.clone()
        };
        problem.loss(&opened).unwrap_or(f64::INFINITY)
    };
    let openings = OPENINGS.map(|k| STEP_DEG * k as f64);
    let coarse = openings.map(|opening| (loss(opening), opening));
    let Some((_, best)) = coarse.min_by(|x, y| x.0.total_cmp(&y.0)) else {
        return f64::INFINITY;
    };
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let [mut low, mut high] = [best - STEP_DEG, best + STEP_DEG];
    for _ in 0..REFINEMENTS {
        let width = golden * (high - low);
        if loss(high - width) < loss(low + width) {
            high = low + width;
        } else {
            low = high - width;
        }
    }
    loss(0.5 * (low + high))
}
