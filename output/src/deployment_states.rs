//! The states in which a deployment is shown: the flat sheet, then every load step. A sheet on pins
//! has no load steps; it is shown at equal steps of its opening.

use design::{
    equilibrium::load_step::LoadStep,
    objective::design_problem::{Deployment, DesignProblem, Model},
    sheet::ideal_deployment::ideal_deployment,
};
use hinge::HingeDeformation;

/// Number of openings at which a sheet on pins is shown.
const OPENINGS: usize = 20;

/// The states before the first state of the path of a deployment.
pub(crate) fn states_before(problem: &DesignProblem, deployment: &Deployment) -> Vec<LoadStep> {
    let (sheet, last) = (&deployment.sheet, deployment.final_step());
    let state = |load_factor, configuration| {
        let mut state = LoadStep::ideal(sheet, configuration);
        state.load_factor = load_factor;
        state
    };
    match &problem.model {
        Model::Ideal { .. } => (0..OPENINGS)
            .map(|i| {
                let load_factor = i as f64 / OPENINGS as f64;
                let opening = load_factor * last.deformations[0].theta;
                state(load_factor, ideal_deployment(sheet, opening))
            })
            .collect(),
        Model::Equilibrium(_) => {
            let mut flat = state(0.0, vec![[0.0; 3]; sheet.panels.len()]);
            if let Some(domain) = problem.model.domain() {
                let undeformed = HingeDeformation::default();
                let inside = |design| domain.contains(design, &undeformed);
                flat.inside = sheet.designs().iter().map(inside).collect();
            }
            vec![flat]
        }
    }
}

/// The indices of at most `most` of `count` states, at least two: the first, the last, and states
/// at equal distances between them.
pub(crate) fn kept(count: usize, most: usize) -> Vec<usize> {
    let stride = (count - 1).div_ceil(most.saturating_sub(1).max(1)).max(1);
    // Counted from the last state, so that the flat sheet is the only one at another distance.
    let mut kept: Vec<usize> = (0..count).rev().step_by(stride).collect();
    if kept.last() != Some(&0) {
        *kept.last_mut().expect("a path has at least one state") = 0;
    }
    kept.reverse();
    kept
}

#[cfg(test)]
mod tests {
    use super::kept;

    #[test]
    fn the_flat_and_the_last_state_are_always_kept() {
        for count in 1..60 {
            for most in 0..70 {
                let kept = kept(count, most);
                assert!(kept.len() <= most.max(2), "{count} {most}: {kept:?}");
                assert_eq!((kept[0], kept[kept.len() - 1]), (0, count - 1));
                assert!(kept.is_sorted_by(|a, b| a < b), "{kept:?}");
                assert!(most < count || kept.len() == count);
            }
        }
    }
}
