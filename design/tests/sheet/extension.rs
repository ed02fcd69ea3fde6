//! A term, a hinge law and an actuation that the library does not contain, each in thirty lines at
//! most, and the gradient of all three together.

use crate::prelude::*;
use crate::taylor::{GRID, assert_order_two, problem, start};
use design::hinge_law::DesignGradient;
use design::objective::term::{Deployed, Term, TermGradient, Weighted};

/// The term: mean square distance of the deployed outline from the origin.
#[derive(Debug)]
struct Spread;

impl Term for Spread {
    fn name(&self) -> &'static str {
        "spread"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let count = at.outline.len() as f64;
        let slopes = at.outline.iter().map(|p| p.map(|x| 2.0 * x / count));
        gradient.add_by_outline(weight, &slopes.collect::<Vec<_>>());
        at.outline.as_flattened().iter().map(|x| x * x / count).sum()
    }
}

/// The law: W = K (a^2 + s^2) / 2 + M w_lig (theta^2 / 2 + theta^4 / 4).
struct Stiffening;

const K: f64 = 100.0;
const M: f64 = 30.0;

impl HingeLaw for Stiffening {
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        Box::new(Prepared(designs.iter().map(|design| design.w_lig).collect()))
    }
}

struct Prepared(Vec<f64>);

impl PreparedLaw for Prepared {
    fn energies(&self, deformations: &[HingeDeformation], _order: Order) -> Vec<HingeEnergy> {
        let energy = |(&w_lig, state): (&f64, &HingeDeformation)| {
            let ([a, s, theta], per_width) =
                (state.to_array(), DesignGradient::from([M, 0.0, 0.0]));
            let square = theta * theta;
            let (value, slope) = (square / 2.0 + square * square / 4.0, theta + theta * square);
            HingeEnergy {
                w: K * (a * a + s * s) / 2.0 + M * w_lig * value,
                forces: [K * a, K * s, M * w_lig * slope],
                tangent: [
                    [K, 0.0, 0.0],
                    [0.0, K, 0.0],
                    [0.0, 0.0, M * w_lig * (1.0 + 3.0 * square)],
                ],
                design: per_width * value,
                mixed: [per_width * 0.0, per_width * 0.0, per_width * slope],
            }
        };
        std::iter::zip(&self.0, deformations).map(energy).collect()
    }
}

/// The actuation: every panel is pulled away from the clamped one in the middle (N).
fn pulled_apart(force: f64) -> EquilibriumSolver {
    let loads = (0..9).flat_map(|panel| {
        let [column, row] = [panel % 3, panel / 3].map(|index| index as f64 - 1.0);
        [(Dof::UX, column), (Dof::UY, row)].map(|(dof, way)| load(panel, dof, way * force))
    });
    let loads: Vec<Load> = loads.filter(|load| load.value != 0.0).collect();
    solver(GRID, &clamp(4), &loads, 4)
}

#[test]
fn a_new_term_law_and_actuation_have_an_exact_gradient() {
    let mut problem = problem(mechanics(Stiffening, pulled_apart(1.0)), HingePoint::CutTip);
    problem.objective.functionals.push(Weighted::new(0.3, Spread));
    assert_order_two(&problem, &start());
}
