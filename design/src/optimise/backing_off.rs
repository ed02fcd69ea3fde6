//! Step halving: a step of the outer loop that leads to a design without objective value, or to one
//! that the search does not accept, is halved until it leads to an acceptable design.

use crate::{
    equilibrium::warm_start::WarmStart,
    objective::design_problem::{DesignProblem, Evaluation},
    optimise::search::Optimiser,
    pattern::design_vector::DesignVector,
};

/// Maximum number of halvings of one step.
pub(crate) const MAX_HALVINGS: u32 = 12;

/// How often a step was halved, and why.
#[derive(Default)]
pub(crate) struct Setback {
    pub halvings: u32,
    pub reason: Option<String>,
}

/// Evaluates the proposal, or else the first point of repeated halving towards `good` that has a
/// finite loss and that the search accepts; `known` is the path of a design near them. The error
/// states why the last point had no value, if it had none.
pub(crate) fn evaluate_or_back_off(
    problem: &DesignProblem,
    search: &Optimiser,
    good: &DesignVector,
    mut proposal: DesignVector,
    known: Option<&WarmStart>,
) -> Result<(DesignVector, Evaluation, Setback), Option<String>> {
    let mut setback = Setback::default();
    loop {
        let fraction = 0.5f64.powi(setback.halvings as i32);
        let reason = match problem.evaluate_near(&proposal, known) {
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
    use crate::objective::design_problem::Model;
    use crate::objective::loss::Objective;
    use crate::objective::shape::ShapeDistance;
    use crate::optimise::adam::Adam;
    use crate::pattern::cut_pattern::Outline;
    use crate::pattern::design_vector::WidthChart;
    use crate::pattern::grid::Grid;
    use crate::sheet::cut_sheet::{HingePoint, SheetOptions};
    use hinge::HingeConstants;

    const GRID: Grid = Grid { m: 2, n: 2 };

    fn problem() -> DesignProblem {
        let process = HingeConstants { kerf: 0.01, r_win: 0.3, ..HingeConstants::PAPER };
        DesignProblem {
            topology: GRID.into(),
            outline: Outline::rectangle(2.0, 2.0),
            widths: WidthChart { w_minus: 0.05, w_plus: 0.1 },
            options: SheetOptions { hinge_point: HingePoint::Corner, process: process.into() },
            model: Model::Ideal { opening: 0.5 },
            objective: Objective {
                shape: ShapeDistance::new(vec![[3.0, 3.0]]),
                functionals: Vec::new(),
                penalties: Vec::new(),
            },
        }
    }

    #[test]
    fn a_proposal_without_value_is_halved_until_it_has_one() {
        let good = DesignVector::uniform(GRID);
        let proposed = |z: f64| {
            let mut proposal = good.clone();
            proposal.pattern.z.fill(z);
            let adam = Optimiser::Adam(Adam::new(0, 0.1));
            evaluate_or_back_off(&problem(), &adam, &good, proposal, None)
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
