//! The cost of a design step.

use anyhow::Result;
use design::objective::design_problem::DesignProblem;
use design::pattern::design_vector::DesignVector;
use std::time::Instant;

/// Number of evaluations, the fastest of which is the cost of a step.
const REPEATS: usize = 5;

/// Time of one design step, equilibria and gradient (s).
pub fn step_time(problem: &DesignProblem, design: &DesignVector) -> Result<f64> {
    let mut fastest = f64::INFINITY;
    for _ in 0..REPEATS {
        let began = Instant::now();
        problem.evaluate(design)?;
        fastest = fastest.min(began.elapsed().as_secs_f64());
    }
    Ok(fastest)
}
