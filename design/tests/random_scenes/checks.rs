//! What must hold for every sheet, and what is counted where it does not.

use crate::dense::DenseCheck;
use crate::drawn::{Drawn, DrawnLaw};
use design::equilibrium::load_step::{DescentEnd, LoadStep, Status};
use design::objective::design_problem::{Deployment, DesignProblem};
use design::optimise::outer_loop::{SearchState, optimise};
use design::optimise::search::SearchMethod;
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;

/// Unbalanced force of an equilibrium by the full matrices, relative to the largest force.
const BALANCED: f64 = 1e-8;
/// Part of the highest eigenvalue by which the lowest may be negative: rounding of the full
/// matrices.
const ROUNDING: f64 = 1e-12;
/// Difference of two configurations of the same sheet (rad, or panel sizes).
const SAME: f64 = 1e-6;
/// Relative difference of the losses of a corrected and of a followed path.
const SAME_LOSS: f64 = 1e-8;
/// Sheets up to this number of hinges are searched for a better design, one in four.
const SEARCHED: usize = 17;

/// What was found at a sheet: its place in the table, its words, and whether it contradicts what
/// the software promises.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding(u8, pub &'static str, pub bool);

impl Finding {
    const SCENES: Self = Self(0, "sheets", false);
    const LEARNED: Self = Self(1, "with a learned law", false);
    const DRIVEN: Self = Self(2, "with a prescribed stroke", false);
    const FULL_LOAD: Self = Self(3, "full load reached", false);
    const JUMPED: Self = Self(4, "with a jump", false);
    const ALMOST: Self = Self(5, "last state `almost`", false);
    const CORRECTED: Self = Self(6, "paths corrected for a design nearby", false);
    const SEARCHED: Self = Self(7, "searches", false);
    const NOT_CUT: Self = Self(8, "pattern without a sheet", false);
    const LOCKED: Self = Self(9, "panels touch before the end of the stroke", false);
    const NO_EQUILIBRIUM_EXTREME: Self =
        Self(10, "no equilibrium found, springs of extreme ratio", false);
    const NO_EQUILIBRIUM: Self = Self(11, "no equilibrium found", true);
    const UNBALANCED: Self = Self(12, "equilibrium not balanced by full matrices", true);
    const UNSTABLE: Self = Self(13, "equilibrium not stable by full matrices", true);
    const MIRROR: Self = Self(14, "mirror image deploys otherwise", true);
    const MIRROR_AFTER_JUMP: Self = Self(15, "mirror image deploys otherwise after a jump", false);
    const SIMILAR: Self = Self(16, "similar sheet deploys otherwise", true);
    const SIMILAR_AFTER_JUMP: Self =
        Self(17, "similar sheet deploys otherwise after a jump", false);
    const LOAD_STEPS: Self = Self(18, "another number of load steps, another state", true);
    const LOAD_STEPS_AFTER_JUMP: Self =
        Self(19, "another number of load steps, another state after a jump", false);
    const OTHER_LOSS: Self =
        Self(20, "corrected path with the followed states and another loss", true);
    const OTHER_ARM: Self =
        Self(21, "corrected path with other stable states, without a jump", false);
    const OTHER_LOSS_AFTER_JUMP: Self =
        Self(22, "corrected path with another loss, followed path with a jump", false);
    const WORSE_THAN_START: Self = Self(23, "search ends above its start", true);
    const FALSE_BEST: Self =
        Self(24, "a step of a search below its best design, and no warning", true);
}

/// What was found, and the details of each.
pub type Findings = Vec<(Finding, String)>;

