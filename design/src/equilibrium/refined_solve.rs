//! Iterative refinement against the true tangent, with its border under displacement control.
//!
//! The tangent is factorised without pivoting. Near a singular tangent, and occasionally for an
//! indefinite one, the factors do not exist or are inaccurate. The factors of H + sigma S are used
//! then, S being the magnitudes of the diagonal: refinement removes the effect of the shift if the
//! equations have a solution, and the backward error shows whether they have.

use crate::equilibrium::{
    displacement_control::{HeldFactor, Stroke},
    load_step::StepTangent,
    tangent::TangentPattern,
};
use std::iter::zip;

/// Maximum number of refinement rounds; they end when the error no longer halves.
const REFINEMENTS: usize = 20;
/// Backward error below which no other shift is tried.
const ENOUGH: f64 = 1e-13;
/// First shift, its growth factor, and its maximum. A smaller shift is removed by fewer refinement
/// rounds, but its factors are less accurate.
const SHIFTS: [f64; 3] = [1e-13, 100.0, 1e-5];

/// The solution of H x + mu c = b, c . x = d.
pub(crate) struct Refined {
    pub x: Vec<f64>,
    /// 0 under load control.
    pub mu: f64,
    /// Maximum componentwise backward error: |b - H x - mu c| relative to |H| |x| + |mu c| + |b|.
    pub error: f64,
}

/// Solution for the right-hand sides (b, d); `None` if not even a shifted tangent can be
/// factorised.
pub(crate) fn refined_solve(
    pattern: &TangentPattern,
    tangent: &StepTangent,
    stroke: Option<&Stroke>,
    b: (&[f64], f64),
) -> Option<Refined> {
    let with = |factor: &HeldFactor| refined(pattern, &tangent.values, factor, stroke, b);
    let own = tangent.factor.as_ref().map(with);
    if own.as_ref().is_some_and(|own| own.error <= ENOUGH) {
        return own;
    }
    let scale = pattern.shift_scale(&tangent.values);
    let [first, growth, maximum] = SHIFTS;
    let mut best = own;
    let mut shift = first;
    while shift <= maximum && best.as_ref().is_none_or(|best| best.error > ENOUGH) {
        let shifted = pattern.shifted(&tangent.values, scale.iter().map(|entry| shift * entry));
        let factor = pattern.factorise(&shifted, Vec::new());
        let factor = factor.and_then(|factor| HeldFactor::new(pattern, factor, stroke));
        let found = factor.as_ref().map(with);
        best = best.into_iter().chain(found).min_by(|a, b| a.error.total_cmp(&b.error));
        shift *= growth;
    }
    best
}

fn refined(
    pattern: &TangentPattern,
    values: &[f64],
    factor: &HeldFactor,
    stroke: Option<&Stroke>,
    (b, d): (&[f64], f64),
) -> Refined {
    let mut refined = Refined { x: vec![0.0; b.len()], mu: 0.0, error: f64::INFINITY };
    let (mut remainder, mut slack) = (b.to_vec(), d);
    for _ in 0..=REFINEMENTS {
        let (dx, dmu) = factor.solve_bordered(pattern, &remainder, slack);
        let x: Vec<f64> = zip(&refined.x, dx).map(|(x, d)| x + d).collect();
        let mu = refined.mu + dmu;
        let (mut product, mut bound) = pattern.product(values, &x);
        slack = d;
        for (i, c) in stroke.iter().flat_map(|stroke| stroke.direction()).enumerate() {
            product[i] += mu * c;
            bound[i] += (mu * c).abs();
            slack -= c * x[i];
        }
        remainder = zip(b, product).map(|(b, p)| b - p).collect();
        let error = backward_error(&remainder, &bound, b);
        if error >= 0.5 * refined.error || error.is_nan() {
            break;
        }
        refined = Refined { x, mu, error };
    }
    refined
}

