//! Backing off: a step of the outer loop that leads to a design without value, or to one that the
//! search does not accept, is halved until it leads to one.

use crate::design_vector::DesignVector;
use crate::gradient::{DesignProblem, Evaluation};
use crate::search::Search;

/// How often a step is halved before it is given up.
pub(crate) const MAX_HALVINGS: u32 = 12;

/// What kept a step from its full length.
#[derive(Default)]
pub(crate) struct Setback {
    pub halvings: u32,
    pub reason: Option<String>,
}

/// Evaluates the proposal, or the first point on halving the way back to `good` that has a finite
/// loss which the search accepts. The error says why the last point had none, if it had none.
pub(crate) fn evaluate_or_back_off(
    problem: &DesignProblem,
    search: &Search,
    good: &DesignVector,
    mut proposal: DesignVector,
) -> Result<(DesignVector, Evaluation, Setback), Option<String>> {
    let mut setback = Setback::default();
    loop {
        let fraction = 0.5f64.powi(setback.halvings as i32);
        let reason = match problem.evaluate(&proposal) {
            Ok(evaluation) if !is_finite(&evaluation) => {
                Some("the loss or its gradient is not finite".to_owned())
            }
            Ok(evaluation) if search.accepts(evaluation.loss, fraction) => {
                return Ok((proposal, evaluation, setback));
            }
            Ok(_) => None,
            Err(error) => Some(error.to_string()),
        };
        if setback.halvings == MAX_HALVINGS {
            return Err(reason);
        }
        setback.halvings += 1;
        setback.reason = setback.reason.or(reason);
        let halfway: Vec<f64> = std::iter::zip(good.to_flat(), proposal.to_flat())
            .map(|(good, proposed)| 0.5 * (good + proposed))
            .collect();
        proposal = proposal.with_flat(&halfway);
    }
}

fn is_finite(evaluation: &Evaluation) -> bool {
    evaluation.loss.is_finite() && evaluation.gradient.to_flat().iter().all(|g| g.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adam::Adam;
    use crate::chamfer::{Chamfer, Precision};
    use crate::design_vector::WidthChart;
    use crate::gradient::Model;
    use crate::grid::Grid;
    use crate::hinge_law::DamageMeasure;
    use crate::objective::{Objective, OutlinePoints};
    use crate::path_functionals::PerFunctional;
    use crate::pattern::Outline;
    use crate::sheet::{Centroid, HingePoint, SheetOptions};
    use hinge::HingeConstants;

    fn problem(grid: Grid) -> DesignProblem {
        DesignProblem {
            grid,
            outline: Outline::rectangle(2.0, 2.0),
            widths: WidthChart {
                w_minus: 0.05,
                w_plus: 0.1,
            },
            options: SheetOptions {
                hinge_point: HingePoint::Corner,
                centroid: Centroid::Area,
                process: HingeConstants {
                    fillet_ratio: 0.16,
                    kerf: 0.01,
                    r_win: 0.3,
                },
            },
            model: Model::Ideal { opening: 0.5 },
            objective: Objective {
                target: vec![[3.0, 3.0]],
                chamfer: Chamfer {
                    coverage_weight: 0.5,
                    smoothing: 0.0,
                    precision: Precision::Samples,
                },
                outline: OutlinePoints::Free,
                centred: false,
                panel_shape: 0.0,
                least_distance: 0.0,
                domain: None,
                weights: PerFunctional::default(),
                damage_measure: DamageMeasure::Mean,
                temperatures: PerFunctional::default(),
            },
        }
    }

    #[test]
    fn a_proposal_without_value_is_halved_until_it_has_one_or_no_more() {
        let grid = Grid { m: 2, n: 2 };
        let good = DesignVector::uniform(grid);
        let proposed = |z: f64| {
            let mut proposal = good.clone();
            proposal.pattern.z.fill(z);
            let adam = Search::Adam(Adam::new(0, 0.1));
            evaluate_or_back_off(&problem(grid), &adam, &good, proposal)
        };
        let (design, _, setback) = proposed(1.0).unwrap();
        assert_eq!((design.pattern.z[0], setback.halvings), (1.0, 0));
        // The logistic chart rounds to 1 near z = 37.
        let (design, _, setback) = proposed(100.0).unwrap();
        assert_eq!((design.pattern.z[0], setback.halvings), (25.0, 2));
        assert!(setback.reason.unwrap().contains("two cuts collide"));
        let reason = proposed(1e9).err().unwrap().unwrap();
        assert!(reason.contains("two cuts collide"));
    }
}