pub fn findings(seed: u64) -> Findings {
    let drawn = Drawn::new(seed);
    let problem = drawn.problem();
    let mut found = vec![(Finding::SCENES, String::new())];
    let mut add = |finding, details: String| found.push((finding, details));
    if matches!(drawn.law, DrawnLaw::Learned(..)) {
        add(Finding::LEARNED, String::new());
    }
    if drawn.stroke.is_some() {
        add(Finding::DRIVEN, String::new());
    }
    let deployment = match problem.deploy(&drawn.design()) {
        Ok(deployment) => deployment,
        Err(error) => {
            add(Finding::NOT_CUT, error.to_string());
            return found;
        }
    };
    let last = deployment.final_step();
    if last.status == Status::Diverged {
        missed(&drawn, last, &mut add);
        return found;
    }
    add(Finding::FULL_LOAD, String::new());
    if jumps(&deployment) {
        add(Finding::JUMPED, String::new());
    }
    if last.status == Status::Almost {
        add(Finding::ALMOST, last.to_string());
    }
    check_states(&drawn, &problem, &deployment, &mut add);
    same_elsewhere(&drawn, &deployment, &mut add);
    corrected(&drawn, &problem, &deployment, &mut add);
    if drawn.grid.hinge_count() <= SEARCHED && seed.is_multiple_of(4) {
        searched(&drawn, &problem, seed, &mut add);
    }
    found
}

/// The load steps by full matrices.
fn check_states(
    drawn: &Drawn,
    problem: &DesignProblem,
    deployment: &Deployment,
    add: &mut impl FnMut(Finding, String),
) {
    let mut force = 0.0;
    for step in &deployment.path {
        let dense = DenseCheck::new(drawn, problem, &deployment.sheet, step, force);
        force = dense.force;
        let allowed = BALANCED.max(10.0 * step.rounding.max(dense.rounding));
        let claimed = step.status != Status::Almost;
        if claimed && dense.residual > allowed {
            let details = format!("{:.1e}, {step}", dense.residual);
            add(Finding::UNBALANCED, details);
        }
        if claimed && dense.lowest < -ROUNDING {
            add(Finding::UNSTABLE, format!("{:.1e}, {step}", dense.lowest));
        }
    }
}

/// The path of a sheet ends before full load.
fn missed(drawn: &Drawn, last: &LoadStep, add: &mut impl FnMut(Finding, String)) {
    let touching = drawn.stroke.is_some() && drawn.contact.is_some();
    let finding = match last.descent_end {
        Some(DescentEnd::NotFinite) if touching => Finding::LOCKED,
        _ if drawn.is_extreme() => Finding::NO_EQUILIBRIUM_EXTREME,
        _ => Finding::NO_EQUILIBRIUM,
    };
    add(finding, format!("{:?} {last}", last.descent_end));
}

fn jumps(deployment: &Deployment) -> bool {
    deployment.path.iter().any(|step| step.jumps > 0)
}

/// The mirror image, a sheet of half the size and another number of load steps.
fn same_elsewhere(drawn: &Drawn, deployment: &Deployment, add: &mut impl FnMut(Finding, String)) {
    let last = deployment.final_step();
    let size = (deployment.sheet.outline.area() / deployment.sheet.panels.len() as f64).sqrt();
    let mut cases = Vec::new();
    if let Some((mirrored, panels)) = drawn.mirrored() {
        let images = panels.iter().map(|&panel| {
            let [x, y, phi] = last.configuration[panel];
            [-x, y, -phi]
        });
        let findings = [Finding::MIRROR, Finding::MIRROR_AFTER_JUMP];
        cases.push((mirrored, size, images.collect(), findings));
    }
    let halves = (last.configuration.iter()).map(|[x, y, phi]| [0.5 * x, 0.5 * y, *phi]);
    let findings = [Finding::SIMILAR, Finding::SIMILAR_AFTER_JUMP];
    cases.push((drawn.similar(0.5), 0.5 * size, halves.collect(), findings));
    let mut other_steps = drawn.clone();
    other_steps.steps = if drawn.steps > 5 { 3 } else { 17 };
    let findings = [Finding::LOAD_STEPS, Finding::LOAD_STEPS_AFTER_JUMP];
    cases.push((other_steps, size, last.configuration.clone(), findings));
    for (other, size, expected, [fault, after_jump]) in cases {
        let problem = other.problem();
        let found = problem.deploy(&other.design()).unwrap();
        let step = found.final_step();
        if step.status == Status::Diverged {
            missed(&other, step, add);
            continue;
        }
        let apart = distance(&step.configuration, &expected, size);
        // Where rounding leaves forces unbalanced, soft motions are known to less.
        let dense = DenseCheck::new(&other, &problem, &found.sheet, step, 0.0);
        let known = SAME.max(10.0 * step.rounding.max(dense.rounding) / dense.lowest.abs());
        if apart > known {
            let jumped = jumps(&found) || jumps(deployment);
            let details = format!("{apart:.1e}, lowest {:.1e}; {step}; {last}", dense.lowest);
            add(if jumped { after_jump } else { fault }, details);
        }
    }
}

