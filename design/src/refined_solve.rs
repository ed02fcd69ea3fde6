//! Iterative refinement against the true tangent, with its border if the sheet is driven.
//!
//! Near a singular tangent the factors may be those of H + sigma S, S the sizes of the diagonal and
//! sigma the smallest shift that has factors at all: refinement takes the shift away again wherever
//! the equations have a solution, and the error says whether they have.

use crate::load_step::StepTangent;
use crate::stroke::{HeldFactor, Stroke};
use crate::tangent::TangentPattern;
use std::borrow::Cow;

/// Most rounds; they end as soon as the error no longer halves.
const REFINEMENTS: usize = 20;
/// First shift tried, its growth, and the greatest: shifts of rounding size.
const SHIFTS: [f64; 3] = [1e-14, 10.0, 1e-6];

/// The solution of H x + mu c = b, c . x = 0.
pub(crate) struct Refined {
    pub x: Vec<f64>,
    /// 0 of a sheet that is not driven.
    pub mu: f64,
    /// Greatest componentwise backward error: |b - H x - mu c| over |H| |x| + |mu c| + |b|.
    pub error: f64,
}

/// `None` where not even a shifted tangent has factors.
pub(crate) fn refined_solve(
    pattern: &TangentPattern,
    tangent: &StepTangent,
    stroke: Option<&Stroke>,
    b: &[f64],
) -> Option<Refined> {
    let factor = match &tangent.factor {
        Some(factor) => Cow::Borrowed(factor),
        None => Cow::Owned(least_shifted(pattern, &tangent.values, stroke)?),
    };
    let mut refined = Refined {
        x: vec![0.0; b.len()],
        mu: 0.0,
        error: f64::INFINITY,
    };
    let (mut remainder, mut slack) = (b.to_vec(), 0.0);
    for _ in 0..=REFINEMENTS {
        let (dx, dmu) = factor.solve_bordered(pattern, &remainder, slack);
        let x: Vec<f64> = std::iter::zip(&refined.x, dx).map(|(x, d)| x + d).collect();
        let mu = refined.mu + dmu;
        let (mut product, mut bound) = pattern.product(&tangent.values, &x);
        slack = 0.0;
        for (i, c) in stroke
            .iter()
            .flat_map(|stroke| stroke.direction())
            .enumerate()
        {
            product[i] += mu * c;
            bound[i] += (mu * c).abs();
            slack -= c * x[i];
        }
        remainder = std::iter::zip(b, product).map(|(b, p)| b - p).collect();
        let error = backward_error(&remainder, &bound, b);
        if error >= 0.5 * refined.error || error.is_nan() {
            break;
        }
        refined = Refined { x, mu, error };
    }
    Some(refined)
}

fn least_shifted(
    pattern: &TangentPattern,
    values: &[f64],
    stroke: Option<&Stroke>,
) -> Option<HeldFactor> {
    let scale = pattern.shift_scale(values);
    let [first, growth, greatest] = SHIFTS;
    std::iter::successors(Some(first), |shift| Some(growth * shift))
        .take_while(|shift| *shift <= greatest)
        .find_map(|shift| {
            let shifted = pattern.shifted(values, scale.iter().map(|entry| shift * entry));
            HeldFactor::new(pattern, pattern.factorise(&shifted)?, stroke)
        })
}

/// Greatest |b - H x| over |H| |x| + |b|.
fn backward_error(remainder: &[f64], bound: &[f64], b: &[f64]) -> f64 {
    (remainder.iter().zip(bound).zip(b))
        .filter(|((remainder, _), _)| **remainder != 0.0)
        .map(|((remainder, bound), b)| remainder.abs() / (bound + b.abs()))
        .fold(0.0, f64::max)
}
