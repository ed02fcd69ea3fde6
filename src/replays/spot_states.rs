//! States drawn uniformly inside a domain, and their windows solved by finite elements.
//!
//! The training domain is convex and contains the flat state. Draw a state x uniformly inside it; x fixes a
//! direction with the density of uniform states. With R the distance to the boundary along it and u uniform in
//! (0, 1), the state at the distance R u^(1/3) is again uniform. Several states can therefore lie on one ray.

use crate::replays::kept_solves::{Outcome, SolveArgs};
use crate::replays::routes::window;
use anyhow::Result;
use dataset::Row;
use fe_driver::{DeformationPath, KeptSolve, ToolVersions, Tools};
use hinge::{
    HingeConstants, HingeDeformation, HingeDesign, HingeSample, SheetMaterial, TrainingDomain,
};
use mesher::Tier;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use std::path::Path;

/// One window to solve, and the fractions of its path at which weights are compared with it.
pub struct Probe {
    /// The hinge design.
    pub design: HingeDesign,
    /// The path along which the window is driven.
    pub path: DeformationPath,
    /// Fractions of the path, in (0, 1].
    pub fractions: Vec<f64>,
}

/// The states on rays that the solver followed to their end.
pub struct Solved {
    /// One row a state; the rows of a window have one job.
    pub rows: Vec<Row>,
    /// Number of states on the other rays.
    pub failed: usize,
    /// Solver CPU time of the paths that it followed to their end (s).
    pub cpu_seconds: f64,
}

/// `count` states drawn uniformly inside a domain, `each` of them on one ray.
pub fn drawn(
    domain: &TrainingDomain,
    constants: &HingeConstants,
    count: usize,
    each: usize,
    seed: u64,
) -> Vec<Probe> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut probes = Vec::new();
    let mut left = count;
    while left > 0 {
        let states = each.min(left);
        probes.push(draw(domain, constants, states, &mut random));
        left -= states;
    }
    probes
}

/// Solves the windows; solutions are stored in `folder` and read from there when the same window is needed again.
pub fn solve(
    probes: &[Probe],
    material: &SheetMaterial,
    tier: Tier,
    solve: &SolveArgs,
    folder: &Path,
) -> Result<Solved> {
    let solves: Vec<KeptSolve> = probes
        .iter()
        .map(|probe| window(probe.design, probe.path.clone(), material, tier))
        .collect();
    let outcomes = solve.solve(&solves.iter().collect::<Vec<_>>(), folder)?;
    let tools = ToolVersions::of(&Tools::find()?);
    let mut solved = Solved {
        rows: Vec::new(),
        failed: 0,
        cpu_seconds: 0.0,
    };
    let mut jobs = BTreeSet::new();
    for ((probe, outcome), kept) in probes.iter().zip(&outcomes).zip(&solves) {
        let job = kept.id();
        // Hinges of a regular sheet can have the same path.
        if !jobs.insert(job.clone()) {
            continue;
        }
        let found = probe.rows(outcome, &job, material, tier, &tools);
        solved.failed += probe.fractions.len() - found.len();
        solved.rows.extend(found);
        let known = outcome.as_ref().ok().and_then(|it| it.cpu_seconds);
        solved.cpu_seconds += known.unwrap_or(0.0);
    }
    Ok(solved)
}

/// A random ray inside the training domain with `states` uniformly distributed states on it.
fn draw(
    domain: &TrainingDomain,
    constants: &HingeConstants,
    states: usize,
    random: &mut ChaCha8Rng,
) -> Probe {
    let mut between = |[from, to]: [f64; 2]| from + (to - from) * random.random::<f64>();
    let design = constants.hinge(
        between(domain.w_lig.map(f64::ln)).exp(),
        between(domain.alpha),
    );
    let bounds = domain.bounds();
    let direction = loop {
        let [eta_a, eta_s, theta] = bounds.map(&mut between);
        let state = HingeDeformation::from_eta(eta_a, eta_s, theta, design.w_lig);
        if domain.contains(&design, &state) {
            break state;
        }
    };
    let edge = edge(domain, &design, &direction);
    let mut radii: Vec<f64> = (0..states).map(|_| between([0.0, 1.0]).cbrt()).collect();
    radii.sort_by(f64::total_cmp);
    let outermost = radii[states - 1];
    Probe {
        design,
        path: DeformationPath::straight(direction.at(edge * outermost)),
        fractions: radii.iter().map(|radius| radius / outermost).collect(),
    }
}

/// The largest factor by which a state can be scaled without leaving the domain.
fn edge(domain: &TrainingDomain, design: &HingeDesign, state: &HingeDeformation) -> f64 {
    let inside = |factor: f64| domain.contains(design, &state.at(factor));
    let mut outside = 2.0;
    while inside(outside) {
        outside *= 2.0;
    }
    let mut edge = 0.5 * outside;
    for _ in 0..40 {
        let middle = 0.5 * (edge + outside);
        *(if inside(middle) {
            &mut edge
        } else {
            &mut outside
        }) = middle;
    }
    edge
}

impl Probe {
    /// The states, none if the solver did not follow the ray to its end.
    fn rows(
        &self,
        outcome: &Outcome,
        job: &str,
        material: &SheetMaterial,
        tier: Tier,
        tools: &ToolVersions,
    ) -> Vec<Row> {
        let Ok(solution) = outcome else {
            return Vec::new();
        };
        let reached = |fraction: &f64| HingeSample::at(&solution.samples, *fraction);
        let samples = self.fractions.iter().filter_map(reached);
        samples
            .map(|sample| Row {
                job: job.into(),
                design: self.design,
                sample,
                failure: String::new(),
                material: material.name.clone(),
                material_hash: material.law_hash(),
                settings_hash: String::new(),
                tier: tier.to_string(),
                solved_tier: tier.to_string(),
                gmsh: tools.gmsh.clone(),
                ccx: tools.ccx.clone(),
                cpu_s: solution.cpu_seconds.unwrap_or(0.0),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_uniform_inside_the_domain() {
        let state = [[-0.8, 0.2], [-0.4, 0.4], [-0.1, 1.3]];
        let domain = TrainingDomain::from_box(state, [5.0, 25.0], [0.8, 2.3]);
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut counts = [0; 4];
        let mut all = 0;
        for _ in 0..500 {
            let probe = draw(&domain, &HingeConstants::PAPER, 4, &mut random);
            assert_eq!(probe.fractions.last(), Some(&1.0));
            for fraction in &probe.fractions {
                let state = probe.path.at(*fraction);
                assert!(domain.contains(&probe.design, &state));
                let [eta_a, eta_s] = state.eta(probe.design.w_lig);
                // Counts in halves of the domain.
                counts[0] += usize::from(eta_a > -0.3);
                counts[1] += usize::from(eta_s > 0.0);
                counts[2] += usize::from(state.theta > 0.6);
                counts[3] += usize::from(probe.design.w_lig > 125f64.sqrt());
                all += 1;
            }
        }
        for count in counts {
            let fraction = f64::from(u32::try_from(count).unwrap()) / f64::from(all);
            // Four standard deviations of 500 independent rays.
            assert!((fraction - 0.5).abs() < 0.09, "{fraction}");
        }
    }
}