/// Maximum difference of two configurations (rad, or panel sizes).
fn distance(found: &[[f64; 3]], expected: &[[f64; 3]], size: f64) -> f64 {
    let panels = std::iter::zip(found, expected);
    let apart = panels.flat_map(|(found, expected)| {
        let pairs = std::iter::zip(found, expected);
        std::iter::zip([size, size, 1.0], pairs).map(|(unit, (a, b))| (a - b).abs() / unit)
    });
    apart.fold(0.0, f64::max)
}

/// The loss of a design close to the drawn one, with its path corrected from the path of the drawn
/// one and followed from the flat sheet.
fn corrected(
    drawn: &Drawn,
    problem: &DesignProblem,
    deployment: &Deployment,
    add: &mut impl FnMut(Finding, String),
) {
    let design = drawn.design();
    let flat = std::iter::zip(design.to_flat(), 1..);
    let moved: Vec<f64> = flat.map(|(x, i)| x + 0.02 * f64::from(i).sin()).collect();
    let moved = design.with_flat(&moved);
    let Ok(near) = problem.evaluate_near(&moved, Some(&deployment.warm_start())) else {
        return;
    };
    if near.deployment.followed {
        return;
    }
    add(Finding::CORRECTED, String::new());
    check_states(drawn, problem, &near.deployment, add);
    let followed = problem.deploy(&moved).unwrap();
    let last = followed.final_step();
    if last.status == Status::Diverged {
        missed(drawn, last, add);
        return;
    }
    let apart = (near.loss / problem.loss(&moved).unwrap() - 1.0).abs();
    if apart > SAME_LOSS {
        let panels = near.deployment.sheet.panels.len() as f64;
        let size = (near.deployment.sheet.outline.area() / panels).sqrt();
        let mut steps = std::iter::zip(&near.deployment.path, &followed.path);
        let same = |(a, b): (&LoadStep, &LoadStep)| {
            distance(&a.configuration, &b.configuration, size) <= SAME
        };
        let finding = match (jumps(&followed), steps.all(same)) {
            (true, _) => Finding::OTHER_LOSS_AFTER_JUMP,
            (false, true) => Finding::OTHER_LOSS,
            (false, false) => Finding::OTHER_ARM,
        };
        add(finding, format!("{apart:.1e}, {last}"));
    }
}

/// A short search: its best design is not worse than its start and has the loss of its followed
/// path.
fn searched(
    drawn: &Drawn,
    problem: &DesignProblem,
    seed: u64,
    add: &mut impl FnMut(Finding, String),
) {
    let start = drawn.design();
    let Ok(evaluation) = problem.evaluate(&start) else {
        return;
    };
    add(Finding::SEARCHED, String::new());
    let method = match (seed / 4) % 2 {
        0 => SearchMethod::Adam,
        _ => SearchMethod::Lbfgs,
    };
    let mut state = SearchState::new(problem, start, &evaluation, method, 0.03);
    let mut sink = |_: &SearchState| Ok::<(), Infallible>(());
    let Ok(_) = optimise(problem, &mut state, 12, &AtomicBool::new(false), &mut sink);
    let best = problem.loss(&state.best).unwrap_or(f64::INFINITY);
    let steps = state.history.iter().map(|record| record.scores.loss);
    let least = steps.fold(f64::INFINITY, f64::min);
    if best > evaluation.loss * (1.0 + SAME_LOSS) {
        let details = format!("{best} from {}", evaluation.loss);
        add(Finding::WORSE_THAN_START, details);
    }
    if !state.branch_mismatch() && best > least * (1.0 + SAME_LOSS) {
        add(Finding::FALSE_BEST, format!("{least}, {best} when followed"));
    }
}