/// Maximum of |b - H x| relative to |H| |x| + |b|.
fn backward_error(remainder: &[f64], bound: &[f64], b: &[f64]) -> f64 {
    (remainder.iter().zip(bound).zip(b))
        .filter(|((remainder, _), _)| **remainder != 0.0)
        .map(|((remainder, bound), b)| remainder.abs() / (bound + b.abs()))
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::grid::Grid;
    use crate::sheet::topology::Topology;
    use std::sync::Arc;

    const GRIDS: [Grid; 2] = [Grid { m: 3, n: 3 }, Grid { m: 12, n: 12 }];

    /// Panel 0 clamped.
    fn pattern(grid: Grid) -> TangentPattern {
        let supported: Vec<bool> = (0..3 * grid.panel_count()).map(|i| i < 3).collect();
        TangentPattern::new(&Arc::<Topology>::from(grid), &supported)
    }

    /// One block v v' - e w w' per hinge.
    fn tangent(grid: Grid, pattern: &TangentPattern, e: f64, shift: f64) -> StepTangent {
        let blocks = (0..grid.hinge_count()).map(|h| {
            let v: [f64; 6] = std::array::from_fn(|d| ((7 * h + d * d) as f64).sin());
            let w: [f64; 6] = std::array::from_fn(|d| ((3 * h + 2 * d) as f64).cos());
            std::array::from_fn(|i| std::array::from_fn(|j| v[i] * v[j] - e * w[i] * w[j]))
        });
        let values = pattern.assemble(blocks);
        let values = pattern.shifted(&values, std::iter::repeat(shift));
        let factor = pattern.factorise(&values, Vec::new());
        let factor = factor.and_then(|factor| HeldFactor::new(pattern, factor, None));
        StepTangent { values, factor }
    }

    fn wave(dimension: usize) -> Vec<f64> {
        (0..dimension).map(|i| (1.0 + i as f64).sin()).collect()
    }

    /// The maximum error of a solution whose right-hand side is computed from a known solution.
    fn error_of(pattern: &TangentPattern, tangent: &StepTangent) -> (f64, f64) {
        let expected = wave(pattern.diagonal(&tangent.values).len());
        let (b, _) = pattern.product(&tangent.values, &expected);
        let solution = refined_solve(pattern, tangent, None, (&b, 0.0)).unwrap();
        let errors = std::iter::zip(&solution.x, &expected).map(|(x, e)| (x - e).abs());
        (solution.error, errors.fold(0.0, f64::max))
    }

    #[test]
    fn indefinite_tangents_are_solved_to_rounding() {
        for grid in GRIDS {
            let pattern = pattern(grid);
            let tangent = tangent(grid, &pattern, 0.4, 0.1);
            let held = tangent.factor.as_ref().unwrap();
            let negative = held.factor.negative_pivots;
            assert!(negative > 0 && negative < pattern.diagonal(&tangent.values).len());
            let (residual, error) = error_of(&pattern, &tangent);
            assert!(residual < 1e-14 && error < 1e-9, "{residual} {error}");
        }
    }

    /// If a pivot vanishes but the tangent is regular, refinement removes the effect of the shift.
    #[test]
    fn a_regular_tangent_without_factors_is_solved_with_a_shift() {
        for grid in GRIDS {
            let pattern = pattern(grid);
            let StepTangent { values, .. } = tangent(grid, &pattern, 0.4, 0.1);
            let away: Vec<f64> = pattern.diagonal(&values).iter().map(|d| -d).collect();
            let values = pattern.shifted(&values, away.into_iter());
            assert!(pattern.factorise(&values, Vec::new()).is_none());
            let factor = None;
            let hollow = StepTangent { values, factor };
            let (residual, error) = error_of(&pattern, &hollow);
            assert!(residual < 1e-14 && error < 1e-8, "{residual} {error}");
        }
    }

    /// The backward error is of the order of rounding however close the tangent is to singular: the
    /// solution is exact for a tangent that differs in its last digits.
    #[test]
    fn nearly_singular_tangents_keep_their_backward_error() {
        for grid in GRIDS {
            let pattern = pattern(grid);
            for shift in [1e-4, 1e-7, 1e-10, 1e-13] {
                let tangent = tangent(grid, &pattern, 0.0, shift);
                let (residual, _) = error_of(&pattern, &tangent);
                assert!(residual < 1e-13, "{shift} {residual}");
            }
        }
    }

    #[test]
    fn a_singular_tangent_is_detected_by_its_backward_error() {
        let grid = GRIDS[0];
        let pattern = pattern(grid);
        let StepTangent { mut values, .. } = tangent(grid, &pattern, 0.0, 0.1);
        values.fill(0.0);
        let one = |i: usize| f64::from(i != 5);
        let dimension = pattern.diagonal(&values).len();
        let values = pattern.shifted(&values, (0..dimension).map(one));
        let factor = None;
        let singular = StepTangent { values, factor };
        let solve = |b: Vec<f64>| {
            let solution = refined_solve(&pattern, &singular, None, (&b, 0.0));
            solution.unwrap().error
        };
        assert!(solve(wave(dimension)) > 1e-2);
        let solvable = std::iter::zip(wave(dimension), 0..).map(|(b, i)| b * one(i));
        assert!(solve(solvable.collect()) < 1e-15);
    }
}
